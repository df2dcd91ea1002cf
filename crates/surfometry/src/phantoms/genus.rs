//! A handlebody of any genus.

use super::jet_arithmetic::{Smooth, norm};
use super::{Shape, Truth, value_and_jet};
use std::f64::consts::PI;

/// A flat stadium with `genus` round holes in a row along x, dilated by a ball: chi = 2 - 2 genus.
///
/// All is known in closed form (Steiner's formula for a plane region in space). Rims are tubes of radius
/// `minor`, holes are `major` wide after the dilation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Genus {
    /// Number of holes.
    pub genus: u32,
    /// Radius of the open holes, mm.
    pub major: f64,
    /// Radius of the dilating ball, half the plate's height, mm.
    pub minor: f64,
}

impl Genus {
    /// Radius of the holes of the plane region.
    fn hole(&self) -> f64 {
        self.major + self.minor
    }

    /// Distance of neighbouring holes' centres: a bar of plane region one `minor` wide is left between them.
    fn pitch(&self) -> f64 {
        2.0 * self.hole() + self.minor
    }

    /// Radius of the stadium of the plane region.
    fn rim(&self) -> f64 {
        self.hole() + self.minor
    }

    /// Half the length of the stadium's straight part.
    fn half_length(&self) -> f64 {
        self.pitch() * f64::from(self.genus.saturating_sub(1)) / 2.0
    }

    fn implicit<T: Smooth>(&self, [x, y, z]: [T; 3]) -> T {
        // Distance outside the stadium's rim, then into the nearest hole, in the plane; whichever is outside
        // counts.
        let half = self.half_length();
        let along = x.abs() + -half;
        let stadium = if along.value() > 0.0 { norm([along, y]) } else { y.abs() } + -self.rim();
        let mut outside = stadium;
        if self.genus > 0 {
            let pitch = self.pitch();
            let last = f64::from(self.genus - 1);
            let number = ((x.value() + half) / pitch).round().clamp(0.0, last);
            let centre = number * pitch - half;
            let hole = norm([x + -centre, y]) * -1.0 + self.hole();
            if hole.value() > outside.value() {
                outside = hole;
            }
        }
        let distance = if outside.value() > 0.0 { norm([outside, z]) } else { z.abs() };
        distance + -self.minor
    }
}

impl Shape for Genus {
    value_and_jet!();

    /// A plane region of area S, rim length L and Euler number X dilated by r: V = 2 r S + pi/2 r^2 L + 4/3
    /// pi r^3 X, A = dV/dr, M = (dA/dr) / 2.
    fn truth(&self) -> Option<Truth> {
        let (r, n) = (self.minor, f64::from(self.genus));
        let straight = 2.0 * self.half_length();
        let area = PI * self.rim().powi(2) + 2.0 * self.rim() * straight - n * PI * self.hole().powi(2);
        let rim = 2.0 * PI * self.rim() + 2.0 * straight + n * 2.0 * PI * self.hole();
        let euler = 1.0 - n;
        Some(Truth::new(
            2.0 * r * area + PI / 2.0 * r * r * rim + 4.0 / 3.0 * PI * r.powi(3) * euler,
            2.0 * area + PI * r * rim + 4.0 * PI * r * r * euler,
            PI / 2.0 * rim + 4.0 * PI * r * euler,
            2 - 2 * i64::from(self.genus),
        ))
    }

    fn half_extent(&self) -> [f64; 3] {
        let outer = self.rim() + self.minor;
        [self.half_length() + outer, outer, self.minor]
    }
}
