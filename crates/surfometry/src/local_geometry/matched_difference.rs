//! Derivatives of the blurred indicator by differences that are matched to the blur.

use super::band_voxels::GROUP as LANES;
use super::matched_weights::{CentralWeights, NODES_BETWEEN, PointWeights, SIDE, Weights};
use super::{BandVoxels, Differentiation, Jet};
use crate::embedding::GaussianEmbedding;
use crate::tiling::{Block, IndexBox};
use fearless_simd::{Level, dispatch, f32x8, prelude::*};
use std::sync::OnceLock;

/// First and second derivatives at a voxel from four voxels on each side.
///
/// Equal to [`super::GaussianDerivatives`] up to 2e-4 in area and 0.001 in the Euler characteristic at sigma = 1.75 voxels, 6e-5 and
/// 3e-4 at 2 (`tests/matched_differences.rs`), for a third of the multiplications of ten convolutions. Below 1.75 voxels the
/// neighbours of a voxel no longer tell its derivatives, and above 8 the rounding of the field's f32 shows in them: use Gaussian derivatives there.
#[derive(Debug)]
pub struct MatchedDifferences<'a> {
    embedding: GaussianEmbedding<'a>,
    weights: [CentralWeights; 3],
    between: OnceLock<[PointWeights; 3]>,
}

/// The smallest and the largest sigma in voxels for which the differences are right.
const VALID: [f64; 2] = [1.75, 8.0];
/// Voxels around a tile that differences at its voxels and vertices need.
const REACH: i64 = SIDE as i64 + 1;

impl<'a> MatchedDifferences<'a> {
    /// Differences of an embedding.
    pub fn new(embedding: GaussianEmbedding<'a>) -> Self {
        let weights = matched_weights(embedding.sigma(), embedding.mask().grid().spacing().mm());
        Self::with_weights(embedding, weights)
    }

    /// The same with weights that are known already: fitting them takes longer than measuring a small object.
    pub(crate) fn with_weights(embedding: GaussianEmbedding<'a>, weights: [CentralWeights; 3]) -> Self {
        Self { embedding, weights, between: OnceLock::new() }
    }

    /// Whether a blur of sigma is neither too narrow nor too wide for voxels of a spacing (a hair is allowed for spacings that went
    /// through f32).
    pub fn are_valid(sigma: f64, spacing: [f64; 3]) -> bool {
        let [low, high] = VALID;
        spacing.iter().all(|h| (low - 1e-3..=high + 1e-3).contains(&(sigma / h)))
    }
}

/// Weights along the three axes of a grid, for a blur of sigma.
pub(crate) fn matched_weights(sigma: f64, spacing: [f64; 3]) -> [CentralWeights; 3] {
    let mut weights = [CentralWeights::new(sigma, spacing[0]); 3];
    for axis in 1..3 {
        let same = spacing[axis] == spacing[axis - 1];
        weights[axis] = if same { weights[axis - 1] } else { CentralWeights::new(sigma, spacing[axis]) };
    }
    weights
}

impl<'a> Differentiation for MatchedDifferences<'a> {
    type Field = GaussianEmbedding<'a>;

    fn embedding(&self) -> &Self::Field {
        &self.embedding
    }

    /// With whole groups of lanes along x, so that the last of a row can be loaded.
    fn field_region(&self, tile: &IndexBox) -> IndexBox {
        let mut region = tile.grown([REACH; 3]);
        let lanes = LANES as i64;
        let needed = groups(tile) as i64 * lanes + 2 * REACH;
        region.upper[0] = region.lower[0] + (needed + lanes - 1) / lanes * lanes;
        region
    }

    fn visit_band(
        &self,
        field: &Block<f32>,
        tile: &IndexBox,
        half_width: f64,
        visit: &mut dyn FnMut(&BandVoxels),
    ) {
        let pass = BandPass { field, tile, weights: &self.weights, half_width };
        dispatch!(Level::new(), simd => pass.run(simd, visit));
    }

    fn jets_at(&self, field: &Block<f32>, points: &[[f64; 3]]) -> Vec<Jet> {
        let (sigma, spacing) = (self.embedding.sigma(), self.embedding.mask().grid().spacing().mm());
        let between = self.between.get_or_init(|| spacing.map(|h| PointWeights::new(sigma, h)));
        dispatch!(Level::new(), simd => point_jets(simd, field, between, points))
    }
}

#[inline(always)]
fn point_jets<S: Simd>(
    simd: S,
    field: &Block<f32>,
    between: &[PointWeights; 3],
    points: &[[f64; 3]],
) -> Vec<Jet> {
    let mut jets = Vec::with_capacity(points.len());
    for point in points {
        let axes = [between[0].at(point[0]), between[1].at(point[1]), between[2].at(point[2])];
        jets.push(point_jet(simd, field, &axes));
    }
    jets
}

/// The products of three axes' weights with the field around a point: rows along x are added up by the orders along y and z, then along
/// x.
#[inline(always)]
fn point_jet<S: Simd>(simd: S, field: &Block<f32>, axes: &[(i64, Weights<NODES_BETWEEN>); 3]) -> Jet {
    let [(x, wx), (y, wy), (z, wz)] = axes;
    let [nx, ny, _] = field.region().extent();
    let first = field.offset([*x, *y, *z]);
    let zero = [f32x8::splat(simd, 0.0); 2];
    // By the orders along y and z: 00, 10, 20, 01, 11, 02.
    let mut sums = [zero; 6];
    for k in 0..NODES_BETWEEN {
        let [w0, w1, w2] = [wz[0][k] as f32, wz[1][k] as f32, wz[2][k] as f32];
        // A vertex lies at a voxel along two axes, whose value is that voxel's alone: then a slice beside it only adds to derivatives across
        // slices, and a row beside it to those across rows.
        let beside = w0 == 0.0;
        if beside && w1 == 0.0 && w2 == 0.0 {
            continue;
        }
        let mut slice = [zero; 3];
        for j in 0..NODES_BETWEEN {
            let [v0, v1, v2] = [wy[0][j] as f32, wy[1][j] as f32, wy[2][j] as f32];
            if v0 == 0.0 && v1 == 0.0 && (beside || v2 == 0.0) {
                continue;
            }
            let row = x_row(simd, &field.values()[first + k * nx * ny + j * nx..]);
            if v0 != 0.0 {
                add(&mut slice[0], row, v0);
            }
            add(&mut slice[1], row, v1);
            if !beside {
                add(&mut slice[2], row, v2);
            }
        }
        if !beside {
            add(&mut sums[0], slice[0], w0);
            add(&mut sums[1], slice[1], w0);
            add(&mut sums[2], slice[2], w0);
        }
        add(&mut sums[3], slice[0], w1);
        add(&mut sums[4], slice[1], w1);
        add(&mut sums[5], slice[0], w2);
    }
    let sums = sums.map(|sum| sum.map(SimdBase::to_array));
    let along_x = |sum: usize, order: usize| {
        let [start, end] = &sums[sum];
        // The second eight overlap the first by six.
        let values = start.iter().chain(&end[2 * 8 - NODES_BETWEEN..]);
        values.zip(&wx[order]).map(|(&v, w)| f64::from(v) * w).sum::<f64>()
    };
    Jet {
        value: along_x(0, 0),
        gradient: [along_x(0, 1), along_x(1, 0), along_x(3, 0)],
        hessian: [along_x(0, 2), along_x(2, 0), along_x(5, 0), along_x(1, 1), along_x(3, 1), along_x(4, 0)],
    }
}

/// The nodes of a row, as its first and its last eight.
#[inline(always)]
fn x_row<S: Simd>(simd: S, row: &[f32]) -> [f32x8<S>; 2] {
    let row = &row[..NODES_BETWEEN];
    [f32x8::from_slice(simd, &row[..8]), f32x8::from_slice(simd, &row[NODES_BETWEEN - 8..])]
}

#[inline(always)]
fn add<S: Simd>(sum: &mut [f32x8<S>; 2], row: [f32x8<S>; 2], weight: f32) {
    sum[0] = row[0].mul_add_precise(weight, sum[0]);
    sum[1] = row[1].mul_add_precise(weight, sum[1]);
}

/// Groups of lanes that a tile's rows are made of.
fn groups(tile: &IndexBox) -> usize {
    tile.extent()[0].div_ceil(LANES)
}

/// Some groups of a row, a bit each.
type GroupSet = u64;

/// One walk over the slices of a tile.
struct BandPass<'a> {
    field: &'a Block<f32>,
    tile: &'a IndexBox,
    weights: &'a [CentralWeights; 3],
    half_width: f64,
}

/// First differences along x and y of the slices around the one in work, which mixed derivatives are first differences of.
struct Slopes {
    /// By slice modulo their number, then row (from the reach before the tile on), then x.
    along_x: Vec<f32>,
    along_y: Vec<f32>,
    row: usize,
    slice: usize,
}

/// Slices whose slopes are kept.
const KEPT: usize = 2 * SIDE + 1;

impl BandPass<'_> {
    #[inline(always)]
    fn run<S: Simd>(&self, simd: S, visit: &mut dyn FnMut(&BandVoxels)) {
        let [_, ny, nz] = self.tile.extent();
        let groups = groups(self.tile);
        assert!(groups <= GroupSet::BITS as usize, "a row of {groups} groups does not fit");
        let bits = self.band_bits(simd, groups);
        let mut rows: Vec<GroupSet> = vec![0; ny * nz];
        for (row, bits) in rows.iter_mut().zip(bits.chunks_exact(groups)) {
            for (group, bits) in bits.iter().enumerate() {
                *row |= GroupSet::from(*bits != 0) << group;
            }
        }
        let mut slopes = Slopes::new(groups * LANES, ny + 2 * SIDE);
        let mut voxels = BandVoxels::new();
        let side = SIDE as i64;
        for n in -side..nz as i64 + side {
            self.slopes_of_slice(simd, n, &rows, &mut slopes);
            let Ok(z) = usize::try_from(n - side) else { continue };
            for y in 0..ny {
                if rows[z * ny + y] != 0 {
                    let bits = &bits[(z * ny + y) * groups..][..groups];
                    self.row(simd, [y, z], (bits, &slopes), &mut voxels, visit);
                }
            }
        }
        voxels.flush(visit);
    }

    /// Position in the field of a voxel given from the tile's first.
    fn place(&self, [x, y, z]: [i64; 3]) -> usize {
        let [i, j, k] = self.tile.lower;
        self.field.offset([i + x, j + y, k + z])
    }

    /// Of each group of lanes, those with |phi| <= the half width.
    #[inline(always)]
    fn band_bits<S: Simd>(&self, simd: S, groups: usize) -> Vec<u8> {
        let [nx, ny, nz] = self.tile.extent();
        let half_width = f32x8::splat(simd, below(self.half_width));
        let mut bits = Vec::with_capacity(groups * ny * nz);
        for z in 0..nz {
            for y in 0..ny {
                let start = self.place([0, y as i64, z as i64]);
                for group in 0..groups {
                    let phi = lanes(simd, self.field.values(), start + group * LANES);
                    let set = phi.abs().simd_le(half_width).to_bitmask() as u8;
                    let left = nx - group * LANES;
                    bits.push(if left < LANES { set & ((1 << left) - 1) } else { set });
                }
            }
        }
        bits
    }

    /// Slopes of a slice, in the groups that a voxel of the band needs: those beside it in the slice, and before and behind.
    #[inline(always)]
    fn slopes_of_slice<S: Simd>(&self, simd: S, z: i64, band: &[GroupSet], slopes: &mut Slopes) {
        let [_, ny, nz] = self.tile.extent().map(|n| n as i64);
        let side = SIDE as i64;
        let within = |n: i64, end: i64| (n - side).max(0)..(n + side + 1).min(end);
        let stride = self.field.region().extent()[0];
        for y in -side..ny + side {
            let mut along_slices = 0;
            if (0..ny).contains(&y) {
                within(z, nz).for_each(|z| along_slices |= band[(z * ny + y) as usize]);
            }
            let mut needed = along_slices;
            if (0..nz).contains(&z) {
                within(y, ny).for_each(|y| needed |= band[(z * ny + y) as usize]);
            }
            let start = self.place([0, y, z]);
            let slot = slopes.place((y + side) as usize, z);
            while needed != 0 {
                let group = needed.trailing_zeros() as usize;
                needed &= needed - 1;
                let x = group * LANES;
                let along_x = self.first_difference(simd, 0, start + x, 1);
                along_x.store_slice(&mut slopes.along_x[slot + x..][..LANES]);
                if along_slices >> group & 1 == 1 {
                    let along_y = self.first_difference(simd, 1, start + x, stride);
                    along_y.store_slice(&mut slopes.along_y[slot + x..][..LANES]);
                }
            }
        }
    }

    #[inline(always)]
    fn first_difference<S: Simd>(&self, simd: S, axis: usize, start: usize, stride: usize) -> f32x8<S> {
        let pair = |n: usize| (start - n * stride, start + n * stride);
        antisymmetric(simd, self.field.values(), &self.weights[axis].first, pair)
    }

    /// First and second derivative along one axis.
    #[inline(always)]
    fn differences<S: Simd>(
        &self,
        simd: S,
        axis: usize,
        start: usize,
        stride: usize,
    ) -> (f32x8<S>, f32x8<S>) {
        let weights = &self.weights[axis];
        let values = self.field.values();
        let centre = lanes(simd, values, start);
        let (mut first, mut second) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 0.0));
        for n in 0..SIDE {
            let step = (n + 1) * stride;
            let (before, behind) = (lanes(simd, values, start - step), lanes(simd, values, start + step));
            first = (behind - before).mul_add_precise(weights.first[n], first);
            // Differences before sums: a constant has exactly no derivative.
            let bend = (behind - centre) + (before - centre);
            second = bend.mul_add_precise(weights.second[n], second);
        }
        (first, second)
    }

    /// The voxels of the band in one row.
    #[inline(always)]
    fn row<S: Simd>(
        &self,
        simd: S,
        [y, z]: [usize; 2],
        (bits, slopes): (&[u8], &Slopes),
        voxels: &mut BandVoxels,
        visit: &mut dyn FnMut(&BandVoxels),
    ) {
        let [nx, ny, _] = self.field.region().extent();
        let start = self.place([0, y as i64, z as i64]);
        for (group, &set) in bits.iter().enumerate().filter(|(_, set)| **set != 0) {
            let x = group * LANES;
            let (gx, xx) = self.differences(simd, 0, start + x, 1);
            let (gy, yy) = self.differences(simd, 1, start + x, nx);
            let (gz, zz) = self.differences(simd, 2, start + x, nx * ny);
            let slot = |row: usize, slice: i64| slopes.place(row, slice) + x;
            let (row, slice) = (y + SIDE, z as i64);
            let across_rows = |n: usize| (slot(row - n, slice), slot(row + n, slice));
            let across_slices = |n: usize| (slot(row, slice - n as i64), slot(row, slice + n as i64));
            let xy = antisymmetric(simd, &slopes.along_x, &self.weights[1].first, across_rows);
            let xz = antisymmetric(simd, &slopes.along_x, &self.weights[2].first, across_slices);
            let yz = antisymmetric(simd, &slopes.along_y, &self.weights[2].first, across_slices);
            let phi = lanes(simd, self.field.values(), start + x);
            let columns = [phi, gx, gy, gz, xx, yy, zz, xy, xz, yz].map(SimdBase::to_array);
            let [i, j, k] = self.tile.lower;
            let first = [i + x as i64, j + y as i64, k + z as i64];
            voxels.push_group(first, set, &columns, visit);
        }
    }
}

impl Slopes {
    fn new(row: usize, rows: usize) -> Self {
        let slice = row * rows;
        Self { along_x: vec![0.0; KEPT * slice], along_y: vec![0.0; KEPT * slice], row, slice }
    }

    /// Where the slopes of a row begin; rows count from the reach before the tile on, slices from the tile's first.
    fn place(&self, row: usize, slice: i64) -> usize {
        slice.rem_euclid(KEPT as i64) as usize * self.slice + row * self.row
    }
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, values: &[f32], start: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &values[start..][..LANES])
}

/// The sum of weights times differences of two groups of lanes, the nearest first.
#[inline(always)]
fn antisymmetric<S: Simd>(
    simd: S,
    values: &[f32],
    weights: &[f32; SIDE],
    pair: impl Fn(usize) -> (usize, usize),
) -> f32x8<S> {
    let mut sums = f32x8::splat(simd, 0.0);
    for n in 0..SIDE {
        let (before, behind) = pair(n + 1);
        let difference = lanes(simd, values, behind) - lanes(simd, values, before);
        sums = difference.mul_add_precise(weights[n], sums);
    }
    sums
}

/// The largest f32 that is not above a value: a comparison with it is one with the value.
fn below(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) > value { nearest.next_down() } else { nearest }
}
