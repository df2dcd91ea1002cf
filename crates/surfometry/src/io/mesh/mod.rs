//! Meshes as files: one file a format. Positions are world coordinates (RAS) in mm in all of them, triangles
//! face outward, and an array has the same name everywhere (docs/formats.md).

mod csv;
mod document;
mod gifti;
mod glb;
mod little_endian;
mod obj;
mod ply;
mod readers;
mod stl;
mod vtp;

pub use document::MeshDocument;
pub(super) use readers::readable;
pub(crate) use readers::{MeshFile, read_mesh_file};
pub use readers::{is_mesh, read_mesh};

use super::write_whole;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A mesh file's format. Only VTP and CSV keep all digits of every array; docs/formats.md says what each one
/// holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Polygon file format, binary: MeshLab, CloudCompare, Blender, trimesh.
    Ply,
    /// VTK's XML poly data: ParaView, PyVista, 3D Slicer.
    Vtp,
    /// Stereolithography, binary: triangles only.
    Stl,
    /// Wavefront: positions, normals, colours.
    Obj,
    /// glTF 2.0, binary: viewers in the browser and on desktops.
    Glb,
    /// GIFTI: Connectome Workbench, FreeView, nibabel. A surface, and its data in files beside it.
    Gifti,
    /// A table, a vertex a row, without the triangles.
    Csv,
}

impl MeshFormat {
    /// The extensions of mesh files.
    pub const EXTENSIONS: [&str; 7] = [".ply", ".vtp", ".stl", ".obj", ".glb", ".gii", ".csv"];

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "PLY",
            Self::Vtp => "VTP",
            Self::Stl => "STL",
            Self::Obj => "OBJ",
            Self::Glb => "GLB",
            Self::Gifti => "GIFTI",
            Self::Csv => "CSV",
        }
    }

    /// By the file's extension, in upper or lower case.
    pub fn of_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "ply" => Some(Self::Ply),
            "vtp" => Some(Self::Vtp),
            "stl" => Some(Self::Stl),
            "obj" => Some(Self::Obj),
            "glb" => Some(Self::Glb),
            "gii" => Some(Self::Gifti),
            "csv" => Some(Self::Csv),
            _ => None,
        }
    }
}

/// Writes a mesh in the format that the file's extension names, whole or not at all, and returns what was
/// written: the file itself, and for GIFTI `NAME.shape.gii` (scalars) and `NAME.vector.gii` (vectors) beside
/// `NAME.surf.gii` or `NAME.gii`, where there are such arrays.
///
/// # Errors
/// `InvalidInput` for an unknown extension or a document that does not hold together: no triangles, a vertex
/// number or a length that is off, a value that is infinite, or is not a number where that does not stand for a scalar's
/// lack. Otherwise whatever the file system says.
pub fn write_mesh(path: impl AsRef<Path>, document: &MeshDocument<'_>) -> io::Result<Vec<PathBuf>> {
    let path = path.as_ref();
    let Some(format) = MeshFormat::of_path(path) else {
        return Err(invalid(format!("a mesh file's name ends in {}", MeshFormat::EXTENSIONS.join(", "))));
    };
    document.check()?;
    let write: fn(&mut dyn Write, &MeshDocument<'_>) -> io::Result<()> = match format {
        MeshFormat::Ply => ply::write,
        MeshFormat::Vtp => vtp::write,
        MeshFormat::Stl => stl::write,
        MeshFormat::Obj => obj::write,
        MeshFormat::Glb => glb::write,
        MeshFormat::Csv => csv::write,
        MeshFormat::Gifti => return gifti::write_files(path, document),
    };
    write_whole(path, |out| write(out, document))?;
    Ok(vec![path.to_owned()])
}

/// The files that [`write_mesh`] may write for a name.
///
/// # Errors
/// `InvalidInput` for a name that means the data of a GIFTI surface and not the surface.
pub fn mesh_paths(path: &Path) -> io::Result<Vec<PathBuf>> {
    match MeshFormat::of_path(path) {
        Some(MeshFormat::Gifti) => gifti::paths(path).map(Vec::from),
        _ => Ok(vec![path.to_owned()]),
    }
}

fn invalid(message: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message.into())
}

#[cfg(test)]
mod test_meshes;

#[cfg(test)]
mod tests {
    use super::test_meshes::tetrahedron;
    use super::*;

    #[test]
    fn a_format_by_its_extension() {
        for extension in MeshFormat::EXTENSIONS {
            let name = format!("a.b{extension}");
            let format = MeshFormat::of_path(Path::new(&name));
            assert!(format.is_some());
            assert_eq!(format, MeshFormat::of_path(Path::new(&name.to_uppercase())));
        }
        assert_eq!(MeshFormat::of_path(Path::new("a.surf.gii")), Some(MeshFormat::Gifti));
        assert_eq!(MeshFormat::of_path(Path::new("ply")), None);
        assert_eq!(MeshFormat::of_path(Path::new("a.nii.gz")), None);
    }

    #[test]
    fn an_unknown_extension_names_the_known_ones() {
        let owned = tetrahedron();
        let error = write_mesh("a.xyz", &owned.document()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
        assert!(error.to_string().contains(".ply, .vtp"));
    }

    #[test]
    fn nothing_is_left_of_a_document_that_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut owned = tetrahedron();
        owned.mesh.vertices[1][2] = f64::NAN;
        for extension in MeshFormat::EXTENSIONS {
            let path = folder.path().join(format!("a{extension}"));
            assert!(write_mesh(path, &owned.document()).is_err());
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
