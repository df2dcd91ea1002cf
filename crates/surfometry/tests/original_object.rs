//! Numbers of the original object: the corrected embedding, its scale, and standard errors, against exact
//! shapes.

mod common;

use common::{measure, phantom, poses, rms};
use surfometry::Measurement;
use surfometry::measurement::{CurvatureScale, Derivatives, EmbeddingKind, SurfaceValues};
use surfometry::phantoms::{Ball, Capsule, Ellipsoid, Phantom, Pose, Torus};
use surfometry::validation::{CaseResult, Summary, Validation, summarise};

/// Rms and mean distance of a surface's vertices from the exact one, mm.
fn distances(phantom: &Phantom, measurement: &Measurement) -> [f64; 2] {
    let mask = phantom.labels().unwrap().mask(1);
    let surface = measurement.prepare(&mask).unwrap().surface();
    let apart: Vec<f64> =
        surface.mesh.vertices.iter().map(|v| phantom.surface_point(*v).unwrap().distance).collect();
    [rms(apart.iter().copied()), apart.iter().sum::<f64>() / apart.len() as f64]
}

/// The plain blur shrinks a ball by sigma^2 / R; the corrected one leaves it where it was, on a torus and an
/// ellipsoid to a tenth of that, on unequal spacings too.
#[test]
fn the_corrected_surface_stands_where_the_object_did() {
    let corrected = |sigma: f64| Measurement::default().embedding(EmbeddingKind::Corrected).sigma_mm(sigma);
    for spacing in [[1.0; 3], [0.8, 1.0, 1.3]] {
        let ball = phantom(Ball { radius: 15.0 }, poses()[0], spacing);
        let [_, plain] = distances(&ball, &Measurement::default().sigma_mm(3.0));
        let [_, mean] = distances(&ball, &corrected(3.0));
        println!("{spacing:?}: ball {plain:.3} -> {mean:.4} mm");
        assert!((plain + 9.0 / 15.0).abs() < 0.03, "{plain}");
        assert!(mean.abs() < 0.02, "{mean}");
        let ellipsoid = phantom(Ellipsoid { radii: [30.0, 20.0, 15.0] }, poses()[1], spacing);
        let torus = phantom(Torus { major: 24.0, minor: 9.0 }, poses()[2], spacing);
        for shape in [ellipsoid, torus] {
            let ([plain, _], [rms, _]) = (
                distances(&shape, &Measurement::default().sigma_mm(3.0)),
                distances(&shape, &corrected(3.0)),
            );
            println!("{spacing:?}: {plain:.3} -> {rms:.3} mm");
            assert!(plain > 0.4 && rms < 0.1, "{plain} {rms}");
        }
    }
}

/// Differences that are matched to the narrower blur are right for both: as convolution, to 1e-3 in A and M
/// and 0.005 in chi.
#[test]
fn the_corrected_field_is_differentiated_alike_in_both_ways() {
    for spacing in [[1.0; 3], [0.8, 1.0, 0.9]] {
        let torus = phantom(Torus { major: 20.0, minor: 8.0 }, poses()[0], spacing);
        let of = |derivatives| {
            let m =
                Measurement::default().embedding(EmbeddingKind::Corrected).sigma_mm(2.0).thickness_mm(2.5);
            measure(&torus, &m.derivatives(derivatives))
        };
        let (a, b) = (of(Derivatives::Gaussian), of(Derivatives::Matched));
        let apart = |a: Option<f64>, b: Option<f64>| (a.unwrap() / b.unwrap() - 1.0).abs();
        assert!(apart(a.blurred.volume_mm3, b.blurred.volume_mm3) < 1e-4);
        assert!(apart(a.blurred.surface_area_mm2, b.blurred.surface_area_mm2) < 1e-3);
        assert!(apart(a.blurred.total_mean_curvature_mm, b.blurred.total_mean_curvature_mm) < 1e-3);
        assert!(
            (a.blurred.euler_characteristic.unwrap() - b.blurred.euler_characteristic.unwrap()).abs() < 5e-3
        );
        // And it is the original object's: V, A and M of the torus, which the plain blur has 4, 2.5 and 0.3 %
        // too small.
        let exact = torus.truth().unwrap();
        let off = |v: Option<f64>, exact: f64| 100.0 * (v.unwrap() / exact - 1.0);
        let c = &b.values;
        let found = [
            off(c.volume_mm3, exact.volume),
            off(c.surface_area_mm2, exact.surface_area),
            off(c.total_mean_curvature_mm, exact.total_mean_curvature),
        ];
        println!("{spacing:?}: {found:.3?}");
        assert!(found.iter().all(|e| e.abs() < 0.5), "{found:?}");
    }
}

/// sigma follows h^(2/7) R^(5/7): twice as large a shape gets 1.64 times the blur, the same shape on half the
/// spacing 0.82 times.
#[test]
fn the_scale_follows_object_and_grid() {
    let scale = |size: f64, spacing: f64| {
        let shape = phantom(Ellipsoid { radii: [3.0, 2.0, 1.5].map(|r| r * size) }, poses()[1], [spacing; 3]);
        let mask = shape.labels().unwrap().mask(1);
        let object = Measurement::default().for_local_curvature(&mask, CurvatureScale::Object).unwrap();
        object.prepare(&mask).unwrap().parameters().sigma_mm.unwrap()
    };
    let base = scale(12.0, 1.0);
    assert!((scale(24.0, 1.0) / base / 2f64.powf(5.0 / 7.0) - 1.0).abs() < 0.06);
    assert!((scale(12.0, 0.5) / base / 0.5f64.powf(2.0 / 7.0) - 1.0).abs() < 0.06);
}

fn of_shapes<'a>(results: &'a [CaseResult], names: &'a [&str]) -> Vec<CaseResult> {
    results.iter().filter(|c| names.contains(&c.shape)).copied().collect()
}

/// Local curvature at automatic scale, on a shape that constants were tuned on and on two that they were not:
/// within 6 and 8 % at R = 10 voxels at 8 already, on tori a third of it, and falling with the order 0.67 to
/// 1.1 in h (0.9 is asked). Error bars hold on 85 to 100 % of the surface.
#[test]
fn local_curvature_converges() {
    let names = ["ellipsoid 3:2:1.5", "ellipsoid 4:3:2", "torus 2:1"];
    let results = Validation { shapes: names.map(str::to_owned).to_vec(), ..held_out() }.run(|| {}).unwrap();
    for name in names {
        let [coarse, fine]: [Summary; 2] = summarise(&of_shapes(&results, &[name])).try_into().unwrap();
        let order = |a: Option<f64>, b: Option<f64>| (a.unwrap() / b.unwrap()).log2();
        let orders = [
            order(coarse.mean_curvature, fine.mean_curvature),
            order(coarse.gaussian_curvature, fine.gaussian_curvature),
        ];
        println!(
            "{name}: H {:?} {:?}, K {:?} {:?}, orders {orders:.2?}, coverage {:?}",
            coarse.mean_curvature,
            fine.mean_curvature,
            coarse.gaussian_curvature,
            fine.gaussian_curvature,
            fine.local_coverage
        );
        let most = if name.starts_with("torus") { [2.0, 3.0] } else { [6.0, 8.0] };
        assert!(coarse.mean_curvature.unwrap() < most[0] && coarse.gaussian_curvature.unwrap() < most[1]);
        assert!(orders.iter().all(|&order| order > 0.6), "{orders:?}");
        assert!(fine.position_voxels.unwrap() < 0.08);
        assert!(fine.local_coverage.unwrap().iter().all(|&share| share > 85.0), "{:?}", fine.local_coverage);
    }
}

/// R = 8 and 16 voxels, in poses that nothing was tuned on.
fn held_out() -> Validation {
    Validation {
        resolutions: vec![8.0, 16.0],
        ratios: vec![1.0],
        poses: 2,
        first_pose: 40,
        ..Validation::default()
    }
}

/// Of the whole zoo, V, A and M lie within their error bars.
#[test]
fn integrals_keep_to_their_bars() {
    let results = Validation { local: false, ..held_out() }.run(|| {}).unwrap();
    let errors: Vec<f64> = results
        .iter()
        .filter_map(|c| c.standardised)
        .flat_map(|e| [e.volume, e.area, e.total_mean_curvature])
        .collect();
    let covered = errors.iter().filter(|z| z.abs() <= 1.96).count() as f64 / errors.len() as f64;
    let volumes = rms(results.iter().filter_map(|c| c.standardised).map(|e| e.volume));
    println!(
        "{} standardised errors, {:.1} % within 1.96; rms of V's {volumes:.2}",
        errors.len(),
        100.0 * covered
    );
    assert!(covered > 0.9, "{covered}");
    // Bars that are too wide are no help either.
    assert!((0.5..1.3).contains(&volumes), "{volumes}");
}

/// k1, k2 and the shape index within their bars, on shapes with and without umbilics; where curvature varies
/// errors reach them.
#[test]
fn principal_curvatures_keep_to_their_bars() {
    let shapes = |pose| {
        [
            phantom(Ellipsoid { radii: [30.0, 20.0, 15.0] }, pose, [1.0; 3]),
            phantom(Torus { major: 30.0, minor: 10.0 }, pose, [1.0, 0.9, 1.1]),
            phantom(Ball { radius: 20.0 }, pose, [1.0; 3]),
        ]
    };
    for (number, phantom) in poses().into_iter().flat_map(shapes).enumerate() {
        let mask = phantom.labels().unwrap().mask(1);
        let m = Measurement::default().for_local_curvature(&mask, CurvatureScale::Object).unwrap();
        let surface = m.prepare(&mask).unwrap().surface();
        let (mut within, mut total, mut standardised) = ([0.0; 3], 0.0, Vec::new());
        for (place, vertex) in surface.mesh.vertices.iter().zip(&surface.vertices).step_by(3) {
            let exact = phantom.surface_point(*place).unwrap().curvature;
            let errors = vertex.errors.unwrap();
            let k = |n: usize| vertex.curvature.principal()[n] - exact.principal()[n];
            let index = vertex.curvature.shape_index() - exact.shape_index();
            let bars = [errors.principal, errors.principal, errors.shape_index].map(f64::from);
            for (n, (error, bar)) in [k(0), k(1), index].into_iter().zip(bars).enumerate() {
                within[n] += f64::from(u8::from(error.abs() <= 1.96 * bar));
            }
            standardised.push(k(0) / bars[0]);
            total += 1.0;
        }
        let covered = within.map(|sum| 100.0 * sum / total);
        let spread = rms(standardised.into_iter());
        println!("{}: within {covered:.1?}, rms of k1's error over its bar {spread:.2}", number % 3);
        assert!(covered.iter().all(|&share| share > 90.0), "{covered:?}");
        // On tori and balls, whose curvature hardly varies, the scale is large and the bias far below what it
        // is taken for.
        assert!(spread > 0.3 || number % 3 != 0, "{spread}");
    }
}

/// The noise that is told is the spread over sub-voxel shifts: of V within a third, of an ellipsoid on cubic
/// and on unequal voxels.
#[test]
fn grid_noise_is_the_spread_over_shifts() {
    for spacing in [[1.0; 3], [0.6, 0.8, 1.2]] {
        let shapes: Vec<_> = (0..40)
            .map(|n| {
                let place = |step: f64| (f64::from(n) * step).fract() - 0.5;
                let shift = [place(0.819_17), place(0.671_04), place(0.549_7)];
                // One rotation: what differs is where the voxels fall.
                let pose = Pose::new([17.0, 31.0, 12.0], std::array::from_fn(|a| shift[a] * spacing[a]));
                measure(
                    &phantom(Ellipsoid { radii: [12.0, 10.0, 9.0] }, pose, spacing),
                    &Measurement::default(),
                )
            })
            .collect();
        let volumes: Vec<f64> = shapes.iter().filter_map(|m| m.blurred.volume_mm3).collect();
        let mean = volumes.iter().sum::<f64>() / volumes.len() as f64;
        let (spread, told) =
            (rms(volumes.iter().map(|v| v - mean)), shapes[0].blurred.grid_noise.volume_mm3.unwrap());
        println!("{spacing:?}: V {mean:.1}, spread {spread:.3}, told {told:.3}");
        assert!((spread / told - 1.0).abs() < 0.4, "{spread} {told}");
    }
}

/// The same object on a 1 mm grid, on a finer one and on thick slices: V, A and M of the original object
/// agree within the error bars of both.
#[test]
fn other_grids_agree_within_the_error_bars() {
    let grids = [[1.0; 3], [0.6; 3], [0.8, 0.8, 2.5], [2.5, 0.8, 0.8]];
    let mut worst: f64 = 0.0;
    for pose in poses() {
        let on = |shape: usize, spacing: [f64; 3]| match shape {
            0 => phantom(Ellipsoid { radii: [26.0, 21.0, 17.0] }, pose, spacing),
            1 => phantom(Torus { major: 30.0, minor: 13.0 }, pose, spacing),
            _ => phantom(Capsule { radius: 14.0, length: 30.0 }, pose, spacing),
        };
        for shape in 0..3 {
            let measured = grids.map(|spacing| measure(&on(shape, spacing), &Measurement::default()));
            for (n, a) in measured.iter().enumerate() {
                for b in &measured[n + 1..] {
                    let pairs = |v: &SurfaceValues| {
                        [v.volume_mm3, v.surface_area_mm2, v.total_mean_curvature_mm].map(Option::unwrap)
                    };
                    let values = pairs(&a.values).into_iter().zip(pairs(&b.values));
                    let errors = pairs(&a.standard_error).into_iter().zip(pairs(&b.standard_error));
                    for ((x, y), (ex, ey)) in values.zip(errors) {
                        worst = worst.max((x - y).abs() / ex.hypot(ey));
                    }
                }
            }
        }
    }
    println!("largest difference {worst:.2} standard errors");
    // 162 differences: 2.6 is what one in a hundred exceeds. Bars that nothing comes near would be too wide.
    assert!((1.0..2.6).contains(&worst), "{worst}");
}
