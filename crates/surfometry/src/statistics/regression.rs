//! Ordinary least squares.

use super::paired::{co_moment, mean, varies};
use super::{Estimate, student_quantile, student_tails};
use serde::Serialize;

/// y = intercept + slope x.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LinearFit {
    /// Slope.
    pub slope: Estimate,
    /// Intercept, in y's unit.
    pub intercept: Estimate,
    /// Share of y's variance that the line explains; NaN where y does not vary.
    pub r_squared: f64,
    /// Standard deviation of y about the line, n - 2 degrees of freedom.
    pub residual_deviation: f64,
    /// Two-sided p-value of a slope of 0.
    pub slope_p_value: f64,
}

impl LinearFit {
    /// Where none is defined.
    pub(super) const NONE: Self = Self {
        slope: Estimate::NONE,
        intercept: Estimate::NONE,
        r_squared: f64::NAN,
        residual_deviation: f64::NAN,
        slope_p_value: f64::NAN,
    };
}

/// The line of least squares through points, x without error, with Student's intervals (n - 2 degrees of
/// freedom).
///
/// `x` and `y` are at least three and as many, as [`Paired`](super::Paired) holds them; all of the line is NaN
/// where `x` does not vary.
pub fn least_squares(x: &[f64], y: &[f64]) -> LinearFit {
    if !varies(x) {
        return LinearFit::NONE;
    }
    let count = x.len() as f64;
    let degrees = count - 2.0;
    let (square_x, square_y) = (co_moment(x, x), co_moment(y, y));
    let slope = co_moment(x, y) / square_x;
    let intercept = mean(y) - slope * mean(x);
    let residual: f64 = x.iter().zip(y).map(|(x, y)| (y - intercept - slope * x).powi(2)).sum();
    let variance = residual / degrees;
    let slope_error = (variance / square_x).sqrt();
    let intercept_error = (variance * (1.0 / count + mean(x).powi(2) / square_x)).sqrt();
    let quantile = student_quantile(0.975, degrees);
    LinearFit {
        slope: Estimate::symmetric(slope, quantile * slope_error),
        intercept: Estimate::symmetric(intercept, quantile * intercept_error),
        r_squared: if varies(y) { 1.0 - residual / square_y } else { f64::NAN },
        residual_deviation: variance.sqrt(),
        slope_p_value: if slope_error > 0.0 {
            student_tails(slope / slope_error, degrees)
        } else if slope == 0.0 {
            1.0
        } else {
            0.0
        },
    }
}
