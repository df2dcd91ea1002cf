//! The lengths of the method: blur sigma, band thickness t, and the half-width eps that t stands for.

use crate::embedding::EdgeProfile;
use crate::integrals::SmearedDelta;
use crate::volume::Spacing;

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

/// Share of a blurred field's saturation that an automatic band keeps within: t = 4.48 sigma at level 0.5,
/// which 2.5 slices exceed from a spacing ratio of 7 on. Just below where the flag `thickness-above-blur`
/// begins.
const AUTO_SATURATION: f64 = 0.975;

/// Thickness that suits a grid and a blur whose field saturates at `saturation`, mm: on slices much thicker
/// than sigma the band would otherwise reach the blurred edge's flat ends.
pub fn auto_thickness_of_blur(spacing: Spacing, profile: &EdgeProfile, saturation: f64) -> f64 {
    auto_thickness(spacing).min(thickness_of_blur(profile, AUTO_SATURATION * saturation))
}

/// Thickness t of which `epsilon`, less than 0.5, is [`epsilon_of_blur`].
pub fn thickness_of_blur(profile: &EdgeProfile, epsilon: f64) -> f64 {
    2.0 * profile.distance_of(epsilon)
}

/// eps for which the band of a blurred flat edge has thickness t; of one blur erf(t / (2 sqrt 2 sigma)) / 2
/// (Besler et al., eq. for epsilon; its linearisation is printed wrong, t / (5 sigma) is right).
pub fn epsilon_of_blur(profile: &EdgeProfile, thickness: f64) -> f64 {
    profile.value(0.5 * thickness)
}

/// Mean square distance from the surface, mm^2, at which the delta looks across a blurred flat edge.
///
/// This is what smearing adds to geometry: V gains it times M, A gains it times the integral of K. For the
/// sine delta and t << sigma it is (1/12 - 1/(2 pi^2)) t^2 = 0.0327 t^2; at larger t the edge's error
/// function bends, so it is integrated: the integral over s of s^2 delta(u(s)) u'(s), with u the edge's
/// profile.
pub fn band_variance(profile: &EdgeProfile, delta: &SmearedDelta) -> f64 {
    // Beyond 6 sigma the profile is flat; the integrand is smooth and vanishes at both ends of the band.
    const STEPS: i32 = 2000;
    let reach = 6.0 * profile.sigma();
    let step = 2.0 * reach / f64::from(STEPS);
    (0..STEPS)
        .map(|i| -reach + (f64::from(i) + 0.5) * step)
        .map(|s| s * s * delta.delta(profile.value(s)) * profile.slope(s) * step)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrals::Smearing;

    #[test]
    fn epsilon_is_a_fifth_of_the_ratio_when_thin() {
        // The paper's linearisation says 5 t / 6.
        assert!(
            (epsilon_of_blur(&EdgeProfile::blurred(2.0), 0.1) / (0.1 / (2.0 * 5.013)) - 1.0).abs() < 1e-3
        );
        assert!((epsilon_of_blur(&EdgeProfile::blurred(2.0), 2.5) - 0.234_014).abs() < 1e-5);
    }

    #[test]
    fn thickness_and_epsilon_are_inverse() {
        let profile = EdgeProfile::blurred(1.7);
        for thickness in [0.01, 1.0, 2.5, 6.0] {
            let back = thickness_of_blur(&profile, epsilon_of_blur(&profile, thickness));
            assert!((back / thickness - 1.0).abs() < 1e-9, "{thickness} {back}");
        }
        let thick = Spacing::new([1.0, 1.0, 30.0]).unwrap();
        let sigma = auto_sigma(thick);
        assert!(
            (auto_thickness_of_blur(thick, &EdgeProfile::blurred(sigma), 0.5) / sigma - 4.48).abs() < 0.01
        );
    }

    #[test]
    fn variance_is_that_of_the_delta_on_a_thin_band() {
        let (sigma, t) = (2.0, 0.5);
        let profile = EdgeProfile::blurred(sigma);
        let delta = SmearedDelta::new(Smearing::Sine, epsilon_of_blur(&profile, t), 0.5);
        assert!((band_variance(&profile, &delta) / (0.032_67 * t * t) - 1.0).abs() < 5e-3);
    }

    #[test]
    fn automatic_lengths_follow_the_spacing() {
        let spacing = Spacing::new([0.5, 1.0, 4.0]).unwrap();
        assert!((auto_sigma(spacing) - 2.0 * 2f64.cbrt()).abs() < 1e-12);
        assert_eq!(auto_thickness(spacing), 10.0);
    }
}
