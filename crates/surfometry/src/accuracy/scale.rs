//! The lengths of the method: blur sigma, band thickness t, and the half-width eps that t stands for.

use crate::integrals::SmearedDelta;
use crate::volume::Spacing;
use std::f64::consts::SQRT_2;

/// Automatic sigma in units of the geometric mean of the spacings.
pub const AUTO_SIGMA_SPACINGS: f64 = 2.0;

/// Automatic thickness in units of the largest spacing: thinner bands undersample the delta.
pub const AUTO_THICKNESS_SPACINGS: f64 = 2.5;

/// sigma that suits a grid, mm. It depends on the image's spacing only, never on what else is measured.
///
/// The geometric mean, not the largest spacing: on thick slices the latter destroys thin parts.
pub fn auto_sigma(spacing: Spacing) -> f64 {
    AUTO_SIGMA_SPACINGS * spacing.geometric_mean()
}

/// Thickness that suits a grid, mm.
pub fn auto_thickness(spacing: Spacing) -> f64 {
    AUTO_THICKNESS_SPACINGS * spacing.largest()
}

/// Share of a blurred field's saturation that an automatic band keeps within: t = 4.48 sigma at level 0.5, which 2.5
/// slices exceed from a spacing ratio of 7 on. Just below where the flag `thickness-above-blur` begins.
const AUTO_SATURATION: f64 = 0.975;

/// Thickness that suits a grid and a blur whose field saturates at `saturation`, mm: on slices much thicker than
/// sigma the band would otherwise reach the blurred edge's flat ends.
pub fn auto_thickness_of_blur(spacing: Spacing, sigma: f64, saturation: f64) -> f64 {
    auto_thickness(spacing).min(thickness_of_blur(sigma, AUTO_SATURATION * saturation))
}

/// Thickness t of which `epsilon`, less than 0.5, is [`epsilon_of_blur`].
pub fn thickness_of_blur(sigma: f64, epsilon: f64) -> f64 {
    // erf is 1 in f64 from 6 on; bisection to the last bit of a bounded, monotonic function.
    let (mut low, mut high) = (0.0, 6.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 0.5 * libm::erf(middle) < epsilon { low = middle } else { high = middle }
    }
    2.0 * SQRT_2 * sigma * 0.5 * (low + high)
}

/// eps for which the band of a blurred flat edge has thickness t: erf(t / (2 sqrt 2 sigma)) / 2 (Besler et al.,
/// eq. for epsilon; its linearisation is printed wrong, t / (5 sigma) is right).
pub fn epsilon_of_blur(sigma: f64, thickness: f64) -> f64 {
    0.5 * libm::erf(thickness / (2.0 * SQRT_2 * sigma))
}

/// Mean square distance from the surface, mm^2, at which the delta looks across a blurred flat edge.
///
/// This is what smearing adds to geometry: V gains it times M, A gains it times the integral of K. For the sine
/// delta and t << sigma it is (1/12 - 1/(2 pi^2)) t^2 = 0.0327 t^2; at larger t the edge's error function bends, so it
/// is integrated: the integral over s of s^2 delta(u(s)) u'(s), with u the edge's profile.
pub fn band_variance(sigma: f64, delta: &SmearedDelta) -> f64 {
    // Beyond 6 sigma the profile is flat; the integrand is smooth and vanishes at both ends of the band.
    const STEPS: i32 = 2000;
    let reach = 6.0 * sigma;
    let step = 2.0 * reach / f64::from(STEPS);
    let density =
        |s: f64| libm::exp(-s * s / (2.0 * sigma * sigma)) / (sigma * libm::sqrt(2.0 * std::f64::consts::PI));
    (0..STEPS)
        .map(|i| -reach + (f64::from(i) + 0.5) * step)
        .map(|s| s * s * delta.delta(0.5 * libm::erf(s / (SQRT_2 * sigma))) * density(s) * step)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrals::Smearing;

    #[test]
    fn epsilon_is_a_fifth_of_the_ratio_when_thin() {
        // The paper's linearisation says 5 t / 6.
        assert!((epsilon_of_blur(2.0, 0.1) / (0.1 / (2.0 * 5.013)) - 1.0).abs() < 1e-3);
        assert!((epsilon_of_blur(2.0, 2.5) - 0.234_014).abs() < 1e-5);
    }

    #[test]
    fn thickness_and_epsilon_are_inverse() {
        for thickness in [0.01, 1.0, 2.5, 6.0] {
            let back = thickness_of_blur(1.7, epsilon_of_blur(1.7, thickness));
            assert!((back / thickness - 1.0).abs() < 1e-9, "{thickness} {back}");
        }
        let thick = Spacing::new([1.0, 1.0, 30.0]).unwrap();
        let sigma = auto_sigma(thick);
        assert!((auto_thickness_of_blur(thick, sigma, 0.5) / sigma - 4.48).abs() < 0.01);
    }

    #[test]
    fn variance_is_that_of_the_delta_on_a_thin_band() {
        let (sigma, t) = (2.0, 0.5);
        let delta = SmearedDelta::new(Smearing::Sine, epsilon_of_blur(sigma, t), 0.5);
        assert!((band_variance(sigma, &delta) / (0.032_67 * t * t) - 1.0).abs() < 5e-3);
    }

    #[test]
    fn automatic_lengths_follow_the_spacing() {
        let spacing = Spacing::new([0.5, 1.0, 4.0]).unwrap();
        assert!((auto_sigma(spacing) - 2.0 * 2f64.cbrt()).abs() < 1e-12);
        assert_eq!(auto_thickness(spacing), 10.0);
    }
}
