//! The surface phi = 0 as a mesh, and what is known at its vertices.

mod cell;
mod cell_interior;
mod curvature_summary;
mod distribution;
mod isosurface;
mod mesh;
mod quantity;
mod surface_map;
mod tile_mesh;
mod triangulation;
mod vertex_array;
mod vertex_geometry;

pub use curvature_summary::CurvatureSummary;
pub use distribution::{Distribution, Histogram, Moments, QUANTILES};
pub use isosurface::{SurfaceSummary, extract};
pub use mesh::Mesh;
#[cfg(feature = "pictures")]
pub(crate) use mesh::{cross, dot, length, minus};
pub use quantity::LocalQuantity;
pub use surface_map::Surface;
pub use vertex_array::{VertexArray, VertexValues};
pub use vertex_geometry::VertexGeometry;
