//! Balls and what is made of them.

use super::jet_arithmetic::{Smooth, norm};
use super::{Shape, Truth, value_and_jet};
use std::f64::consts::PI;

fn ball_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

fn sphere_area(radius: f64) -> f64 {
    4.0 * PI * radius * radius
}

/// A ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// mm.
    pub radius: f64,
}

impl Ball {
    fn implicit<T: Smooth>(self, p: [T; 3]) -> T {
        // |p|^2 - R^2 over 2 R: smooth everywhere, of unit gradient at the surface.
        (p[0].square() + p[1].square() + p[2].square() + -self.radius * self.radius) * (0.5 / self.radius)
    }
}

impl Shape for Ball {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        Some(Truth::new(ball_volume(self.radius), sphere_area(self.radius), 4.0 * PI * self.radius, 2))
    }

    fn half_extent(&self) -> [f64; 3] {
        [self.radius; 3]
    }
}

/// A ball with a concentric cavity: two spheres, chi = 4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    /// Outer radius, mm.
    pub radius: f64,
    /// Radius of the cavity, mm.
    pub inner: f64,
}

impl Shell {
    fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let outside = Ball { radius: self.radius }.implicit(p);
        let cavity = Ball { radius: self.inner }.implicit(p) * -1.0;
        if outside.value() > cavity.value() { outside } else { cavity }
    }
}

impl Shape for Shell {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        // On the cavity's sphere the outward normal points to the centre, so H = -1/inner there.
        Some(Truth::new(
            ball_volume(self.radius) - ball_volume(self.inner),
            sphere_area(self.radius) + sphere_area(self.inner),
            4.0 * PI * (self.radius - self.inner),
            4,
        ))
    }

    fn half_extent(&self) -> [f64; 3] {
        [self.radius; 3]
    }
}

/// Two equal balls on the x axis: chi = 4 where they are apart, 2 where they overlap, with a crease between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoBalls {
    /// Radius of each, mm.
    pub radius: f64,
    /// Distance of the centres, mm; of two radii they touch, and their surface is none.
    pub length: f64,
}

impl TwoBalls {
    /// Of each, what does not lie within the other; their spheres meet on a circle, where normals turn.
    fn overlapping(&self) -> Truth {
        let (r, half) = (self.radius, self.length / 2.0);
        let cap = r - half;
        let circle = 2.0 * PI * (r * r - half * half).sqrt();
        let area = 2.0 * (sphere_area(r) - 2.0 * PI * r * cap);
        let turn = 2.0 * libm::asin(half / r);
        Truth::new(
            2.0 * (ball_volume(r) - PI * cap * cap * (3.0 * r - cap) / 3.0),
            area,
            area / r - 0.5 * turn * circle,
            2,
        )
    }

    fn implicit<T: Smooth>(&self, [x, y, z]: [T; 3]) -> T {
        Ball { radius: self.radius }.implicit([x.abs() + -self.length / 2.0, y, z])
    }
}

impl Shape for TwoBalls {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        let r = self.radius;
        if self.length < 2.0 * r {
            return Some(self.overlapping());
        }
        Some(Truth::new(2.0 * ball_volume(r), 2.0 * sphere_area(r), 8.0 * PI * r, 4))
    }

    fn half_extent(&self) -> [f64; 3] {
        [self.length / 2.0 + self.radius, self.radius, self.radius]
    }
}

/// A cylinder along z with half balls on its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// Radius of cylinder and balls, mm.
    pub radius: f64,
    /// Length of the cylinder, mm.
    pub length: f64,
}

impl Capsule {
    fn implicit<T: Smooth>(&self, [x, y, z]: [T; 3]) -> T {
        let beyond = z.abs() + -self.length / 2.0;
        let distance = if beyond.value() > 0.0 { norm([x, y, beyond]) } else { norm([x, y]) };
        distance + -self.radius
    }
}

impl Shape for Capsule {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        let (r, l) = (self.radius, self.length);
        Some(Truth::new(
            PI * r * r * l + ball_volume(r),
            2.0 * PI * r * l + sphere_area(r),
            PI * l + 4.0 * PI * r,
            2,
        ))
    }

    fn half_extent(&self) -> [f64; 3] {
        [self.radius, self.radius, self.length / 2.0 + self.radius]
    }
}
