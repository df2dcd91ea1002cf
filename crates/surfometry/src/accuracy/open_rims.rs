//! What a surface's open rims add to the error of its total mean curvature.

use super::terraces::inverse_fourth_powers;
use crate::volume::Spacing;
use std::f64::consts::PI;

/// Standard error of M of a mask's surface that ends in sections of so much length, mm.
///
/// Moving a surface by u changes the integral of H by that of u K, and along a rim by half of that of u's derivative across it:
/// of a closed surface's noise H sees next to nothing, of an open one's it sees how steep that is at the rim. The noise of a
/// blurred mask has the spectrum exp(-sigma^2 k^2): where H scatters by sqrt(S / (64 pi^4)) / sigma^3 (docs/method.md; S is the sum of
/// 1 / xi^4 over the reciprocal lattice) its slope does by sigma times that, and along a line it forgets itself over 2 sqrt(pi) sigma.
pub(crate) fn mean_of_open_rims(spacing: Spacing, sigma: f64, length: f64) -> f64 {
    let slope = inverse_fourth_powers(spacing).sqrt() / (8.0 * PI * PI * sigma * sigma);
    0.5 * slope * (2.0 * PI.sqrt() * sigma * length).sqrt()
}
