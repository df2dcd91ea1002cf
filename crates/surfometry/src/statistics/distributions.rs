//! Quantiles of Student's, Fisher's and the normal distribution, from the incomplete beta function and its inverse (`puruspe`).

use puruspe::{betai, invbetai, inverfc};
use std::f64::consts::SQRT_2;

/// Degrees of freedom above which Student's distribution is taken from an expansion about the normal one: its beta function then loses digits.
const MANY: f64 = 1e4;

/// Probability that a normal number of mean 0 and deviation 1 is below x.
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x / SQRT_2)
}

/// The number below which a normal one lies with a probability.
pub fn normal_quantile(probability: f64) -> f64 {
    -SQRT_2 * inverfc(2.0 * probability)
}

/// Probability that Student's t of some degrees of freedom is farther from 0 than t: the two-sided p-value.
pub fn student_tails(t: f64, degrees: f64) -> f64 {
    betai(0.5 * degrees, 0.5, degrees / (degrees + t * t))
}

/// The number below which Student's t of some degrees of freedom lies with a probability (between 0 and 1, both left out).
pub fn student_quantile(probability: f64, degrees: f64) -> f64 {
    if degrees > MANY {
        // Abramowitz and Stegun 26.7.5, to 1e-12 here.
        let z = normal_quantile(probability);
        let (z3, z5) = (z.powi(3), z.powi(5));
        return z
            + (z3 + z) / (4.0 * degrees)
            + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * degrees * degrees);
    }
    let tail = 2.0 * probability.min(1.0 - probability);
    let x = invbetai(tail, 0.5 * degrees, 0.5);
    let t = (degrees * (1.0 - x) / x).sqrt();
    if probability < 0.5 { -t } else { t }
}

/// The number below which Fisher's F of some degrees of freedom lies with a probability.
pub fn f_quantile(probability: f64, [numerator, denominator]: [f64; 2]) -> f64 {
    let x = invbetai(probability, 0.5 * numerator, 0.5 * denominator);
    denominator * x / (numerator * (1.0 - x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy.stats 1.16: t.ppf, t.sf, f.ppf, norm.ppf. (statrs has 1.959981 at 1e5 degrees of freedom.)
    #[test]
    fn as_scipy() {
        for (degrees, expected) in [
            (1.0, 12.706_204_736_174_694),
            (4.0, 2.776_445_105_197_793_4),
            (48.0, 2.010_634_757_624_232),
            (1e5, 1.959_987_707_534_609_5),
        ] {
            let found = student_quantile(0.975, degrees);
            assert!((found / expected - 1.0).abs() < 1e-9, "{degrees}: {found}");
            assert!((student_quantile(0.025, degrees) / found + 1.0).abs() < 1e-9);
        }
        // The incomplete beta function's continued fraction ends at 1e-8.
        let tails = student_tails(2.5, 17.0);
        assert!((tails / 0.022_947_806_386_984_94 - 1.0).abs() < 1e-7, "{tails}");
        assert!((f_quantile(0.975, [5.0, 15.0]) / 3.576_415_349_279_060_7 - 1.0).abs() < 1e-9);
        assert!((normal_quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-12);
        assert!((normal_cdf(-1.0) - 0.158_655_253_931_457_05).abs() < 1e-15);
    }

    #[test]
    fn quantiles_undo_probabilities() {
        for degrees in [2.0, 7.0, 300.0, 9999.0] {
            for p in [0.6, 0.9, 0.999] {
                let t = student_quantile(p, degrees);
                assert!((1.0 - 0.5 * student_tails(t, degrees) - p).abs() < 1e-7, "{degrees} {p}");
            }
        }
    }
}
