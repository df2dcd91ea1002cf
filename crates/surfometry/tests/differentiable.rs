//! Integrals with their derivatives: the numbers are the measurement's, the derivatives theirs, to rounding.

mod common;

use common::{phantom, poses};
use std::f64::consts::PI;
use surfometry::Measurement;
use surfometry::differentiable::{Differentiable, IntegralValues};
use surfometry::integrals::Smearing;
use surfometry::measurement::{Clip, Derivatives, EmbeddingKind, MeasureError, Measured, Padding};
use surfometry::phantoms::{Phantom, Torus};
use surfometry::volume::{FieldImage, FieldValues, Grid, ProbabilityImage, VolumeError};

const SPACING: [f64; 3] = [0.8, 1.1, 0.9];

fn given() -> Measurement {
    Measurement::default().embedding(EmbeddingKind::Given).thickness_mm(3.0)
}

fn soft() -> Measurement {
    Measurement::default().embedding(EmbeddingKind::Probability)
}

/// A turned torus off the grid.
fn torus(major: f64, minor: f64) -> Phantom {
    phantom(Torus { major, minor }, poses()[0], SPACING)
}

/// Its exact distance, mm, in single precision, that all measure the same numbers.
fn distance(torus: &Phantom, grid: &Grid) -> Vec<f64> {
    let place = |offset: usize| grid.affine().apply(grid.index_of(offset).map(|i| i as f64));
    let value = |offset| torus.shape().value(torus.pose().to_shape(place(offset)));
    (0..grid.voxel_count()).map(|offset| f64::from(value(offset) as f32)).collect()
}

/// A soft edge about twice as wide as a voxel's.
fn shares(torus: &Phantom, grid: &Grid) -> Vec<f64> {
    let share = |d: f64| f64::from((1.0 / (1.0 + libm::exp(d / 0.4))) as f32);
    distance(torus, grid).into_iter().map(share).collect()
}

/// A part of a phantom's grid, whose edge cuts it.
fn cut_grid(torus: &Phantom) -> Grid {
    let mut affine = *torus.grid().affine();
    affine.origin = affine.apply([9.0, 7.0, 6.0]);
    Grid::new(torus.grid().dimensions().map(|n| n - 10), affine).unwrap()
}

fn blurred(measured: &Measured) -> [f64; 5] {
    let v = &measured.blurred;
    [
        v.volume_mm3,
        v.surface_area_mm2,
        v.total_mean_curvature_mm,
        v.total_gaussian_curvature,
        v.total_squared_mean_curvature,
    ]
    .map(|value| value.expect("a surface"))
}

/// Relative to each number, and of the integral of K, which is 0 of a torus, to 4 pi.
fn assert_same(found: &IntegralValues, expected: [f64; 5], tolerance: f64) {
    for ((found, expected), name) in found.to_array().into_iter().zip(expected).zip(IntegralValues::NAMES) {
        let difference = (found - expected).abs() / expected.abs().max(4.0 * PI);
        assert!(difference < tolerance, "{name}: {found} {expected} ({difference:.1e})");
    }
}

#[test]
fn numbers_of_a_field_are_the_measurements() {
    let torus = torus(11.0, 4.5);
    for grid in [*torus.grid(), cut_grid(&torus)] {
        let phi = distance(&torus, &grid);
        let field = FieldImage::new(grid, FieldValues::F64(phi.clone())).unwrap();
        let band = Measurement::default().embedding(EmbeddingKind::Given).epsilon(1.4);
        for measurement in [band, band.delta(Smearing::Tanh), paper_band()] {
            let values = Differentiable::new(&measurement, grid).unwrap().values(&phi).unwrap();
            assert_same(&values, blurred(&measurement.run_field(&field).unwrap()), 1e-12);
        }
    }
}

fn paper_band() -> Measurement {
    Measurement::paper().embedding(EmbeddingKind::Given).thickness_mm(None).epsilon(1.4)
}

/// The measurement blurs in single precision.
#[test]
fn numbers_of_a_soft_segmentation_are_the_measurements() {
    let torus = torus(11.0, 4.5);
    for grid in [*torus.grid(), cut_grid(&torus)] {
        let p = shares(&torus, &grid);
        let image = ProbabilityImage::new(grid, p.iter().map(|&v| v as f32).collect()).unwrap();
        let finite = soft().derivatives(Derivatives::FiniteDifference);
        for measurement in [
            soft().sigma_mm(2.0),
            soft().sigma_mm(2.2).level(0.4).delta(Smearing::Tanh).thickness_mm(2.0),
            finite.sigma_mm(1.5),
            Measurement::paper().embedding(EmbeddingKind::Probability),
        ] {
            let values = Differentiable::new(&measurement, grid).unwrap().values(&p).unwrap();
            assert_same(&values, blurred(&measurement.run_probability(&image).unwrap()), 2e-5);
        }
    }
}

/// A blur of 10 voxels, for which the measurement takes Gaussian derivatives.
#[test]
fn a_wide_blur_is_differentiated_by_differences() {
    let ball = phantom(surfometry::phantoms::Ball { radius: 12.0 }, poses()[1], [0.5, 0.4, 0.5]);
    let mask = ball.labels().unwrap().mask(1);
    let voxels = (0..ball.grid().voxel_count()).map(|o| mask.get(ball.grid().index_of(o).map(|i| i as i64)));
    let p: Vec<f64> = voxels.map(|inside| f64::from(u8::from(inside))).collect();
    let image = ProbabilityImage::new(*ball.grid(), p.iter().map(|&v| v as f32).collect()).unwrap();
    // The measurement cuts kernels at 5 sigma, where derivatives are Gaussian; here, at 4.
    let wide = soft().sigma_mm(4.0).thickness_mm(3.0).truncation(5.0);
    let values = Differentiable::new(&wide, *ball.grid()).unwrap().values(&p).unwrap();
    assert_same(&values, blurred(&wide.run_probability(&image).unwrap()), 1e-4);
}

/// Deterministic numbers between -1 and 1.
fn noise(count: usize) -> Vec<f64> {
    (0..count).map(|n| libm::sin(12.9898 * n as f64) * 43.758).map(|v| 2.0 * (v - v.floor()) - 1.0).collect()
}

/// Along a direction that changes every voxel at random, and along single voxels inside the band; each integral
/// for itself, and relative to the derivative's size.
fn assert_is_derivative(integrals: &Differentiable, at: &[f64], step: f64) {
    let along = |direction: &[f64], length: f64| -> [f64; 5] {
        let moved: Vec<f64> = at.iter().zip(direction).map(|(v, d)| v + length * d).collect();
        integrals.values(&moved).unwrap().to_array()
    };
    // Of fourth order, so that the step can be large against rounding.
    let slopes = |direction: &[f64]| -> [f64; 5] {
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|n| along(direction, n * step));
        std::array::from_fn(|n| (a[n] - 8.0 * b[n] + 8.0 * c[n] - d[n]) / (12.0 * step))
    };
    let random = noise(at.len());
    let gradients: Vec<Vec<f64>> = (0..5)
        .map(|integral| {
            let mut weights = [0.0; 5];
            weights[integral] = 1.0;
            integrals.gradient(at, &IntegralValues::from_array(weights)).unwrap()
        })
        .collect();
    let check = |direction: &[f64], what: &str| {
        let expected = slopes(direction);
        for (integral, gradient) in gradients.iter().enumerate() {
            let found: f64 = gradient.iter().zip(direction).map(|(g, d)| g * d).sum();
            // Of a sum of random signs; of one voxel, the largest there is.
            let alone = direction.iter().filter(|d| **d != 0.0).count() == 1;
            let parts =
                gradient.iter().zip(direction).map(|(g, d)| if alone { g.abs() } else { (g * d).abs() });
            let size =
                if alone { parts.fold(0.0, f64::max) } else { parts.map(|v| v * v).sum::<f64>().sqrt() };
            let error = (found - expected[integral]).abs() / size;
            let name = IntegralValues::NAMES[integral];
            assert!(error < 1e-6, "{name} along {what}: {found} {} ({error:.1e})", expected[integral]);
        }
    };
    check(&random, "a random direction");
    // Where the bending energy changes most, and at a few other places.
    let order = |a: &usize, b: &usize| gradients[4][*a].abs().total_cmp(&gradients[4][*b].abs());
    let steepest = (0..at.len()).max_by(order).unwrap();
    let live: Vec<usize> =
        (0..at.len()).filter(|&n| gradients[4][n].abs() > 0.2 * gradients[4][steepest].abs()).collect();
    for &voxel in live.iter().step_by(live.len().div_ceil(4)).chain([&steepest]) {
        let mut direction = vec![0.0; at.len()];
        direction[voxel] = 1.0;
        check(&direction, &format!("voxel {voxel}"));
    }
}

#[test]
fn derivatives_by_a_field_are_exact() {
    let torus = torus(7.0, 3.1);
    for grid in [*torus.grid(), cut_grid(&torus)] {
        let phi = distance(&torus, &grid);
        for measurement in [given(), given().delta(Smearing::Tanh), paper_band()] {
            assert_is_derivative(&Differentiable::new(&measurement, grid).unwrap(), &phi, 2e-5);
        }
    }
}

#[test]
fn derivatives_by_a_soft_segmentation_are_exact() {
    let torus = torus(8.0, 3.6);
    for grid in [*torus.grid(), cut_grid(&torus)] {
        // Clear of 0 and 1, so that steps stay between them.
        let p: Vec<f64> = shares(&torus, &grid).into_iter().map(|v| 0.01 + 0.98 * v).collect();
        let finite = soft().derivatives(Derivatives::FiniteDifference);
        for measurement in [
            soft(),
            finite.sigma_mm(1.2).level(0.45),
            Measurement::paper().embedding(EmbeddingKind::Probability),
        ] {
            assert_is_derivative(&Differentiable::new(&measurement, grid).unwrap(), &p, 2e-5);
        }
    }
}

/// A distance raised by a constant is that of a parallel surface, and how integrals change from one to the next is
/// Steiner's: -A of V, -2 M of A, -int K of M, 0 of int K. Exact numbers of the torus.
#[test]
fn parallel_surfaces_change_as_steiner_says() {
    let (major, minor) = (20.0, 7.0);
    let torus = phantom(Torus { major, minor }, poses()[2], [0.7, 1.0, 0.9]);
    let phi = distance(&torus, torus.grid());
    let integrals = Differentiable::new(&given(), *torus.grid()).unwrap();
    let raised =
        |weights: IntegralValues| -> f64 { integrals.gradient(&phi, &weights).unwrap().iter().sum() };
    let none = IntegralValues::default();
    let (area, total_mean) = (4.0 * PI * PI * major * minor, 2.0 * PI * PI * major);
    let volume = raised(IntegralValues { volume: 1.0, ..none });
    assert!((volume / -area - 1.0).abs() < 1e-3, "{volume} {area}");
    let surface_area = raised(IntegralValues { surface_area: 1.0, ..none });
    assert!((surface_area / (-2.0 * total_mean) - 1.0).abs() < 5e-3, "{surface_area} {total_mean}");
    let mean = raised(IntegralValues { total_mean_curvature: 1.0, ..none });
    // int |K| is 8 pi: half of it outside, positive, half inside, negative.
    assert!(mean.abs() < 0.02 * 8.0 * PI, "{mean}");
    let gaussian = raised(IntegralValues { total_gaussian_curvature: 1.0, ..none });
    assert!(gaussian.abs() < 0.05, "{gaussian}");
    // int H^2 of a torus is pi^2 c^2 / sqrt(c^2 - 1), c = R / r.
    let bending = |minor: f64| {
        let c: f64 = major / minor;
        PI * PI * c * c / (c * c - 1.0).sqrt()
    };
    let expected = (bending(minor - 1e-3) - bending(minor + 1e-3)) / 2e-3;
    let found = raised(IntegralValues { total_squared_mean_curvature: 1.0, ..none });
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let torus = torus(8.0, 3.6);
    let p = shares(&torus, torus.grid());
    let phi = distance(&torus, torus.grid());
    let weights = IntegralValues::from_array([1.0, 0.5, -0.3, 0.2, 0.7]);
    let on = |threads: usize| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let of = |measurement: &Measurement, image: &[f64]| {
                let integrals = Differentiable::new(measurement, *torus.grid()).unwrap();
                let values = integrals.values(image).unwrap().to_array();
                let gradient = integrals.gradient(image, &weights).unwrap();
                values.into_iter().chain(gradient).map(f64::to_bits).collect::<Vec<_>>()
            };
            [of(&soft(), &p), of(&given(), &phi)].concat()
        })
    };
    let one = on(1);
    for threads in [2, 3, 5] {
        assert_eq!(one, on(threads), "{threads} threads");
    }
}

/// Without a surface there is nothing to change: V of all or nothing, and no slope.
#[test]
fn without_a_surface_all_is_flat() {
    let grid = Grid::axis_aligned([12, 11, 10], SPACING).unwrap();
    let weights = IntegralValues::from_array([1.0; 5]);
    for (measurement, value, volume) in
        [(given(), 9.0, 0.0), (given(), -9.0, 1320.0 * 0.8 * 1.1 * 0.9), (soft(), 0.1, 0.0)]
    {
        let integrals = Differentiable::new(&measurement, grid).unwrap();
        let image = vec![value; 1320];
        let values = integrals.values(&image).unwrap();
        assert!((values.volume - volume).abs() < 1e-9, "{values:?}");
        assert_eq!(values.to_array()[1..], [0.0; 4]);
        assert!(integrals.gradient(&image, &weights).unwrap().iter().all(|&v| v == 0.0));
    }
}

#[test]
fn what_has_no_derivative_is_refused() {
    let grid = Grid::axis_aligned([12, 11, 10], SPACING).unwrap();
    let message =
        |measurement: Measurement, grid| Differentiable::new(&measurement, grid).unwrap_err().to_string();
    assert!(message(Measurement::default(), grid).contains("soft segmentation"));
    assert!(message(given().padding(Padding::Highest), grid).contains("pad the image"));
    assert!(message(soft().clip(Clip::Exclude), grid).contains("pad the image"));
    assert!(message(soft().derivatives(Derivatives::Gaussian), grid).contains("leave derivatives out"));
    assert!(message(soft().sigma_mm(1.5), grid).contains("larger sigma"));
    assert!(message(soft().sigma_mm(-1.0), grid).contains("positive"));
    assert!(message(soft().sigma_mm(1e5), grid).contains("sigma"));
    assert!(message(soft().epsilon(0.6), grid).contains("too wide"));
    let thin = Grid::axis_aligned([12, 5, 10], SPACING).unwrap();
    assert!(matches!(
        Differentiable::new(&given(), thin),
        Err(MeasureError::FieldTooSmall { axis: 1, voxels: 5 })
    ));

    let mut image = vec![0.5f32; 1320];
    let fields = Differentiable::new(&given(), grid).unwrap();
    let shares = Differentiable::new(&soft(), grid).unwrap();
    let short = fields.values(&image[..1319]);
    assert!(matches!(
        short,
        Err(MeasureError::Volume(VolumeError::Incomplete { found: 1319, expected: 1320 }))
    ));
    image[13] = 1.5;
    assert!(fields.values(&image).is_ok());
    let (index, value) = ([1, 1, 0], 1.5);
    assert_eq!(shares.values(&image), Err(VolumeError::NotAProbability { index, value }.into()));
    image[13] = f32::NAN;
    assert!(matches!(fields.values(&image), Err(MeasureError::Volume(VolumeError::NotFinite { .. }))));
    let refused = shares.gradient(&image, &IntegralValues::default());
    assert!(matches!(refused, Err(MeasureError::Volume(VolumeError::NotAProbability { .. }))));
    image[13] = 1e31;
    assert!(matches!(fields.values(&image), Err(MeasureError::Volume(VolumeError::HugeValue { .. }))));
}
