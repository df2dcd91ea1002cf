//! Derivatives of the embedding at a voxel and the curvatures of the level set through it.

mod curvature;
mod finite_difference;
mod gaussian_derivatives;
mod interpolation;
mod jet;
mod stencil;

pub use curvature::Curvature;
pub use finite_difference::FiniteDifferences;
pub use gaussian_derivatives::GaussianDerivatives;
pub use jet::Jet;
pub use stencil::MINIMUM_POINTS;

use crate::tiling::{Block, IndexBox};

/// A scheme that hands out an embedding with its derivatives near the surface.
pub trait Differentiation: Sync {
    /// A box outside which there is neither band nor inside.
    fn support(&self, half_width: f64) -> IndexBox;

    /// The field on a tile, and its first and second derivatives wherever |phi| <= `half_width`.
    fn sample(&self, tile: &IndexBox, half_width: f64) -> TileSample;

    /// The field and its derivatives, taken there, at points off the grid: fractional voxel indices, near each other.
    /// Derivatives are along the image's axes, in mm.
    fn jets_at(&self, points: &[[f64; 3]]) -> Vec<Jet>;
}

/// What the integrals need of one tile.
#[derive(Debug)]
pub enum TileSample {
    /// No voxel of the tile lies in the band, and all are on one side of it.
    Constant {
        /// The tile.
        region: IndexBox,
        /// Its field value, or one of the same side.
        phi: f64,
    },
    /// The field, and the band's voxels with their derivatives.
    Varying {
        /// phi at every voxel.
        phi: Block<f64>,
        /// Voxels with |phi| <= the half width, in memory order.
        band: Vec<BandVoxel>,
    },
}

/// A voxel of the band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandVoxel {
    /// Image index.
    pub index: [i64; 3],
    /// The field and its derivatives there.
    pub jet: Jet,
}

impl TileSample {
    /// The tile.
    pub fn region(&self) -> IndexBox {
        match self {
            Self::Constant { region, .. } => *region,
            Self::Varying { phi, .. } => phi.region(),
        }
    }
}

/// Indices of a block where |phi| <= `half_width`, in memory order.
fn band_indices<T: Copy + Into<f64>>(phi: &Block<T>, half_width: f64) -> Vec<[i64; 3]> {
    let mut indices = Vec::new();
    for (y, z) in phi.region().rows() {
        for (x, &value) in (phi.region().lower[0]..).zip(phi.row(y, z)) {
            if value.into().abs() <= half_width {
                indices.push([x, y, z]);
            }
        }
    }
    indices
}

/// The box of the voxels at or below fractional indices; `None` without any.
fn hull_of_points(points: &[[f64; 3]]) -> Option<IndexBox> {
    let voxel = |p: &[f64; 3]| IndexBox::voxel(p.map(|v| v.floor() as i64));
    points.iter().map(voxel).reduce(|hull, voxel| hull.hull(&voxel))
}
