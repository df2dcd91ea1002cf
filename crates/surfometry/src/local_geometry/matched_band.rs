//! Matched differences at the voxels of a band, eight neighbours along x together.

use super::BandVoxels;
use super::band_voxels::GROUP as LANES;
use super::matched_weights::{CentralWeights, SIDE};
use crate::embedding::Precision;
use crate::tiling::{Block, IndexBox};
use crate::vectors;
use fearless_simd::{dispatch, f32x8, prelude::*};

/// The band of a field, voxel after voxel.
pub(super) struct BandPass<'a> {
    pub(super) field: &'a Block<f32>,
    pub(super) weights: &'a [CentralWeights; 3],
    pub(super) half_width: f64,
}

/// Some voxels of a row: bit n stands for voxel n - `SIDE`, because those beside the tile's are wanted too.
type RowSet = u128;
/// Longest row: with those on both sides of it, it fits a set.
const LONGEST: usize = RowSet::BITS as usize - 2 * SIDE - LANES;
/// Most windows that cover a row, and the differences along it.
const MOST_WINDOWS: usize = RowSet::BITS as usize / LANES;
/// The voxels on both sides of one.
const NEIGHBOURS: usize = 2 * SIDE;

/// Voxels of a tile's row, whole windows of lanes.
pub(super) fn padded_width(tile: &IndexBox) -> usize {
    tile.extent()[0].next_multiple_of(LANES)
}

impl BandPass<'_> {
    pub(super) fn visit(&self, tile: &IndexBox, visit: &mut dyn FnMut(&BandVoxels)) {
        let mut part = *tile;
        while part.lower[0] < tile.upper[0] {
            part.upper[0] = tile.upper[0].min(part.lower[0] + LONGEST as i64);
            let mut slice = Slice::new(self, part);
            dispatch!(vectors::level(), simd => slice.walk(simd, visit));
            part.lower[0] = part.upper[0];
        }
    }
}

/// The slice in work of a tile.
struct Slice<'a> {
    pass: &'a BandPass<'a>,
    tile: IndexBox,
    /// Voxels of a row, those on both sides of it included.
    width: usize,
    /// The band in each row; rows count from `SIDE` before the tile's on.
    band: Vec<RowSet>,
    /// First differences along z, of which those along x and y are mixed second ones: row after row, where
    /// the band needs them.
    along_z: Vec<f32>,
    /// First differences of the row in work along y.
    along_y: Vec<f32>,
    numbers: Numbers,
    voxels: BandVoxels,
}

/// A jet's ten numbers, each in the windows of a row, and some room that may be read.
type Numbers = [[f32; (MOST_WINDOWS + 1) * LANES]; 10];

impl<'a> Slice<'a> {
    fn new(pass: &'a BandPass<'a>, tile: IndexBox) -> Self {
        let width = padded_width(&tile) + NEIGHBOURS;
        let rows = tile.extent()[1] + NEIGHBOURS;
        Self {
            pass,
            tile,
            width,
            band: vec![0; rows],
            along_z: vec![0.0; width * rows],
            along_y: vec![0.0; width],
            numbers: [[0.0; (MOST_WINDOWS + 1) * LANES]; 10],
            voxels: BandVoxels::new(),
        }
    }

    #[inline(always)]
    fn walk<S: Simd>(&mut self, simd: S, visit: &mut dyn FnMut(&BandVoxels)) {
        let [_, ny, _] = self.tile.extent();
        for z in self.tile.lower[2]..self.tile.upper[2] {
            if !self.find_band(simd, z) {
                continue;
            }
            self.differentiate_along_z(simd, z);
            for row in SIDE..SIDE + ny {
                if self.band[row] != 0 {
                    self.row(simd, row, z, visit);
                }
            }
        }
        self.voxels.flush(visit);
    }

    /// Where a row begins in the field: `SIDE` before the tile's first voxel.
    #[inline(always)]
    fn start(&self, row: usize, z: i64) -> usize {
        let [x, y, _] = self.tile.lower;
        let side = SIDE as i64;
        self.pass.field.offset([x - side, y - side + row as i64, z])
    }

    /// Sets the bits where |phi| <= the half width; whether there are any.
    #[inline(always)]
    fn find_band<S: Simd>(&mut self, simd: S, z: i64) -> bool {
        let [nx, ny, _] = self.tile.extent();
        let half_width = f32x8::splat(simd, f32::at_most(self.pass.half_width));
        let within: RowSet = ((1 << nx) - 1) << SIDE;
        let mut any = 0;
        for row in SIDE..SIDE + ny {
            let start = self.start(row, z) + SIDE;
            let values = &self.pass.field.values()[start..][..self.width - NEIGHBOURS];
            let mut groups = [0; MOST_WINDOWS];
            for (group, phi) in groups.iter_mut().zip(values.chunks_exact(LANES)) {
                *group = f32x8::from_slice(simd, phi).abs().simd_le(half_width).to_bitmask() as u8;
            }
            self.band[row] = RowSet::from_le_bytes(groups) << SIDE & within;
            any |= self.band[row];
        }
        any != 0
    }

    /// Where the band's mixed differences need them: beside it along x in its rows, and in the rows beside.
    #[inline(always)]
    fn differentiate_along_z<S: Simd>(&mut self, simd: S, z: i64) {
        let values = self.pass.field.values();
        let [nx, ny, _] = self.pass.field.region().extent();
        let weights = &self.pass.weights[2].first;
        for row in 0..self.band.len() {
            let beside = self.band[row.saturating_sub(SIDE)..self.band.len().min(row + SIDE + 1)].iter();
            let needed = grown(self.band[row]) | beside.fold(0, |all, set| all | set);
            if needed == 0 {
                continue;
            }
            let width = self.width;
            let rows = neighbours(values, self.start(row, z), nx * ny, width);
            let out = &mut self.along_z[row * width..][..width];
            for &at in Windows::new(needed, width).starts() {
                antisymmetric(simd, &rows, weights, at).store_slice(&mut out[at..at + LANES]);
            }
        }
    }

    /// Hands on the voxels of the band in one row.
    #[inline(always)]
    fn row<S: Simd>(&mut self, simd: S, row: usize, z: i64, visit: &mut dyn FnMut(&BandVoxels)) {
        let band = self.band[row];
        let width = self.width;
        let [x, y, z_weights] = self.pass.weights;
        let values = self.pass.field.values();
        let start = self.start(row, z);
        let [nx, ny, _] = self.pass.field.region().extent();
        let across_rows = neighbours(values, start, nx, width);
        let across_slices = neighbours(values, start, nx * ny, width);
        let along_y = &mut self.along_y[..width];
        for &at in Windows::new(grown(band), width).starts() {
            antisymmetric(simd, &across_rows, &y.first, at).store_slice(&mut along_y[at..at + LANES]);
        }
        let windows = Windows::new(band, width - SIDE);
        let starts = windows.starts();
        let centre = &values[start..][..width];
        let [phi, gx, gy, gz, xx, yy, zz, xy, xz, yz] = &mut self.numbers;
        let along_z = &self.along_z[row * width..][..width];
        values_and_slopes(simd, centre, &x.first, starts, [phi, gx]);
        values_and_slopes(simd, along_y, &x.first, starts, [gy, xy]);
        values_and_slopes(simd, along_z, &x.first, starts, [gz, xz]);
        let (inner, along_row) = within(centre);
        for (&at, xx) in starts.iter().zip(lanes_of(xx)) {
            symmetric(simd, inner, &along_row, &x.second, at - SIDE).store_slice(xx);
        }
        for (&at, yy) in starts.iter().zip(lanes_of(yy)) {
            symmetric(simd, centre, &across_rows, &y.second, at).store_slice(yy);
        }
        for (&at, zz) in starts.iter().zip(lanes_of(zz)) {
            symmetric(simd, centre, &across_slices, &z_weights.second, at).store_slice(zz);
        }
        let slopes = neighbours(&self.along_z, row * width, width, width);
        for (&at, yz) in starts.iter().zip(lanes_of(yz)) {
            antisymmetric(simd, &slopes, &y.first, at).store_slice(yz);
        }
        let [i, j, _] = self.tile.lower;
        for (window, &at) in starts.iter().enumerate() {
            let first = [i + at as i64 - SIDE as i64, j + (row - SIDE) as i64, z];
            self.voxels.push_window(first, windows.sets[window], &self.numbers, window * LANES, visit);
        }
    }
}

/// A set grown by the reach of a difference along the row.
fn grown(set: RowSet) -> RowSet {
    let twice = set | set << 1 | set >> 1;
    let thrice = twice | twice << 1 | twice >> 1;
    thrice | thrice << 2 | thrice >> 2
}

/// Windows of lanes that cover a set.
struct Windows {
    starts: [usize; MOST_WINDOWS],
    /// Which of a window's voxels belong to the set and to no earlier window.
    sets: [u8; MOST_WINDOWS],
    count: usize,
}

impl Windows {
    /// Each begins at the first voxel that is not covered yet, or so that it does not go beyond `end`.
    #[inline(always)]
    fn new(mut set: RowSet, end: usize) -> Self {
        let mut windows = Self { starts: [0; MOST_WINDOWS], sets: [0; MOST_WINDOWS], count: 0 };
        while set != 0 {
            let at = (set.trailing_zeros() as usize).min(end - LANES);
            let here = (set >> at) as u8;
            windows.starts[windows.count] = at;
            windows.sets[windows.count] = here;
            windows.count += 1;
            set &= !(RowSet::from(here) << at);
        }
        windows
    }

    #[inline(always)]
    fn starts(&self) -> &[usize] {
        &self.starts[..self.count]
    }
}

/// The rows at equal distances before and behind one, or with a stride of 1 the same row's values there: -1,
/// 1, -2, 2 and so on.
#[inline(always)]
fn neighbours(values: &[f32], start: usize, stride: usize, width: usize) -> [&[f32]; NEIGHBOURS] {
    let mut rows = [&values[..0]; NEIGHBOURS];
    for n in 0..SIDE {
        rows[2 * n] = &values[start - (n + 1) * stride..][..width];
        rows[2 * n + 1] = &values[start + (n + 1) * stride..][..width];
    }
    rows
}

fn lanes_of(numbers: &mut [f32]) -> std::slice::ChunksExactMut<'_, f32> {
    numbers.chunks_exact_mut(LANES)
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, row: &[f32], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &row[at..at + LANES])
}

/// The sum of weights times differences of rows, the nearest first.
#[inline(always)]
fn antisymmetric<S: Simd>(
    simd: S,
    rows: &[&[f32]; NEIGHBOURS],
    weights: &[f32; SIDE],
    at: usize,
) -> f32x8<S> {
    let mut sum = f32x8::splat(simd, 0.0);
    for n in 0..SIDE {
        let difference = lanes(simd, rows[2 * n + 1], at) - lanes(simd, rows[2 * n], at);
        sum = difference.mul_add_precise(weights[n], sum);
    }
    sum
}

/// The same of second differences. Differences before sums: a constant has exactly no derivative.
#[inline(always)]
fn symmetric<S: Simd>(
    simd: S,
    centre: &[f32],
    rows: &[&[f32]; NEIGHBOURS],
    weights: &[f32; SIDE],
    at: usize,
) -> f32x8<S> {
    let centre = lanes(simd, centre, at);
    let mut sum = f32x8::splat(simd, 0.0);
    for n in 0..SIDE {
        let (before, behind) = (lanes(simd, rows[2 * n], at), lanes(simd, rows[2 * n + 1], at));
        sum = ((behind - centre) + (before - centre)).mul_add_precise(weights[n], sum);
    }
    sum
}

/// A row without the `SIDE` values at its ends, and those beside each value of it.
#[inline(always)]
fn within(row: &[f32]) -> (&[f32], [&[f32]; NEIGHBOURS]) {
    let width = row.len() - NEIGHBOURS;
    (&row[SIDE..][..width], neighbours(row, SIDE, 1, width))
}

/// Windows of a row, and of its first differences along itself.
#[inline(always)]
fn values_and_slopes<S: Simd>(
    simd: S,
    row: &[f32],
    weights: &[f32; SIDE],
    starts: &[usize],
    [values, slopes]: [&mut [f32]; 2],
) {
    let (inner, along_row) = within(row);
    for ((&at, value), slope) in starts.iter().zip(lanes_of(values)).zip(lanes_of(slopes)) {
        let at = at - SIDE;
        value.copy_from_slice(&inner[at..at + LANES]);
        antisymmetric(simd, &along_row, weights, at).store_slice(slope);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every voxel of a set is in exactly one window, and no window goes beyond the end.
    #[test]
    fn windows_cover_a_set_once() {
        let mut state: u64 = 1;
        for round in 0..2000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let end = LANES + round % (LONGEST + NEIGHBOURS - LANES + 1);
            let sparse = RowSet::from(state >> (round % 40)) | RowSet::from(state) << 61;
            let set = sparse & ((1 << end) - 1);
            let windows = Windows::new(set, end);
            let mut covered = 0;
            for (at, here) in windows.starts().iter().zip(windows.sets) {
                let here = RowSet::from(here) << at;
                assert!(at + LANES <= end && covered & here == 0);
                covered |= here;
            }
            assert_eq!(covered, set);
        }
    }

    /// By the definition.
    #[test]
    fn a_set_grows_by_the_reach_of_a_difference() {
        let set: RowSet = 1 << 4 | 1 << 40 | 1 << 43 | 1 << 119;
        let near = |n: usize| (0..120).any(|m| set >> m & 1 == 1 && n.abs_diff(m) <= SIDE);
        assert!((0..RowSet::BITS as usize).all(|n| (grown(set) >> n & 1 == 1) == near(n)));
    }
}
