//! Fields that the user brings: exact distances, other slopes, and surfaces that leave the image.

mod common;

use common::codes;
use std::f64::consts::PI;
use surfometry::Measurement;
use surfometry::accuracy::FlagCode;
use surfometry::integrals::{QuadratureRule, Smearing};
use surfometry::measurement::{DescribedSurface, MeasureError, Measured, Padding};
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

/// A ball's distance, and the blur's profile of it, up to a plane that cuts the ball below its middle.
fn cut_ball(of_distance: impl Fn(f64) -> f64, h: [f64; 3], axis: usize) -> (FieldImage, [f64; 4]) {
    let (radius, height) = (15.0, 6.6);
    let dimensions: [usize; 3] = std::array::from_fn(|a| (42.0 / h[a]) as usize);
    // The cut lies on the outer face of the last voxel.
    let at = |a: usize| if a == axis { (dimensions[a] as f64 - 0.5) * h[a] - height } else { 20.3 };
    let centre: [f64; 3] = std::array::from_fn(at);
    let grid = Grid::axis_aligned(dimensions, h).unwrap();
    let distance = |p: [f64; 3]| (0..3).map(|a| (p[a] - centre[a]).powi(2)).sum::<f64>().sqrt() - radius;
    let field = sampled(grid, true, |p| of_distance(distance(p)));
    let rim_square = radius * radius - height * height;
    let zone = 2.0 * PI * radius * (radius + height);
    let volume = PI * (2.0 / 3.0 * radius.powi(3) + radius * radius * height - height.powi(3) / 3.0);
    // An edge that turns by an angle has half of it a length.
    let rim = 2.0 * PI * rim_square.sqrt() * 0.5 * (height / radius).acos();
    (field, [volume, zone + PI * rim_square, zone / radius + rim, 2.0])
}

fn offs(r: &Measured, [volume, area, mean_curvature, chi]: [f64; 4]) -> [f64; 4] {
    [
        relative(r.volume_mm3, volume),
        relative(r.surface_area_mm2, area),
        relative(r.total_mean_curvature_mm, mean_curvature),
        r.euler_characteristic.unwrap() - chi,
    ]
}

/// With padding a ball that the edge cuts is the closed spherical segment, on any axis, of a distance and of a
/// blur's profile in other units, whatever the constant.
#[test]
fn padding_closes_what_the_edge_cuts() {
    let blur = |d: f64| 7.0 * libm::erf(d / (2.0 * std::f64::consts::SQRT_2));
    for (axis, h) in [(0, [1.0; 3]), (1, [0.8, 1.0, 0.9]), (2, [0.9, 0.7, 1.1])] {
        let fields = [cut_ball(|d| d, h, axis), cut_ball(blur, h, axis)];
        for ((field, exact), constant) in fields.into_iter().zip([30.0, 7.0]) {
            let m = Measurement::default().thickness_mm(2.75);
            for padding in [Padding::Highest, Padding::Constant(constant)] {
                let r = m.padding(padding).run_field(&field).unwrap();
                let [volume, area, mean_curvature, chi] = offs(&r, exact);
                println!("axis {axis}: {volume:.4} {area:.4} {mean_curvature:.4} {chi:.3}");
                assert!(
                    volume.abs() < 0.005 && area.abs() < 0.005 && mean_curvature.abs() < 0.005,
                    "{volume} {area} {mean_curvature}"
                );
                assert!(chi.abs() < 0.04, "{chi}");
                assert_eq!(r.topology.euler_characteristic_mesh, Some(2));
                assert!(r.mesh.volume_mm3.is_some());
                let codes = codes(&r);
                assert!(
                    codes.contains(&"touches-border".to_owned())
                        && !codes.contains(&"surface-leaves-field".to_owned()),
                    "{codes:?}"
                );
            }
            // The open surface misses the cap, a tenth of a ball's area here.
            let [_, area, _, chi] = offs(&m.run_field(&field).unwrap(), exact);
            assert!(area < -0.1 && chi < -0.5, "{area} {chi}");
        }
    }
}

/// What lies inside its image is the same with padding and without, to what the shifted stencils differ by.
#[test]
fn padding_changes_nothing_of_what_is_not_cut() {
    let grid = Grid::axis_aligned([40; 3], [1.0; 3]).unwrap();
    let distance = |p: [f64; 3]| (p.iter().map(|v| (v - 19.3).powi(2)).sum::<f64>()).sqrt() - 14.0;
    let field = sampled(grid, true, distance);
    let m = Measurement::default();
    let [plain, padded] = [m, m.padding(Padding::Highest)].map(|m| m.run_field(&field).unwrap());
    assert_eq!(plain.values, padded.values);
    assert_eq!(padded.parameters.padding, Some(field_highest(&field)));
}

fn field_highest(field: &FieldImage) -> f64 {
    let values = (0..field.grid().voxel_count()).map(|offset| field.values().get(offset));
    values.fold(f64::NEG_INFINITY, f64::max)
}

/// What the pages say of balls that the edge cuts through their middle, at defaults: the rim's rounding takes A and M,
/// the cap along the voxels gives 4.7 % of its area, a third of a half ball's.
#[test]
fn the_rim_of_a_cap_costs_area_and_mean_curvature() {
    for (radius, [area, mean_curvature]) in [(12.0, [-0.018, -0.020]), (24.0, [-0.0014, -0.0093])] {
        let size = 2 * radius as usize + 10;
        let grid = Grid::axis_aligned([size, size, radius as usize + 8], [1.0; 3]).unwrap();
        let centre = [0.5 * size as f64 - 0.3, 0.5 * size as f64 - 0.2, -0.5];
        let distance = |p: [f64; 3]| (0..3).map(|a| (p[a] - centre[a]).powi(2)).sum::<f64>().sqrt() - radius;
        let field = sampled(grid, true, distance);
        let r = Measurement::default().padding(Padding::Highest).run_field(&field).unwrap();
        let exact_mean = 2.0 * PI * radius * (1.0 + 0.25 * PI);
        let found = offs(&r, [2.0 / 3.0 * PI * radius.powi(3), 3.0 * PI * radius * radius, exact_mean, 2.0]);
        println!("R {radius}: {found:.4?}");
        assert!(found[0].abs() < 0.002 && found[3].abs() < 0.04, "{found:?}");
        assert!((found[1] - area).abs() < 0.002, "{found:?}");
        assert!((found[2] - mean_curvature).abs() < 0.002, "{found:?}");
    }
}

/// A field of one sign has no surface, whatever is beyond its edge.
#[test]
fn a_field_of_one_sign_is_told_so() {
    let grid = Grid::axis_aligned([12, 14, 16], [1.0, 0.8, 1.1]).unwrap();
    for (sign, words) in
        [(-1.0, "no voxel of the field is positive"), (1.0, "no voxel of the field is negative")]
    {
        let field = sampled(grid, true, |p| sign * (1.0 + 0.01 * p[0] * p[0]));
        for padding in [None, Some(Padding::Highest), Some(Padding::Constant(3.0))] {
            for m in [Measurement::default(), Measurement::default().epsilon(0.5)] {
                let error = m.padding(padding).run_field(&field).unwrap_err().to_string();
                assert!(error.contains(words) && error.contains("phi < 0 as inside"), "{error}");
            }
        }
    }
}

/// Words are about the field: it was not blurred by this program.
#[test]
fn flags_of_a_field_blame_no_blur() {
    let (field, _) = cut_ball(|d| d, [1.0; 3], 2);
    for m in [Measurement::default(), Measurement::default().padding(Padding::Highest)] {
        for flag in m.run_field(&field).unwrap().flags.iter().filter(|f| f.code != FlagCode::NotComputed) {
            assert!(!flag.message.contains("blur"), "{}", flag.message);
        }
    }
}

/// A constant inside the band, and padding of what has background already.
#[test]
fn padding_that_makes_no_sense_is_refused() {
    let (field, _) = cut_ball(|d| d, [1.0; 3], 2);
    let m = Measurement::default().epsilon(1.5);
    for (value, words) in
        [(1.0, "above epsilon"), (-3.0, "positive and finite"), (f64::NAN, "positive and finite")]
    {
        let error = m.padding(Padding::Constant(value)).run_field(&field).unwrap_err().to_string();
        assert!(error.contains("padding") && error.contains(words), "{error}");
    }
    let mask = surfometry::volume::Mask::from_predicate(*field.grid(), |[x, _, _]| x > 20);
    let refused = Measurement::default().padding(Padding::Highest).run(mask);
    assert!(matches!(refused, Err(MeasureError::Conflict(_))));
}

/// The paper's padding with a constant alone: the band jumps over the cap, whose area is missing.
#[test]
fn a_constant_alone_leaves_the_cap_out() {
    let (field, exact) = cut_ball(|d| 7.0 * libm::erf(d / 2.8), [1.0; 3], 2);
    let [nx, ny, nz] = field.grid().dimensions();
    let grid = Grid::new([nx, ny, nz + 6], *field.grid().affine()).unwrap();
    let inner = |offset: usize| if offset < nx * ny * nz { field.values().get(offset) } else { 7.0 };
    let padded =
        FieldImage::new(grid, FieldValues::F64((0..grid.voxel_count()).map(inner).collect())).unwrap();
    let [_, area, _, chi] =
        offs(&Measurement::default().thickness_mm(2.5).run_field(&padded).unwrap(), exact);
    assert!((-0.21..-0.17).contains(&area) && chi < -0.15, "{area} {chi}");
}
