//! Named values at the vertices of a mesh.

use std::borrow::Cow;

/// One value or vector at every vertex. Names and units are those of the contract, the same in every format.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexArray {
    /// Name, which ends in the unit where there is one: `mean_curvature_per_mm`.
    pub name: Cow<'static, str>,
    /// The values.
    pub values: VertexValues,
}

/// Values of a [`VertexArray`].
#[derive(Debug, Clone, PartialEq)]
pub enum VertexValues {
    /// A number a vertex.
    Scalar(Vec<f64>),
    /// A vector a vertex, in world coordinates (RAS).
    Vector(Vec<[f64; 3]>),
}
