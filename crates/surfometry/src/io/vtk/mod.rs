//! Images of VTK: legacy files of structured points, and XML image data. VTK's world has no anatomy: its axes are
//! taken as they are.

mod data_array;
mod image_data;
mod legacy;

pub(super) use image_data::read_header as read_image_data;
pub(super) use legacy::read_header as read_legacy;

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
