//! The band of voxels that stands for a surface.

use super::SmearedDelta;
use crate::local_geometry::{Curvature, Jet};

/// Share of the expected slope below which a voxel's gradient says nothing of a surface. Half-way through a
/// plate of 3 voxels at sigma 2 voxels it is 0 and grows to half of a flat edge's at the faces.
const COLLAPSED: f64 = 0.05;

/// A smeared delta, and what a voxel of its band must be like for its curvature to count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    delta: SmearedDelta,
    minimum_gradient: f64,
    /// Of a blurred flat edge: the slope at level 1/2, and phi there. 0 where it is another field.
    edge: (f64, f64),
}

/// Share of a flat edge's slope at the same level below which another surface is near: half-way through a
/// part, or across a gap, of 2.4 sigma the band's outermost voxels have 0.6. Curvature of 1 / (3 sigma) takes
/// 0.2 off.
const NARROW: f64 = 0.6;

impl Band {
    /// A band that is `thickness` mm wide across a flat surface, which sets the slope to expect: 2 eps / t.
    ///
    /// Where the band reaches the middle of a thin part, the gradient falls to 0 though no surface is near,
    /// and curvature, which divides by it, blows up. Voxels with less than a twentieth of the expected slope
    /// carry no curvature.
    pub fn new(delta: SmearedDelta, thickness: f64) -> Self {
        Self { delta, minimum_gradient: COLLAPSED * 2.0 * delta.epsilon() / thickness, edge: (0.0, 0.0) }
    }

    /// Tells which slope a flat edge has, so that narrow parts and gaps can be told from it: a step blurred
    /// by `sigma`, of which `level` is the surface.
    #[must_use]
    pub fn of_blurred_edge(self, sigma: f64, level: f64) -> Self {
        let steepest = 1.0 / (sigma * libm::sqrt(std::f64::consts::TAU));
        Self { edge: (steepest, level - 0.5), ..self }
    }

    /// The slope of a flat edge where the field is phi, exp(-x^2 / 2) = 1 - pi u^2 + O(u^4) of the steepest
    /// where the blurred step is 1/2 + u; 0 where that is not known.
    #[inline(always)]
    pub(super) fn slope_of_edge(&self, phi: f64) -> f64 {
        let (steepest, middle) = self.edge;
        let u = phi - middle;
        steepest * (1.0 - std::f64::consts::PI * u * u)
    }

    /// Whether another surface is so near that a voxel's gradient shows it.
    #[inline(always)]
    pub(super) fn is_narrow(&self, phi: f64, gradient: f64) -> bool {
        gradient < NARROW * self.slope_of_edge(phi)
    }

    /// The delta.
    pub fn delta(&self) -> &SmearedDelta {
        &self.delta
    }

    /// What a voxel adds to the surface: its area in a unit of volume, delta |grad phi|, and the curvature
    /// there; `None` where the gradient has collapsed.
    pub fn element(&self, jet: &Jet) -> Option<(f64, Curvature)> {
        let gradient = jet.gradient_magnitude();
        self.curvature(jet).map(|curvature| (self.delta.delta(jet.value) * gradient, curvature))
    }

    /// The curvature at a point of the surface; `None` where the gradient has collapsed.
    pub fn curvature(&self, jet: &Jet) -> Option<Curvature> {
        Curvature::of(jet).filter(|_| self.stands(jet.gradient_magnitude()))
    }

    /// Whether a gradient is one that a surface has.
    #[inline(always)]
    pub(crate) fn stands(&self, gradient: f64) -> bool {
        gradient < f64::INFINITY && gradient >= self.minimum_gradient
    }
}
