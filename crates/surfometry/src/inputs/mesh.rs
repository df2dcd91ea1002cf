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
        // A mesh can be read without its materials, which may be missing.
        let beside = self.beside.iter().filter(|file| file.is_file());
        [&self.path].into_iter().chain(beside).cloned().collect()
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
