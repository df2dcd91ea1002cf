//! Other volumes on a surface: values, correlation with curvature against quadrature, and whether intervals hold.

mod common;

use common::{phantom, poses};
use std::f64::consts::{PI, TAU};
use surfometry::Measurement;
use surfometry::phantoms::{Ball, Ellipsoid};
use surfometry::statistics::Places;
use surfometry::surface::{LocalQuantity, Mesh, SampleSummary, SampledVolume, Surface};
use surfometry::volume::{Affine, FieldImage, FieldValues, Grid, Samples, Slab, SlabReader, VolumeError};

/// A function of the world on a turned lattice around its origin.
fn volume(half: f64, spacing: [f64; 3], value: impl Fn([f64; 3]) -> f64) -> SampledVolume {
    let (sin, cos) = 0.6f64.sin_cos();
    let turned = [[cos, 0.0, sin], [0.0, -1.0, 0.0], [-sin, 0.0, cos]];
    let dimensions = spacing.map(|h| 2 * (half / h) as usize + 2);
    let mut affine = Affine::from_directions(turned, spacing, [0.0; 3]);
    affine.origin = affine.apply(dimensions.map(|n| 0.5 * n as f64 - 0.41)).map(|v| -v);
    let grid = Grid::new(dimensions, affine).unwrap();
    let voxel = |n: usize| value(affine.apply(grid.index_of(n).map(|i| i as f64)));
    let values = FieldValues::F64((0..grid.voxel_count()).map(voxel).collect());
    SampledVolume::new("stress", FieldImage::new(grid, values).unwrap()).unwrap()
}

const AXES: [f64; 3] = [18.0, 12.0, 9.0];

fn ellipsoid(spacing: [f64; 3]) -> Surface {
    let mask = phantom(Ellipsoid { radii: AXES }, poses()[1], spacing).labels().unwrap().mask(1);
    Measurement::default().prepare(mask).unwrap().surface()
}

/// Pearson's coefficient of H and a function over an ellipsoid, by quadrature over its parameters.
fn exact_correlation(value: impl Fn([f64; 3]) -> f64) -> f64 {
    let [a, b, c] = AXES;
    let mut sums = [0.0; 6];
    let steps = 400;
    for n in 0..steps {
        for m in 0..2 * steps {
            let theta = PI * (f64::from(n) + 0.5) / f64::from(steps);
            let ((sin, cos), (s, k)) =
                (theta.sin_cos(), (TAU * (f64::from(m) + 0.5) / f64::from(2 * steps)).sin_cos());
            let p = [a * sin * k, b * sin * s, c * cos];
            let q = (p[0] / (a * a)).powi(2) + (p[1] / (b * b)).powi(2) + (p[2] / (c * c)).powi(2);
            let squares = p.iter().map(|v| v * v).sum::<f64>();
            // H of an ellipsoid, positive where convex.
            let h = (a * a + b * b + c * c - squares) / (2.0 * (a * b * c).powi(2) * q.powf(1.5));
            let area = a * b * c * q.sqrt() * sin;
            let f = value(p);
            [1.0, h, f, h * h, f * f, h * f].iter().zip(&mut sums).for_each(|(v, sum)| *sum += area * v);
        }
    }
    let [w, h, f, hh, ff, hf] = sums;
    (hf / w - h * f / (w * w)) / ((hh / w - (h / w).powi(2)) * (ff / w - (f / w).powi(2))).sqrt()
}

/// A known function of position goes with mean curvature as quadrature says.
#[test]
fn a_known_volume_correlates_as_quadrature_says() {
    let pose = poses()[1];
    let functions: [fn([f64; 3]) -> f64; 3] =
        [|p| p[0] * p[0], |p| p[2].abs() - 0.3 * p[0] * p[0] / 18.0, |p| p[0] + 2.0 * p[1] * p[1]];
    for spacing in [[1.0; 3], [0.6, 0.9, 1.1]] {
        let mut surface = ellipsoid(spacing);
        for value in functions {
            let sampled = volume(24.0, [0.8, 0.7, 1.2], |p| value(pose.to_shape(p)));
            surface.samples = vec![sampled.on(&surface.mesh)];
            let summary = surface.samples[0].summary(&surface);
            assert_eq!((summary.name.as_str(), summary.vertices_outside), ("stress", 0));
            let found = &summary.correlations[0];
            let (pearson, exact) = (found.pearson.unwrap(), exact_correlation(value));
            println!(
                "{spacing:?}: r {:.3} {:?} exact {exact:.3}, n {:.1}",
                pearson.value, pearson.interval, pearson.effective_size
            );
            assert!((pearson.value - exact).abs() < 0.04, "{} for {exact}", pearson.value);
            assert!(pearson.interval[0] < exact && exact < pearson.interval[1], "{pearson:?} {exact}");
            let total: f64 = found.joint_histogram.by_area.iter().flatten().sum();
            assert!((total - 1.0).abs() < 1e-9, "{total}");
            assert!(surface.arrays().last().unwrap().name == "stress");
        }
        // What rises with curvature in whatever way has the same ranks.
        let curved = surface.values(LocalQuantity::MeanCurvature).unwrap();
        let cubes: Vec<f64> = curved.iter().map(|h| h.powi(3)).collect();
        let places = Places::new(&surface.mesh.vertices, &surface.mesh.vertex_areas()).unwrap();
        assert!((places.spearman(&curved, &cubes).unwrap().value - 1.0).abs() < 1e-12);
    }
}

/// Smooth volumes that know nothing of the shape: the interval holds 0 in 95 of 100 cases, and is no wider than it must be.
#[test]
fn intervals_hold_for_independent_volumes() {
    let surface = ellipsoid([1.5; 3]);
    let curved = surface.values(LocalQuantity::MeanCurvature).unwrap();
    let (vertices, areas) = (&surface.mesh.vertices, surface.mesh.vertex_areas());
    let places = Places::new(vertices, &areas).unwrap();
    let mut state = 7u64;
    let mut even = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for wavelength in [8.0, 16.0, 30.0] {
        let (cases, mut held, mut sizes, mut values) = (200, 0, Vec::new(), Vec::new());
        for _ in 0..cases {
            let waves: Vec<([f64; 3], f64)> = (0..30)
                .map(|_| {
                    let (z, turn) = (2.0 * even() - 1.0, TAU * even());
                    let r = (1.0 - z * z).sqrt();
                    let k = TAU / wavelength * (0.7 + 0.6 * even());
                    ([k * r * turn.cos(), k * r * turn.sin(), k * z], TAU * even())
                })
                .collect();
            let wave = |p: &[f64; 3]| -> f64 {
                waves.iter().map(|(k, phase)| ((0..3).map(|a| k[a] * p[a]).sum::<f64>() + phase).cos()).sum()
            };
            let random: Vec<f64> = vertices.iter().map(wave).collect();
            let found = places.pearson(&curved, &random).unwrap();
            held += usize::from(found.interval[0] <= 0.0 && 0.0 <= found.interval[1]);
            sizes.push(found.effective_size);
            values.push(found.value);
        }
        let share = held as f64 / f64::from(cases);
        let size = sizes.iter().sum::<f64>() / sizes.len() as f64;
        let spread = common::rms(values.into_iter());
        println!("wavelength {wavelength}: held {share:.3}, effective size {size:.1}, spread {spread:.3}");
        assert!(share >= 0.92, "{wavelength}: {share}");
        // The interval of so many independent pairs is as wide as coefficients scatter, to a half.
        assert!(spread * size.sqrt() < 1.5 && spread * size.sqrt() > 0.5, "{wavelength}: {spread} {size}");
    }
}

/// Waves along one direction, whose covariance turns over where that of curvature does not: no interval is one of as many pairs as
/// there are patches.
#[test]
fn intervals_hold_for_plane_waves() {
    let surface = ellipsoid([1.0; 3]);
    let vertices = &surface.mesh.vertices;
    let places = Places::new(vertices, &surface.mesh.vertex_areas()).unwrap();
    for quantity in [LocalQuantity::MeanCurvature, LocalQuantity::GaussianCurvature] {
        let curved = surface.values(quantity).unwrap();
        let (mut held, mut cases, mut most) = (0, 0, 0.0_f64);
        for n in 0..20 {
            for m in 0..10 {
                let (z, turn) = (1.0 - (f64::from(n) + 0.5) / 10.0, 2.4 * f64::from(n + 7 * m));
                let k = TAU / (7.0 + 3.0 * f64::from(m));
                let r = k * (1.0 - z * z).sqrt();
                let wave = |p: &[f64; 3]| {
                    (r * turn.cos() * p[0] + r * turn.sin() * p[1] + k * z * p[2] + turn).cos()
                };
                let found = places.pearson(&curved, &vertices.iter().map(wave).collect::<Vec<_>>()).unwrap();
                held += u32::from(found.interval[0] <= 0.0 && 0.0 <= found.interval[1]);
                most = most.max(found.effective_size);
                cases += 1;
            }
        }
        println!("{quantity:?}: held {held} of {cases}, largest effective size {most:.0}");
        assert!(most < 600.0, "{most}");
        assert!(f64::from(held) >= 0.9 * f64::from(cases), "{quantity:?}: {held} of {cases}");
    }
}

/// Beyond a volume there is no value; vertices there are left out of statistics and counted.
#[test]
fn outside_a_volume() {
    let mask = phantom(Ball { radius: 10.0 }, poses()[0], [1.0; 3]).labels().unwrap().mask(1);
    let mut surface = Measurement::default().prepare(mask).unwrap().surface();
    let small = volume(7.0, [1.0; 3], |p| p[2]);
    surface.samples = vec![small.on(&surface.mesh)];
    let sample = &surface.samples[0];
    let outside = sample.values.iter().filter(|v| v.is_nan()).count() as u64;
    assert!(outside > 0 && sample.values.iter().all(|v| v.is_nan() || v.abs() < 10.0));
    let summary = sample.summary(&surface);
    assert_eq!(summary.vertices_outside, outside);
    assert!((0.1..0.9).contains(&summary.share_outside), "{}", summary.share_outside);
    // What is left is even in z, but for where the volume's lattice ends.
    assert!(summary.mean.unwrap().abs() < 1.0 && !summary.is_constant());
    let far = volume(7.0, [1.0; 3], |p| p[2]).on(&Mesh {
        vertices: surface.mesh.vertices.iter().map(|v| v.map(|c| c + 100.0)).collect(),
        triangles: Vec::new(),
    });
    assert!(far.values.iter().all(|v| v.is_nan()));
    let nothing = far.summary(&surface);
    assert_eq!((nothing.mean, nothing.share_outside, nothing.correlations.len()), (None, 1.0, 0));
    let point = volume(7.0, [0.5; 3], |p| 3.0 * p[0] - p[1] + 0.5 * p[2]).at([1.234, -2.3, 0.77]);
    assert!((point - (3.0 * 1.234 + 2.3 + 0.385)).abs() < 1e-9, "{point:?}");
}

/// Voxels that are not a number have no value: vertices beside them neither, and all others theirs. Infinite ones are refused.
#[test]
fn voxels_without_a_value() {
    let mut surface = ellipsoid([1.0; 3]);
    let grid = Grid::new([60; 3], Affine { origin: [-30.0; 3], ..Affine::diagonal([1.0; 3]) }).unwrap();
    let read = |value: &dyn Fn([f64; 3]) -> f32| {
        let voxel = |n: usize| value(grid.affine().apply(grid.index_of(n).map(|i| i as f64)));
        let samples = Samples::F32((0..grid.voxel_count()).map(voxel).collect());
        SampledVolume::from_slabs("stress", &mut OneSlab { grid, samples: Some(samples) })
    };
    let gap = |p: [f64; 3]| if p[0] > 3.0 { f32::NAN } else { (2.0 * p[1]) as f32 };
    surface.samples = vec![read(&gap).unwrap().on(&surface.mesh)];
    for (place, value) in surface.mesh.vertices.iter().zip(&surface.samples[0].values) {
        // The last voxel with a value lies at 3.
        assert_eq!(value.is_nan(), place[0] > 3.0, "{place:?}: {value}");
        assert!(value.is_nan() || (value - 2.0 * place[1]).abs() < 1e-4);
    }
    let summary = surface.samples[0].summary(&surface);
    assert!(summary.share_outside > 0.1 && summary.correlations[0].pearson.unwrap().value.is_finite());
    let infinite = |p: [f64; 3]| if p == [0.0; 3] { f32::INFINITY } else { 1.0 };
    let index = [30; 3];
    let refused = read(&infinite).err();
    assert_eq!(refused, Some(VolumeError::InfiniteSample { index, value: f64::INFINITY }));
}

/// A volume that is the same everywhere, up to rounding, has neither correlation; a part that is the same is of one rank.
#[test]
fn rounding_is_no_correlation() {
    let mut surface = ellipsoid([1.0; 3]);
    surface.samples = vec![volume(24.0, [0.8, 0.7, 1.2], |_| 0.1).on(&surface.mesh)];
    let values = &surface.samples[0].values;
    assert!(values.iter().any(|v| *v != values[0]), "interpolation rounds");
    let summary = surface.samples[0].summary(&surface);
    assert!(summary.is_constant() && (summary.mean.unwrap() - 0.1).abs() < 1e-12);
    assert!(summary.correlations.iter().all(|c| c.pearson.is_none() && c.spearman.is_none()));
    let step = volume(24.0, [0.8, 0.7, 1.2], |p| if p[2] > 0.0 { 1.1 } else { 0.1 });
    let clean = |v: f64| (v * 1e6).round() / 1e6;
    let mut exact = step.on(&surface.mesh);
    let rounded = exact.summary(&surface);
    exact.values.iter_mut().for_each(|v| *v = clean(*v));
    let of = |summary: &SampleSummary| summary.correlations[0].spearman.unwrap().value;
    assert!((of(&rounded) - of(&exact.summary(&surface))).abs() < 1e-4);
}

/// A volume that comes in one piece.
struct OneSlab {
    grid: Grid,
    samples: Option<Samples>,
}

impl SlabReader for OneSlab {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        Ok(self.samples.take().map(|samples| Slab { slices: 0..self.grid.dimensions()[2], samples }))
    }
}
