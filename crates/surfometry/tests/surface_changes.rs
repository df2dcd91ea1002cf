//! Distances from one surface to a later one, against closed forms, and against what two masks of one object differ by.

mod common;

use common::rms;
use surfometry::Measurement;
use surfometry::measurement::{CurvatureScale, Object};
use surfometry::phantoms::{Ball, Capsule, Ellipsoid, Pose, Shape, Torus};
use surfometry::surface::{Placed, Surface, SurfaceChange, VertexChange};
use surfometry::volume::{Affine, Grid, Mask};

/// A scan: a grid turned in the world, with its voxels' spacing, about a centre that it does not hit.
fn scan(spacing: [f64; 3], turn: [f64; 3], shift: [f64; 3], half: f64) -> Grid {
    let pose = Pose::new(turn, [0.0; 3]);
    // Rows of the rotation are where the world's axes lie in the scan's frame.
    let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| pose.to_shape(axis));
    let linear = rows.map(|row| std::array::from_fn(|a| row[a] * spacing[a]));
    let dimensions = spacing.map(|h| (2.0 * half / h) as usize);
    let centred = Affine { linear, origin: [0.0; 3] };
    let centre = centred.apply(dimensions.map(|n| n as f64 / 2.0));
    Grid::new(dimensions, Affine { linear, origin: std::array::from_fn(|w| shift[w] - centre[w]) }).unwrap()
}

/// A shape in the world, as a scan sees it.
fn mask(grid: Grid, shape: &dyn Shape, pose: &Pose) -> Mask {
    let world = |index: [usize; 3]| grid.affine().apply(index.map(|v| v as f64));
    Mask::from_predicate(grid, |index| shape.value(pose.to_shape(world(index))) < 0.0)
}

struct Compared {
    surface: Surface,
    changes: Vec<VertexChange>,
    whole: SurfaceChange,
}

fn compared(first: &Object, later: Mask) -> Compared {
    let later = first.comparable().prepare(later).unwrap();
    let (mut surface, later_surface) = (first.surface(), later.surface());
    let noise = [first.position_noise(), later.position_noise()];
    let here = Placed { surface: &surface, noise: noise[0].as_ref(), known: first.field_of_view() };
    let there = Placed { surface: &later_surface, noise: noise[1].as_ref(), known: later.field_of_view() };
    let changes = Surface::changes_to(here, there).unwrap();
    let back = Surface::changes_to(there, here).unwrap();
    surface.set_changes(&changes);
    let whole = surface.change(&later_surface, &back).unwrap();
    Compared { surface, changes, whole }
}

/// Rms, mm, by which two masks of one body differ at a scale of its own at each vertex, as measured here.
const LOCAL_NOISE: f64 = 0.028;

const POSE: [f64; 3] = [17.0, 31.0, 12.0];

fn scans(half: f64) -> [Grid; 4] {
    [
        scan([0.8, 0.8, 1.0], [0.0; 3], [0.31, 0.17, 0.43], half),
        scan([0.8, 0.8, 1.0], [23.0, -31.0, 40.0], [0.05, -0.27, 0.11], half),
        scan([1.0, 0.9, 0.8], [-12.0, 18.0, 75.0], [-0.4, 0.2, 0.3], half),
        scan([0.9, 0.9, 0.9], [50.0, 7.0, -29.0], [0.15, 0.45, -0.35], half),
    ]
}

/// Scans of one object, turned against each other, on grids of the same and of other spacings: the distance is none but for
/// noise, which is as large as is told, by its rms and by what lies beyond two standard errors. A wide blur leaves a dozen waves
/// of a body, so its noise scatters by a fifth: pairs are pooled.
#[test]
fn two_masks_of_one_object_differ_by_noise() {
    let pose = Pose::new(POSE, [0.0; 3]);
    let shapes: [Box<dyn Shape>; 3] = [
        Box::new(Ellipsoid { radii: [16.0, 11.0, 9.0] }),
        Box::new(Torus { major: 14.0, minor: 5.5 }),
        // Where curvature jumps.
        Box::new(Capsule { radius: 7.0, length: 16.0 }),
    ];
    for scale in [CurvatureScale::AsMeasured, CurvatureScale::Object, CurvatureScale::Local] {
        // Of a scale at each vertex no noise is told.
        let is_told = scale != CurvatureScale::Local;
        let (mut squares, mut told, mut beyond, mut of_curvature, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for shape in &shapes {
            let area = shape.truth().unwrap().surface_area;
            let scans = scans(22.0);
            for (first, later) in [(0, 1), (1, 2), (2, 3), (3, 0)].map(|(n, m)| (scans[n], scans[m])) {
                let voxels = mask(first, &**shape, &pose);
                let local = Measurement::default().for_local_curvature(&voxels, scale).unwrap();
                let found = compared(&local.prepare(voxels).unwrap(), mask(later, &**shape, &pose)).whole;
                let distance = found.distance_mm;
                assert_eq!(distance.noise_rms.is_some(), is_told);
                let noise = distance.noise_rms.unwrap_or(LOCAL_NOISE);
                let share = distance.share_beyond_noise.unwrap_or_default();
                println!(
                    "{scale:?}: mean {:+.4} rms {:.4} told {noise:.4} beyond {share:.3}",
                    distance.mean, distance.rms
                );
                // Volumes of both scatter by the law of lattice points, 0.258 h^2 sqrt A (Kendall 1948).
                let scatter =
                    [first, later].map(|g| 0.258 * g.spacing().geometric_mean().powi(2) / area.sqrt());
                assert!(distance.mean.abs() < 3.0 * scatter[0].hypot(scatter[1]), "{distance:?} {scatter:?}");
                assert!(found.hausdorff_95_mm < 3.0 * noise && found.hausdorff_mm < 0.5, "{found:?}");
                let curvature = found.mean_curvature_change_per_mm;
                assert!(curvature.mean.abs() < 0.002, "{curvature:?}");
                assert_eq!(curvature.noise_rms.is_some(), scale != CurvatureScale::AsMeasured);
                squares += distance.rms.powi(2);
                told += noise * noise;
                beyond += share;
                of_curvature += curvature.share_beyond_noise.unwrap_or_default();
                count += 1.0;
            }
        }
        let ratio: f64 = (squares / told).sqrt();
        println!(
            "{scale:?}: rms {ratio:.3} of what is told, beyond it {:.3}, of H {:.3}",
            beyond / count,
            of_curvature / count
        );
        assert!((0.8..1.1).contains(&ratio), "{scale:?}: {ratio}");
        assert!(beyond / count < 0.075 && of_curvature / count < 0.1, "{scale:?}: {beyond} {of_curvature}");
    }
}

/// A ring that has become thicker everywhere, or thinner: its distance is the thickness, to 0.05 voxel on the mean and to noise
/// at vertices, and H changes as it does from one ring to the other.
#[test]
fn a_thicker_ring_is_farther_by_its_thickness() {
    let pose = Pose::new(POSE, [0.2, -0.3, 0.1]);
    let ring = |minor| Torus { major: 14.0, minor };
    let [first, later, ..] = scans(26.0);
    for scale in [CurvatureScale::AsMeasured, CurvatureScale::Local] {
        for (from, to) in [(5.0, 6.5), (6.5, 5.0), (5.5, 5.9)] {
            let voxels = mask(first, &ring(from), &pose);
            let local = Measurement::default().for_local_curvature(&voxels, scale).unwrap();
            let found = compared(&local.prepare(voxels).unwrap(), mask(later, &ring(to), &pose));
            let distance = found.whole.distance_mm;
            assert_eq!(distance.noise_rms.is_some(), scale == CurvatureScale::AsMeasured);
            let noise = distance.noise_rms.unwrap_or(LOCAL_NOISE);
            let error = rms(found.changes.iter().map(|c| f64::from(c.distance) - (to - from)));
            println!(
                "{scale:?} {from} to {to}: mean {:+.4} rms of errors {error:.4} told {noise:.4}",
                distance.mean
            );
            assert!((distance.mean - (to - from)).abs() < 0.03, "{distance:?}");
            assert!(error < 1.3 * noise, "{error} {noise}");
            if (to - from).abs() > 1.0 {
                assert!(distance.share_beyond_noise.unwrap_or(1.0) > 0.99, "{distance:?}");
                assert!((found.whole.hausdorff_95_mm - (to - from).abs()).abs() < 2.5 * noise);
            }
            // Of blurred surfaces H is that of thinner rings.
            if scale == CurvatureScale::AsMeasured {
                continue;
            }
            let change = |place: &[f64; 3]| {
                let at = pose.to_shape(*place);
                let out = at[0].hypot(at[1]);
                let cosine = (out - 14.0) / (out - 14.0).hypot(at[2]);
                let mean = |r: f64| 0.5 * (1.0 / r + cosine / (14.0 + r * cosine));
                mean(to) - mean(from)
            };
            let exact = found.surface.mesh.vertices.iter().map(change);
            let errors =
                found.changes.iter().zip(exact).map(|(c, exact)| f64::from(c.mean_curvature) - exact);
            let mean = errors.sum::<f64>() / found.changes.len() as f64;
            assert!(mean.abs() < 0.0035, "{mean}");
        }
    }
}

/// A ball that has moved: each vertex has its own distance, outward on one side and inward on the other.
#[test]
fn a_ball_that_moved_is_outside_on_one_side() {
    let (shape, moved) = (Ball { radius: 10.0 }, [1.1, -0.7, 0.4]);
    let [first, later, ..] = scans(18.0);
    let object = Measurement::default().prepare(mask(first, &shape, &Pose::new(POSE, [0.0; 3]))).unwrap();
    let found = compared(&object, mask(later, &shape, &Pose::new(POSE, moved)));
    let distance = |place: &[f64; 3]| {
        // The vertex before the blur moved it.
        let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let original = place.map(|v| v / length(*place) * 10.0);
        10.0 - length(std::array::from_fn(|a| original[a] - moved[a]))
    };
    let exact = found.surface.mesh.vertices.iter().map(distance);
    let errors: Vec<f64> =
        found.changes.iter().zip(exact).map(|(c, exact)| f64::from(c.distance) - exact).collect();
    let noise = found.whole.distance_mm.noise_rms.unwrap();
    println!("rms of errors {:.4}, told {noise:.4}", rms(errors.iter().copied()));
    assert!(rms(errors.iter().copied()) < 1.3 * noise);
    // The mean of |R n - m| over directions is R + m^2 / (3 R).
    let square: f64 = moved.iter().map(|m| m * m).sum();
    let whole = found.whole.distance_mm;
    assert!((whole.mean + square / 30.0).abs() < 0.03, "{whole:?}");
    assert!((whole.rms - (square / 3.0).sqrt()).abs() < 0.03, "{whole:?}");
}

/// The same bits for any number of threads; nothing where the later surface is empty; no standard error of a field.
#[test]
fn changes_do_not_depend_on_threads() {
    let (shape, pose) = (Ball { radius: 8.0 }, Pose::new(POSE, [0.0; 3]));
    let [first, later, ..] = scans(14.0);
    let object = Measurement::default().prepare(mask(first, &shape, &pose)).unwrap();
    let with_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| compared(&object, mask(later, &shape, &pose)).changes)
    };
    assert_eq!(with_threads(1), with_threads(3));
    let surface = object.surface();
    let here = Placed { surface: &surface, noise: None, known: None };
    let none = Surface::default();
    assert_eq!(Surface::changes_to(here, Placed { surface: &none, ..here }), None);
    let same = Surface::changes_to(here, here).unwrap();
    assert!(
        same.iter().all(|c| c.distance.abs() < 1e-6 && c.mean_curvature == 0.0 && c.distance_error.is_none())
    );
}

/// A later scan that shows half of a ball, and a first one that is cut: what lies outside either, and near the cuts, has no
/// distance, and all else has that of two masks of one object.
#[test]
fn what_an_image_does_not_show_has_no_distance() {
    let (shape, pose) = (Ball { radius: 12.0 }, Pose::new([0.0; 3], [0.0; 3]));
    let whole = scan([1.0; 3], [0.0; 3], [0.31, 0.17, 0.43], 20.0);
    // The same lattice, without what lies above a plane across the ball.
    let half = Grid::new([40, 40, 24], *whole.affine()).unwrap();
    let edge = whole.affine().apply([0.0, 0.0, 23.5])[2];
    for [first, later] in [[whole, half], [half, whole]] {
        let object = Measurement::default().prepare(mask(first, &shape, &pose)).unwrap();
        let found = compared(&object, mask(later, &shape, &pose));
        let is_known = |(place, change): (&[f64; 3], &VertexChange)| {
            assert_eq!(change.distance.is_nan(), change.mean_curvature.is_nan());
            assert_eq!(change.distance.is_nan(), change.distance_error.unwrap().is_nan());
            // Three sigma inside the cut.
            let is_shown = place[2] < edge - 6.0;
            assert!(change.distance.is_nan() || is_shown, "{place:?}");
            assert!(!change.distance.is_nan() || place[2] > edge - 6.5, "{place:?}");
        };
        found.surface.mesh.vertices.iter().zip(&found.changes).for_each(is_known);
        let distance = found.whole.distance_mm;
        println!("share {:.3}, mean {:.5}", found.whole.share_without_distance, distance.mean);
        assert!((0.2..0.8).contains(&found.whole.share_without_distance), "{:?}", found.whole);
        assert!(distance.mean.abs() < 0.01 && distance.rms < 0.02, "{distance:?}");
        assert!(found.whole.hausdorff_mm < 0.1 && distance.share_beyond_noise.unwrap() < 0.01);
    }
}

/// Two scans that have no place in common.
#[test]
fn scans_that_do_not_meet_have_no_change() {
    let (shape, pose) = (Ball { radius: 8.0 }, Pose::new(POSE, [0.0; 3]));
    let away = Pose::new(POSE, [800.0, 0.0, 0.0]);
    let first = scan([1.0; 3], [0.0; 3], [0.0; 3], 14.0);
    let later = scan([1.0; 3], [0.0; 3], [800.0, 0.0, 0.0], 14.0);
    let object = Measurement::default().prepare(mask(first, &shape, &pose)).unwrap();
    let other = object.comparable().prepare(mask(later, &shape, &away)).unwrap();
    let (mut surface, there) = (object.surface(), other.surface());
    let [first, later] = [(&surface, &object), (&there, &other)].map(|(surface, object)| Placed {
        surface,
        noise: None,
        known: object.field_of_view(),
    });
    let changes = Surface::changes_to(first, later).unwrap();
    let back = Surface::changes_to(later, first).unwrap();
    assert!(changes.iter().chain(&back).all(|change| change.distance.is_nan()));
    surface.set_changes(&changes);
    assert_eq!(surface.change(&there, &back), None);
}
