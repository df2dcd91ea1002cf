//! Differences of a field in double precision, and their transpose.

use crate::local_geometry::{CentralWeights, Jet, MATCHED_SIDE, Stencil};

/// The most points that a difference along an axis takes.
const MOST: usize = 2 * MATCHED_SIDE + 1;

/// Weights of a first and a second derivative along an axis, at one place of it.
#[derive(Debug, Clone, Copy)]
struct Taps {
    /// Offset of the first weight from the voxel.
    start: isize,
    count: usize,
    /// 1/mm.
    first: [f64; MOST],
    /// 1/mm^2.
    second: [f64; MOST],
}

/// Differences along the three axes of a block, whose first voxel has index 0.
#[derive(Debug)]
pub(super) struct Differences {
    axes: [Vec<Taps>; 3],
    strides: [usize; 3],
}

/// Pairs of axes of a Hessian's mixed derivatives, in its order.
const MIXED: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

impl Differences {
    /// The paper's fourth-order differences, shifted at the ends of the block, which has at least six voxels
    /// along each axis.
    pub(super) fn of_fourth_order(extent: [usize; 3], spacing: [f64; 3]) -> Self {
        Self::new(extent, |axis, index| Taps::of_stencils(index, extent[axis], spacing[axis]))
    }

    /// Differences matched to a blur, at voxels that are at least [`MATCHED_SIDE`] from the ends of the block.
    pub(super) fn matched(extent: [usize; 3], weights: &[CentralWeights; 3]) -> Self {
        Self::new(extent, |axis, _| Taps::matched(&weights[axis]))
    }

    fn new(extent: [usize; 3], taps: impl Fn(usize, usize) -> Taps) -> Self {
        let axis = |a: usize| (0..extent[a]).map(|index| taps(a, index)).collect();
        Self { axes: [axis(0), axis(1), axis(2)], strides: [1, extent[0], extent[0] * extent[1]] }
    }

    /// Voxels along the slowest axis that a difference reaches on either side.
    pub(super) fn reach(&self) -> usize {
        let far = |taps: &Taps| {
            taps.start.unsigned_abs().max((taps.start + taps.count as isize - 1).unsigned_abs())
        };
        self.axes[2].iter().map(far).max().unwrap_or(0)
    }

    /// The field's jet at a voxel. Weights add up to 0, so values are taken less the voxel's own: a constant
    /// has exactly no derivative.
    pub(super) fn jet<T: Copy + Into<f64>>(&self, phi: &[T], index: [usize; 3]) -> Jet {
        let taps = self.taps(index);
        let at = self.offset(index);
        let centre: f64 = phi[at].into();
        let step = |axis: usize, k: usize| (taps[axis].start + k as isize) * self.strides[axis] as isize;
        let value = |offset: isize| phi[at.wrapping_add_signed(offset)].into() - centre;
        let along = |axis: usize, weights: &[f64; MOST]| {
            (0..taps[axis].count).map(|k| weights[k] * value(step(axis, k))).sum::<f64>()
        };
        let mixed = |[a, b]: [usize; 2]| {
            let row = |k: usize| {
                let beside = step(b, k);
                (0..taps[a].count).map(|l| taps[a].first[l] * value(step(a, l) + beside)).sum::<f64>()
            };
            let rows = (0..taps[b].count).filter(|&k| taps[b].first[k] != 0.0);
            rows.map(|k| taps[b].first[k] * row(k)).sum::<f64>()
        };
        let [xy, xz, yz] = MIXED.map(mixed);
        let second = |axis: usize| along(axis, &taps[axis].second);
        Jet {
            value: centre,
            gradient: std::array::from_fn(|axis| along(axis, &taps[axis].first)),
            hessian: [second(0), second(1), second(2), xy, xz, yz],
        }
    }

    /// Adds to a gradient what derivatives with respect to a voxel's jet are with respect to the field: the
    /// transpose of [`Differences::jet`]. `gradient` are the voxels of a block from number `first` on.
    pub(super) fn add_transposed(
        &self,
        adjoint: &Jet,
        index: [usize; 3],
        gradient: &mut [f64],
        first: usize,
    ) {
        let taps = self.taps(index);
        let at = self.offset(index) - first;
        let step = |axis: usize, k: usize| (taps[axis].start + k as isize) * self.strides[axis] as isize;
        let mut centre = adjoint.value;
        let mut add = |offset: isize, amount: f64| {
            gradient[at.wrapping_add_signed(offset)] += amount;
            centre -= amount;
        };
        for axis in 0..3 {
            for k in 0..taps[axis].count {
                let amount = taps[axis].first[k] * adjoint.gradient[axis]
                    + taps[axis].second[k] * adjoint.hessian[axis];
                add(step(axis, k), amount);
            }
        }
        for ([a, b], amount) in MIXED.into_iter().zip(&adjoint.hessian[3..]) {
            for k in (0..taps[b].count).filter(|&k| taps[b].first[k] != 0.0) {
                let (row, amount) = (step(b, k), taps[b].first[k] * amount);
                for l in 0..taps[a].count {
                    add(row + step(a, l), taps[a].first[l] * amount);
                }
            }
        }
        gradient[at] += centre;
    }

    fn taps(&self, index: [usize; 3]) -> [&Taps; 3] {
        std::array::from_fn(|axis| &self.axes[axis][index[axis]])
    }

    fn offset(&self, index: [usize; 3]) -> usize {
        (0..3).map(|axis| index[axis] * self.strides[axis]).sum()
    }
}

impl Taps {
    fn of_stencils(index: usize, length: usize, spacing: f64) -> Self {
        let (index, length) = (index as i64, length as i64);
        let (first, second) = (Stencil::first(index, 0, length), Stencil::second(index, 0, length));
        debug_assert_eq!(first.start, second.start);
        let used =
            |stencil: &Stencil| stencil.weights.iter().rposition(|w| *w != 0.0).map_or(0, |last| last + 1);
        let scaled = |stencil: &Stencil, scale: f64| {
            std::array::from_fn(|k| stencil.weights.get(k).map_or(0.0, |w| w / scale))
        };
        Self {
            start: first.start as isize,
            count: used(&first).max(used(&second)),
            first: scaled(&first, spacing),
            second: scaled(&second, spacing * spacing),
        }
    }

    fn matched(weights: &CentralWeights) -> Self {
        let mut taps =
            Self { start: -(MATCHED_SIDE as isize), count: MOST, first: [0.0; MOST], second: [0.0; MOST] };
        for n in 0..MATCHED_SIDE {
            let (first, second) = (f64::from(weights.first[n]), f64::from(weights.second[n]));
            let (before, behind) = (MATCHED_SIDE - 1 - n, MATCHED_SIDE + 1 + n);
            (taps.first[before], taps.first[behind]) = (-first, first);
            (taps.second[before], taps.second[behind]) = (second, second);
        }
        taps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local_geometry::MatchedWeights;

    fn fields() -> [Differences; 2] {
        let (extent, spacing) = ([9, 10, 11], [0.7, 1.0, 1.6]);
        [
            Differences::of_fourth_order(extent, spacing),
            Differences::matched(extent, MatchedWeights::new(3.0, spacing).central()),
        ]
    }

    /// <w, J phi> = <J' w, phi> for every jet's number, at ends, beside them and in the middle.
    #[test]
    fn the_transpose_is_the_transpose() {
        let phi: Vec<f64> = (0..990).map(|n| libm::sin(0.7 * f64::from(n)) + 1e-3 * f64::from(n)).collect();
        for (differences, indices) in
            fields().iter().zip([&[[0, 1, 10], [8, 9, 1], [4, 5, 5]][..], &[[4, 5, 6]]])
        {
            for &index in indices {
                let jet = differences.jet(&phi, index);
                let adjoint =
                    Jet { value: 0.3, gradient: [0.7, -1.1, 0.2], hessian: [0.9, -0.4, 0.5, 1.3, -0.8, 0.6] };
                let mut gradient = vec![0.0; phi.len()];
                differences.add_transposed(&adjoint, index, &mut gradient, 0);
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let by_jet = adjoint.value * jet.value
                    + dot(&adjoint.gradient, &jet.gradient)
                    + dot(&adjoint.hessian, &jet.hessian);
                assert!((by_jet - dot(&gradient, &phi)).abs() < 1e-12 * by_jet.abs().max(1.0), "{index:?}");
            }
        }
    }

    /// A parabola in turned axes, whose derivatives are known.
    #[test]
    fn parabolas_are_exact() {
        for (differences, index) in fields().iter().zip([[1, 9, 3], [4, 5, 5]]) {
            let value = |[x, y, z]: [f64; 3]| {
                0.5 * x * x - y * y + 0.3 * z * z + x * y - 0.7 * x * z + 0.2 * y * z + x - 2.0 * z
            };
            let place = |i: usize| [0.7 * (i % 9) as f64, (i / 9 % 10) as f64, 1.6 * (i / 90) as f64];
            let phi: Vec<f64> = (0..990).map(|i| value(place(i))).collect();
            let [x, y, z] = place(index[0] + 9 * index[1] + 90 * index[2]);
            let jet = differences.jet(&phi, index);
            let gradient = [x + y - 0.7 * z + 1.0, -2.0 * y + x + 0.2 * z, 0.6 * z - 0.7 * x + 0.2 * y - 2.0];
            let hessian = [1.0, -2.0, 0.6, 1.0, -0.7, 0.2];
            // Matched weights are kept in single precision, and values here go up to a hundred.
            assert!(
                jet.gradient.iter().zip(gradient).all(|(a, b)| (a - b).abs() < 1e-4),
                "{jet:?} {gradient:?}"
            );
            assert!(jet.hessian.iter().zip(hessian).all(|(a, b)| (a - b).abs() < 1e-4), "{jet:?}");
        }
    }
}
