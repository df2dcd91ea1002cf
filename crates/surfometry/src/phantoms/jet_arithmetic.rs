//! Arithmetic that carries first and second derivatives along, so that a shape is written once, as a formula.
//!
//! Elementary functions are std's, several times as fast as `libm`: shapes are evaluated millions of times,
//! and the last bit does not matter to them.
//!
//! Own code because the crate for it (`num-dual`) brings nalgebra for what are sixty lines here.

use crate::local_geometry::Jet;
use std::ops::{Add, Mul, Sub};

/// Numbers that implicit functions are written in: f64 for values, [`Jet`] for values with derivatives.
pub(crate) trait Smooth:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Add<f64, Output = Self>
{
    /// The plain value.
    fn value(self) -> f64;

    /// f(self) from f, f' and f'' at the value.
    fn compose(self, f: f64, f1: f64, f2: f64) -> Self;

    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.compose(root, 0.5 / root, -0.25 / (root * self.value()))
    }

    fn powf(self, exponent: f64) -> Self {
        let power = self.value().powf(exponent);
        let slope = exponent * power / self.value();
        self.compose(power, slope, (exponent - 1.0) * slope / self.value())
    }

    fn sin(self) -> Self {
        let (sin, cos) = self.value().sin_cos();
        self.compose(sin, cos, -sin)
    }

    fn cos(self) -> Self {
        let (sin, cos) = self.value().sin_cos();
        self.compose(cos, -sin, -cos)
    }

    fn square(self) -> Self {
        self * self
    }

    /// |self|, whose derivatives are those of one side.
    fn abs(self) -> Self {
        if self.value() < 0.0 { self * -1.0 } else { self }
    }
}

/// The point's coordinates as functions of themselves.
pub(crate) fn coordinates(point: [f64; 3]) -> [Jet; 3] {
    std::array::from_fn(|a| {
        let mut gradient = [0.0; 3];
        gradient[a] = 1.0;
        Jet { value: point[a], gradient, hessian: [0.0; 6] }
    })
}

/// |p| of two or three coordinates.
pub(crate) fn norm<T: Smooth, const N: usize>(p: [T; N]) -> T {
    p[1..].iter().fold(p[0].square(), |sum, &v| sum + v.square()).sqrt()
}

/// (a + b + sqrt((a - b)^2 + w^2)) / 2: the larger of two, blended over a width.
pub(crate) fn smooth_maximum<T: Smooth>(a: T, b: T, w: f64) -> T {
    (a + b + ((a - b).square() + w * w).sqrt()) * 0.5
}

/// The smaller of two, blended alike.
pub(crate) fn smooth_minimum<T: Smooth>(a: T, b: T, w: f64) -> T {
    smooth_maximum(a * -1.0, b * -1.0, w) * -1.0
}

/// Axes of the Hessian's entries.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

impl Smooth for f64 {
    fn value(self) -> f64 {
        self
    }
    fn compose(self, f: f64, _: f64, _: f64) -> f64 {
        f
    }
}

impl Smooth for Jet {
    fn value(self) -> f64 {
        self.value
    }
    fn compose(self, f: f64, f1: f64, f2: f64) -> Self {
        let g = self.gradient;
        Self {
            value: f,
            gradient: g.map(|v| f1 * v),
            hessian: std::array::from_fn(|n| f1 * self.hessian[n] + f2 * g[PAIRS[n].0] * g[PAIRS[n].1]),
        }
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: std::array::from_fn(|a| self.gradient[a] + other.gradient[a]),
            hessian: std::array::from_fn(|n| self.hessian[n] + other.hessian[n]),
        }
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

// The product rule adds.
#[allow(clippy::suspicious_arithmetic_impl)]
impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (f, g) = (self, other);
        Self {
            value: f.value * g.value,
            gradient: std::array::from_fn(|a| f.gradient[a] * g.value + f.value * g.gradient[a]),
            hessian: std::array::from_fn(|n| {
                let (a, b) = PAIRS[n];
                f.hessian[n] * g.value
                    + f.gradient[a] * g.gradient[b]
                    + f.gradient[b] * g.gradient[a]
                    + f.value * g.hessian[n]
            }),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self.compose(self.value * factor, factor, 0.0)
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    fn add(self, constant: f64) -> Self {
        Self { value: self.value + constant, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function<T: Smooth>([x, y, z]: [T; 3]) -> T {
        (x * y * 2.0 + z.sin()).square()
            + (x.square() + y.square() + 1.0).sqrt() * z.cos()
            + (z + 2.0).powf(1.3)
            - x.abs() * z
    }

    #[test]
    fn derivatives_equal_differences() {
        let point = [-0.7, 0.4, 1.1];
        let jet = function(coordinates(point));
        let at = |steps: &[(usize, f64)]| {
            let mut p = point;
            for &(a, s) in steps {
                p[a] += s;
            }
            function(p)
        };
        let h = 1e-4;
        for a in 0..3 {
            let difference = (at(&[(a, h)]) - at(&[(a, -h)])) / (2.0 * h);
            assert!((jet.gradient[a] - difference).abs() < 1e-6, "gradient {a}");
        }
        for (n, (a, b)) in PAIRS.into_iter().enumerate() {
            let corner = |s: f64, t: f64| at(&[(a, s * h), (b, t * h)]);
            let difference = (corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0))
                / (4.0 * h * h);
            assert!((jet.hessian[n] - difference).abs() < 1e-5, "hessian {n}");
        }
    }
}
