//! Agreement of Euler characteristics.

use serde::Serialize;
use std::collections::BTreeMap;

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
    /// Rounds; what is beyond 64 bits is the largest there is.
    pub fn round(self, chi: f64) -> i64 {
        match self {
            Self::Even => (2.0 * libm::round(0.5 * chi)) as i64,
            Self::Integer => libm::round(chi) as i64,
        }
    }
}

/// Most classes of a matrix: its size is their square.
const MOST_CLASSES: usize = 50;

/// How often each pair of classes occurs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ConfusionMatrix {
    /// How values were rounded.
    pub rounding: EulerRounding,
    /// The classes of both methods, ascending; the 50 most frequent where there are more.
    pub classes: Vec<i64>,
    /// Counts: a row for each class of the standard, a column for each of the method.
    pub counts: Vec<Vec<usize>>,
    /// What the matrix leaves out, where there are more classes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rare: Option<RareClasses>,
}

/// Classes that a matrix has no room for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct RareClasses {
    /// How many.
    pub classes: usize,
    /// Pairs of which one or both are in such a class.
    pub pairs: usize,
    /// Pairs of which both are in the same such class.
    pub same: usize,
}

impl ConfusionMatrix {
    /// Of pairs of a method's and the standard's value.
    pub fn new(pairs: &[(f64, f64)], rounding: EulerRounding) -> Self {
        let round = |&(method, standard): &(f64, f64)| [rounding.round(standard), rounding.round(method)];
        let rounded: Vec<[i64; 2]> = pairs.iter().map(round).collect();
        let classes = frequent_classes(&rounded);
        let mut counts = vec![vec![0; classes.listed.len()]; classes.listed.len()];
        let mut rare = RareClasses { classes: classes.left_out, pairs: 0, same: 0 };
        for [standard, method] in rounded {
            let place = |class| classes.listed.binary_search(&class).ok();
            if let Some((row, column)) = place(standard).zip(place(method)) {
                counts[row][column] += 1;
            } else {
                rare.pairs += 1;
                rare.same += usize::from(standard == method);
            }
        }
        Self { rounding, classes: classes.listed, counts, rare: (rare.classes > 0).then_some(rare) }
    }

    /// Share of pairs in the same class.
    pub fn accuracy(&self) -> f64 {
        let listed: usize = (0..self.classes.len()).map(|n| self.counts[n][n]).sum();
        let same = listed + self.rare.map_or(0, |rare| rare.same);
        let all = self.counts.iter().flatten().sum::<usize>() + self.rare.map_or(0, |rare| rare.pairs);
        same as f64 / all as f64
    }
}

struct Classes {
    /// Ascending.
    listed: Vec<i64>,
    left_out: usize,
}

/// Those in which most pairs are, by one method or the other; of equally frequent ones the least.
fn frequent_classes(rounded: &[[i64; 2]]) -> Classes {
    let mut frequencies = BTreeMap::new();
    for class in rounded.as_flattened() {
        *frequencies.entry(*class).or_insert(0usize) += 1;
    }
    let mut classes: Vec<(i64, usize)> = frequencies.into_iter().collect();
    // A stable sort: ascending classes stay so.
    classes.sort_by_key(|&(_, frequency)| std::cmp::Reverse(frequency));
    let left_out = classes.len().saturating_sub(MOST_CLASSES);
    classes.truncate(MOST_CLASSES);
    let mut listed: Vec<i64> = classes.into_iter().map(|(class, _)| class).collect();
    listed.sort_unstable();
    Classes { listed, left_out }
}
