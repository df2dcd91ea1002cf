//! The torus.

use super::jet_arithmetic::{Smooth, norm};
use super::{Shape, Truth, value_and_jet};
use std::f64::consts::PI;

/// A torus around the z axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torus {
    /// Radius of the tube's centre line, mm.
    pub major: f64,
    /// Radius of the tube, mm; less than `major`.
    pub minor: f64,
}

impl Torus {
    fn implicit<T: Smooth>(&self, [x, y, z]: [T; 3]) -> T {
        norm([norm([x, y]) + -self.major, z]) + -self.minor
    }
}

impl Shape for Torus {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        let (major, minor) = (self.major, self.minor);
        Some(Truth::new(
            2.0 * PI * PI * major * minor * minor,
            4.0 * PI * PI * major * minor,
            2.0 * PI * PI * major,
            0,
        ))
    }

    fn half_extent(&self) -> [f64; 3] {
        let outer = self.major + self.minor;
        [outer, outer, self.minor]
    }
}
