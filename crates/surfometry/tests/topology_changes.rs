//! Where topology changes: shapes whose holes, struts, gaps and cavities are known, with a blur that does
//! away with them.

mod common;

use common::{codes, measure, phantom, poses};
use surfometry::Measurement;
use surfometry::measurement::{ChangeStage, LocatedChange, Measured};
use surfometry::phantoms::{Genus, Phantom, Pose, Shell, Torus, TwoBalls};
use surfometry::volume::{Grid, Mask};

const SPACINGS: [[f64; 3]; 2] = [[1.0; 3], [1.0, 1.0, 1.6]];

fn explained(phantom: &Phantom, measurement: &Measurement) -> (Measured, Vec<LocatedChange>) {
    let mask = phantom.labels().unwrap().mask(1);
    let object = measurement.prepare(&mask).unwrap();
    let mut measured = object.measure();
    measured.explain(object.explain_topology().unwrap());
    let changes = measured.topology.changes.clone().unwrap();
    (measured, changes)
}

fn of_blur(changes: &[LocatedChange]) -> Vec<&LocatedChange> {
    changes.iter().filter(|change| change.stage == ChangeStage::Blur).collect()
}

/// A place in the shape's frame.
fn in_shape(pose: &Pose, change: &LocatedChange) -> [f64; 3] {
    pose.to_shape(change.position_mm)
}

#[test]
fn holes_that_the_blur_closes_are_found() {
    for (spacing, genus) in SPACINGS.into_iter().zip([1, 3]) {
        for pose in poses() {
            let shape = Genus { genus, major: 3.0, minor: 6.0 };
            let pitch = 2.0 * (shape.major + shape.minor) + shape.minor;
            let (measured, changes) =
                explained(&phantom(shape, pose, spacing), &Measurement::default().sigma_mm(5.0));
            assert_eq!(measured.topology.handles, i64::from(genus));
            assert_eq!(measured.topology.euler_characteristic_mesh, Some(2));
            let closed = of_blur(&changes);
            assert_eq!(closed.len(), genus as usize, "{closed:?}");
            let mut along: Vec<f64> = closed.iter().map(|change| in_shape(&pose, change)[0]).collect();
            along.sort_by(f64::total_cmp);
            for (n, (change, x)) in closed.iter().zip(along).enumerate() {
                assert_eq!((change.kind.to_string().as_str(), change.handles), ("hole-closed", -1));
                // The hole's axis is at a multiple of the pitch; its throat is 6 mm wide.
                let centre = pitch * (n as f64 - f64::from(genus - 1) / 2.0);
                assert!((x - centre).abs() < 1.0, "{x} for {centre}");
                let [_, y, z] = in_shape(&pose, change);
                assert!(y.abs() < 1.0 && z.abs() < 1.0, "{y} {z}");
                // A voxel beside the axis is nearer to the wall, and the wall's voxels reach into the hole:
                // up to a voxel less, and one more where slices are thick.
                assert!((4.0..=6.0).contains(&change.width_mm), "{}", change.width_mm);
            }
            assert!(codes(&measured).contains(&"euler-differs-from-voxels".to_owned()));
            let told = measured.flags.iter().find(|f| f.code.to_string() == "euler-differs-from-voxels");
            assert!(told.unwrap().message.contains(&format!("{genus} hole")), "{told:?}");
        }
    }
}

#[test]
fn gaps_and_cavities_that_the_blur_fills_are_found() {
    let m = Measurement::default().sigma_mm(3.0);
    for pose in poses() {
        let balls = phantom(TwoBalls { radius: 12.0, length: 26.5 }, pose, [1.0; 3]);
        let (measured, changes) = explained(&balls, &m);
        assert_eq!((measured.topology.components, measured.topology.euler_characteristic_mesh), (2, Some(2)));
        let [joined] = of_blur(&changes)[..] else { panic!("{changes:?}") };
        assert_eq!((joined.kind.to_string().as_str(), joined.components), ("pieces-joined", -1));
        let distance = in_shape(&pose, joined).map(|v| v * v).iter().sum::<f64>().sqrt();
        assert!(distance < 2.0 && joined.width_mm < 4.5, "{distance} {joined:?}");

        let shell = phantom(Shell { radius: 18.0, inner: 3.0 }, pose, [1.0; 3]);
        let (measured, changes) = explained(&shell, &m);
        assert_eq!((measured.topology.cavities, measured.topology.euler_characteristic_mesh), (1, Some(2)));
        let [filled] = of_blur(&changes)[..] else { panic!("{changes:?}") };
        assert_eq!((filled.kind.to_string().as_str(), filled.cavities), ("cavity-filled", -1));
        let distance = in_shape(&pose, filled).map(|v| v * v).iter().sum::<f64>().sqrt();
        assert!(distance < 3.0 && (3.0..7.5).contains(&filled.width_mm), "{distance} {filled:?}");
    }
}

/// Two blocks on a strut, a plate and a speck: pieces that the blur takes away.
#[test]
fn struts_plates_and_specks_that_the_blur_takes_away_are_found() {
    let grid = Grid::axis_aligned([70, 40, 40], [1.0, 1.2, 0.9]).unwrap();
    let measured = |inside: fn([usize; 3]) -> bool| {
        let mask = Mask::from_predicate(grid, inside);
        let object = Measurement::default().sigma_mm(3.0).prepare(&mask).unwrap();
        object.explain_topology().unwrap().changes
    };
    let strut = measured(|[x, y, z]| {
        let block =
            (5..30).contains(&y) && (5..30).contains(&z) && ((5..27).contains(&x) || (43..65).contains(&x));
        block || (27..43).contains(&x) && (16..19).contains(&y) && (16..19).contains(&z)
    });
    let [cut] = of_blur(&strut)[..] else { panic!("{strut:?}") };
    assert_eq!((cut.kind.to_string().as_str(), cut.components), ("piece-split", 1));
    assert!((27..43).contains(&cut.voxel[0]) && (2.5..3.7).contains(&cut.width_mm), "{cut:?}");

    // A thick ring with a thin plate across.
    let plate = measured(|[x, y, z]| {
        let across = ((x as f64 - 30.0).powi(2) + (1.2 * (y as f64 - 20.0)).powi(2)).sqrt();
        across < 22.0 && (5..35).contains(&z) && (across > 12.0 || (19..21).contains(&z))
    });
    let [opened] = of_blur(&plate)[..] else { panic!("{plate:?}") };
    assert_eq!((opened.kind.to_string().as_str(), opened.handles), ("hole-opened", 1));
    assert!((19..21).contains(&opened.voxel[2]) && (0.8..1.9).contains(&opened.width_mm), "{opened:?}");

    let speck = measured(|[x, y, z]| {
        let block = (5..27).contains(&x) && (5..30).contains(&y) && (5..30).contains(&z);
        block || (50..53).contains(&x) && (20..23).contains(&y) && (20..23).contains(&z)
    });
    let [lost] = of_blur(&speck)[..] else { panic!("{speck:?}") };
    assert_eq!((lost.kind.to_string().as_str(), lost.components), ("piece-lost", -1));
    assert_eq!(lost.voxel, [51, 21, 21]);
}

/// The same places in the same order, and the same flattest place, on any number of threads: also where the
/// object spans several tiles.
#[test]
fn places_do_not_depend_on_threads() {
    let grid = Grid::axis_aligned([150, 60, 60], [1.0; 3]).unwrap();
    let wave = |v: usize, step: f64| (v as f64 * step).sin();
    let mask = Mask::from_predicate(grid, |[x, y, z]| {
        wave(x, 0.61) + wave(y, 0.83) + wave(z, 0.72) + wave(x * y + 3 * z, 1.3) > 1.1
    });
    let object = Measurement::default().prepare(&mask).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| object.explain_topology().unwrap())
    };
    let found = on(1);
    assert!(found.changes.len() > 100 && found.weakest.is_some());
    assert_eq!(on(3), found);
}

#[test]
fn nothing_is_found_where_nothing_changes() {
    let (measured, changes) =
        explained(&phantom(Torus { major: 14.0, minor: 6.0 }, poses()[1], [1.0; 3]), &Measurement::default());
    assert!(changes.is_empty(), "{changes:?}");
    assert_eq!(measured.topology.euler_characteristic_expected, Some(0.0));
}

/// A hole that closes between the levels of the band: Gauss-Bonnet sees the mean over the levels, which
/// meshes of other levels confirm.
#[test]
fn the_band_sees_the_mean_over_its_levels() {
    let shape = phantom(Genus { genus: 2, major: 3.6, minor: 7.0 }, poses()[0], [1.0; 3]);
    let m = Measurement::default().sigma_mm(3.4).thickness_mm(8.5);
    let (measured, changes) = explained(&shape, &m);
    let in_band: Vec<_> = changes.iter().filter(|change| change.stage == ChangeStage::Band).collect();
    assert!(in_band.iter().all(|change| change.handles == -1 || change.handles == 1) && in_band.len() == 2);
    let epsilon = measured.parameters.epsilon;
    let levels = 24;
    let (mut mean, mut total) = (0.0, 0.0);
    for n in 0..levels {
        let phi = epsilon * (2.0 * (f64::from(n) + 0.5) / f64::from(levels) - 1.0);
        let weight = 1.0 + (std::f64::consts::PI * phi / epsilon).cos();
        let at_level = measure(&shape, &m.level(0.5 - phi).thickness_mm(1.0));
        mean += weight * at_level.topology.euler_characteristic_mesh.unwrap() as f64;
        total += weight;
    }
    mean /= total;
    let expected = measured.topology.euler_characteristic_expected.unwrap();
    assert!((expected - mean).abs() < 0.25, "expected {expected}, mean over levels {mean}");
    let seen = measured.blurred.euler_characteristic.unwrap();
    assert!((seen - mean).abs() < 0.3, "seen {seen}, mean over levels {mean}");
    assert!(codes(&measured).iter().any(|code| code == "euler-not-integer"));
}
