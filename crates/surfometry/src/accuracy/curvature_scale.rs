//! The blur that local curvature is best measured at.

use crate::volume::Spacing;

/// Blur of the pilot measurement that tells an object's radius of curvature, in units of the rms spacing.
pub const PILOT_SPACINGS: f64 = 3.0;
/// Blur in units of h^(2/7) R^(5/7): between the grid's noise in H, 0.136 h^2 / sigma^3, and the bias that is left, sigma^4 / R^5, in mean square. The
/// constant is fitted on ellipsoids, tori, a gyroid and a bumpy sphere (FACTS 0).
const BALANCE: f64 = 0.66;
/// Least blur in units of the geometric mean of the spacings: below, samples are no Gaussian's.
const LEAST_SPACINGS: f64 = 1.25;
/// Largest blur in units of the mean thickness 2 V / A. Parts that thin come out up to 0.16 sigma too thick (FACTS 0).
const MOST_OF_THICKNESS: f64 = 0.4;

/// Root of the mean square of the spacings, mm: what the grid's noise goes with, to 8 % at a ratio of 3 (FACTS 0).
pub fn rms_spacing(spacing: Spacing) -> f64 {
    (spacing.mm().iter().map(|h| h * h).sum::<f64>() / 3.0).sqrt()
}

/// sigma of the corrected embedding, mm, for local curvature of an object of radius of curvature R = 1 / rms(larger principal curvature) and of mean
/// thickness 2 V / A. It depends on the object alone.
pub fn auto_curvature_sigma(spacing: Spacing, radius: f64, mean_thickness: f64) -> f64 {
    let balanced = BALANCE * libm::pow(rms_spacing(spacing), 2.0 / 7.0) * libm::pow(radius, 5.0 / 7.0);
    balanced.min(MOST_OF_THICKNESS * mean_thickness).max(LEAST_SPACINGS * spacing.geometric_mean())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The optimum of noise^2 + bias^2 goes with h^(2/7) R^(5/7), whatever the constants.
    #[test]
    fn follows_the_balance_between_its_limits() {
        let spacing = Spacing::new([0.5; 3]).unwrap();
        let at = |radius: f64| auto_curvature_sigma(spacing, radius, 1e9);
        assert!((at(20.0) / at(10.0) - 2f64.powf(5.0 / 7.0)).abs() < 1e-12);
        let fine = auto_curvature_sigma(Spacing::new([0.25; 3]).unwrap(), 20.0, 1e9);
        assert!((at(20.0) / fine - 2f64.powf(2.0 / 7.0)).abs() < 1e-12);
        assert!((auto_curvature_sigma(spacing, 20.0, 5.0) - 2.0).abs() < 1e-12);
        assert!((auto_curvature_sigma(spacing, 0.1, 1.0) - 0.625).abs() < 1e-12);
    }
}
