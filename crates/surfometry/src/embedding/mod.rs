//! From an object to a field phi whose zero level set is its surface, negative inside.

mod blur;
mod corrected_mask;
mod distance;
mod edge_profile;
mod gaussian;
mod given;
mod indicator;
mod kernel;
mod point_kernel;
mod precision;
mod probability;
mod separable;

pub use corrected_mask::CorrectedMask;
pub use distance::DistanceEmbedding;
pub use edge_profile::EdgeProfile;
pub use gaussian::GaussianEmbedding;
pub use indicator::{Indicator, Row};
pub use kernel::{GaussianKernel, TRUNCATION, TRUNCATION_OF_BLUR};
pub use precision::Precision;

use crate::tiling::{Block, IndexBox};

/// A field that can be had on any box of voxels.
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

    /// The field on a box, in memory that was used before; `half_width` is the largest |phi| that needs to be exact.
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

    /// `Some(phi)` where the field is constant on a box, or beyond `half_width` and of one sign, known without
    /// evaluating it.
    fn constant_on(&self, region: &IndexBox, half_width: f64) -> Option<f64>;
}
