//! Agreement of Euler characteristics.

use serde::Serialize;

/// What a real characteristic is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EulerRounding {
    /// The nearest even number: a closed surface has no other.
    Even,
    /// The nearest whole number, as in the paper.
    Integer,
}

impl EulerRounding {
    /// Rounds.
    pub fn round(self, chi: f64) -> i64 {
        match self {
            Self::Even => 2 * libm::round(0.5 * chi) as i64,
            Self::Integer => libm::round(chi) as i64,
        }
    }
}

/// How often each pair of classes occurs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ConfusionMatrix {
    /// How values were rounded.
    pub rounding: EulerRounding,
    /// The classes of both methods, ascending.
    pub classes: Vec<i64>,
    /// Counts: a row for each class of the standard, a column for each of the method.
    pub counts: Vec<Vec<usize>>,
}

impl ConfusionMatrix {
    /// Of pairs of a method's and the standard's value.
    pub fn new(pairs: &[(f64, f64)], rounding: EulerRounding) -> Self {
        let rounded: Vec<(i64, i64)> =
            pairs.iter().map(|&(m, s)| (rounding.round(m), rounding.round(s))).collect();
        let mut classes: Vec<i64> = rounded.iter().flat_map(|&(m, s)| [m, s]).collect();
        classes.sort_unstable();
        classes.dedup();
        let count =
            |standard: i64, method: i64| rounded.iter().filter(|&&pair| pair == (method, standard)).count();
        let counts = classes.iter().map(|&s| classes.iter().map(|&m| count(s, m)).collect()).collect();
        Self { rounding, classes, counts }
    }

    /// Share of pairs in the same class.
    pub fn accuracy(&self) -> f64 {
        let same: usize = (0..self.classes.len()).map(|n| self.counts[n][n]).sum();
        same as f64 / self.counts.iter().flatten().sum::<usize>() as f64
    }
}
