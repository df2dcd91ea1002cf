//! Quantiles of Student's, Fisher's and the normal distribution, from the incomplete beta function and its
//! inverse (`puruspe`; `statrs` for many degrees of freedom).

use puruspe::{betai, invbetai, inverfc};
use statrs::function::beta::beta_reg;
use std::f64::consts::SQRT_2;

/// Degrees of freedom above which Student's distribution is taken from an expansion about the normal one: its
/// beta function then loses digits.
const MANY: f64 = 1e4;
/// Degrees of freedom above which no crate's inverse of the incomplete beta function is right: `puruspe`'s is
/// up to 2 % off, and panics from 6000 and 6000 on; that of `statrs` stops early. The latter's incomplete
/// beta function itself is right.
const INVERTIBLE: f64 = 2e3;

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

/// The number below which Student's t of some degrees of freedom lies with a probability (between 0 and 1,
/// both left out).
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

/// The number below which Fisher's F of some degrees of freedom lies with a probability; not a number for
/// degrees that are none.
pub fn f_quantile(probability: f64, [numerator, denominator]: [f64; 2]) -> f64 {
    if !([numerator, denominator].iter().all(|degrees| degrees.is_finite() && *degrees > 0.0)) {
        return f64::NAN;
    }
    if numerator.max(denominator) > INVERTIBLE {
        return f_quantile_by_halving(probability, [numerator, denominator]);
    }
    let x = invbetai(probability, 0.5 * numerator, 0.5 * denominator);
    denominator * x / (numerator * (1.0 - x))
}

/// The same by halving an interval of logarithms that holds all numbers, until its ends are neighbours.
fn f_quantile_by_halving(probability: f64, degrees: [f64; 2]) -> f64 {
    let [mut low, mut high] = [-700.0, 700.0];
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return libm::exp(middle);
        }
        if f_cdf(libm::exp(middle), degrees) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Probability that Fisher's F is below f, from the tail that is not next to 1.
fn f_cdf(f: f64, [numerator, denominator]: [f64; 2]) -> f64 {
    let odds = f * numerator / denominator;
    if odds < 1.0 {
        beta_reg(0.5 * numerator, 0.5 * denominator, odds / (1.0 + odds))
    } else {
        1.0 - beta_reg(0.5 * denominator, 0.5 * numerator, 1.0 / (1.0 + odds))
    }
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

    /// scipy.stats 1.17: f.ppf. One of the degrees may be few, as Satterthwaite's are.
    #[test]
    fn many_degrees_as_scipy() {
        for (degrees, expected) in [
            ([5999.0, 5999.0], [0.950_644_521_931_312, 1.051_917_911_406_483]),
            ([6100.0, 6100.0], [0.951_044_689_132_436, 1.051_475_300_190_386]),
            ([999_999.0, 999_999.0], [0.996_087_740_741_169, 1.003_927_625_146_676]),
            ([5990.0, 1e6], [0.964_402_132_093_393, 1.036_241_920_156_601]),
            ([1e6, 5990.0], [0.965_025_618_582_267, 1.036_911_851_106_484]),
            ([1e6, 12.5], [0.520_002_053_642_185, 2.657_161_135_685_497]),
            ([12.5, 1e6], [0.376_341_497_160_284, 1.923_069_328_276_35]),
            ([1e6, 1.0], [0.199_048_495_681_35, 1_018.257_760_090_66]),
        ] {
            for (probability, expected) in [0.025, 0.975].into_iter().zip(expected) {
                let found = f_quantile(probability, degrees);
                assert!((found / expected - 1.0).abs() < 2e-9, "{degrees:?} {probability}: {found}");
            }
        }
    }

    /// Where one way of inverting takes over from the other.
    #[test]
    fn quantiles_of_f_are_continuous() {
        for few in [1.0, 3.7, 60.0, 2000.0] {
            for degrees in [[2000.0, few], [few, 2000.0]] {
                let [crate_s, own] = [f_quantile(0.975, degrees), f_quantile_by_halving(0.975, degrees)];
                assert!((crate_s / own - 1.0).abs() < 1e-9, "{degrees:?}: {crate_s} and {own}");
            }
        }
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
