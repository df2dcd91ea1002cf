//! What must hold for any shape: scaling, translation, permutation, mirror, complement, splitting.

mod common;

use common::{POWERS, measure, phantom, values};
use proptest::prelude::*;
use surfometry::Measurement;
use surfometry::measurement::Measured;
use surfometry::phantoms::{Ellipsoid, Pose};
use surfometry::volume::{Affine, Grid, Mask};

/// A lumpy object that is symmetric in nothing: an ellipsoid in a pose.
fn object() -> impl Strategy<Value = (Mask, [f64; 3])> {
    let radii = prop::array::uniform3(5.0..9.0f64);
    let angles = prop::array::uniform3(-60.0..60.0f64);
    let spacing = prop::array::uniform3(0.5..1.0f64);
    (radii, angles, spacing).prop_map(|(radii, angles, spacing)| {
        let phantom = phantom(Ellipsoid { radii }, Pose::new(angles, [0.1, 0.2, 0.3]), spacing);
        (phantom.labels().unwrap().mask(1), spacing)
    })
}

fn measurement() -> Measurement {
    Measurement::default().sigma_mm(1.5).thickness_mm(2.5)
}

fn numbers(m: &Measured) -> [f64; 8] {
    values(m).map(|v| v.expect("a number"))
}

fn close(a: &[f64; 8], b: &[f64; 8], tolerance: f64) -> Result<(), TestCaseError> {
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        prop_assert!((x - y).abs() <= tolerance * x.abs().max(1.0), "value {}: {} {}", i, x, y);
    }
    Ok(())
}

/// The mask with its voxels at other indices of a new grid.
fn moved(mask: &Mask, grid: Grid, from: impl Fn([i64; 3]) -> [i64; 3]) -> Mask {
    Mask::from_predicate(grid, |index| mask.get(from(index.map(|i| i as i64))))
}

fn run(mask: &Mask) -> [f64; 8] {
    numbers(&measurement().run(mask).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// All lengths times s: V s^3, A s^2, M s, total K and the bending energy unchanged.
    #[test]
    fn scaling((mask, spacing) in object(), s in 0.01..100.0f64) {
        let grid = Grid::axis_aligned(mask.grid().dimensions(), spacing.map(|h| h * s)).unwrap();
        let scaled = moved(&mask, grid, |i| i);
        let m = Measurement::default().sigma_mm(1.5 * s).thickness_mm(2.5 * s);
        let mut back = numbers(&m.run(&scaled).unwrap());
        (0..8).for_each(|i| back[i] /= s.powi(POWERS[i]));
        close(&run(&mask), &back, 1e-5)?;
    }

    /// Voxels moved by whole indices; f32 fields and other tiles leave 1e-6.
    #[test]
    fn translation((mask, spacing) in object(), shift in prop::array::uniform3(0..70i64)) {
        let dimensions = std::array::from_fn(|a| mask.grid().dimensions()[a] + shift[a] as usize);
        let grid = Grid::axis_aligned(dimensions, spacing).unwrap();
        let shifted = moved(&mask, grid, |i| std::array::from_fn(|a| i[a] - shift[a]));
        close(&run(&mask), &run(&shifted), 1e-6)?;
    }

    #[test]
    fn axis_permutation((mask, spacing) in object(), order in Just([0, 1, 2]).prop_shuffle()) {
        let pick = |v: [f64; 3]| order.map(|a| v[a]);
        let dimensions = order.map(|a| mask.grid().dimensions()[a]);
        let grid = Grid::axis_aligned(dimensions, pick(spacing)).unwrap();
        let permuted = moved(&mask, grid, |i| {
            let mut original = [0; 3];
            (0..3).for_each(|a| original[order[a]] = i[a]);
            original
        });
        close(&run(&mask), &run(&permuted), 1e-5)?;
    }

    /// Turned over in the array, or by a mirroring affine: nothing that is measured changes.
    #[test]
    fn mirror((mask, spacing) in object(), axis in 0usize..3) {
        let n = mask.grid().dimensions()[axis] as i64;
        let mut affine = Affine::diagonal(spacing);
        (0..3).for_each(|w| affine.linear[w][axis] *= -1.0);
        let grid = Grid::new(mask.grid().dimensions(), affine).unwrap();
        let mirrored = moved(&mask, grid, |mut i| { i[axis] = n - 1 - i[axis]; i });
        close(&run(&mask), &run(&mirrored), 1e-5)?;
    }

    /// A box without the object: the surface between them is the same one seen from the other side, so H
    /// changes sign and K does not; V, A and chi add up.
    #[test]
    fn complement((mask, spacing) in object()) {
        let margin = 16i64;
        let dimensions = mask.grid().dimensions().map(|n| n + 2 * margin as usize);
        let grid = Grid::axis_aligned(dimensions, spacing).unwrap();
        let inside = |i: [i64; 3]| mask.get(i.map(|v| v - margin));
        let full = run(&Mask::from_predicate(grid, |_| true));
        let hollow = run(&Mask::from_predicate(grid, |i| !inside(i.map(|v| v as i64))));
        let object = run(&mask);
        prop_assert!((hollow[0] - (full[0] - object[0])).abs() < 1e-5 * full[0]);
        prop_assert!((hollow[1] - (full[1] + object[1])).abs() < 1e-5 * full[1]);
        prop_assert!((hollow[2] - (full[2] - object[2])).abs() < 1e-5 * full[2]);
        prop_assert!((hollow[3] - (full[3] + object[3])).abs() < 1e-4 * full[3]);
        prop_assert!((hollow[4] - (full[4] + object[4])).abs() < 1e-4 * full[4]);
    }
}

/// Two objects as one are the sum of both, if they are far apart.
#[test]
fn distant_objects_add_up() {
    let phantom =
        phantom(Ellipsoid { radii: [8.0, 6.0, 7.0] }, Pose::new([20.0, 30.0, 40.0], [0.2; 3]), [0.8; 3]);
    let single = numbers(&measure(&phantom, &measurement()));
    let mask = phantom.labels().unwrap().mask(1);
    let [nx, ny, nz] = phantom.grid().dimensions();
    let gap = nx as i64 + 30;
    let grid = Grid::axis_aligned([nx + gap as usize, ny, nz], [0.8; 3]).unwrap();
    let both = moved(&mask, grid, |i| if i[0] >= gap { [i[0] - gap, i[1], i[2]] } else { i });
    close(&single.map(|v| 2.0 * v), &run(&both), 1e-6).unwrap();
}
