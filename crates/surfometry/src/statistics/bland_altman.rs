//! Bland and Altman's analysis.

use super::paired::{deviation, mean};
use super::{Estimate, LinearFit, Paired, least_squares, student_quantile, student_tails};
use serde::Serialize;

/// Differences, method minus standard.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlandAltman {
    /// Their mean.
    pub bias: Estimate,
    /// Two-sided p-value of no bias (paired t-test).
    pub bias_p_value: f64,
    /// Bias in % of the standard's mean.
    pub bias_percent: f64,
    /// Their standard deviation.
    pub deviation: f64,
    /// Bias -+ 1.96 standard deviations.
    pub limits: [Estimate; 2],
    /// Proportional bias: the line of the differences on the means of both methods; its slope is 0 without
    /// one, and `slope_p_value` tells. NaN where a method's or the standard's values are all the same.
    pub proportional: LinearFit,
    /// Width of the limits of agreement in % of the mean: a spread. The paper gives this number, halved or
    /// not, as "proportional bias" (-5.0 and +0.6 % there).
    pub limits_width_percent: f64,
}

/// Bias, limits of agreement and their intervals (Bland and Altman 1986, 1999: the variance of a limit is s^2
/// (1/n + 1.96^2 / 2 (n - 1))).
///
/// Valid where differences are about normal and do not grow with size; where `proportional` says they do,
/// compare logarithms.
pub fn bland_altman(pairs: &Paired) -> BlandAltman {
    let (differences, means) = (pairs.differences(), pairs.means());
    let count = pairs.count() as f64;
    let quantile = student_quantile(0.975, count - 1.0);
    let (bias, deviation) = (mean(&differences), deviation(&differences));
    let error = deviation / count.sqrt();
    let limit_error = deviation * (1.0 / count + 1.96f64.powi(2) / (2.0 * (count - 1.0))).sqrt();
    let limit = |sign: f64| Estimate::symmetric(bias + sign * 1.96 * deviation, quantile * limit_error);
    BlandAltman {
        bias: Estimate::symmetric(bias, quantile * error),
        bias_p_value: if error > 0.0 {
            student_tails(bias / error, count - 1.0)
        } else {
            f64::from(u8::from(bias == 0.0))
        },
        bias_percent: 100.0 * bias / mean(pairs.standard()).abs(),
        deviation,
        limits: [limit(-1.0), limit(1.0)],
        // Differences to a constant are as large as what differs from it, whatever the method.
        proportional: if pairs.vary() { least_squares(&means, &differences) } else { LinearFit::NONE },
        limits_width_percent: 100.0 * 2.0 * 1.96 * deviation / mean(&means).abs(),
    }
}
