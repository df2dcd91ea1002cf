//! Smeared Heaviside and delta.

use crate::choice::choices;
use std::f64::consts::{FRAC_1_PI, PI};

/// Profile of the smeared delta.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Smearing {
    /// (1 + cos(pi x / eps)) / (2 eps) on |x| <= eps (the paper).
    #[default]
    Sine,
    /// sech^2(x / s) / (2 s) with s such that its second moment is the sine's, cut at 2 eps (or where the
    /// field saturates, if that is nearer) and renormalised.
    Tanh,
}

choices!(Smearing, "delta": {
    Sine = "sine": "A raised cosine (the paper)",
    Tanh = "tanh": "The derivative of a hyperbolic tangent, cut where the field saturates",
});

/// Variance of the sine delta in units of eps^2: 1/3 - 2/pi^2.
const SINE_VARIANCE: f64 = 1.0 / 3.0 - 2.0 / (PI * PI);

/// A smeared delta of a given half-width eps, in units of phi, and its Heaviside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmearedDelta {
    smearing: Smearing,
    epsilon: f64,
    /// Where the delta ends, in units of phi.
    half_width: f64,
}

impl SmearedDelta {
    /// A delta of half-width `epsilon` for a field that saturates at |phi| = `saturation` (infinite if it
    /// does not).
    ///
    /// The hyperbolic tangent has tails; on a field that saturates they would weigh all of space. They are
    /// cut inside the saturation, and what is left is scaled to the integral 1.
    pub fn new(smearing: Smearing, epsilon: f64, saturation: f64) -> Self {
        let half_width = match smearing {
            Smearing::Sine => epsilon,
            // A hair inside, so that f32 rounding of the saturated value stays out.
            Smearing::Tanh => (2.0 * epsilon).min(saturation * (1.0 - 1e-6)),
        };
        Self { smearing, epsilon, half_width }
    }

    /// eps, in units of phi.
    pub fn epsilon(&self) -> f64 {
        self.epsilon
    }

    /// Largest |phi| with a weight.
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    fn tanh_scale(&self) -> f64 {
        // Variance of sech^2(x/s)/(2s) is (pi s)^2 / 12.
        self.epsilon * libm::sqrt(12.0 * SINE_VARIANCE) / PI
    }

    /// delta(phi) and theta(-phi) of voxels within the half-width.
    #[inline(always)]
    pub(super) fn lanes<const N: usize>(&self, phi: &[f64; N]) -> ([f64; N], [f64; N]) {
        let (mut delta, mut heaviside) = ([0.0; N], [0.0; N]);
        match self.smearing {
            Smearing::Sine => {
                for lane in 0..N {
                    (delta[lane], heaviside[lane]) = self.sine(-phi[lane]);
                }
            }
            Smearing::Tanh => {
                for lane in 0..N {
                    (delta[lane], heaviside[lane]) = (self.delta(phi[lane]), self.heaviside(-phi[lane]));
                }
            }
        }
        (delta, heaviside)
    }

    /// delta and theta of the sine within the half-width; 1 + cos x and sin x by half the angle.
    #[inline(always)]
    fn sine(&self, phi: f64) -> (f64, f64) {
        let inverse = 1.0 / self.epsilon;
        let x = phi * inverse;
        let (sin, cos) = sin_cos_half_pi(x);
        (cos * cos * inverse, 0.5 * (1.0 + x) + sin * cos * FRAC_1_PI)
    }

    /// delta(phi), in units of 1/phi.
    pub fn delta(&self, phi: f64) -> f64 {
        if phi.abs() > self.half_width {
            return 0.0;
        }
        match self.smearing {
            Smearing::Sine => self.sine(phi).0,
            Smearing::Tanh => {
                let s = self.tanh_scale();
                let cosh = libm::cosh(phi / s);
                1.0 / (2.0 * s * cosh * cosh * libm::tanh(self.half_width / s))
            }
        }
    }

    /// d delta / d phi, in units of 1/phi^2.
    pub fn slope(&self, phi: f64) -> f64 {
        if phi.abs() > self.half_width {
            return 0.0;
        }
        match self.smearing {
            Smearing::Sine => {
                let inverse = 1.0 / self.epsilon;
                let (sin, cos) = sin_cos_half_pi(phi * inverse);
                -PI * sin * cos * inverse * inverse
            }
            Smearing::Tanh => {
                let s = self.tanh_scale();
                -2.0 / s * libm::tanh(phi / s) * self.delta(phi)
            }
        }
    }

    /// theta(phi): 0 below the band, 1 above.
    pub fn heaviside(&self, phi: f64) -> f64 {
        if phi <= -self.half_width {
            return 0.0;
        }
        if phi >= self.half_width {
            return 1.0;
        }
        match self.smearing {
            Smearing::Sine => self.sine(phi).1,
            Smearing::Tanh => {
                let s = self.tanh_scale();
                0.5 * (1.0 + libm::tanh(phi / s) / libm::tanh(self.half_width / s))
            }
        }
    }
}

/// Terms of a series in -angle^2, each the one before over (n - 1) n, the n of the first being `n`.
const fn series(mut n: f64) -> [f64; 11] {
    let mut factors = [0.0; 11];
    let mut k = 0;
    while k < 11 {
        factors[k] = -1.0 / ((n - 1.0) * n);
        n += 2.0;
        k += 1;
    }
    factors
}

const COSINE: [f64; 11] = series(2.0);
const SINE: [f64; 11] = series(3.0);

/// Sine and cosine of pi x / 2 for |x| <= 1, from their series: without a branch, so that many are computed
/// at once. The first term that is left out is below 1e-17.
#[inline(always)]
fn sin_cos_half_pi(x: f64) -> (f64, f64) {
    let angle = 0.5 * PI * x;
    let square = angle * angle;
    // Horner's rule, from the last term.
    let (mut sin, mut cos) = (1.0, 1.0);
    for k in (0..11).rev() {
        cos = 1.0 + square * COSINE[k] * cos;
        sin = 1.0 + square * SINE[k] * sin;
    }
    (angle * sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_are_sine_and_cosine() {
        for step in -1000..=1000 {
            let x = f64::from(step) / 1000.0;
            let (sin, cos) = sin_cos_half_pi(x);
            let (exact_sin, exact_cos) = libm::sincos(0.5 * PI * x);
            assert!((sin - exact_sin).abs() < 5e-16 && (cos - exact_cos).abs() < 5e-16, "{x}");
        }
    }

    #[test]
    fn the_delta_is_the_heavisides_derivative_and_weighs_one() {
        for smearing in [Smearing::Sine, Smearing::Tanh] {
            for epsilon in [0.1, 0.234, 0.4] {
                let d = SmearedDelta::new(smearing, epsilon, 0.5);
                let n = 20_000;
                let step = 2.0 * d.half_width() / f64::from(n);
                let xs = (0..n).map(|i| -d.half_width() + (f64::from(i) + 0.5) * step);
                let weight: f64 = xs.clone().map(|x| d.delta(x) * step).sum();
                assert!((weight - 1.0).abs() < 1e-7, "{smearing:?} {epsilon} {weight}");
                for x in xs.step_by(997) {
                    let slope = (d.heaviside(x + 1e-6) - d.heaviside(x - 1e-6)) / 2e-6;
                    assert!((slope - d.delta(x)).abs() < 1e-5 * d.delta(0.0));
                    assert!((d.heaviside(x) + d.heaviside(-x) - 1.0).abs() < 1e-12);
                    let bend = (d.delta(x + 1e-6) - d.delta(x - 1e-6)) / 2e-6;
                    assert!((d.slope(x) - bend).abs() < 1e-6 / (epsilon * epsilon));
                }
                assert_eq!((d.heaviside(0.5), d.heaviside(-0.5), d.delta(0.5)), (1.0, 0.0, 0.0));
            }
        }
    }

    #[test]
    fn both_profiles_have_the_same_second_moment() {
        let moment = |smearing| {
            let d = SmearedDelta::new(smearing, 0.1, f64::INFINITY);
            let step = 1e-5;
            (-20_000..20_000).map(|i| f64::from(i) * step).map(|x| x * x * d.delta(x) * step).sum::<f64>()
        };
        assert!((moment(Smearing::Sine) / (SINE_VARIANCE * 0.01) - 1.0).abs() < 1e-4);
        // The cut at 2 eps takes 0.4 % of it away.
        assert!((moment(Smearing::Tanh) / moment(Smearing::Sine) - 1.0).abs() < 0.006);
    }
}
