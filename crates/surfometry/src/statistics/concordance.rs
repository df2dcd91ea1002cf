//! Lin's concordance correlation coefficient.

use super::paired::Moments;
use super::{Estimate, Paired, normal_quantile};

/// How close pairs lie to the line of equality: correlation times a penalty for shift and scale (Lin 1989,
/// with the variance as corrected in 2000), 1 for identical values.
///
/// The interval is symmetric in the inverse hyperbolic tangent. NaN where either does not vary.
pub fn concordance(pairs: &Paired) -> Estimate {
    if !pairs.vary() {
        return Estimate::NONE;
    }
    let Moments { means, sums } = Moments::of(pairs.method(), pairs.standard());
    let count = pairs.count() as f64;
    let [xx, yy, xy] = sums.map(|sum| sum / count);
    let shift = means[0] - means[1];
    let value = 2.0 * xy / (xx + yy + shift * shift);
    let r = xy / (xx * yy).sqrt();
    let u = shift / (xx * yy).sqrt().sqrt();
    let square = value * value;
    let scale = 1.0 - square;
    let of_correlation = (1.0 - r * r) * square / (scale * r * r);
    let of_shift = 2.0 * value.powi(3) * (1.0 - value) * u * u / (r * scale * scale);
    let of_both = square * square * u.powi(4) / (2.0 * r * r * scale * scale);
    let error = ((of_correlation + of_shift - of_both).max(0.0) / (count - 2.0)).sqrt();
    let middle = libm::atanh(value);
    let half = normal_quantile(0.975) * error;
    // Of identical values, and of uncorrelated ones, the variance is not defined.
    if !half.is_finite() {
        return Estimate { value, interval: if value >= 1.0 { [1.0; 2] } else { [-1.0, 1.0] } };
    }
    Estimate { value, interval: [libm::tanh(middle - half), libm::tanh(middle + half)] }
}
