//! The ellipsoid.

use super::curved_triangles::GAUSS_5;
use super::jet_arithmetic::Smooth;
use super::{Shape, Truth, value_and_jet};
use std::f64::consts::{PI, TAU};

/// An ellipsoid along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// Semi-axes along x, y, z, mm.
    pub radii: [f64; 3],
}

impl Ellipsoid {
    fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let term = |a: usize| p[a].square() * (1.0 / (self.radii[a] * self.radii[a]));
        // Scaled so that values are near a distance in mm.
        (term(0) + term(1) + term(2) + -1.0) * (0.5 * self.smallest())
    }

    fn smallest(&self) -> f64 {
        self.radii.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Integral of f over the unit sphere, refined until it stands still: flat shapes need many points.
fn over_unit_sphere(f: impl Fn([f64; 3]) -> f64) -> f64 {
    let mut coarse = on_panels(&f, 32);
    for panels in [64, 128, 256, 512] {
        let fine = on_panels(&f, panels);
        if (fine / coarse - 1.0).abs() < 1e-12 {
            return fine;
        }
        coarse = fine;
    }
    coarse
}

/// Trapezoids in the azimuth (spectral on a circle), Gauss panels in the latitude.
fn on_panels(f: impl Fn([f64; 3]) -> f64, panels: u32) -> f64 {
    let azimuths = 4 * panels;
    let ring = |z: f64| {
        let r = libm::sqrt(1.0 - z * z);
        let angles = (0..azimuths).map(|i| TAU * f64::from(i) / f64::from(azimuths));
        angles.map(|a| f([r * libm::cos(a), r * libm::sin(a), z])).sum::<f64>() * TAU / f64::from(azimuths)
    };
    // z = sin(latitude) crowds the panels at the poles, where a flat ellipsoid varies fastest.
    let mut sum = 0.0;
    for panel in 0..panels {
        for (node, weight) in GAUSS_5 {
            let latitude = PI * ((f64::from(panel) + node) / f64::from(panels) - 0.5);
            sum += weight * PI / f64::from(panels) * libm::cos(latitude) * ring(libm::sin(latitude));
        }
    }
    sum
}

impl Shape for Ellipsoid {
    value_and_jet!();

    /// Area and mean curvature are elliptic integrals, taken here over the unit sphere of directions u: the
    /// surface is D u, so dA = det(D) |D^-1 u| du; and M of a convex body is the integral of its support
    /// function |D u|.
    fn truth(&self) -> Option<Truth> {
        let product: f64 = self.radii.iter().product();
        let length = |f: [f64; 3], u: [f64; 3]| libm::sqrt((0..3).map(|a| (f[a] * u[a]).powi(2)).sum());
        let area = over_unit_sphere(|u| product * length(self.radii.map(|r| 1.0 / r), u));
        let mean = over_unit_sphere(|u| length(self.radii, u));
        Some(Truth::new(4.0 / 3.0 * PI * product, area, mean, 2))
    }

    fn half_extent(&self) -> [f64; 3] {
        self.radii
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spheroids have closed forms (Beyer, CRC tables).
    #[test]
    fn spheroids_agree_with_their_closed_forms() {
        let (a, c) = (10.0f64, 25.0f64);
        let e = (1.0 - a * a / (c * c)).sqrt();
        let truth = Ellipsoid { radii: [a, a, c] }.truth().unwrap();
        let area = 2.0 * PI * a * a * (1.0 + c / (a * e) * e.asin());
        assert!((truth.surface_area / area - 1.0).abs() < 1e-10, "{}", truth.surface_area / area - 1.0);
        // M = 2 pi (c + a^2 / (c e) artanh e) for a prolate spheroid (Santalo).
        let mean = 2.0 * PI * (c + a * a / (c * e) * e.atanh());
        assert!((truth.total_mean_curvature / mean - 1.0).abs() < 1e-10);
        let (a, c) = (25.0f64, 10.0f64);
        let e = (1.0 - c * c / (a * a)).sqrt();
        let truth = Ellipsoid { radii: [a, c, a] }.truth().unwrap();
        let area = 2.0 * PI * a * a * (1.0 + (1.0 - e * e) / e * e.atanh());
        assert!((truth.surface_area / area - 1.0).abs() < 1e-10, "{}", truth.surface_area / area - 1.0);
    }
}
