//! A coiled tube.

use super::jet_arithmetic::Smooth;
use super::{Shape, Truth, value_and_jet};
use std::f64::consts::{PI, TAU};

/// A tube of round section about a helix along z, with half balls on its ends.
///
/// As long as it stays clear of itself its integrals are those of a straight tube as long as the helix (Weyl 1939).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Helix {
    /// Radius of the tube, mm.
    pub radius: f64,
    /// Radius of the coil, mm; more than that of the tube.
    pub coil: f64,
    /// From one turn to the next, mm; more than two radii of the tube.
    pub pitch: f64,
    /// Number of turns.
    pub turns: f64,
}

/// Places on each turn from which the nearest point is looked for.
const STARTS: f64 = 24.0;
/// Newton's steps from there.
const STEPS: usize = 6;

impl Helix {
    fn half_angle(&self) -> f64 {
        PI * self.turns
    }

    fn rise(&self) -> f64 {
        self.pitch / TAU
    }

    fn length(&self) -> f64 {
        TAU * self.turns * libm::hypot(self.coil, self.rise())
    }

    /// Half the square of the distance from the point of the helix at an angle, and its first and second derivatives by
    /// the angle.
    fn half_square(&self, [x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
        let (sin, cos) = angle.sin_cos();
        let (r, c) = (self.coil, self.rise());
        let off = [x - r * cos, y - r * sin, z - c * angle];
        let half = 0.5 * off.iter().map(|v| v * v).sum::<f64>();
        [half, r * (x * sin - y * cos) - c * off[2], r * (x * cos + y * sin) + c * c]
    }

    /// The angle of the nearest point.
    fn nearest(&self, p: [f64; 3]) -> f64 {
        let half = self.half_angle();
        let count = (STARTS * self.turns).ceil() as usize;
        let starts = (0..=count).map(|n| half * (2.0 * n as f64 / count as f64 - 1.0));
        let distance = |angle: &f64| self.half_square(p, *angle)[0];
        let mut angle = starts.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or_default();
        for _ in 0..STEPS {
            let [_, slope, second] = self.half_square(p, angle);
            if second > 0.0 {
                angle = (angle - slope / second).clamp(-half, half);
            }
        }
        angle
    }

    fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let place = p.map(T::value);
        let angle = self.nearest(place);
        let [_, slope, second] = self.half_square(place, angle);
        let zero = p[0] * 0.0;
        let ends = angle.abs() >= self.half_angle() || second <= 0.0;
        // The nearest point moves with p: one more of Newton's steps has the right first derivatives, and as the distance
        // is the least there, that is enough for the second ones of the distance.
        let turned = if ends {
            zero + angle
        } else {
            let constant = zero + angle;
            let (sin, cos) = (constant.sin(), constant.cos());
            let along =
                (p[0] * sin - p[1] * cos) * self.coil + (p[2] - constant * self.rise()) * -self.rise();
            constant + along * (-1.0 / second)
        };
        debug_assert!(ends || slope.abs() < 1e-6 * (1.0 + second));
        let off =
            [p[0] - turned.cos() * self.coil, p[1] - turned.sin() * self.coil, p[2] - turned * self.rise()];
        let square = off[0].square() + off[1].square() + off[2].square();
        (square + -self.radius * self.radius) * (0.5 / self.radius)
    }
}

impl Shape for Helix {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        let (r, l) = (self.radius, self.length());
        Some(Truth::new(
            PI * r * r * l + 4.0 / 3.0 * PI * r.powi(3),
            TAU * r * l + 4.0 * PI * r * r,
            PI * l + 4.0 * PI * r,
            2,
        ))
    }

    fn half_extent(&self) -> [f64; 3] {
        let across = self.coil + self.radius;
        [across, across, 0.5 * self.pitch * self.turns + self.radius]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantoms::curved_triangles::integrate_until_steady;

    /// Against integrals over the surface that the formula describes.
    #[test]
    fn a_coil_has_the_integrals_of_a_straight_tube() {
        let helix = Helix { radius: 1.0, coil: 3.0, pitch: 4.0, turns: 1.5 };
        let (exact, found) = (helix.truth().unwrap(), integrate_until_steady(&helix, 0.4, 1e-3).unwrap());
        let pairs = [
            (exact.volume, found.volume),
            (exact.surface_area, found.surface_area),
            (exact.total_mean_curvature, found.total_mean_curvature),
        ];
        for (exact, found) in pairs {
            assert!((found / exact - 1.0).abs() < 2e-3, "{exact} {found}");
        }
        assert_eq!(found.euler_characteristic, 2);
    }
}
