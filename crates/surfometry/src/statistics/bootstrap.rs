//! The bootstrap over pairs.

use super::{Estimate, Paired, normal_cdf, normal_quantile};
use rayon::prelude::*;

/// How a bootstrap is drawn; the same seed gives the same interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bootstrap {
    /// Samples drawn.
    pub samples: usize,
    /// Start of the random numbers.
    pub seed: u64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self { samples: 2000, seed: 1 }
    }
}

/// Pairs beyond which none is drawn: the jackknife takes time with their square, and means of so many are
/// normal.
const MOST_PAIRS: usize = 10_000;

/// A statistic with its bias-corrected and accelerated interval (BCa; Efron 1987): pairs are drawn with
/// replacement, the acceleration is the jackknife's.
///
/// `None` where the statistic is the same for nearly all samples, so that there is no interval; and of more
/// than 10,000 pairs.
pub fn bootstrap(
    pairs: &Paired,
    how: Bootstrap,
    statistic: impl Fn(&Paired) -> f64 + Sync,
) -> Option<Estimate> {
    let count = pairs.count();
    if count > MOST_PAIRS {
        return None;
    }
    let value = statistic(pairs);
    let mut random = Pcg::new(how.seed);
    let mut drawn: Vec<f64> = (0..how.samples)
        .filter_map(|_| {
            let places: Vec<usize> = (0..count).map(|_| random.below(count)).collect();
            pairs.chosen(&places)
        })
        .map(|sample| statistic(&sample))
        .filter(|v| v.is_finite())
        .collect();
    drawn.sort_by(f64::total_cmp);
    let below = drawn.iter().filter(|&&v| v < value).count() as f64 / drawn.len() as f64;
    if !(below > 0.0 && below < 1.0) {
        return None;
    }
    let left_out: Vec<f64> = (0..count)
        .into_par_iter()
        .filter_map(|place| pairs.without(place))
        .map(|sample| statistic(&sample))
        .filter(|v| v.is_finite())
        .collect();
    let mean = super::paired::mean(&left_out);
    let power = |n: i32| left_out.iter().map(|v| (mean - v).powi(n)).sum::<f64>();
    let square = power(2);
    let acceleration = if square > 0.0 { power(3) / (6.0 * square * square.sqrt()) } else { 0.0 };
    let shift = normal_quantile(below);
    let end = |probability: f64| {
        let z = shift + normal_quantile(probability);
        let place = normal_cdf(shift + z / (1.0 - acceleration * z));
        quantile(&drawn, place)
    };
    Some(Estimate { value, interval: [end(0.025), end(0.975)] })
}

/// Of sorted values, between the two that are next.
fn quantile(sorted: &[f64], probability: f64) -> f64 {
    let place = probability * (sorted.len() - 1) as f64;
    let (low, share) = (place.floor() as usize, place.fract());
    let high = (low + 1).min(sorted.len() - 1);
    sorted[low] + share * (sorted[high] - sorted[low])
}

/// PCG-XSH-RR (O'Neill 2014): a page's numbers must be the same for ever, which random number crates do not
/// promise of their default.
struct Pcg(u64);

impl Pcg {
    const STEP: u64 = 6_364_136_223_846_793_005;
    const STREAM: u64 = 1_442_695_040_888_963_407;

    fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_add(Self::STREAM));
        random.next();
        random
    }

    fn next(&mut self) -> u32 {
        let old = self.0;
        self.0 = old.wrapping_mul(Self::STEP).wrapping_add(Self::STREAM);
        let mixed = (((old >> 18) ^ old) >> 27) as u32;
        mixed.rotate_right((old >> 59) as u32)
    }

    /// A number below `end`, to a share of end / 2^32 evenly.
    fn below(&mut self, end: usize) -> usize {
        ((u64::from(self.next()) * end as u64) >> 32) as usize
    }
}
