//! Triply periodic minimal surfaces, cut out by a rounded box.

use super::curved_triangles::integrate_surface;
use super::jet_arithmetic::{Smooth, smooth_maximum};
use super::{Shape, Truth, value_and_jet};
use std::f64::consts::TAU;

/// Which periodic surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MinimalSurface {
    /// sin x cos y + sin y cos z + sin z cos x.
    Gyroid,
    /// cos x + cos y + cos z.
    SchwarzP,
}

/// One side of a periodic surface's level set, within a rounded box; a stand-in for trabecular bone.
///
/// The two are joined by a smooth maximum, so the whole surface is analytic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Periodic {
    /// Which surface.
    pub surface: MinimalSurface,
    /// Its period, mm.
    pub period: f64,
    /// Edge of the box, mm.
    pub size: f64,
}

impl Periodic {
    fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let wave = TAU / self.period;
        let q = p.map(|v| v * wave);
        // Divided by the gradient's typical size, so that values are near a distance in mm.
        let network = match self.surface {
            MinimalSurface::Gyroid => {
                (q[0].sin() * q[1].cos() + q[1].sin() * q[2].cos() + q[2].sin() * q[0].cos()) * (0.65 / wave)
            }
            MinimalSurface::SchwarzP => (q[0].cos() + q[1].cos() + q[2].cos()) * (0.7 / wave),
        };
        // A superellipsoid of exponent 6, nearly a distance; CORE keeps the sixth root analytic at the
        // centre.
        let half = self.size / 2.0;
        let sixth = |v: T| {
            let square = (v * (1.0 / half)).square();
            square.square() * square
        };
        let radius = (sixth(p[0]) + sixth(p[1]) + sixth(p[2]) + CORE).powf(1.0 / 6.0);
        let cut = (radius + -libm::pow(1.0 + CORE, 1.0 / 6.0)) * half;
        smooth_maximum(network, cut, self.period * ROUNDING)
    }
}

/// Softens the superellipsoid's centre, where its root would be singular.
const CORE: f64 = 0.01;
/// Width over which network and box blend, in periods: rounds the rims with a radius of this order.
const ROUNDING: f64 = 0.2;

impl Shape for Periodic {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        integrate_surface(self, self.period / 10.0)
    }

    fn half_extent(&self) -> [f64; 3] {
        [self.size / 2.0; 3]
    }
}
