//! Objects and choices at the ends of what numbers can hold: a number, or a null under a flag; no panic, nothing that is not
//! finite, and nobody waits.

use std::time::{Duration, Instant};
use surfometry::Measurement;
use surfometry::measurement::{Clip, EmbeddingKind, MeasureError, Measured, SurfaceValues};
use surfometry::reference_methods::METHODS;
use surfometry::volume::{Grid, LabelImage, LabelSelection, Mask};

/// In an unoptimised build on a busy machine; one case takes some hundredths of a second.
const PATIENCE: Duration = Duration::from_secs(20);

/// Voxels that nobody would draw, by name.
fn masks(spacing: [f64; 3]) -> Vec<(&'static str, Mask)> {
    let grid = |size| Grid::axis_aligned(size, spacing).unwrap();
    let all = |size, inside: fn([usize; 3]) -> bool| Mask::from_predicate(grid(size), inside);
    vec![
        ("one voxel", all([9; 3], |index| index == [4; 3])),
        ("a corner", all([9; 3], |index| index == [8; 3])),
        ("an image of one voxel", all([1; 3], |_| true)),
        ("one slice", all([16, 14, 9], |[x, y, z]| z == 4 && (2..14).contains(&x) && (2..12).contains(&y))),
        ("one column", all([9, 9, 40], |[x, y, _]| x == 4 && y == 4)),
        ("all ones", all([14, 12, 10], |_| true)),
        ("all faces touched", all([16; 3], |index| index.iter().any(|&v| v == 7 || v == 8))),
        ("a checkerboard", all([14; 3], |[x, y, z]| (x + y + z) % 2 == 0)),
        ("stripes", all([16; 3], |[x, _, _]| x % 2 == 0)),
        ("all but one voxel", all([13; 3], |index| index != [6; 3])),
        ("two corners that touch", all([12; 3], |[x, y, z]| (x < 6) == (y < 6) && (x < 6) == (z < 6))),
        ("noise", all([18; 3], |[x, y, z]| (x * 7919 + y * 104_729 + z * 1_299_709) % 7 < 2)),
    ]
}

fn numbers(values: &SurfaceValues) -> [Option<f64>; 7] {
    [
        values.volume_mm3,
        values.surface_area_mm2,
        values.total_mean_curvature_mm,
        values.average_mean_curvature_per_mm,
        values.total_gaussian_curvature,
        values.euler_characteristic,
        values.total_squared_mean_curvature,
    ]
}

/// All numbers are finite, and where one of the object's own could not be had a flag says something.
fn check(name: &str, measured: &Measured) {
    let all =
        [&measured.values, &measured.standard_error, &measured.blurred.values, &measured.blurred.grid_noise];
    for value in all.into_iter().flat_map(numbers).flatten() {
        assert!(value.is_finite(), "{name}: {measured:?}");
    }
    let own = numbers(&measured.values);
    assert!(own[0].is_some_and(|volume| volume > 0.0) || !measured.flags.is_empty(), "{name}: {measured:?}");
    assert!(own[..6].iter().all(Option::is_some) || !measured.flags.is_empty(), "{name}: {measured:?}");
    let errors = numbers(&measured.standard_error).into_iter().flatten();
    assert!(errors.into_iter().all(|error| error >= 0.0), "{name}: {measured:?}");
    // What is counted is exact, whatever else is not.
    let counted = measured.voxels.count as f64 * measured.grid.spacing_mm.iter().product::<f64>();
    assert!((measured.voxels.volume_mm3 / counted - 1.0).abs() < 1e-3, "{name}");
    serde_json::to_string(measured).unwrap();
}

fn in_time(name: &str, work: impl FnOnce()) {
    let start = Instant::now();
    work();
    assert!(start.elapsed() < PATIENCE, "{name}: {:?}", start.elapsed());
}

/// Small images that are all surface: what corrections of them would take is known before they are begun.
#[test]
fn small_images_that_are_all_surface() {
    let grid = |n: usize| Grid::axis_aligned([n; 3], [1.0; 3]).unwrap();
    let mixed = |hash: u32, v: usize| (hash ^ v as u32).wrapping_mul(2_654_435_769).rotate_left(15);
    let hash = |index: [usize; 3]| index.into_iter().fold(7, mixed);
    let masks = [
        ("a checkerboard", Mask::from_predicate(grid(55), |index| index.iter().sum::<usize>() % 2 == 0)),
        ("diagonal stripes", Mask::from_predicate(grid(60), |index| index.iter().sum::<usize>() % 4 < 2)),
        ("noise", Mask::from_predicate(grid(60), |index| hash(index) % 2 == 0)),
        ("thin noise", Mask::from_predicate(grid(70), |index| hash(index) % 10 == 0)),
    ];
    for (name, mask) in masks {
        in_time(name, || check(name, &Measurement::default().run_settled(mask).unwrap()));
    }
}

/// Twelve masks at eight spacings from 1e-6 to 1e3 mm, as cubes and 50 times as long as wide, at every blur from 0.3 voxels
/// to the image's size, in each embedding of a mask.
#[test]
fn every_mask_at_every_scale() {
    let spacings = [
        [1.0; 3],
        [1e-6; 3],
        [1e3; 3],
        [0.02, 1.0, 1.0],
        [1.0, 1.0, 50.0],
        [1e-6, 2e-6, 5e-5],
        [0.3, 0.3, 6.0],
    ];
    for spacing in spacings {
        let unit = spacing.iter().product::<f64>().cbrt();
        for (what, mask) in masks(spacing) {
            for blur in [0.3, 1.0, 2.0, 16.0] {
                let name = format!("{what}, {spacing:?} mm, {blur} spacings");
                in_time(&name, || {
                    check(&name, &Measurement::default().sigma_mm(blur * unit).run(mask.clone()).unwrap());
                });
            }
            in_time(what, || check(what, &Measurement::default().run_settled(mask.clone()).unwrap()));
        }
    }
    for (what, mask) in masks([1.0, 0.7, 1.9]) {
        for kind in [
            EmbeddingKind::Corrected,
            EmbeddingKind::Recovering,
            EmbeddingKind::Distance,
            EmbeddingKind::DistanceToVoxels,
        ] {
            let name = format!("{what}, {kind:?}");
            in_time(&name, || {
                check(&name, &Measurement::default().embedding(kind).run(mask.clone()).unwrap());
            });
        }
        for measurement in [
            Measurement::paper(),
            Measurement::default().clip(Clip::Exclude),
            Measurement::default().level(0.05),
            Measurement::default().level(0.95),
            Measurement::default().thickness_mm(1e-3),
            Measurement::default().thickness_mm(1e3),
            Measurement::default().epsilon(1e-9),
        ] {
            let name = format!("{what}, {measurement:?}");
            in_time(&name, || match measurement.run(mask.clone()) {
                Ok(measured) => check(&name, &measured),
                // Refused in words, as what is cut where nothing is left.
                Err(error) => assert!(error.to_string().len() > 20, "{name}: {error}"),
            });
        }
    }
}

/// The classical methods on the same: finite, or nothing.
#[test]
fn classical_methods() {
    for spacing in [[1.0; 3], [1e-6; 3], [1.0, 1.0, 50.0]] {
        for (what, mask) in masks(spacing) {
            for method in METHODS {
                in_time(what, || {
                    let values = method.prepared(mask.grid().spacing())(&mask);
                    let numbers = [
                        values.volume_mm3,
                        values.surface_area_mm2,
                        values.total_mean_curvature_mm,
                        values.euler_characteristic,
                    ];
                    let finite = numbers.into_iter().flatten().all(f64::is_finite);
                    assert!(finite, "{what}, {}: {values:?}", method.name());
                });
            }
        }
    }
}

/// 70,000 labels of a voxel each, and of stripes.
#[test]
fn seventy_thousand_labels() {
    let grid = Grid::axis_aligned([100, 100, 21], [1.0, 0.8, 1.7]).unwrap();
    let apart = |n: usize| if n.is_multiple_of(3) { (n / 3 + 1) as i64 } else { 0 };
    let voxels: Vec<i64> = (0..grid.voxel_count()).map(apart).collect();
    let image = LabelImage::from_voxels(grid, &voxels).unwrap();
    in_time("70,000 labels", || {
        let measured = Measurement::default().run_labels(&image, &LabelSelection::All, |_, _| {}).unwrap();
        assert_eq!(measured.len(), 70_000);
        measured.iter().step_by(997).for_each(|(label, measured)| check(&label.to_string(), measured));
    });
}

/// Choices without sense are refused in words, before anything is done.
#[test]
fn choices_without_sense() {
    let (_, mask) = masks([1.0; 3]).remove(3);
    for measurement in [
        Measurement::default().sigma_mm(0.0),
        Measurement::default().sigma_mm(-1.0),
        Measurement::default().sigma_mm(f64::NAN),
        Measurement::default().sigma_mm(f64::INFINITY),
        Measurement::default().sigma_mm(1e-300),
        Measurement::default().sigma_mm(1e300),
        Measurement::default().thickness_mm(0.0),
        Measurement::default().thickness_mm(f64::NAN),
        Measurement::default().epsilon(f64::INFINITY),
        Measurement::default().level(0.0),
        Measurement::default().level(1.0),
        Measurement::default().level(f64::NAN),
        // Nothing is given back from a blur of so many voxels, in minutes.
        Measurement::default().embedding(EmbeddingKind::Recovering).sigma_mm(13.0),
    ] {
        let name = format!("{measurement:?}");
        in_time(&name, || match measurement.run(mask.clone()) {
            // A length below all voxels is one all the same, and one above leaves nothing.
            Ok(measured) => {
                assert!(["1e-300", "1e300"].iter().any(|length| name.contains(length)), "{name} is measured");
                check(&name, &measured);
            }
            Err(MeasureError::Volume(error)) => panic!("{name}: {error}"),
            Err(error) => assert!(error.to_string().len() > 20, "{name}: {error}"),
        });
    }
}
