//! A number and its interval.

use serde::Serialize;

/// An estimate with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Lower and upper end of its interval.
    pub interval: [f64; 2],
}

impl Estimate {
    /// Where none is defined.
    pub(super) const NONE: Self = Self { value: f64::NAN, interval: [f64::NAN; 2] };

    /// `value` with an interval of `half` to both sides.
    pub(super) fn symmetric(value: f64, half: f64) -> Self {
        Self { value, interval: [value - half, value + half] }
    }
}
