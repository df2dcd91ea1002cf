//! Why an input could not be opened or read.

use crate::Stopped;
use crate::io::ReadError;
use crate::phantoms::ParsePhantomError;
use crate::volume::VolumeError;
use crate::voxelisation::VoxeliseError;
use thiserror::Error;

/// Why an input could not be opened or read. The input's name is added by who knows it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InputError {
    /// The file.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The built-in shape.
    #[error(transparent)]
    Phantom(#[from] ParsePhantomError),
    /// A mesh that cannot be put on a lattice.
    #[error(transparent)]
    Voxelise(#[from] VoxeliseError),
    /// A mesh without a lattice.
    #[error("a mesh has no voxels of its own: say how far apart they shall be, in mm")]
    MeshWithoutSpacing,
    /// What the input cannot take.
    #[error("{0}")]
    Unfit(&'static str),
    /// The run was told to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl From<VolumeError> for InputError {
    fn from(error: VolumeError) -> Self {
        Self::Read(error.into())
    }
}
