//! The blur in double precision, between any two boxes.

use crate::embedding::GaussianKernel;
use crate::tiling::IndexBox;
use crate::vectors;
use fearless_simd::dispatch;
use rayon::prelude::*;

/// Convolution with the sampled Gaussian, of values that are 0 beyond their box.
///
/// From one box to another it is a matrix, and the kernel is symmetric: from the other box back it is the
/// matrix's transpose. A box may be smaller or larger than the other.
#[derive(Debug)]
pub(super) struct TransposableBlur {
    /// Taps along x, y, z, from the centre outward.
    taps: [Vec<f64>; 3],
}

/// Rows of some slices, and whether each holds anything but zeros.
struct Slices {
    values: Vec<f64>,
    live: Vec<bool>,
}

impl TransposableBlur {
    /// A blur of sigma and spacing in the same unit, cut at `truncation` sigma.
    pub(super) fn new(sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        let outward = |axis: usize| {
            let kernel = GaussianKernel::new(sigma, spacing[axis], 0, truncation);
            kernel.taps()[kernel.radius()..].to_vec()
        };
        Self { taps: std::array::from_fn(outward) }
    }

    /// Voxels beyond an object of values up to 1 at which its blur may exceed a share, along each axis.
    pub(super) fn reach(&self, share: f64) -> [usize; 3] {
        let farthest = |taps: &Vec<f64>| {
            let exceeds = |&distance: &usize| taps[distance..].iter().sum::<f64>() > share;
            (1..taps.len()).rev().find(exceeds).unwrap_or(0)
        };
        std::array::from_fn(|axis| farthest(&self.taps[axis]))
    }

    /// The values of a box blurred, on another box.
    pub(super) fn apply<T: Copy + Into<f64> + Sync>(
        &self,
        values: &[T],
        from: &IndexBox,
        to: &IndexBox,
    ) -> Vec<f64> {
        self.along_z(&self.along_x_and_y(values, from, to), from, to)
    }

    fn along_x_and_y<T: Copy + Into<f64> + Sync>(
        &self,
        values: &[T],
        from: &IndexBox,
        to: &IndexBox,
    ) -> Slices {
        let ([nx, ny, nz], [width, height, _]) = (from.extent(), to.extent());
        let mut slices = Slices { values: vec![0.0; width * height * nz], live: vec![false; height * nz] };
        let out =
            slices.values.par_chunks_exact_mut(width * height).zip(slices.live.par_chunks_exact_mut(height));
        out.zip(values.par_chunks_exact(nx * ny)).for_each(|((plane, live), slice)| {
            dispatch!(vectors::level(), _simd => {
                let rows = self.along_x(slice, (nx, ny), from.lower[0], (width, to.lower[0]));
                for (number, (row, live)) in plane.chunks_exact_mut(width).zip(live).enumerate() {
                    let y = number as i64 + to.lower[1] - from.lower[1];
                    *live = convolve(row, &self.taps[1], |step| rows.row(width, y + step));
                }
            });
        });
        slices
    }

    /// The rows of a slice convolved along x.
    #[inline(always)]
    fn along_x<T: Copy + Into<f64>>(
        &self,
        slice: &[T],
        (nx, ny): (usize, usize),
        from: i64,
        (width, to): (usize, i64),
    ) -> Slices {
        let taps = &self.taps[0];
        let radius = taps.len() - 1;
        // The voxels that a row's values come from, zeros where there are none.
        let mut source = vec![0.0; width + 2 * radius];
        let first = to - radius as i64;
        let start = from.max(first);
        let end = (from + nx as i64).min(first + source.len() as i64);
        let mut rows = Slices { values: vec![0.0; width * ny], live: vec![false; ny] };
        for (y, out) in rows.values.chunks_exact_mut(width).enumerate() {
            if start >= end {
                continue;
            }
            let part = &slice[y * nx..][(start - from) as usize..(end - from) as usize];
            let place = &mut source[(start - first) as usize..][..part.len()];
            place.iter_mut().zip(part).for_each(|(to, &value)| *to = value.into());
            if place.iter().all(|&value| value == 0.0) {
                continue;
            }
            rows.live[y] =
                convolve(out, taps, |step| Some(&source[(radius as i64 + step) as usize..][..width]));
        }
        rows
    }

    fn along_z(&self, slices: &Slices, from: &IndexBox, to: &IndexBox) -> Vec<f64> {
        let [width, height, depth] = to.extent();
        let mut out = vec![0.0; width * height * depth];
        out.par_chunks_exact_mut(width * height).enumerate().for_each(|(number, plane)| {
            let z = number as i64 + to.lower[2] - from.lower[2];
            dispatch!(vectors::level(), _simd => {
                for (y, row) in plane.chunks_exact_mut(width).enumerate() {
                    // A slice that is not there has no number that is.
                    let number = |step: i64| (z + step) * height as i64 + y as i64;
                    convolve(row, &self.taps[2], |step| slices.row(width, number(step)));
                }
            });
        });
        out
    }
}

impl Slices {
    /// A row by its number; `None` where there is none, or nothing in it.
    #[inline(always)]
    fn row(&self, width: usize, number: i64) -> Option<&[f64]> {
        let number = usize::try_from(number).ok().filter(|&number| number < self.live.len())?;
        self.live[number].then(|| &self.values[number * width..][..width])
    }
}

/// Adds to zeros the rows at equal distances on both sides times their tap, the farthest first; whether there
/// was any.
#[inline(always)]
fn convolve<'a>(out: &mut [f64], taps: &[f64], row: impl Fn(i64) -> Option<&'a [f64]>) -> bool {
    let mut any = false;
    for (distance, &tap) in taps.iter().enumerate().skip(1).rev() {
        let distance = distance as i64;
        match (row(-distance), row(distance)) {
            (Some(before), Some(behind)) => add_both(out, tap, before, behind),
            (Some(one), None) | (None, Some(one)) => add(out, tap, one),
            (None, None) => continue,
        }
        any = true;
    }
    if let Some(centre) = row(0) {
        add(out, taps[0], centre);
        any = true;
    }
    any
}

#[inline(always)]
fn add(out: &mut [f64], tap: f64, row: &[f64]) {
    for (out, value) in out.iter_mut().zip(row) {
        *out += tap * value;
    }
}

#[inline(always)]
fn add_both(out: &mut [f64], tap: f64, before: &[f64], behind: &[f64]) {
    for ((out, before), behind) in out.iter_mut().zip(before).zip(behind) {
        *out += tap * (before + behind);
    }
}
