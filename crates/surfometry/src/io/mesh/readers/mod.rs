//! Meshes out of files: one file a format, which turns the bytes of a whole file into a [`Surface`].
//!
//! No reader takes memory for what a header claims: counts are compared with the bytes that are there, or vectors
//! grow as these are read. What carries triangles is read or refused by name, never passed over.

mod gifti;
mod glb;
mod numbers;
mod obj;
mod off;
mod ply;
mod space;
mod stl;
mod surface;
mod unpack;
mod vtk;
mod vtp;
mod words;
mod xml;

use super::super::{PACKED, ReadError};
use crate::surface::Mesh;
use std::path::{Path, PathBuf};
use surface::Surface;

/// What came of reading; why not is said in words, to which the format and the cure are added.
type Outcome<T> = Result<T, String>;

/// A format of meshes that are read.
struct MeshKind {
    name: &'static str,
    ending: &'static str,
    read: fn(&[u8]) -> Outcome<Surface>,
}

const KINDS: [MeshKind; 8] = [
    MeshKind { name: "STL", ending: ".stl", read: stl::read },
    MeshKind { name: "PLY", ending: ".ply", read: ply::read },
    MeshKind { name: "OBJ", ending: ".obj", read: obj::read },
    MeshKind { name: "OFF", ending: ".off", read: off::read },
    MeshKind { name: "VTP", ending: ".vtp", read: vtp::read },
    MeshKind { name: VTK, ending: ".vtk", read: vtk::read },
    MeshKind { name: "GIFTI", ending: ".gii", read: gifti::read },
    MeshKind { name: "GLB", ending: ".glb", read: glb::read },
];
const VTK: &str = "VTK";

impl MeshKind {
    fn of(path: &Path) -> Option<&'static Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let name = PACKED.iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or(&name);
        KINDS.iter().find(|kind| name.ends_with(kind.ending))
    }
}

/// The formats that are read, for people.
pub(in crate::io) fn readable() -> String {
    KINDS.iter().map(|kind| format!("{} ({})", kind.name, kind.ending)).collect::<Vec<_>>().join(", ")
}

/// A mesh with what else its file says.
pub(crate) struct MeshFile {
    pub(crate) mesh: Mesh,
    /// The format's name, for people.
    pub(crate) format: &'static str,
    /// Bytes behind the last element, which are no padding.
    pub(crate) surplus: u64,
    /// Files that it names, as its materials.
    pub(crate) beside: Vec<PathBuf>,
}

/// Whether a file is a mesh that [`read_mesh`] reads: by its name, of a `.vtk` file also by what it holds, which may be
/// an image. It may be packed by gzip or bzip2.
pub fn is_mesh(path: &Path) -> bool {
    MeshKind::of(path).is_some_and(|kind| kind.name != VTK || vtk::is_surface(path))
}

/// Reads the triangles of a mesh file: STL, PLY, OBJ, OFF, VTP, VTK poly data, GIFTI or GLB, packed by gzip or bzip2 or
/// not. Polygons are cut into fans, strips into triangles. Coordinates are taken as they are, in mm, as RAS; where the
/// file says `SPACE=LPS`, as 3D Slicer writes it, x and y are turned.
///
/// # Errors
/// [`ReadError::Io`], [`ReadError::NotAFile`], or [`ReadError::Mesh`] for a file that is not what its name says, is
/// damaged, or holds surfaces in a form that is not read.
pub fn read_mesh(path: &Path) -> Result<Mesh, ReadError> {
    read_mesh_file(path).map(|file| file.mesh)
}

/// Reads a mesh and what else its file says.
///
/// # Errors
/// As of [`read_mesh`].
pub(crate) fn read_mesh_file(path: &Path) -> Result<MeshFile, ReadError> {
    let kind = MeshKind::of(path).unwrap_or(&KINDS[0]);
    let refused = |reason| ReadError::Mesh { format: kind.name, reason };
    let bytes = unpack::contents(path, kind.name)?;
    if bytes.is_empty() {
        return Err(refused("the file is empty (0 bytes)".to_owned()));
    }
    let surface = (kind.read)(&bytes).map_err(refused)?;
    drop(bytes);
    let folder = path.parent().unwrap_or(Path::new(""));
    let beside = surface.beside.iter().map(|name| folder.join(name)).collect();
    let surplus = surface.surplus;
    let mesh = surface.into_mesh().map_err(refused)?;
    Ok(MeshFile { mesh, format: kind.name, surplus, beside })
}
