//! Meshes from STL and PLY files; STL by `stl_io`.

use super::super::ReadError;
use super::super::packed::open_file;
use super::{MeshFormat, ply_reader};
use crate::surface::Mesh;
use std::io::{BufReader, Read};
use std::path::Path;

/// Whether a file is, by its name, a mesh that [`read_mesh`] reads.
pub fn is_mesh(path: &Path) -> bool {
    matches!(MeshFormat::of_path(path), Some(MeshFormat::Stl | MeshFormat::Ply))
}

/// Reads the triangles of an STL or PLY file, text or binary; polygons are cut into fans. Coordinates are
/// taken as they are, in mm.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Header`] for a file that is not what its name says.
pub fn read_mesh(path: &Path) -> Result<Mesh, ReadError> {
    let (file, size) = open_file(path)?;
    let mut file = BufReader::new(file);
    if MeshFormat::of_path(path) == Some(MeshFormat::Ply) {
        ply_reader::read(file, size)
    } else {
        stl(&mut file)
    }
}

fn stl<R: Read + std::io::Seek>(file: &mut R) -> Result<Mesh, ReadError> {
    let read = stl_io::read_stl(file).map_err(|error| ReadError::damaged_mesh("STL", &error))?;
    let vertices = read.vertices.iter().map(|v| v.0.map(f64::from)).collect();
    let triangles = read.faces.iter().map(|face| face.vertices.map(|v| v as u32)).collect();
    Ok(Mesh { vertices, triangles })
}
