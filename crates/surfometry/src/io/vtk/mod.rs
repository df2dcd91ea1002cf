//! Images of VTK: legacy files of structured points, and XML image data. VTK's world has no anatomy: its axes are
//! taken as they are.

mod data_array;
mod image_data;
mod legacy;
mod outline;

pub(super) use image_data::read_header as read_image_data;
pub(super) use legacy::read_header as read_legacy;

use crate::volume::ScalarType;

/// The array of marks at points or cells that do not count, which VTK may write in front of others.
const GHOSTS: &str = "vtkGhostType";

/// The type that arrays in XML call so.
pub(super) fn scalar_of_xml(name: &str) -> Option<ScalarType> {
    Some(match name {
        "UInt8" => ScalarType::U8,
        "Int8" => ScalarType::I8,
        "UInt16" => ScalarType::U16,
        "Int16" => ScalarType::I16,
        "UInt32" => ScalarType::U32,
        "Int32" => ScalarType::I32,
        "UInt64" => ScalarType::U64,
        "Int64" => ScalarType::I64,
        "Float32" => ScalarType::F32,
        "Float64" => ScalarType::F64,
        _ => return None,
    })
}

/// Dimensions and the place of the first value of an array, which has one a point or one a cell.
fn lattice(points: [usize; 3], origin: [f64; 3], spacing: [f64; 3], cells: bool) -> ([usize; 3], [f64; 3]) {
    if cells {
        // A cell's middle is half a step on.
        let dimensions = points.map(|n| n.saturating_sub(1));
        (dimensions, std::array::from_fn(|a| origin[a] + spacing[a] / 2.0))
    } else {
        (points, origin)
    }
}
