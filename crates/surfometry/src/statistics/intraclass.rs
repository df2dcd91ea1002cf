//! Intraclass correlation.

use super::paired::mean;
use super::{Estimate, f_quantile};
use serde::Serialize;

/// Reliability of single measurements, of objects by methods.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Intraclass {
    /// ICC(2,1), or ICC(A,1): absolute agreement of methods drawn at random.
    pub agreement: Estimate,
    /// ICC(3,1), or ICC(C,1): consistency of these methods, whatever their bias.
    pub consistency: Estimate,
}

impl Intraclass {
    /// Where none is defined.
    pub(super) const NONE: Self = Self { agreement: Estimate::NONE, consistency: Estimate::NONE };
}

/// Intraclass correlations from the two-way analysis of variance (Shrout and Fleiss 1979; intervals of McGraw
/// and Wong 1996).
///
/// `methods` holds at least two methods, each with the same at least two objects in the same order.
pub fn intraclass(methods: &[&[f64]]) -> Intraclass {
    let (k, n) = (methods.len() as f64, methods[0].len() as f64);
    let objects: Vec<f64> = (0..methods[0].len())
        .map(|object| methods.iter().map(|method| method[object]).sum::<f64>() / k)
        .collect();
    let grand = mean(&objects);
    let between_objects = k * objects.iter().map(|m| (m - grand).powi(2)).sum::<f64>() / (n - 1.0);
    let between_methods = n * methods.iter().map(|m| (mean(m) - grand).powi(2)).sum::<f64>() / (k - 1.0);
    let residual = |method: &[f64]| {
        let own = mean(method);
        method.iter().zip(&objects).map(|(v, object)| (v - object - own + grand).powi(2)).sum::<f64>()
    };
    let degrees = (n - 1.0) * (k - 1.0);
    let error = methods.iter().map(|method| residual(method)).sum::<f64>() / degrees;

    let ratio = between_objects / error;
    let upper = f_quantile(0.975, [n - 1.0, degrees]);
    let of_ratio = |f: f64| if f.is_finite() { (f - 1.0) / (f + k - 1.0) } else { 1.0 };
    let consistency = Estimate {
        value: of_ratio(ratio),
        interval: [of_ratio(ratio / upper), of_ratio(ratio * f_quantile(0.975, [degrees, n - 1.0]))],
    };

    let value =
        (between_objects - error) / (between_objects + (k - 1.0) * error + k * (between_methods - error) / n);
    // Satterthwaite's degrees of freedom of what methods and error add up to.
    let methods_ratio = between_methods / error;
    let a = k * value * methods_ratio;
    let b = n * (1.0 + (k - 1.0) * value) - k * value;
    let spread = if methods_ratio.is_finite() {
        degrees * (a + b).powi(2) / ((n - 1.0) * a * a + b * b)
    } else {
        k - 1.0
    };
    let denominator = k * between_methods + (k * n - k - n) * error;
    let low = f_quantile(0.975, [n - 1.0, spread]);
    let high = f_quantile(0.975, [spread, n - 1.0]);
    let agreement = Estimate {
        value,
        interval: [
            n * (between_objects - low * error) / (low * denominator + n * between_objects),
            n * (high * between_objects - error) / (denominator + n * high * between_objects),
        ],
    };
    Intraclass { agreement, consistency }
}
