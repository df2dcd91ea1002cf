//! Geometry at every vertex at the scale that suits it.

use super::spread_mean::SpreadMean;
use super::{Surface, VertexGeometry};
use crate::Control;
use crate::accuracy::{
    CurvatureDifferences, CurvatureErrors, largest_agreeing, noise_factor, rms_spacing, scaled_errors,
    vertex_noise,
};
use crate::local_geometry::{Curvature, Jet};
use crate::space::{dot, minus};
use crate::tiling::TILE;
use crate::volume::Grid;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// An embedding of the object at one scale.
pub(crate) trait ScaledField: Sync {
    /// mm.
    fn sigma(&self) -> f64;

    /// |grad phi| at a flat edge, 1/mm.
    fn slope(&self) -> f64;

    /// Its derivatives at points near each other, which are fractional voxel indices.
    fn jets(&self, points: &[[f64; 3]]) -> Vec<Jet>;

    /// Those of the blur of the same sigma whose shift is not taken off.
    fn plain_jets(&self, points: &[[f64; 3]]) -> Vec<Jet>;
}

/// Edge of the lattice over which changes between scales are averaged, in sigma of the finer one.
const CHANGES_OVER: f64 = 2.5;
/// The same for what the plain blur differs by, in sigma.
const PLAIN_OVER: f64 = 1.7;
/// The same for the chosen scale, in rms spacings.
const SCALE_OVER: f64 = 3.0;
/// Slopes, in units of a flat edge's, that a surface has: others are of fields that have no surface here.
const SLOPES: [f64; 2] = [0.2, 5.0];
/// Furthest that a vertex is moved onto its scale's surface, in rms spacings.
const FURTHEST: f64 = 0.3;
/// What changes of more than this many times the noise count as: it is enough to tell that scales disagree.
const MOST_CHANGE: f64 = 12.0;

/// What one scale says at a vertex; `None` where its field has no surface there.
#[derive(Clone, Copy)]
struct Reading {
    /// phi over the slope of a flat edge, so that scales can be mixed: derivatives of a distance, nearly.
    jet: Jet,
    curvature: Curvature,
}

impl Reading {
    fn of(jet: &Jet, slope: f64, furthest: f64) -> Option<Self> {
        let jet = Jet {
            value: jet.value / slope,
            gradient: jet.gradient.map(|g| g / slope),
            hessian: jet.hessian.map(|h| h / slope),
        };
        Some(Self { curvature: at_zero_level(&jet, furthest)?, jet })
    }

    /// Between two scales.
    fn mixed(fine: &Self, coarse: &Self, share: f64, furthest: f64) -> Option<Self> {
        let mix = |a: f64, b: f64| (1.0 - share) * a + share * b;
        let (a, b) = (&fine.jet, &coarse.jet);
        let jet = Jet {
            value: mix(a.value, b.value),
            gradient: std::array::from_fn(|n| mix(a.gradient[n], b.gradient[n])),
            hessian: std::array::from_fn(|n| mix(a.hessian[n], b.hessian[n])),
        };
        Some(Self { curvature: at_zero_level(&jet, furthest)?, jet })
    }

    /// How far outward the zero level is, to first order.
    fn to_zero(jet: &Jet, furthest: f64) -> f64 {
        (-jet.value / jet.gradient_magnitude()).clamp(-furthest, furthest)
    }
}

/// Curvature of the zero level beside a point: that of the level through the point, carried over as between
/// parallel surfaces, k / (1 + d k).
fn at_zero_level(jet: &Jet, furthest: f64) -> Option<Curvature> {
    let [least, most] = SLOPES;
    let slope = jet.gradient_magnitude();
    if !(least..most).contains(&slope) {
        return None;
    }
    let curvature = Curvature::of(jet)?;
    let distance = Reading::to_zero(jet, furthest);
    let [k1, k2] = curvature.principal().map(|k| k / (1.0 + distance * k).max(0.5));
    Some(Curvature { mean_curvature: 0.5 * (k1 + k2), gaussian_curvature: k1 * k2 })
}

impl Surface {
    /// Gives every vertex the geometry and the place of the scale that suits it: the largest one whose
    /// curvature agrees with those of all smaller ones within their noise (Lepski 1991), both as local rms
    /// over a few sigma, its logarithm then averaged over a few voxels, and between two scales a mixture of
    /// both. Standard errors are of that scale's noise and of what changed from the next finer one.
    ///
    /// The same bits for any number of threads. Memory: 96 bytes a vertex and scale.
    pub(crate) fn at_local_scales(&mut self, scales: &[impl ScaledField], grid: &Grid, control: &Control) {
        let furthest = FURTHEST * rms_spacing(grid.spacing());
        let indices = indices(&self.mesh.vertices, grid);
        let tiles = by_tile(&indices);
        let points = Points { indices: &indices, tiles: &tiles, control };
        let readings: Vec<Vec<Option<Reading>>> = scales
            .iter()
            .map(|scale| {
                points.read(|points| scale.jets(points), |jet| Reading::of(jet, scale.slope(), furthest))
            })
            .collect();
        if control.is_stopped() || readings.len() < 2 {
            return;
        }
        let sigmas: Vec<f64> = scales.iter().map(ScaledField::sigma).collect();
        let along: Vec<f64> = self.vertices.iter().map(|v| grid.cosine_to_nearest_axis(v.normal)).collect();
        let areas = self.weights();
        let mut changes = Changes::between(&readings, &sigmas, (&self.mesh.vertices, &areas, &along), grid);
        let most = 1.0 / grid.spacing().smallest();
        for (scale, readings) in scales.iter().zip(&readings) {
            let plain = points.read(|points| scale.plain_jets(points), Curvature::of);
            let differences: Vec<[f64; 3]> =
                readings.iter().zip(plain).map(|(a, b)| bounded(a.map(|a| a.curvature), b, most)).collect();
            let mean = SpreadMean::new(&self.mesh.vertices, PLAIN_OVER * scale.sigma());
            changes.from_plain.push(mean.of(&differences, &areas));
        }
        let places = smoothed_places(&changes.chosen(&along), &self.mesh.vertices, &areas, grid);
        let axes = grid.axes();
        let apply = |(n, (vertex, position)): (usize, (&mut VertexGeometry, &mut [f64; 3]))| {
            let (lower, share) = (places[n].floor() as usize, places[n].fract());
            let upper = (lower + 1).min(scales.len() - 1);
            let both = readings[lower][n].zip(readings[upper][n]);
            let mixed = both.and_then(|(fine, coarse)| Reading::mixed(&fine, &coarse, share, furthest));
            let Some(Reading { jet, curvature }) = mixed else { return };
            let sigma = sigmas[lower] * libm::pow(sigmas[upper] / sigmas[lower], share);
            *vertex = VertexGeometry::of(&jet, curvature, None, &axes);
            let distance = Reading::to_zero(&jet, furthest);
            *position = std::array::from_fn(|a| position[a] + distance * vertex.normal[a]);
            let noise = changes.noise_factor * vertex_noise(sigma, grid.spacing(), along[n]);
            vertex.errors = Some(scaled_errors(&curvature, noise, changes.at(n, places[n])));
            vertex.curvature_sigma = Some(sigma as f32);
        };
        self.vertices.par_iter_mut().zip(&mut self.mesh.vertices).enumerate().for_each(apply);
        for vertex in &mut self.vertices {
            if vertex.errors.is_none() {
                vertex.errors = Some(CurvatureErrors::unknown(grid.spacing()));
                vertex.curvature_sigma = Some(sigmas[0] as f32);
            }
        }
    }
}

/// Fractional voxel indices of points of the world.
pub(super) fn indices(points: &[[f64; 3]], grid: &Grid) -> Vec<[f64; 3]> {
    let affine = grid.affine();
    let rows = affine.reciprocal();
    points.iter().map(|p| rows.map(|row| dot(row, minus(*p, affine.origin)))).collect()
}

/// Numbers of the points in each tile.
fn by_tile(indices: &[[f64; 3]]) -> Vec<Vec<usize>> {
    let mut tiles: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    for (number, index) in indices.iter().enumerate() {
        let tile = std::array::from_fn(|a| (index[2 - a].floor() as i64).div_euclid(TILE[2 - a]));
        tiles.entry(tile).or_default().push(number);
    }
    tiles.into_values().collect()
}

/// Squares of the differences of H, K, and of k1 and k2, none of them larger than what a voxel's size would
/// make; where one of them has no surface, as large.
fn bounded(a: Option<Curvature>, b: Option<Curvature>, most: f64) -> [f64; 3] {
    let most = [most.powi(2), most.powi(4), most.powi(2)];
    let Some((a, b)) = a.zip(b) else { return most };
    let squares = squares(&a, &b);
    std::array::from_fn(|n| squares[n].min(most[n]))
}

/// Vertices, tile by tile.
struct Points<'a> {
    indices: &'a [[f64; 3]],
    tiles: &'a [Vec<usize>],
    control: &'a Control,
}

impl Points<'_> {
    /// What a field says at all of them.
    fn read<T: Copy + Send>(
        &self,
        jets: impl Fn(&[[f64; 3]]) -> Vec<Jet> + Sync,
        reading: impl Fn(&Jet) -> Option<T> + Sync,
    ) -> Vec<Option<T>> {
        let of_tile = |numbers: &Vec<usize>| {
            if self.control.is_stopped() {
                return Vec::new();
            }
            let points: Vec<[f64; 3]> = numbers.iter().map(|&n| self.indices[n]).collect();
            jets(&points).iter().map(&reading).collect()
        };
        let parts: Vec<Vec<Option<T>>> = self.tiles.par_iter().map(of_tile).collect();
        let mut readings = vec![None; self.indices.len()];
        for (numbers, part) in self.tiles.iter().zip(parts) {
            for (&number, reading) in numbers.iter().zip(part) {
                readings[number] = reading;
            }
        }
        readings
    }
}

/// Most scales: from 1.5 to 8 rms spacings by factors of sqrt 2.
const MOST_SCALES: usize = 6;

/// What changes from scale to scale around each vertex.
struct Changes {
    scales: usize,
    /// By finer scale and vertex: mean squares of the changes to each scale, in units of its noise.
    to_coarser: Vec<Vec<[f64; MOST_SCALES]>>,
    /// By finer scale and vertex: mean squares of the changes of H, K, and of k1 and k2, to the next one.
    to_next: Vec<Vec<[f64; 3]>>,
    /// By scale and vertex: those of the differences from the plain blur.
    from_plain: Vec<Vec<[f64; 3]>>,
    noise_factor: f64,
}

impl Changes {
    fn between(
        readings: &[Vec<Option<Reading>>],
        sigmas: &[f64],
        (places, areas, along): (&[[f64; 3]], &[f64], &[f64]),
        grid: &Grid,
    ) -> Self {
        let scales = readings.len().min(MOST_SCALES);
        let of_scale = |fine: usize| {
            let mean = SpreadMean::new(places, CHANGES_OVER * sigmas[fine]);
            let noise = |n: usize| vertex_noise(sigmas[fine], grid.spacing(), along[n]);
            let to_coarser = |n: usize| {
                std::array::from_fn(|coarse| {
                    if coarse <= fine || coarse >= scales {
                        return 0.0;
                    }
                    let change = readings[fine][n].zip(readings[coarse][n]);
                    let change = change.map(|(a, b)| size(&a.curvature, &b.curvature) / noise(n));
                    change.map_or(MOST_CHANGE, |change| change.min(MOST_CHANGE)).powi(2)
                })
            };
            let to_next = |n: usize| {
                let change = readings[fine][n].zip(readings[fine + 1][n]);
                change.map_or([0.0; 3], |(a, b)| squares(&a.curvature, &b.curvature))
            };
            let numbers = 0..places.len();
            let coarser: Vec<[f64; MOST_SCALES]> = numbers.clone().map(to_coarser).collect();
            let next: Vec<[f64; 3]> = numbers.map(to_next).collect();
            (mean.of(&coarser, areas), mean.of(&next, areas))
        };
        let (to_coarser, to_next): (Vec<_>, Vec<_>) = (0..scales - 1).into_par_iter().map(of_scale).unzip();
        let finest = to_coarser.first().map_or(&[][..], |first: &Vec<_>| first.as_slice());
        let noise_factor = noise_factor(finest.iter().map(|squares| squares[1].sqrt()).collect());
        Self { scales, to_coarser, to_next, from_plain: Vec::new(), noise_factor }
    }

    /// The number of the scale that suits each vertex.
    fn chosen(&self, along: &[f64]) -> Vec<usize> {
        let chosen = |n: usize| {
            let change =
                |fine: usize, coarse: usize| self.to_coarser[fine][n][coarse].sqrt() / self.noise_factor;
            largest_agreeing(self.scales, change)
        };
        (0..along.len()).into_par_iter().map(chosen).collect()
    }

    /// Local rms changes of curvature from the next finer scale, or from the finest to the next, and from the
    /// plain blur, at a place between two scales.
    fn at(&self, vertex: usize, place: f64) -> [CurvatureDifferences; 2] {
        let (lower, share) = (place.floor() as usize, place.fract());
        let upper = (lower + 1).min(self.scales - 1);
        let step = |scale: usize| self.to_next[scale.saturating_sub(1)][vertex];
        let plain = |scale: usize| self.from_plain[scale][vertex];
        [[step(lower), step(upper)], [plain(lower), plain(upper)]].map(|[a, b]| {
            let [mean_curvature, gaussian_curvature, principal] =
                std::array::from_fn(|n| ((1.0 - share) * a[n] + share * b[n]).sqrt() as f32);
            CurvatureDifferences { mean_curvature, gaussian_curvature, principal }
        })
    }
}

/// Squares of the differences of H, of K, and the mean of those of k1 and k2.
fn squares(a: &Curvature, b: &Curvature) -> [f64; 3] {
    let ([a1, a2], [b1, b2]) = (a.principal(), b.principal());
    let principal = 0.5 * ((a1 - b1).powi(2) + (a2 - b2).powi(2));
    let gaussian = a.gaussian_curvature - b.gaussian_curvature;
    [(a.mean_curvature - b.mean_curvature).powi(2), gaussian * gaussian, principal]
}

/// How far two curvatures are apart, 1/mm, so that noise of H alone is what it is: a third each of the squares
/// of H, k1 and k2, whose noise is larger.
fn size(a: &Curvature, b: &Curvature) -> f64 {
    let [mean, _, principal] = squares(a, b);
    ((mean + principal) / 3.0).sqrt()
}

/// Scales by number, averaged over a few voxels, so that curvature does not jump where the choice does.
fn smoothed_places(chosen: &[usize], places: &[[f64; 3]], areas: &[f64], grid: &Grid) -> Vec<f64> {
    let values: Vec<[f64; 1]> = chosen.iter().map(|&scale| [scale as f64]).collect();
    let mean = SpreadMean::new(places, SCALE_OVER * rms_spacing(grid.spacing()));
    let means = mean.of(&values, areas);
    // What has no area has no mean.
    means
        .iter()
        .zip(areas)
        .zip(&values)
        .map(|((m, &area), own)| if area > 0.0 { m[0] } else { own[0] })
        .collect()
}
