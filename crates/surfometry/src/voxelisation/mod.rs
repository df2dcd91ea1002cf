//! Closed meshes as voxels: those whose centres are inside.
//!
//! ```
//! use surfometry::{surface::Mesh, volume::Spacing, voxelisation::VoxelisedMesh};
//! // A tetrahedron of 10^3 / 6 mm^3, its faces between the voxels' centres.
//! let corners = [[0.0; 3], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 10.0]];
//! let mesh = Mesh {
//!     vertices: corners.map(|corner| corner.map(|x: f64| x + 0.05)).to_vec(),
//!     triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
//! };
//! let image = VoxelisedMesh::new(&mesh, Spacing::new([0.1; 3])?)?.labels()?;
//! let volume = image.mask(1).voxels() as f64 * 0.1_f64.powi(3);
//! assert!((volume / (1000.0 / 6.0) - 1.0).abs() < 0.03);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod closing;
mod crossings;
mod error;
mod voxelised_mesh;

pub use error::VoxeliseError;
pub use voxelised_mesh::VoxelisedMesh;
