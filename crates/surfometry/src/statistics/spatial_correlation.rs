//! Correlation of two quantities over a surface, with an interval that minds how they vary in space.

use super::student_quantile;
use serde::Serialize;
use std::collections::BTreeMap;

/// Patches into which a surface is parted, about: neighbours are as good as one.
const PATCHES: f64 = 1200.0;
/// Bins of distance between patches.
const BINS: usize = 40;
/// Effective size below which an interval says nothing.
const SMALLEST: f64 = 4.0;
/// Least share of what distances add to the variance of a coefficient that others can leave of it.
const LEAST_LEFT: f64 = 1.0 / 3.0;
/// Probability that an interval holds the truth.
const CONFIDENCE: f64 = 0.95;

/// A correlation coefficient and its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpatialCorrelation {
    /// From -1 to 1.
    pub value: f64,
    /// Where the truth lies in 95 of 100 cases; -1 to 1 where there is too little to tell.
    pub interval: [f64; 2],
    /// How many independent pairs tell as much.
    pub effective_size: f64,
}

/// Places with the areas that they stand for.
#[derive(Debug)]
pub struct Places<'a> {
    positions: &'a [[f64; 3]],
    /// Shares of the whole.
    shares: Vec<f64>,
    /// By place, which patch it is in.
    patch_of: Vec<usize>,
    patches: Vec<([f64; 3], f64)>,
}

impl<'a> Places<'a> {
    /// Positions, mm, and areas, mm^2; `None` without any area. Lists are equally long.
    pub fn new(positions: &'a [[f64; 3]], areas: &[f64]) -> Option<Self> {
        let total: f64 = areas.iter().sum();
        if !(total > 0.0 && total.is_finite()) || positions.len() != areas.len() {
            return None;
        }
        let edge = (total / PATCHES).sqrt();
        let mut numbers = BTreeMap::new();
        let mut patches: Vec<([f64; 3], f64)> = Vec::new();
        let mut patch_of = Vec::with_capacity(positions.len());
        let shares: Vec<f64> = areas.iter().map(|area| area / total).collect();
        for (position, share) in positions.iter().zip(&shares) {
            let cell = position.map(|v| (v / edge).floor() as i64);
            let patch = *numbers.entry(cell).or_insert(patches.len());
            if patch == patches.len() {
                patches.push(([0.0; 3], 0.0));
            }
            let (sum, weight) = &mut patches[patch];
            (0..3).for_each(|a| sum[a] += share * position[a]);
            *weight += share;
            patch_of.push(patch);
        }
        for (sum, weight) in &mut patches {
            if *weight > 0.0 {
                *sum = sum.map(|v| v / *weight);
            }
        }
        Some(Self { positions, shares, patch_of, patches })
    }

    /// Pearson's coefficient of two quantities, each place weighing by its area.
    ///
    /// Its variance is that of two independent quantities that vary in space as these do: the sum over all pairs of places
    /// of the product of both autocovariances, taken by distance (Clifford, Richardson and Hemon 1989); the interval is
    /// Fisher's with so many independent pairs as have that variance, and Student's quantile. `None` where one of them is
    /// the same everywhere.
    pub fn pearson(&self, first: &[f64], second: &[f64]) -> Option<SpatialCorrelation> {
        let (first, second) = (self.standardised(first)?, self.standardised(second)?);
        let value: f64 =
            self.shares.iter().zip(&first).zip(&second).map(|((share, a), b)| share * a * b).sum();
        let effective_size = self.effective_size(&first, &second);
        Some(SpatialCorrelation { value, interval: interval(value, effective_size), effective_size })
    }

    /// Spearman's: that of the ranks, a rank being the share of the area that lies below.
    pub fn spearman(&self, first: &[f64], second: &[f64]) -> Option<SpatialCorrelation> {
        self.pearson(&self.ranks(first)?, &self.ranks(second)?)
    }

    fn ranks(&self, values: &[f64]) -> Option<Vec<f64>> {
        if values.len() != self.positions.len() {
            return None;
        }
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]));
        let mut ranks = vec![0.0; values.len()];
        let mut below = 0.0;
        for alike in order.chunk_by(|&a, &b| values[a] == values[b]) {
            let share: f64 = alike.iter().map(|&n| self.shares[n]).sum();
            for &n in alike {
                ranks[n] = below + 0.5 * share;
            }
            below += share;
        }
        Some(ranks)
    }

    /// Less the mean, over the standard deviation.
    fn standardised(&self, values: &[f64]) -> Option<Vec<f64>> {
        if values.len() != self.positions.len() {
            return None;
        }
        let mean: f64 = self.shares.iter().zip(values).map(|(share, v)| share * v).sum();
        let variance: f64 = self.shares.iter().zip(values).map(|(s, v)| s * (v - mean) * (v - mean)).sum();
        let scale: f64 = self.shares.iter().zip(values).map(|(s, v)| s * v * v).sum();
        // A constant's variance is what rounding left.
        let varies = variance.is_finite() && variance > 1e-20 * scale;
        varies.then(|| values.iter().map(|v| (v - mean) / variance.sqrt()).collect())
    }

    fn patch_means(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.patches.len()];
        for ((patch, share), value) in self.patch_of.iter().zip(&self.shares).zip(values) {
            sums[*patch] += share * value;
        }
        let mean =
            |(sum, (_, weight)): (f64, &([f64; 3], f64))| if *weight > 0.0 { sum / weight } else { 0.0 };
        sums.into_iter().zip(&self.patches).map(mean).collect()
    }

    fn effective_size(&self, first: &[f64], second: &[f64]) -> f64 {
        let means = [self.patch_means(first), self.patch_means(second)];
        let farthest =
            self.patches.iter().filter_map(|(p, _)| self.patches.first().map(|(q, _)| distance(p, q)));
        let longest = 2.0 * farthest.fold(0.0, f64::max);
        // By bin of distance, pairs of a patch with itself first: weight, and both covariances times it.
        let mut bins = vec![[0.0; 3]; BINS + 2];
        for (n, (place, weight)) in self.patches.iter().enumerate() {
            let own = weight * weight;
            let square = |of: usize| own * means[of][n] * means[of][n];
            [own, square(0), square(1)].iter().zip(&mut bins[0]).for_each(|(v, sum)| *sum += v);
            for (m, (other, more)) in self.patches.iter().enumerate().skip(n + 1) {
                let bin = 1 + (distance(place, other) / longest * BINS as f64) as usize;
                let both = 2.0 * weight * more;
                let product = |of: usize| both * means[of][n] * means[of][m];
                [both, product(0), product(1)].iter().zip(&mut bins[bin]).for_each(|(v, sum)| *sum += v);
            }
        }
        let products = || bins.iter().filter(|bin| bin[0] > 0.0).map(|[w, a, b]| a * b / w);
        // Where one of them repeats itself and the other turns over, distances take off what others add, and all that is left
        // may be nothing.
        let least = LEAST_LEFT * products().map(|product| product.max(0.0)).sum::<f64>();
        let variance = products().sum::<f64>().max(least);
        let most = self.patches.len() as f64;
        if variance > 0.0 { (1.0 + 1.0 / variance).min(most) } else { most }
    }
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    libm::sqrt((0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum())
}

fn interval(value: f64, size: f64) -> [f64; 2] {
    if size < SMALLEST {
        return [-1.0, 1.0];
    }
    let wide = student_quantile(0.5 + 0.5 * CONFIDENCE, size - 2.0) / libm::sqrt(size - 3.0);
    let middle = libm::atanh(value.clamp(-1.0 + 1e-12, 1.0 - 1e-12));
    [libm::tanh(middle - wide), libm::tanh(middle + wide)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: sums of products 21.2, of squares 14.8 and 38.8; four ranks are off by one.
    #[test]
    fn coefficients_of_known_numbers() {
        let (a, b) = ([1.0, 2.0, 3.0, 4.0, 6.0], [2.0, 1.0, 4.0, 3.0, 9.0]);
        let positions: Vec<[f64; 3]> = (0..5).map(|n| [f64::from(n), 0.0, 0.0]).collect();
        let places = Places::new(&positions, &[1.0; 5]).unwrap();
        let pearson = places.pearson(&a, &b).unwrap();
        assert!((pearson.value - 21.2 / (14.8f64 * 38.8).sqrt()).abs() < 1e-12, "{}", pearson.value);
        assert!((places.spearman(&a, &b).unwrap().value - 0.8).abs() < 1e-12);
        assert!(places.pearson(&a, &[1.0; 5]).is_none());
        assert!(Places::new(&positions, &[0.0; 5]).is_none());
    }
}
