//! The surface phi = 0 as a mesh, and what is known at its vertices.

mod mesh;
mod vertex_array;

pub use mesh::Mesh;
#[cfg(feature = "pictures")]
pub(crate) use mesh::{cross, dot, length, minus};
pub use vertex_array::{VertexArray, VertexValues};
