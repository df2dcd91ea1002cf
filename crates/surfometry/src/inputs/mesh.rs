//! Closed surfaces in files, put on a lattice.

use super::slabs::Reader;
use super::{HeaderFacts, InputError, OpenOptions, Slabs, Source};
use crate::accuracy::{Flag, FlagCode};
use crate::io::{MeshFile, read_mesh_file};
use crate::volume::{Grid, Spacing};
use crate::voxelisation::VoxelisedMesh;
use std::path::{Path, PathBuf};

/// A closed surface on a lattice.
pub(super) struct MeshSource {
    path: PathBuf,
    format: &'static str,
    surplus: u64,
    beside: Vec<PathBuf>,
    voxels: VoxelisedMesh,
}

impl MeshSource {
    pub(super) fn open(path: &Path, options: &OpenOptions) -> Result<Self, InputError> {
        let spacing = Spacing::new(options.spacing.ok_or(InputError::MeshWithoutSpacing)?)?;
        let MeshFile { mesh, format, surplus, beside } = read_mesh_file(path)?;
        let voxels = VoxelisedMesh::new(&mesh, spacing)?;
        Ok(Self { path: path.to_owned(), format, surplus, beside, voxels })
    }
}

/// The files that a mesh rests on.
pub(super) fn files(path: &Path) -> Result<Vec<PathBuf>, InputError> {
    Ok(with_those_beside(path, &read_mesh_file(path)?.beside))
}

/// A mesh can be read without its materials, which may be missing.
fn with_those_beside(path: &Path, beside: &[PathBuf]) -> Vec<PathBuf> {
    let there = beside.iter().map(PathBuf::as_path).filter(|file| file.is_file());
    [path].into_iter().chain(there).map(Path::to_owned).collect()
}

impl Source for MeshSource {
    fn grid(&self) -> &Grid {
        self.voxels.grid()
    }

    fn slabs(&self) -> Result<Slabs<'_>, InputError> {
        Ok(Box::new(Reader(self.voxels.slabs())))
    }

    fn is_object(&self) -> bool {
        true
    }

    fn header(&self) -> HeaderFacts {
        HeaderFacts { format: self.format, voxel_type: "uint8" }
    }

    fn files(&self) -> Vec<PathBuf> {
        with_those_beside(&self.path, &self.beside)
    }

    fn flags(&self) -> Vec<Flag> {
        let bytes = self.surplus;
        let message = format!(
            "{bytes} bytes follow the last element that the mesh's header counts, and were not read: is the rest of the \
             surface in them?"
        );
        (bytes > 0).then(|| Flag::new(FlagCode::SurplusData, message)).into_iter().collect()
    }
}
