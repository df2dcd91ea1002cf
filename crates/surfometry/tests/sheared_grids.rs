//! Axes that are up to a degree from perpendicular: the volume is the determinant's, area and curvature are within errors.

use surfometry::Measurement;
use surfometry::measurement::Measured;
use surfometry::phantoms::{Phantom, Pose};
use surfometry::volume::{Affine, Grid, Mask, VolumeError};

/// Axes of a spacing that are sheared by some degrees each way, turned in the world.
fn sheared(degrees: [f64; 3], spacing: [f64; 3], turned: f64) -> Affine {
    let [xy, xz, yz] = degrees.map(|d| d.to_radians().tan());
    let (sin, cos) = turned.to_radians().sin_cos();
    let columns = [[1.0, 0.0, 0.0], [xy, 1.0, 0.0], [xz, yz, 1.0]];
    let world = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
    let columns = columns.map(world);
    let length = |c: [f64; 3]| c.iter().map(|v| v * v).sum::<f64>().sqrt();
    let linear =
        std::array::from_fn(|w| std::array::from_fn(|a| columns[a][w] * spacing[a] / length(columns[a])));
    Affine { linear, origin: [0.0; 3] }
}

/// An ellipsoid in the world, seen by such a grid.
fn measured(affine: Affine, radii: [f64; 3], turn: [f64; 3], shift: [f64; 3]) -> Measured {
    let size = 2.0 * radii.iter().fold(0.0f64, |a, b| a.max(*b)) + 14.0;
    let dimensions = affine.column_lengths().map(|h| (size / h) as usize);
    let centre = affine.apply(dimensions.map(|n| n as f64 / 2.0));
    let pose = Pose::new(turn, std::array::from_fn(|a| centre[a] + shift[a]));
    let grid = Grid::new(dimensions, affine).unwrap();
    let mask = Mask::from_predicate(grid, |index| {
        let local = pose.to_shape(affine.apply(index.map(|v| v as f64)));
        (0..3).map(|a| (local[a] / radii[a]).powi(2)).sum::<f64>() < 1.0
    });
    Measurement::default().run(mask).unwrap()
}

/// Sheared by 0.1 to 1 degree, along one pair of axes and all three, cubic and thick voxels: V, A and M of an ellipsoid are
/// within two standard errors, and V is not that of perpendicular axes.
#[test]
fn ellipsoids_keep_their_numbers() {
    let radii = [18.0, 10.0, 7.0];
    let exact = Phantom::from_spec("ellipsoid?radii=18,10,7").unwrap().truth().unwrap();
    let (mut worst, mut count) = ([0.0f64; 3], 0);
    for degrees in [[0.0, 0.0, 0.1], [0.0, 0.0, 0.5], [0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.9, -0.9, 0.9]] {
        for spacing in [[0.8; 3], [0.7, 0.7, 1.2]] {
            for (n, turn) in
                [[17.0, 31.0, 12.0], [63.0, -22.0, 40.0], [0.0, 0.0, 45.0]].into_iter().enumerate()
            {
                let found =
                    measured(sheared(degrees, spacing, 20.0 * n as f64), radii, turn, [0.31, 0.17, 0.43]);
                let flagged = found.flags.iter().any(|flag| flag.code.to_string() == "sheared-grid");
                assert!(flagged, "{degrees:?}");
                let error = &found.standard_error;
                let z = [
                    (found.volume_mm3, error.volume_mm3, exact.volume),
                    (found.surface_area_mm2, error.surface_area_mm2, exact.surface_area),
                    (
                        found.total_mean_curvature_mm,
                        error.total_mean_curvature_mm,
                        exact.total_mean_curvature,
                    ),
                ]
                .map(|(value, error, exact)| (value.unwrap() - exact) / error.unwrap());
                println!("{degrees:?} {spacing:?} {turn:?}: z of V, A, M {z:+.2?}");
                (0..3).for_each(|i| worst[i] = worst[i].max(z[i].abs()));
                count += usize::from(z.iter().all(|z| z.abs() < 2.0));
            }
        }
    }
    assert!(count >= 28, "{count} of 30, worst {worst:?}");
    assert!(worst.iter().all(|z| *z < 3.0), "{worst:?}");
}

/// A voxel's volume is the determinant, to the last digits; up to rounding perpendicular axes are taken as they are stated.
#[test]
fn volume_is_the_determinant() {
    let affine = sheared([0.9, -0.9, 0.9], [0.7, 0.8, 1.2], 30.0);
    let grid = Grid::new([10; 3], affine).unwrap();
    assert!((grid.spacing().cell_volume() / affine.determinant().abs() - 1.0).abs() < 1e-14);
    let stated = affine.column_lengths().iter().product::<f64>();
    assert!(stated / grid.spacing().cell_volume() > 1.0002);
    let rounded = sheared([0.05, 0.0, 0.05], [0.7, 0.8, 1.2], 30.0);
    assert_eq!(Grid::new([10; 3], rounded).unwrap().spacing().mm(), rounded.column_lengths());
    let beyond = Grid::new([10; 3], sheared([0.0, 1.1, 0.0], [1.0; 3], 0.0));
    assert!(matches!(beyond, Err(VolumeError::Sheared { first: 0, second: 2, .. })));
}
