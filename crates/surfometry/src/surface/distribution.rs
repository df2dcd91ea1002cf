//! How a quantity is distributed over a surface.

use serde::Serialize;

/// Shares of the sample below the quantiles that are given.
pub const QUANTILES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];
/// Bins of a histogram.
const BINS: usize = 64;

/// A quantity over the vertices of a surface: every vertex alike, as in the paper, or by the area that it
/// stands for.
///
/// By vertex, parts with small triangles weigh more than their area does: use it to compare with tools that
/// count vertices, and the area-weighted form for what the surface is like. Bins are fixed by the quantiles
/// 0.01 and 0.99 of the area and counted beyond them in the outer bins, so that a few extreme vertices do not
/// flatten the rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Distribution {
    /// The array's name.
    pub name: &'static str,
    /// Weighted by area.
    pub by_area: Moments,
    /// Every vertex alike.
    pub by_vertex: Moments,
    /// The histogram.
    pub histogram: Histogram,
}

/// Moments and quantiles of weighted values. (Of crates, none takes weights.)
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Moments {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of the population.
    pub standard_deviation: f64,
    /// Third standardised moment; 0 for a single value.
    pub skewness: f64,
    /// Fourth standardised moment less 3; 0 for a single value.
    pub excess_kurtosis: f64,
    /// Smallest value.
    pub minimum: f64,
    /// Largest value.
    pub maximum: f64,
    /// Values below which the shares [`QUANTILES`] lie.
    pub quantiles: [f64; QUANTILES.len()],
}

/// Shares in bins of one width.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Histogram {
    /// Ends of the bins, one more than there are bins, ascending. The outer bins hold all that lies beyond.
    pub edges: Vec<f64>,
    /// Share of the area in each bin.
    pub by_area: Vec<f64>,
    /// Share of the vertices in each bin.
    pub by_vertex: Vec<f64>,
}

impl Distribution {
    /// Of one value a vertex; `None` where there is no area.
    pub fn of(name: &'static str, values: &[f64], areas: &[f64]) -> Option<Self> {
        let total: f64 = areas.iter().sum();
        if values.is_empty() || total <= 0.0 {
            return None;
        }
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]));
        let sorted = |weight: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            order.iter().map(|&i| (values[i], weight(i))).collect()
        };
        let by_area = sorted(&|i| areas[i] / total);
        let by_vertex = sorted(&|_| 1.0 / values.len() as f64);
        let moments = Moments::of_sorted(&by_area);
        let edges = bin_edges(moments.quantiles[0], moments.quantiles[QUANTILES.len() - 1], BINS);
        Some(Self {
            name,
            by_area: moments,
            by_vertex: Moments::of_sorted(&by_vertex),
            histogram: Histogram {
                by_area: shares(&edges, &by_area),
                by_vertex: shares(&edges, &by_vertex),
                edges,
            },
        })
    }
}

impl Moments {
    /// The value that half lies below.
    pub fn median(&self) -> f64 {
        self.quantiles[QUANTILES.len() / 2]
    }

    /// Of values in ascending order with weights that sum to 1.
    fn of_sorted(sample: &[(f64, f64)]) -> Self {
        let mean: f64 = sample.iter().map(|(v, w)| v * w).sum();
        let central = |power: i32| sample.iter().map(|(v, w)| (v - mean).powi(power) * w).sum::<f64>();
        let variance = central(2);
        // A constant's variance is what rounding left.
        let scale = sample.iter().map(|(v, w)| v * v * w).sum::<f64>();
        let standardised = |power: i32, normal: f64| {
            if variance > 1e-24 * scale {
                central(power) / libm::pow(variance, 0.5 * f64::from(power)) - normal
            } else {
                0.0
            }
        };
        Self {
            mean,
            standard_deviation: libm::sqrt(variance),
            skewness: standardised(3, 0.0),
            excess_kurtosis: standardised(4, 3.0),
            minimum: sample[0].0,
            maximum: sample[sample.len() - 1].0,
            quantiles: QUANTILES.map(|share| quantile(sample, share)),
        }
    }
}

/// The values below which the shares [`QUANTILES`] of the area lie; all 0 without any.
pub(super) fn quantiles(values: &[f64], areas: &[f64]) -> [f64; QUANTILES.len()] {
    let total: f64 = areas.iter().sum();
    let mut sample: Vec<(f64, f64)> = values.iter().zip(areas).map(|(&v, area)| (v, area / total)).collect();
    sample.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    if sample.is_empty() { [0.0; QUANTILES.len()] } else { QUANTILES.map(|share| quantile(&sample, share)) }
}

/// The value where the sum of the weights, each taken to its middle, reaches a share; linear between (Hazen's
/// plotting positions where all weigh the same).
fn quantile(sample: &[(f64, f64)], share: f64) -> f64 {
    let (mut below, mut last) = (0.0, (sample[0].0, 0.0));
    for &(value, weight) in sample {
        let position = below + 0.5 * weight;
        if position >= share {
            let step = position - last.1;
            let part = if step > 0.0 { ((share - last.1) / step).clamp(0.0, 1.0) } else { 1.0 };
            return last.0 + part * (value - last.0);
        }
        last = (value, position);
        below += weight;
    }
    last.0
}

/// Equal bins over a range, or a narrow range around a single value.
pub(super) fn bin_edges(low: f64, high: f64, bins: usize) -> Vec<f64> {
    let margin = if high > low { 0.0 } else { 0.5 * low.abs().max(1e-6) };
    let (low, high) = (low - margin, high + margin);
    (0..=bins).map(|i| low + (high - low) * i as f64 / bins as f64).collect()
}

/// The bin that a value counts in; the outer ones take what lies beyond.
pub(super) fn bin_of(edges: &[f64], value: f64) -> usize {
    edges.partition_point(|&edge| edge <= value).clamp(1, edges.len() - 1) - 1
}

fn shares(edges: &[f64], sample: &[(f64, f64)]) -> Vec<f64> {
    let mut shares = vec![0.0; edges.len() - 1];
    for &(value, weight) in sample {
        shares[bin_of(edges, value)] += weight;
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_and_quantiles_of_a_known_sample() {
        // NumPy: mean 5, std 2, skewness 0.65625, excess kurtosis -0.21875; Hazen's quartiles 4 and 6.
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        let d = Distribution::of("x", &values, &[0.5; 8]).unwrap();
        for m in [d.by_area, d.by_vertex] {
            assert!((m.mean - 5.0).abs() < 1e-12 && (m.standard_deviation - 2.0).abs() < 1e-12);
            assert!((m.skewness - 0.656_25).abs() < 1e-12 && (m.excess_kurtosis + 0.218_75).abs() < 1e-12);
            assert!((m.quantiles[2] - 4.0).abs() < 1e-12 && (m.quantiles[4] - 6.0).abs() < 1e-12, "{m:?}");
            assert_eq!((m.minimum, m.maximum), (2.0, 9.0));
        }
        for shares in [&d.histogram.by_area, &d.histogram.by_vertex] {
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    /// A weight of n is n values.
    #[test]
    fn weights_are_repetitions() {
        let weighted = Distribution::of("x", &[3.0, 1.0, 2.0], &[2.0, 1.0, 3.0]).unwrap().by_area;
        let repeated = Distribution::of("x", &[1.0, 2.0, 2.0, 2.0, 3.0, 3.0], &[1.0; 6]).unwrap().by_vertex;
        assert!((weighted.mean - repeated.mean).abs() < 1e-12);
        assert!((weighted.standard_deviation - repeated.standard_deviation).abs() < 1e-12);
        assert!((weighted.skewness - repeated.skewness).abs() < 1e-12);
        assert!((weighted.quantiles[3] - 2.0).abs() < 0.4);
    }

    #[test]
    fn a_constant_has_no_spread() {
        let d = Distribution::of("x", &[0.1; 5], &[0.3; 5]).unwrap();
        assert_eq!((d.by_area.skewness, d.by_area.excess_kurtosis), (0.0, 0.0));
        assert!((d.by_area.quantiles[0] - 0.1).abs() < 1e-12 && d.histogram.edges[0] < 0.1);
        assert!(Distribution::of("x", &[], &[]).is_none());
    }
}
