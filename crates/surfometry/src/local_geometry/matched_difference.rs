//! Derivatives of the blurred indicator by differences that are matched to the blur.

use super::band_voxels::GROUP as LANES;
use super::matched_band::{BandPass, padded_width};
use super::matched_weights::{MatchedWeights, NODES_BETWEEN, PointWeights, SIDE, Weights};
use super::{BandVoxels, Differentiation, Jet};
use crate::embedding::GaussianEmbedding;
use crate::tiling::{Block, IndexBox};
use crate::vectors;
use fearless_simd::{dispatch, f32x8, prelude::*};
use std::sync::Arc;

/// First and second derivatives at a voxel from four voxels on each side.
///
/// Equal to [`super::GaussianDerivatives`] up to 2e-4 in area and 0.001 in the Euler characteristic at sigma
/// = 1.75 voxels, 6e-5 and 3e-4 at 2 (`tests/matched_differences.rs`), for a third of the multiplications of
/// ten convolutions. Below 1.75 voxels the neighbours of a voxel no longer tell its derivatives, and above 8
/// the rounding of the field's f32 shows in them: use Gaussian derivatives there.
#[derive(Debug)]
pub struct MatchedDifferences<'a> {
    embedding: GaussianEmbedding<'a>,
    weights: Arc<MatchedWeights>,
}

/// The smallest and the largest sigma in voxels for which the differences are right.
const VALID: [f64; 2] = [1.75, 8.0];
/// Voxels around a tile that differences at its voxels and vertices need.
const REACH: i64 = SIDE as i64 + 1;

impl<'a> MatchedDifferences<'a> {
    /// Differences of an embedding.
    pub fn new(embedding: GaussianEmbedding<'a>) -> Self {
        let weights = MatchedWeights::new(embedding.sigma(), embedding.indicator().grid().spacing().mm());
        Self::with_weights(embedding, Arc::new(weights))
    }

    /// The same with weights that are known already: fitting them takes longer than measuring a small object.
    pub(crate) fn with_weights(embedding: GaussianEmbedding<'a>, weights: Arc<MatchedWeights>) -> Self {
        Self { embedding, weights }
    }

    /// Whether a blur of sigma is neither too narrow nor too wide for voxels of a spacing (a hair is allowed
    /// for spacings that went through f32).
    pub fn are_valid(sigma: f64, spacing: [f64; 3]) -> bool {
        let [low, high] = VALID;
        spacing.iter().all(|h| (low - 1e-3..=high + 1e-3).contains(&(sigma / h)))
    }
}

impl<'a> Differentiation for MatchedDifferences<'a> {
    type Field = GaussianEmbedding<'a>;

    fn embedding(&self) -> &Self::Field {
        &self.embedding
    }

    /// With whole groups of lanes along x, so that the last of a row can be loaded.
    fn field_region(&self, tile: &IndexBox) -> IndexBox {
        let mut region = tile.grown([REACH; 3]);
        let needed = padded_width(tile) + 2 * REACH as usize;
        region.upper[0] = region.lower[0] + needed.next_multiple_of(LANES) as i64;
        region
    }

    fn visit_band(
        &self,
        field: &Block<f32>,
        tile: &IndexBox,
        half_width: f64,
        visit: &mut dyn FnMut(&BandVoxels),
    ) {
        BandPass { field, weights: self.weights.central(), half_width }.visit(tile, visit);
    }

    fn jets_at(&self, field: &Block<f32>, points: &[[f64; 3]]) -> Vec<Jet> {
        let between = self.weights.between();
        dispatch!(vectors::level(), simd => point_jets(simd, field, between, points))
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

/// The products of three axes' weights with the field around a point: rows along x are added up by the orders
/// along y and z, then along x.
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
        // A vertex lies at a voxel along two axes, whose value is that voxel's alone: then a slice beside it
        // only adds to derivatives across slices, and a row beside it to those across rows.
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
