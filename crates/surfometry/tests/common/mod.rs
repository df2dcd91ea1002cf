//! Shapes, poses and comparisons that several tests use.
#![allow(dead_code, missing_docs, unreachable_pub)]

use surfometry::Measurement;
use surfometry::measurement::{Measured, StageSeconds};
use surfometry::phantoms::{Phantom, Pose, Shape, Truth};
use surfometry::volume::LabelGroup;

/// Rotations and shifts that leave no axis special and no centre on the grid.
pub fn poses() -> [Pose; 3] {
    [
        Pose::new([17.0, 31.0, 12.0], [0.31, 0.17, 0.43]),
        Pose::new([63.0, -22.0, 40.0], [0.11, -0.37, 0.29]),
        Pose::new([-35.0, 48.0, 71.0], [-0.23, 0.41, -0.07]),
    ]
}

/// Poses that nothing was tuned on.
pub fn held_out_pose(number: usize) -> Pose {
    let part = |n: usize, step: f64| (0.37 + step * (3 * number + n) as f64).fract();
    Pose::new(
        std::array::from_fn(|a| 180.0 * part(a, 0.618_034)),
        std::array::from_fn(|a| part(a, 0.754_878) - 0.5),
    )
}

/// Spacings whose largest edge is 1 and whose ratio goes up to 4.
pub const SPACINGS: [[f64; 3]; 5] =
    [[1.0, 1.0, 1.0], [0.5, 0.5, 1.0], [1.0, 0.7, 0.4], [0.25, 1.0, 0.5], [0.25, 0.25, 1.0]];

pub fn phantom(shape: impl Shape + 'static, pose: Pose, spacing: [f64; 3]) -> Phantom {
    Phantom::new(shape, pose, spacing).expect("a valid phantom")
}

/// All of some results but the times.
pub fn without_times(results: &[(LabelGroup, Measured)]) -> Vec<String> {
    let text = |(group, measured): &(LabelGroup, Measured)| {
        let mut measured = measured.clone();
        measured.timings = StageSeconds::default();
        // Debug prints every digit of an f64.
        format!("{group} {measured:?}")
    };
    results.iter().map(text).collect()
}

/// Measures a phantom's voxels.
pub fn measure(phantom: &Phantom, measurement: &Measurement) -> Measured {
    measurement.run(phantom.labels().unwrap().mask(1)).unwrap()
}

/// Relative errors in % of compensated V, A, M.
pub fn compensated_errors(measured: &Measured, truth: &Truth) -> [f64; 3] {
    let c = &measured.values;
    let percent = |value: Option<f64>, exact: f64| 100.0 * (value.expect("a number") / exact - 1.0);
    [
        percent(c.volume_mm3, truth.volume),
        percent(c.surface_area_mm2, truth.surface_area),
        percent(c.total_mean_curvature_mm, truth.total_mean_curvature),
    ]
}

pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    (sum / count).sqrt()
}

pub fn codes(measured: &Measured) -> Vec<String> {
    measured.flags.iter().map(|f| f.code.to_string()).collect()
}

/// Powers of length of [`values`].
pub const POWERS: [i32; 8] = [3, 2, 1, 0, 0, 3, 2, 1];

/// V, A, M, total K, bending energy; compensated V, A, M.
pub fn values(m: &Measured) -> [Option<f64>; 8] {
    let c = &m.values;
    [
        m.blurred.volume_mm3,
        m.blurred.surface_area_mm2,
        m.blurred.total_mean_curvature_mm,
        m.blurred.total_gaussian_curvature,
        m.blurred.total_squared_mean_curvature,
        c.volume_mm3,
        c.surface_area_mm2,
        c.total_mean_curvature_mm,
    ]
}

/// Everything that does not depend on where the object lies, within `tolerance`.
pub fn assert_same(name: &str, found: &Measured, expected: &Measured, tolerance: f64) {
    for (i, (a, b)) in values(found).into_iter().zip(values(expected)).enumerate() {
        let (a, b) = (a.expect("a number"), b.expect("a number"));
        assert!((a / b - 1.0).abs() < tolerance, "{name}: value {i} is {a}, not {b}");
    }
    assert_eq!(found.voxels.count, expected.voxels.count, "{name}");
    assert_eq!(found.topology, expected.topology, "{name}");
}

pub fn assert_same_place(name: &str, found: &Measured, expected: &Measured) {
    for (a, b) in found.voxels.centroid_mm.iter().zip(expected.voxels.centroid_mm) {
        assert!((a - b).abs() < 1e-3, "{name}: centroid {a}, not {b}");
    }
}

/// A and M: what they are off, in shares of the truth and in standard errors.
pub fn off_by(measured: &Measured, truth: [f64; 2]) -> [[f64; 2]; 2] {
    let errors = &measured.standard_error;
    let found = [
        (measured.surface_area_mm2, errors.surface_area_mm2),
        (measured.total_mean_curvature_mm, errors.total_mean_curvature_mm),
    ];
    std::array::from_fn(|n| {
        let by = found[n].0.unwrap() - truth[n];
        [by / truth[n], by / found[n].1.unwrap()]
    })
}
