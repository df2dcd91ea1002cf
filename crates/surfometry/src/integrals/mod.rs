//! Smeared delta and Heaviside, and the sums over a band that stand for integrals over a surface.

mod partial;
mod quadrature;
mod smeared;

pub use partial::{Partial, SurfaceIntegrals};
pub use quadrature::{Quadrature, QuadratureRule};
pub use smeared::{SmearedDelta, Smearing};

use crate::local_geometry::Differentiation;
use crate::tiling::TILE_EDGE;
use crate::volume::Spacing;
use rayon::prelude::*;

/// Integrates over an object's surface and inside, tile by tile, in parallel.
///
/// The result is the same to the last bit for any number of threads: see [`Partial`].
pub fn integrate<D: Differentiation + ?Sized>(
    scheme: &D,
    delta: &SmearedDelta,
    quadrature: &Quadrature,
    spacing: Spacing,
) -> Integrals {
    let half_width = delta.half_width();
    let tiles = scheme.support(half_width).tiles(TILE_EDGE);
    let partial = tiles
        .par_iter()
        .map(|tile| Partial::of_tile(&scheme.sample(tile, half_width), delta, quadrature))
        .reduce(Partial::default, |a, b| a.merged(&b));
    Integrals {
        volume: partial.volume() * spacing.cell_volume(),
        surface: partial.surface(spacing.cell_volume()),
        inside_voxels: partial.inside_voxels,
        band_voxels: partial.band_voxels,
        voxels_without_normal: partial.voxels_without_normal,
    }
}

/// Integrals over one object, in powers of mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrals {
    /// Integral of theta(-phi), mm^3.
    pub volume: f64,
    /// Integrals over the surface.
    pub surface: SurfaceIntegrals,
    /// Voxels with phi < 0.
    pub inside_voxels: u64,
    /// Voxels that the delta weighs.
    pub band_voxels: u64,
    /// Band voxels left out of the curvature integrals because the gradient vanishes there.
    pub voxels_without_normal: u64,
}
