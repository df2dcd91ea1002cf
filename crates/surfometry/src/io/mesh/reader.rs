//! Meshes from STL and PLY files, by `stl_io` and `ply-rs-bw`.

use super::super::ReadError;
use super::MeshFormat;
use crate::surface::Mesh;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Whether a file is, by its name, a mesh that [`read_mesh`] reads.
pub fn is_mesh(path: &Path) -> bool {
    matches!(MeshFormat::of_path(path), Some(MeshFormat::Stl | MeshFormat::Ply))
}

/// Reads the triangles of an STL or PLY file, text or binary; polygons are cut into fans. Coordinates are taken as they are, in mm.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Header`] for a file that is not what its name says.
pub fn read_mesh(path: &Path) -> Result<Mesh, ReadError> {
    let file = File::open(path).map_err(|source| ReadError::io(path, source))?;
    let mut file = BufReader::new(file);
    if MeshFormat::of_path(path) == Some(MeshFormat::Ply) { ply(&mut file) } else { stl(&mut file) }
}

fn damaged(format: &'static str, reason: &impl std::fmt::Display) -> ReadError {
    ReadError::Header { format, reason: format!("{reason}; export the mesh again") }
}

fn stl<R: Read + std::io::Seek>(file: &mut R) -> Result<Mesh, ReadError> {
    let read = stl_io::read_stl(file).map_err(|error| damaged("STL", &error))?;
    let vertices = read.vertices.iter().map(|v| v.0.map(f64::from)).collect();
    let triangles = read.faces.iter().map(|face| face.vertices.map(|v| v as u32)).collect();
    Ok(Mesh { vertices, triangles })
}

fn ply<R: Read>(file: &mut R) -> Result<Mesh, ReadError> {
    let read = Parser::<DefaultElement>::new().read_ply(file).map_err(|error| damaged("PLY", &error))?;
    let elements = |name: &str| read.payload.get(name).map(Vec::as_slice).unwrap_or_default();
    let vertex = |element: &DefaultElement| -> Option<[f64; 3]> {
        let [x, y, z] = ["x", "y", "z"].map(|axis| element.get(axis).and_then(number));
        Some([x?, y?, z?])
    };
    let vertices: Option<Vec<[f64; 3]>> = elements("vertex").iter().map(vertex).collect();
    let vertices = vertices.ok_or_else(|| damaged("PLY", &"a vertex has no x, y and z"))?;
    let corners = |element: &DefaultElement| -> Option<Vec<u32>> {
        let corners = ["vertex_indices", "vertex_index"]
            .iter()
            .find_map(|name| element.get(*name))
            .and_then(indices)?;
        corners.iter().all(|&v| (v as usize) < vertices.len()).then_some(corners)
    };
    let mut triangles = Vec::new();
    for face in elements("face") {
        let corners =
            corners(face).ok_or_else(|| damaged("PLY", &"a face names vertices that are not there"))?;
        triangles.extend((2..corners.len()).map(|n| [corners[0], corners[n - 1], corners[n]]));
    }
    Ok(Mesh { vertices, triangles })
}

fn number(property: &Property) -> Option<f64> {
    match property {
        Property::Float(v) => Some(f64::from(*v)),
        Property::Double(v) => Some(*v),
        Property::Int(v) => Some(f64::from(*v)),
        Property::Short(v) => Some(f64::from(*v)),
        _ => None,
    }
}

fn indices(property: &Property) -> Option<Vec<u32>> {
    fn all<T: Copy + TryInto<u32>>(values: &[T]) -> Option<Vec<u32>> {
        values.iter().map(|&v| v.try_into().ok()).collect()
    }
    match property {
        Property::ListInt(v) => all(v),
        Property::ListUInt(v) => all(v),
        Property::ListShort(v) => all(v),
        Property::ListUShort(v) => all(v),
        Property::ListChar(v) => all(v),
        Property::ListUChar(v) => all(v),
        _ => None,
    }
}
