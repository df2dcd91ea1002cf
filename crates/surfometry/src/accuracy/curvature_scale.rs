//! The blur that local curvature is best measured at.

use crate::volume::Spacing;

/// Blur of the pilot measurement that tells an object's radius of curvature, in units of the rms spacing.
pub const PILOT_SPACINGS: f64 = 3.0;
/// Blur in units of h^(2/7) R^(5/7): between the grid's noise in H, 0.136 h^2 / sigma^3, and the bias that is
/// left, sigma^4 / R^5, in mean square. The constant is fitted on ellipsoids, tori, a gyroid and a bumpy
/// sphere.
const BALANCE: f64 = 0.66;
/// Least blur in units of the geometric mean of the spacings: below, samples are no Gaussian's.
const LEAST_SPACINGS: f64 = 1.25;
/// Largest blur in units of the mean thickness T = 2 V / A: `MOST_OF_BULKY` times T / R, for T is 2 R / 3 of
/// a ball and R of a rod, but much less than R of a shell or a plate, whose far side a blur must not reach;
/// within these limits.
const MOST_OF_BULKY: f64 = 0.73;
const MOST_OF_THICKNESS: [f64; 2] = [0.33, 0.47];
/// By how much a balanced blur may differ from the rule's.
const MOST_CHANGE: [f64; 2] = [0.6, 1.45];
/// Share of the blur of least error in the model, in which bias goes on growing with sigma^4 beyond the blur
/// in question. It grows more slowly, so the model makes it too small (ellipsoids, Schwarz P and gyroid of 10
/// and 20 voxels have their least error at 0.83 to 0.88).
const SATURATION: f64 = 0.84;

/// Root of the mean square of the spacings, mm: what the grid's noise goes with, to 8 % at a ratio of 3.
pub fn rms_spacing(spacing: Spacing) -> f64 {
    (spacing.mm().iter().map(|h| h * h).sum::<f64>() / 3.0).sqrt()
}

/// sigma of the corrected embedding, mm, for local curvature of an object of radius of curvature R = 1 /
/// rms(larger principal curvature) and of mean thickness 2 V / A. It depends on the object alone.
pub fn auto_curvature_sigma(spacing: Spacing, radius: f64, mean_thickness: f64) -> f64 {
    let balanced = BALANCE * libm::pow(rms_spacing(spacing), 2.0 / 7.0) * libm::pow(radius, 5.0 / 7.0);
    limited(spacing, balanced, radius, mean_thickness)
}

fn limited(spacing: Spacing, sigma: f64, radius: f64, mean_thickness: f64) -> f64 {
    let [least, most] = MOST_OF_THICKNESS;
    let share =
        if radius > 0.0 { (MOST_OF_BULKY * mean_thickness / radius).clamp(least, most) } else { least };
    sigma.min(share * mean_thickness).max(LEAST_SPACINGS * spacing.geometric_mean())
}

/// The same, from what curvature does when sigma changes: mean squares of its change from sigma / sqrt 2 to
/// sigma, and from there to sqrt 2 sigma.
///
/// The grid's noise has a mean square n^2 that falls with sigma^-6, and, being white along the surface, a
/// correlation between two scales of the cube of sigma_1 sigma_2 over the mean of their squares; bias b grows
/// with sigma^4. So the changes are 0.5625 b^2 + 4.26 n^2 and 9 b^2 + 0.532 n^2, which tell b and n, and
/// b^2 + n^2 is least at (3 n^2 / 4 b^2)^(1/14) times sigma. The 14th root forgives much: an object whose
/// curvature hardly varies gets a larger blur, one with noisy voxels as well, one with detail a smaller one.
pub fn balanced_sigma(
    spacing: Spacing,
    sigma: f64,
    changes: [f64; 2],
    (radius, mean_thickness): (f64, f64),
) -> f64 {
    let [down, up] = changes;
    // What is left of a difference of nearly equal numbers is no less than a thousandth of them.
    let bias = (up - 0.125 * down).max(1e-3 * up) / 8.93;
    let noise = (down - 0.0625 * up).max(1e-3 * down) / 4.23;
    let [least, most] = MOST_CHANGE;
    let factor = SATURATION * libm::pow(0.75 * noise / bias, 1.0 / 14.0);
    if factor.is_finite() {
        limited(spacing, factor.clamp(least, most) * sigma, radius, mean_thickness)
    } else {
        sigma
    }
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
        // A shell of 20 mm with a wall of 5 mm, a rod, and what is too small for any blur.
        assert!((auto_curvature_sigma(spacing, 20.0, 5.0) - 0.33 * 5.0).abs() < 1e-12);
        assert!((auto_curvature_sigma(spacing, 2.0, 2.0) - 0.66 * 2f64.powf(3.0 / 7.0)).abs() < 1e-12);
        assert!((auto_curvature_sigma(spacing, 0.1, 1.0) - 0.625).abs() < 1e-12);
    }

    /// Changes made from a known noise and bias give their optimum back.
    #[test]
    fn balances_what_changes_tell() {
        let spacing = Spacing::new([0.5; 3]).unwrap();
        for (noise, bias) in [(0.03_f64, 0.03_f64), (0.05, 0.01), (0.01, 0.04)] {
            let (n, b) = (noise * noise, bias * bias);
            let changes = [0.5625 * b + 4.26 * n, 9.0 * b + 0.532 * n];
            let found = balanced_sigma(spacing, 3.0, changes, (50.0, 50.0)) / (3.0 * SATURATION);
            let error = |factor: f64| n * factor.powi(-6) + b * factor.powi(8);
            assert!(error(found) < error(found * 1.01) && error(found) < error(found * 0.99), "{found}");
        }
    }
}
