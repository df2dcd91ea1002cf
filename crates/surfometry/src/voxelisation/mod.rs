//! Closed meshes as voxels: those whose centres are inside.

mod crossings;
mod voxelised_mesh;

pub use voxelised_mesh::{VoxeliseError, VoxelisedMesh};
