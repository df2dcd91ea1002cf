//! Closed surfaces in files, put on a lattice.

use super::slabs::Reader;
use super::{HeaderFacts, InputError, OpenOptions, Slabs, Source};
use crate::io::{MeshFormat, read_mesh};
use crate::volume::{Grid, Spacing};
use crate::voxelisation::VoxelisedMesh;
use std::path::{Path, PathBuf};

/// A closed surface on a lattice.
pub(super) struct MeshSource {
    path: PathBuf,
    voxels: VoxelisedMesh,
}

impl MeshSource {
    pub(super) fn open(path: &Path, options: &OpenOptions) -> Result<Self, InputError> {
        let spacing = Spacing::new(options.spacing.ok_or(InputError::MeshWithoutSpacing)?)?;
        let voxels = VoxelisedMesh::new(&read_mesh(path)?, spacing)?;
        Ok(Self { path: path.to_owned(), voxels })
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
        HeaderFacts {
            format: MeshFormat::of_path(&self.path).map_or("mesh", MeshFormat::name),
            voxel_type: "uint8",
        }
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }
}
