//! Smeared delta and Heaviside, and the sums over a band that stand for integrals over a surface.
//!
//! ```
//! use surfometry::integrals::{SmearedDelta, Smearing};
//! // Whatever its width, a smeared delta weighs 1 in all.
//! let delta = SmearedDelta::new(Smearing::Sine, 0.4, 0.5);
//! let sum: f64 = (-500..=500).map(|n| delta.delta(f64::from(n) * 1e-3) * 1e-3).sum();
//! assert!((sum - 1.0).abs() < 1e-6);
//! ```

mod band;
mod globals;
mod partial;
mod parts;
mod quadrature;
mod smeared;

pub use band::Band;
pub use globals::Globals;
pub use partial::{BandGeometry, NarrowVoxels, Observer, Partial, SurfaceIntegrals};
pub use quadrature::{Quadrature, QuadratureRule};
pub use smeared::{SmearedDelta, Smearing};

use crate::local_geometry::Differentiation;
use crate::tiling::IndexBox;
use crate::volume::Spacing;
use rayon::prelude::*;
use std::time::Duration;

/// The part of an object's integrals that lies in some boxes, each of which is one tile or a part of one.
///
/// Parts of disjoint lists of whole tiles merge into the same bits however the tiles were dealt out: over
/// threads, slabs or machines.
pub fn integrate_boxes<D: Differentiation + ?Sized>(
    scheme: &D,
    boxes: &[IndexBox],
    band: &Band,
    quadrature: &Quadrature,
) -> Partial {
    let part = |tile: &IndexBox| {
        let field = scheme.tile_field(Vec::new(), tile, band.delta().half_width());
        Partial::of_tile(
            scheme,
            &field,
            tile,
            band,
            quadrature,
            Observer { look: &mut |_, _| {}, summing: &mut Duration::default() },
        )
    };
    boxes.par_iter().map(part).reduce(Partial::default, |a, b| a.merged(&b))
}

/// Integrals over one object, in powers of mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrals {
    /// Integral of theta(-phi), mm^3.
    pub volume: f64,
    /// Integrals over the surface.
    pub surface: SurfaceIntegrals,
    /// Area whose normal lies within a degree of the grid's x, y and z axis, mm^2: flat faces along the
    /// voxels, as where an image cuts an object.
    pub faces: [f64; 3],
    /// Area whose normal lies 1 to 13 degrees off an axis of the grid, mm^2: where the voxels' terraces are wide.
    pub tilted: f64,
    /// Voxels with phi < 0.
    pub inside_voxels: u64,
    /// Voxels that the delta weighs.
    pub band_voxels: u64,
    /// Band voxels left out of the surface integrals because the gradient has collapsed there.
    pub voxels_without_normal: u64,
    /// Band voxels within narrow parts of the object, and within narrow gaps.
    pub narrow: [NarrowVoxels; 2],
}

impl Integrals {
    /// V, A and M.
    pub fn globals(&self) -> Globals {
        Globals {
            volume: self.volume,
            area: self.surface.area,
            total_mean_curvature: self.surface.total_mean_curvature,
        }
    }

    /// Whether any voxel with a normal lay in the band.
    pub fn has_surface(&self) -> bool {
        self.surface.area > 0.0
    }

    /// The integrals that the parts of an object add up to.
    pub fn of(whole: &Partial, spacing: Spacing) -> Self {
        Self {
            volume: whole.volume() * spacing.cell_volume(),
            surface: whole.surface(spacing.cell_volume()),
            faces: whole.faces(spacing.cell_volume()),
            tilted: whole.tilted(spacing.cell_volume()),
            inside_voxels: whole.inside_voxels,
            band_voxels: whole.band_voxels,
            voxels_without_normal: whole.voxels_without_normal,
            narrow: whole.narrow,
        }
    }
}
