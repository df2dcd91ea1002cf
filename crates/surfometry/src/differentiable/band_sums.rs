//! Sums over the band of a field that is held as a whole, and their derivatives by every voxel.

use super::differences::Differences;
use super::integrand::{IntegralValues, adjoint_jet};
use crate::integrals::Band;
use rayon::prelude::*;
use std::mem;

/// A field on a block, and how it is integrated.
pub(super) struct BandSums<'a, T> {
    /// x fastest.
    pub(super) phi: &'a [T],
    pub(super) extent: [usize; 3],
    pub(super) differences: &'a Differences,
    pub(super) band: &'a Band,
    /// Quadrature weights along x, y, z.
    pub(super) weights: [&'a [f64]; 3],
    /// mm^3.
    pub(super) cell_volume: f64,
}

impl<T: Copy + Into<f64> + Sync> BandSums<'_, T> {
    /// The integrals. Slices are summed on their own, then in their order: threads change no bit.
    pub(super) fn values(&self) -> IntegralValues {
        let slices: Vec<IntegralValues> =
            (0..self.extent[2]).into_par_iter().map(|z| self.of_slice(z)).collect();
        let mut total = IntegralValues::default();
        for slice in &slices {
            total.add(slice, self.cell_volume);
        }
        total
    }

    fn of_slice(&self, z: usize) -> IntegralValues {
        let half_width = self.band.delta().half_width();
        let mut sums = IntegralValues::default();
        for y in 0..self.extent[1] {
            let row = self.row(y, z);
            sums.volume += self.inside(row, half_width) * (self.weights[1][y] * self.weights[2][z]);
            for x in band_places(row, half_width) {
                let jet = self.differences.jet(self.phi, [x, y, z]);
                sums.add(&IntegralValues::of_voxel(&jet, self.band), self.weight([x, y, z]));
            }
        }
        sums
    }

    /// Derivatives of the weighted sum of the integrals by every voxel.
    ///
    /// A slab of slices changes its own and those within reach. Slabs are as thick as two reaches, so every
    /// other one can be done at the same time; each voxel is added to in one order.
    pub(super) fn gradient(&self, weights: &IntegralValues) -> Vec<f64> {
        let mut gradient = vec![0.0; self.phi.len()];
        let reach = self.differences.reach();
        let (plane, depth, thickness) = (self.extent[0] * self.extent[1], self.extent[2], 2 * reach);
        for parity in 0..2 {
            let (mut rest, mut done, mut pieces) = (&mut gradient[..], 0, Vec::new());
            for lower in (parity * thickness..depth).step_by(2 * thickness) {
                let upper = (lower + thickness).min(depth);
                let (first, last) = (lower.saturating_sub(reach), (upper + reach).min(depth));
                let tail = mem::take(&mut rest).split_at_mut((first - done) * plane).1;
                let (piece, tail) = tail.split_at_mut((last - first) * plane);
                pieces.push((lower..upper, piece, first * plane));
                (rest, done) = (tail, last);
            }
            pieces.into_par_iter().for_each(|(slices, piece, first)| {
                slices.for_each(|z| self.add_slice(z, weights, piece, first));
            });
        }
        gradient
    }

    fn add_slice(&self, z: usize, weights: &IntegralValues, gradient: &mut [f64], first: usize) {
        let half_width = self.band.delta().half_width();
        for y in 0..self.extent[1] {
            for x in band_places(self.row(y, z), half_width) {
                let index = [x, y, z];
                let mut weighted = IntegralValues::default();
                weighted.add(weights, self.weight(index) * self.cell_volume);
                let adjoint = adjoint_jet(&self.differences.jet(self.phi, index), self.band, &weighted);
                self.differences.add_transposed(&adjoint, index, gradient, first);
            }
        }
    }

    /// Weights along x of a row's voxels that lie deeper than the band.
    fn inside(&self, row: &[T], half_width: f64) -> f64 {
        let deep = |value: f64| if value < -half_width { 1.0 } else { 0.0 };
        row.iter().zip(self.weights[0]).map(|(&value, weight)| deep(value.into()) * weight).sum()
    }

    fn row(&self, y: usize, z: usize) -> &[T] {
        &self.phi[(z * self.extent[1] + y) * self.extent[0]..][..self.extent[0]]
    }

    fn weight(&self, [x, y, z]: [usize; 3]) -> f64 {
        self.weights[0][x] * (self.weights[1][y] * self.weights[2][z])
    }
}

/// Places of a row that lie in the band. Whether there is any is asked first, without a branch: most rows have none.
fn band_places<T: Copy + Into<f64>>(row: &[T], half_width: f64) -> impl Iterator<Item = usize> {
    let within = move |value: T| value.into().abs() <= half_width;
    let any = row.iter().fold(false, |any, &value| any | within(value));
    let row = if any { row } else { &[] };
    row.iter().enumerate().filter(move |(_, value)| within(**value)).map(|(x, _)| x)
}
