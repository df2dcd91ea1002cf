//! The same objects by two methods.

use thiserror::Error;

/// Values of a method and of the standard on the same objects: at least three, all finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Paired {
    method: Vec<f64>,
    standard: Vec<f64>,
}

/// Why values cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PairError {
    /// Different counts.
    #[error("{method} values of the method and {standard} of the standard do not make pairs")]
    Unpaired {
        /// Of the method.
        method: usize,
        /// Of the standard.
        standard: usize,
    },
    /// Too few.
    #[error("{0} pairs are too few: agreement needs three")]
    TooFew(usize),
    /// Not a number, or infinite.
    #[error("pair {0} is not finite")]
    NotFinite(usize),
}

impl Paired {
    /// Pairs.
    ///
    /// # Errors
    /// [`PairError`].
    pub fn new(method: Vec<f64>, standard: Vec<f64>) -> Result<Self, PairError> {
        if method.len() != standard.len() {
            return Err(PairError::Unpaired { method: method.len(), standard: standard.len() });
        }
        if method.len() < 3 {
            return Err(PairError::TooFew(method.len()));
        }
        let finite = |(m, s): (&f64, &f64)| m.is_finite() && s.is_finite();
        if let Some(bad) = method.iter().zip(&standard).position(|pair| !finite(pair)) {
            return Err(PairError::NotFinite(bad));
        }
        Ok(Self { method, standard })
    }

    /// The method's values.
    pub fn method(&self) -> &[f64] {
        &self.method
    }

    /// The standard's values.
    pub fn standard(&self) -> &[f64] {
        &self.standard
    }

    /// Whether both the method's and the standard's values vary, as lines and correlations need.
    pub fn vary(&self) -> bool {
        varies(&self.method) && varies(&self.standard)
    }

    /// Number of pairs.
    pub fn count(&self) -> usize {
        self.method.len()
    }

    /// Method minus standard.
    pub fn differences(&self) -> Vec<f64> {
        self.pairs().map(|(m, s)| m - s).collect()
    }

    /// Means of method and standard.
    pub fn means(&self) -> Vec<f64> {
        self.pairs().map(|(m, s)| 0.5 * (m + s)).collect()
    }

    fn pairs(&self) -> impl Iterator<Item = (f64, f64)> {
        self.method.iter().copied().zip(self.standard.iter().copied())
    }

    /// Mean of method minus standard.
    pub fn mean_difference(&self) -> f64 {
        self.pairs().map(|(m, s)| m - s).sum::<f64>() / self.count() as f64
    }

    /// The pairs but one; `None` where what is left is too few.
    pub(super) fn without(&self, place: usize) -> Option<Self> {
        let rest = |values: &[f64]| [&values[..place], &values[place + 1..]].concat();
        Self::new(rest(&self.method), rest(&self.standard)).ok()
    }

    /// The pairs at some places; `None` where they are too few.
    pub(super) fn chosen(&self, places: &[usize]) -> Option<Self> {
        let take = |values: &[f64]| places.iter().map(|&place| values[place]).collect();
        Self::new(take(&self.method), take(&self.standard)).ok()
    }
}

/// Whether not all values are the same, to the bit: sums of the same numbers leave rounding behind.
pub(super) fn varies(values: &[f64]) -> bool {
    values.iter().any(|v| v != &values[0])
}

/// Mean.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Sum of the products of two numbers' distances from their means.
pub(super) fn co_moment(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b) = (mean(a), mean(b));
    a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum()
}

/// Means of two numbers, and the sums of squares and products of their distances from them: as [`mean`] and
/// [`co_moment`] have them, in two passes.
pub(super) struct Moments {
    pub(super) means: [f64; 2],
    /// Of the first's squares, the second's, and the products.
    pub(super) sums: [f64; 3],
}

impl Moments {
    pub(super) fn of(x: &[f64], y: &[f64]) -> Self {
        let pairs = || x.iter().zip(y);
        let add = |[a, b]: [f64; 2], (x, y): (&f64, &f64)| [a + x, b + y];
        let means = pairs().fold([0.0; 2], add).map(|sum| sum / x.len() as f64);
        let sums = pairs().fold([0.0; 3], |[xx, yy, xy], (x, y)| {
            let (a, b) = (x - means[0], y - means[1]);
            [xx + a * a, yy + b * b, xy + a * b]
        });
        Self { means, sums }
    }
}

/// Standard deviation, of a sample.
pub(super) fn deviation(values: &[f64]) -> f64 {
    (co_moment(values, values) / (values.len() as f64 - 1.0)).sqrt()
}
