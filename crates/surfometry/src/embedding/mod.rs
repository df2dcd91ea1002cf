//! From an object to a field phi whose zero level set is its surface, negative inside.

mod blur;
mod closed_field;
mod corrected_mask;
mod distance;
mod edge_profile;
mod gaussian;
mod given;
mod indicator;
mod kernel;
mod point_field;
mod point_kernel;
mod precision;
mod probability;
mod recovering;
mod separable;

pub use closed_field::ClosedField;
pub use corrected_mask::CorrectedMask;
pub use distance::DistanceEmbedding;
pub use edge_profile::EdgeProfile;
pub use gaussian::GaussianEmbedding;
pub use indicator::{Indicator, Row};
pub use kernel::{GaussianKernel, TRUNCATION, TRUNCATION_OF_BLUR};
pub(crate) use point_kernel::JET_ORDERS;
pub use precision::Precision;
pub use recovering::{Corrections, Price, Recovery};

use crate::tiling::{Block, IndexBox};

/// A field that can be had on any box of voxels.
///
/// Those of this crate serve on their own, with the derivatives of [`local_geometry`](crate::local_geometry)
/// and the mesh of [`surface`](crate::surface); one's own is an implementation away
/// ([`Differentiation`](crate::local_geometry::Differentiation) shows one).
///
/// ```
/// use surfometry::embedding::{Embedding, GaussianEmbedding, TRUNCATION};
/// use surfometry::local_geometry::{Curvature, Differentiation, GaussianDerivatives};
/// use surfometry::surface::extract;
/// use surfometry::tiling::IndexBox;
/// use surfometry::volume::{Grid, Mask};
///
/// // A ball of 12 voxels, blurred by 2 mm; its voxels are 1 mm wide.
/// let grid = Grid::axis_aligned([31; 3], [1.0; 3])?;
/// let square = |v: usize| (v as f64 - 15.0).powi(2);
/// let mask = Mask::from_predicate(grid, |[x, y, z]| square(x) + square(y) + square(z) < 144.0);
/// let embedding = GaussianEmbedding::new(&mask, 2.0, 0.5, TRUNCATION);
///
/// // phi on a box of voxels, which may reach beyond the image: negative inside.
/// let phi = embedding.evaluate(&IndexBox::new([10, 15, 15], [40, 16, 16]), 0.5);
/// assert!(phi.get([15, 15, 15]) < -0.49 && phi.get([38, 15, 15]) == 0.5);
///
/// // The field and its derivatives at any points, in fractional voxel indices.
/// let scheme = GaussianDerivatives::new(embedding);
/// let points = [[21.7, 21.7, 21.7], [8.3, 8.3, 21.7]];
/// for jet in scheme.jets(&points) {
///     assert!((Curvature::of(&jet).unwrap().mean_curvature - 1.0 / 11.6).abs() < 0.02);
/// }
///
/// // The zero level as a mesh.
/// let mesh = extract(scheme.embedding(), &grid);
/// assert!((mesh.area() / (4.0 * std::f64::consts::PI * 11.6 * 11.6) - 1.0).abs() < 0.03);
/// # Ok::<(), surfometry::volume::VolumeError>(())
/// ```
pub trait Embedding: Sync {
    /// Precision in which the field is kept.
    type Value: Precision;

    /// A box outside which no voxel can have |phi| <= `half_width` or phi < 0.
    fn support(&self, half_width: f64) -> IndexBox;

    /// Voxels of the object, on each side of a voxel, that the field there depends on.
    fn halo(&self, half_width: f64) -> [i64; 3];

    /// The part of a box where the field exists: all of it, unless the field ends at the image's edge.
    fn available(&self, region: &IndexBox) -> IndexBox {
        *region
    }

    /// The field on a box, in memory that was used before; `half_width` is the largest |phi| that needs to be
    /// exact.
    fn evaluate_in(
        &self,
        storage: Vec<Self::Value>,
        region: &IndexBox,
        half_width: f64,
    ) -> Block<Self::Value>;

    /// The field on a box.
    fn evaluate(&self, region: &IndexBox, half_width: f64) -> Block<Self::Value> {
        self.evaluate_in(Vec::new(), region, half_width)
    }

    /// `Some(phi)` where the field is constant on a box, or beyond `half_width` and of one sign, known
    /// without evaluating it.
    fn constant_on(&self, region: &IndexBox, half_width: f64) -> Option<f64>;
}
