//! What a blur leaves of ripples and creases after compensation.
//!
//! Let a surface be waved by a small a cos(q x). A blur leaves b = a exp(-sigma^2 q^2 / 2) of it, and of the area that the waves
//! add, a^2 q^2 / 4, first-order compensation gives back b^2 q^2 (1 + sigma^2 q^2) / 4: in the leading order, sigma^4 times the
//! integral of |grad H|^2 is missing, along the surface. Powers of curvature see none of it, for H K and H^2 are of second order
//! in b whatever the length of the waves. Summed over the waves of a crease, whose powers fall as 1 / q^4, all orders are 4 times
//! the leading one; of waves of sigma q = 1, 1.4 times, and 3.4 times of sigma q = 1.7, 7 voxels at a sigma of 2. Two blurs whose
//! shifts cancel leave as much in the leading order, and 1.9 times that of a crease.

use super::uncertainty::{ErrorModel, least_mean};
use crate::embedding::EdgeProfile;
use crate::integrals::SurfaceIntegrals;
use std::f64::consts::PI;

/// All orders of what is missing of creases in units of the leading one, after one blur, and after two whose shifts cancel.
const ORDERS: [f64; 2] = [4.0, 1.9];
/// What M lacks of itself in units of what A lacks of itself: 1 of waves on a ball, 1.3 to 1.5 where balls meet.
const OF_MEAN: f64 = 1.5;
/// What is missing in units of what compensation adds to A, at most: beyond it curvature is that of a field without a surface.
const MOST: f64 = 4.0;

impl ErrorModel {
    /// By how much A, mm^2, and M, mm, are off by ripples and creases, by the mean square of H's gradient along the surface,
    /// 1/mm^4, in which the grid's noise is, of masks.
    pub(crate) fn of_ripples(
        &self,
        surface: &SurfaceIntegrals,
        profile: &EdgeProfile,
        mean_square: f64,
    ) -> [f64; 2] {
        let square = self.sigma * self.sigma;
        let noise = if self.occupancies.is_some() { 0.0 } else { self.noise_of_ripples(profile) };
        let orders = ORDERS[profile.terms().len() - 1];
        let missing = orders * square * square * (mean_square - noise).max(0.0) * surface.area;
        let area = missing.min(MOST * 2.0 * square * surface.total_squared_mean_curvature);
        let mean = surface.total_mean_curvature.abs().max(least_mean(surface));
        [area, OF_MEAN * area * mean / surface.area]
    }

    /// Mean square of the gradient that the grid's noise makes of H, 1/mm^4: a blurred surface scatters with the spectrum
    /// exp(-sigma^2 k^2) of the waves in its plane, and H with k^4 times that (docs/method.md has the mean square of H itself).
    fn noise_of_ripples(&self, profile: &EdgeProfile) -> f64 {
        // What each blur has to say of where the surface is goes with its weight and its slope.
        let terms = profile.terms();
        let slopes: f64 = terms.iter().map(|(weight, sigma)| weight / sigma).sum();
        let pairs = terms.iter().flat_map(|a| terms.iter().map(move |b| (a, b)));
        let powers: f64 = pairs
            .map(|((u, a), (v, b))| u * v / (a * b * slopes * slopes) / (0.5 * (a * a + b * b)).powi(4))
            .sum();
        3.0 * self.lattice / (64.0 * PI.powi(4)) * powers
    }
}
