//! Fields that the user brings: exact distances, other slopes, and surfaces that leave the image.

mod common;

use common::codes;
use std::f64::consts::PI;
use surfometry::Measurement;
use surfometry::integrals::{QuadratureRule, Smearing};
use surfometry::measurement::DescribedSurface;
use surfometry::phantoms::{Phantom, Pose, Torus};
use surfometry::volume::{FieldImage, FieldValues, Grid};

fn sampled(grid: Grid, double: bool, phi: impl Fn([f64; 3]) -> f64) -> FieldImage {
    let value = |offset| phi(grid.affine().apply(grid.index_of(offset).map(|i| i as f64)));
    let values = (0..grid.voxel_count()).map(value);
    let values = if double {
        FieldValues::F64(values.collect())
    } else {
        FieldValues::F32(values.map(|v| v as f32).collect())
    };
    FieldImage::new(grid, values).unwrap()
}

fn relative(value: Option<f64>, exact: f64) -> f64 {
    value.expect("a number") / exact - 1.0
}

/// A rotated torus's exact distance on an anisotropic grid, in both precisions and in other units of phi: a
/// thickness means mm whatever the field's slope.
#[test]
fn an_exact_distance_gives_exact_integrals() {
    let torus = Torus { major: 30.0, minor: 10.0 };
    let phantom =
        Phantom::new(torus, Pose::new([25.0, -40.0, 60.0], [0.3, 0.1, 0.2]), [0.8, 1.0, 0.9]).unwrap();
    let dimensions = phantom.grid().dimensions().map(|n| n + 12);
    let mut affine = *phantom.grid().affine();
    affine.origin = affine.apply([-6.0; 3]);
    let grid = Grid::new(dimensions, affine).unwrap();
    let truth = phantom.truth().unwrap();
    for (double, slope) in [(true, 1.0), (true, 1e-7), (false, 1.0), (false, 40.0)] {
        let field = sampled(grid, double, |p| slope * phantom.shape().value(phantom.pose().to_shape(p)));
        for m in [Measurement::default(), Measurement::default().delta(Smearing::Tanh)] {
            let r = m.thickness_mm(3.0).run_field(&field).unwrap();
            // A averages over parallel surfaces; int K of a torus is 0, so that changes nothing.
            assert!(
                relative(r.surface_area_mm2, truth.surface_area).abs() < 1e-3,
                "{:?}",
                r.surface_area_mm2
            );
            assert!(relative(r.total_mean_curvature_mm, truth.total_mean_curvature).abs() < 1e-3);
            // The Heaviside adds the band's variance, 0.0327 t^2, times M.
            let volume = truth.volume + 0.0327 * 9.0 * truth.total_mean_curvature;
            assert!(relative(r.volume_mm3, volume).abs() < 1e-3, "{:?} {volume}", r.volume_mm3);
            assert!(r.euler_characteristic.unwrap().abs() < 5e-3, "{:?}", r.euler_characteristic);
            assert_eq!((r.surface, r.values), (DescribedSurface::Given, r.blurred.values));
            assert!(r.standard_error.volume_mm3.is_none());
            assert_eq!(r.topology.euler_characteristic_voxels_26, 0);
            assert!((r.parameters.epsilon / (1.5 * slope) - 1.0).abs() < 0.01, "{}", r.parameters.epsilon);
        }
    }
}

/// eps in the field's units is the same as the thickness that it stands for.
#[test]
fn epsilon_and_thickness_agree() {
    let grid = Grid::axis_aligned([40, 40, 40], [1.0; 3]).unwrap();
    let distance = |p: [f64; 3]| (p.iter().map(|v| (v - 19.3).powi(2)).sum::<f64>()).sqrt() - 12.0;
    let field = sampled(grid, true, distance);
    let by_thickness = Measurement::default().thickness_mm(3.0).run_field(&field).unwrap();
    let by_epsilon = Measurement::default().epsilon(1.5).run_field(&field).unwrap();
    assert!((by_thickness.parameters.epsilon - 1.5).abs() < 1e-3);
    let change = relative(by_thickness.surface_area_mm2, by_epsilon.surface_area_mm2.unwrap());
    assert!(change.abs() < 1e-5, "{change}");
}

/// A ball cut in half by the edge of the field: shifted stencils see the open half sphere, on every side.
#[test]
fn a_surface_that_leaves_the_field_is_measured_up_to_the_edge() {
    let (radius, h) = (15.0, [0.8, 1.0, 0.7]);
    for axis in 0..3 {
        for at_upper in [false, true] {
            let dimensions: [usize; 3] =
                std::array::from_fn(|a| (if a == axis { 20.0 } else { 40.0 } / h[a]) as usize);
            let grid = Grid::axis_aligned(dimensions, h).unwrap();
            // The centre lies on the outer face of the last voxel, so that voxels cover exactly half of the
            // ball.
            let centre: [f64; 3] = std::array::from_fn(|a| match (a == axis, at_upper) {
                (true, false) => -0.5 * h[a],
                (true, true) => (dimensions[a] as f64 - 0.5) * h[a],
                _ => 19.7,
            });
            let distance =
                |p: [f64; 3]| (0..3).map(|a| (p[a] - centre[a]).powi(2)).sum::<f64>().sqrt() - radius;
            let field = sampled(grid, true, distance);
            let r = Measurement::default().thickness_mm(3.0).run_field(&field).unwrap();
            let variance = 0.0327 * 9.0;
            let area = 2.0 * PI * (radius * radius + variance);
            assert!(
                relative(r.surface_area_mm2, area).abs() < 2e-3,
                "axis {axis}: {:?} {area}",
                r.surface_area_mm2
            );
            assert!(relative(r.total_mean_curvature_mm, 2.0 * PI * radius).abs() < 2e-3);
            // Without the boundary term of Gauss and Bonnet: half of 4 pi.
            assert!((r.euler_characteristic.unwrap() - 1.0).abs() < 5e-3);
            assert!(codes(&r).contains(&"surface-leaves-field".to_owned()), "{:?}", codes(&r));
        }
    }
}

/// Simpson's rule over a bounded field, as the paper uses it: exact on smooth fields too, only noisier.
#[test]
fn simpson_over_a_field() {
    let grid = Grid::axis_aligned([41, 40, 43], [1.0; 3]).unwrap();
    let distance = |p: [f64; 3]| (p.iter().map(|v| (v - 19.3).powi(2)).sum::<f64>()).sqrt() - 12.0;
    let field = sampled(grid, true, distance);
    let r = Measurement::default()
        .thickness_mm(6.0)
        .quadrature(QuadratureRule::Simpson)
        .run_field(&field)
        .unwrap();
    let area = 4.0 * PI * (144.0 + 0.0327 * 36.0);
    assert!(relative(r.surface_area_mm2, area).abs() < 0.01, "{:?} {area}", r.surface_area_mm2);
}
