//! Creases into which a surface turns inwards, as where two balls overlap.
//!
//! A blur of sigma fills a crease of slope s on both sides by 0.8 s sigma, of which its shift sigma^2 H explains a half: background
//! voxels lie that much inside the surface, which those of smooth bodies do not. Of the area that the crease had over its filling,
//! 1.1 s^2 sigma a length, compensation gives back as little as a half, and powers of curvature, by which the errors of
//! convex edges are told (`accuracy/uncertainty.rs`), see next to nothing: what curves around the crease is taken off its own.

use crate::local_geometry::Curvature;
use crate::volume::Spacing;
use serde::{Deserialize, Serialize};

/// Depth, in the grid's largest spacing, up to which noise of the grid explains a voxel.
const NOISE: f64 = 0.05;
/// What compensation leaves of A, in units of the depths' integral over sigma^2, and of M, in units of that of depths times
/// the curvature along the crease: 19 to 23 where balls of 6 to 40 voxels meet at 70 to 100 degrees, of A and of M, and 30 to 60
/// below 50 degrees, where much of the filling is thinner than noise (`experiments/hollow_creases`).
const LEFT: f64 = 25.0;
/// Parts of a unit that are added as whole numbers, whose sum is the same in any order.
const PARTS: f64 = (1_u64 << 32) as f64;

/// Background inside the surface, further than the blur's shift explains and less than voxels do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct HollowCreases {
    /// Sum of unexplained depths, in sigma.
    depth: u64,
    /// Sum of these depths times the smaller principal curvature.
    along: u64,
}

impl HollowCreases {
    pub(super) fn merge(&mut self, other: &Self) {
        self.depth = self.depth.saturating_add(other.depth);
        self.along = self.along.saturating_add(other.along);
    }

    /// Adds a voxel that lies so deep inside the surface, mm, beyond what the blur's shift explains.
    pub(super) fn add(&mut self, depth: f64, curvature: &Curvature, sigma: f64, spacing: Spacing) {
        let [most, least] = curvature.principal();
        if least >= 0.0 || sigma <= 0.0 || depth <= NOISE * spacing.largest() {
            return;
        }
        // Where the gradient all but vanishes curvature is anything; a crease does not turn within its own depth.
        let turned = (depth * most.abs().min(least.abs())).min(1.0);
        self.merge(&Self { depth: (depth / sigma * PARTS) as u64, along: (turned * PARTS) as u64 });
    }

    /// By how much A, mm^2, and M, mm, are off, as a standard error.
    pub(super) fn errors(&self, sigma: f64, spacing: Spacing) -> [f64; 2] {
        if sigma <= 0.0 {
            return [0.0; 2];
        }
        let unit = LEFT * spacing.cell_volume() / (sigma * PARTS);
        [unit * self.depth as f64, unit * self.along as f64 / sigma]
    }
}
