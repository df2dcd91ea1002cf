//! What a correction of one voxel does at another.

use crate::embedding::EdgeProfile;
use crate::embedding::blur::half_taps;
use crate::embedding::kernel::GaussianKernel;

/// The kernel of the corrected embedding between voxels, of the very taps that blur amounts beside a mask's
/// bits.
#[derive(Debug)]
pub(super) struct PairKernel {
    /// By distance in voxels, x fastest.
    values: Vec<f64>,
    extent: [usize; 3],
}

impl PairKernel {
    pub(super) fn corrected(sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        let terms: Vec<(f64, [Vec<f32>; 3])> = EdgeProfile::corrected(sigma)
            .terms()
            .iter()
            .map(|&(weight, sigma)| {
                let taps = spacing.map(|h| half_taps(&GaussianKernel::new(sigma, h, 0, truncation)));
                (weight, taps)
            })
            .collect();
        let extent = std::array::from_fn(|a| terms.iter().map(|(_, taps)| taps[a].len()).max().unwrap_or(0));
        let mut values = Vec::with_capacity(extent.iter().product());
        for z in 0..extent[2] {
            for y in 0..extent[1] {
                for x in 0..extent[0] {
                    let value = |(weight, taps): &(f64, [Vec<f32>; 3])| {
                        let tap = |a: usize, n: usize| f64::from(taps[a].get(n).copied().unwrap_or(0.0));
                        weight * tap(0, x) * tap(1, y) * tap(2, z)
                    };
                    values.push(terms.iter().map(value).sum());
                }
            }
        }
        Self { values, extent }
    }

    /// At a distance within the reach.
    pub(super) fn at(&self, [x, y, z]: [usize; 3]) -> f64 {
        self.values[(z * self.extent[1] + y) * self.extent[0] + x]
    }

    /// At no distance, where it is highest.
    pub(super) fn peak(&self) -> f64 {
        self.values[0]
    }

    /// The farthest at which it matters to a solution, along each axis: beyond it is below a share of the
    /// peak.
    pub(super) fn reach_above(&self, share: f64) -> [i64; 3] {
        let axis = |a: usize| {
            let at = |n: usize| self.at(std::array::from_fn(|b| if a == b { n } else { 0 }));
            let near = (0..self.extent[a]).rev().find(|&n| at(n).abs() >= share * self.peak());
            near.unwrap_or(0) as i64
        };
        [axis(0), axis(1), axis(2)]
    }
}
