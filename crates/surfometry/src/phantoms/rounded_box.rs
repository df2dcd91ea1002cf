//! A box with rounded edges.

use super::jet_arithmetic::{Smooth, norm};
use super::{Shape, Truth, value_and_jet};
use std::f64::consts::PI;

/// A box dilated by a ball: flat faces, quarter cylinders, eighths of a sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundedBox {
    /// Half the outer edges, rounding included, mm; each more than `radius`.
    pub radii: [f64; 3],
    /// Radius of the rounding, mm.
    pub radius: f64,
}

impl RoundedBox {
    fn core(&self) -> [f64; 3] {
        self.radii.map(|r| r - self.radius)
    }

    fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let core = self.core();
        let beyond: [T; 3] = std::array::from_fn(|a| p[a].abs() + -core[a]);
        let outside: Vec<T> = beyond.into_iter().filter(|d| d.value() > 0.0).collect();
        match outside[..] {
            [] => {
                beyond.into_iter().reduce(|a, b| if a.value() > b.value() { a } else { b }).expect("three")
                    + -self.radius
            }
            [a] => a + -self.radius,
            [a, b] => norm([a, b]) + -self.radius,
            _ => norm(beyond) + -self.radius,
        }
    }
}

impl Shape for RoundedBox {
    value_and_jet!();

    /// Steiner's formula for a box dilated by r: edges add quarter cylinders, corners eighths of a ball.
    fn truth(&self) -> Option<Truth> {
        let [a, b, c] = self.core().map(|half| 2.0 * half);
        let r = self.radius;
        let (faces, edges) = (2.0 * (a * b + b * c + a * c), 4.0 * (a + b + c));
        Some(Truth::new(
            a * b * c + faces * r + edges * PI / 4.0 * r * r + 4.0 / 3.0 * PI * r.powi(3),
            faces + edges * PI / 2.0 * r + 4.0 * PI * r * r,
            edges * PI / 4.0 + 4.0 * PI * r,
            2,
        ))
    }

    fn half_extent(&self) -> [f64; 3] {
        self.radii
    }
}
