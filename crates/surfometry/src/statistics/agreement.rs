//! Everything that is asked of a method against a standard.

use super::paired::{deviation, mean};
use super::{
    BlandAltman, Bootstrap, Estimate, Intraclass, LinearFit, Paired, bland_altman, bootstrap, concordance,
    intraclass, least_squares,
};
use serde::Serialize;

/// Mean and standard deviation of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Spread {
    /// Of at least two values.
    pub fn of(values: &[f64]) -> Self {
        Self { mean: mean(values), deviation: deviation(values) }
    }
}

/// Agreement of a method with a standard. Where all values of either are the same, lines and correlations are
/// NaN.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Agreement {
    /// Number of pairs.
    pub count: usize,
    /// The method's values.
    pub method: Spread,
    /// The standard's.
    pub standard: Spread,
    /// Method = intercept + slope standard. (The paper has the standard on the method's values.)
    pub regression: LinearFit,
    /// Differences, method minus standard.
    pub bland_altman: BlandAltman,
    /// Lin's concordance.
    pub concordance: Estimate,
    /// Intraclass correlations.
    pub intraclass: Intraclass,
    /// The bias with a bootstrapped interval, which needs no normal differences.
    pub bootstrapped_bias: Option<Estimate>,
    /// The same of Lin's concordance.
    pub bootstrapped_concordance: Option<Estimate>,
}

impl Agreement {
    /// Of pairs.
    pub fn of(pairs: &Paired, how: Bootstrap) -> Self {
        Self {
            count: pairs.count(),
            method: Spread::of(pairs.method()),
            standard: Spread::of(pairs.standard()),
            regression: least_squares(pairs.standard(), pairs.method()),
            bland_altman: bland_altman(pairs),
            concordance: concordance(pairs),
            intraclass: if pairs.vary() {
                intraclass(&[pairs.method(), pairs.standard()])
            } else {
                Intraclass::NONE
            },
            bootstrapped_bias: bootstrap(pairs, how, Paired::mean_difference),
            bootstrapped_concordance: bootstrap(pairs, how, |sample| concordance(sample).value),
        }
    }
}
