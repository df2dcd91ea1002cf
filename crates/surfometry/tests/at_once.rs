//! What cannot be measured is told at once: spacings that are no lengths between voxels, and blurs that leave
//! nothing.

use std::time::{Duration, Instant};
use surfometry::Measurement;
use surfometry::measurement::{EmbeddingKind, Measured, Progress};
use surfometry::phantoms::{Ball, Phantom, Pose};
use surfometry::volume::{Affine, Grid, LabelSelection, Mask, Spacing, VolumeError};

/// Time for what takes minutes where it is not known beforehand, on a machine that does other things as well.
const AT_ONCE: Duration = Duration::from_secs(10);

#[track_caller]
fn at_once<T>(work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    assert!(start.elapsed() < AT_ONCE, "{:?}", start.elapsed());
    result
}

/// A ball of 10 voxels in the middle of a cube.
fn ball(voxels: usize, spacing: [f64; 3]) -> Mask {
    let middle = 0.5 * voxels as f64 - 0.3;
    let grid = Grid::axis_aligned([voxels; 3], spacing).unwrap();
    Mask::from_predicate(grid, |index| {
        index.iter().map(|&i| (i as f64 - middle).powi(2)).sum::<f64>() < 100.0
    })
}

/// Only what the voxels tell is left.
fn vanished(measured: &Measured) {
    assert_eq!((measured.blurred.volume_mm3, measured.surface_area_mm2), (None, None));
    assert_eq!(measured.volume_mm3, Some(measured.voxels.volume_mm3));
    assert!(measured.flags.iter().any(|flag| flag.code.to_string() == "surface-vanished"));
}

/// In an image that is much larger than the blur, whose box alone says nothing; as slices go by, and held as
/// a whole.
#[test]
fn blurs_that_leave_nothing() {
    for sigma in [9.0, 25.0, 60.0, 399.0, 1e5] {
        let phantom = Phantom::new(Ball { radius: 10.0 }, Pose::new([3.0; 3], [0.2; 3]), [1.0; 3]).unwrap();
        let measurement = Measurement::default().sigma_mm(sigma);
        let all = LabelSelection::All;
        let streamed = at_once(|| measurement.run_slabs(&mut phantom.slabs(), &all, |_: Progress| {}));
        vanished(&streamed.unwrap().results[0].1);
        vanished(&at_once(|| measurement.run(ball(300, [1.0; 3]))).unwrap());
    }
}

/// Of a thin object its box says nothing: a diagonal of voxels.
#[test]
fn few_voxels_in_a_large_box() {
    let grid = Grid::axis_aligned([200; 3], [1.0; 3]).unwrap();
    let diagonal = Mask::from_predicate(grid, |[x, y, z]| x == y && y == z);
    for embedding in [EmbeddingKind::Gaussian, EmbeddingKind::Corrected] {
        let measurement = Measurement::default().sigma_mm(40.0).embedding(embedding);
        vanished(&at_once(|| measurement.run(&diagonal)).unwrap());
    }
}

/// What is known beforehand is what comes out: at these blurs a ball of 10 is nearly gone or just gone.
#[test]
fn nothing_is_left_that_was_there() {
    for (sigma, left) in [(6.2, true), (6.8, false)] {
        let measurement = Measurement::default().sigma_mm(sigma).thickness_mm(1.0);
        let measured = measurement.run(ball(40, [1.0; 3])).unwrap();
        assert_eq!(measured.blurred.volume_mm3.is_some(), left, "sigma {sigma}");
    }
}

/// As a header may have them after one flipped bit.
#[test]
fn spacings_that_are_none() {
    for spacing in [[3e38, 1.0, 1.0], [1.0, 1e-38, 1.0], [1.0, 1.0, 1e8], [1e6, 1.0, 1.0], [1e-7, 1.0, 1.0]] {
        let refused = at_once(|| Grid::axis_aligned([8, 8, 8], spacing)).unwrap_err();
        let message = refused.to_string();
        assert!(message.contains("header is damaged"), "{spacing:?}: {message}");
        let oblique =
            Affine::from_directions([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], spacing, [0.0; 3]);
        assert!(Grid::new([8, 8, 8], oblique).is_err(), "{spacing:?}");
    }
    assert!(matches!(Spacing::new([0.0, 1.0, 1.0]), Err(VolumeError::InvalidSpacing { .. })));
}

/// As unequal as may be, with blurs and bands of every size: an answer or a refusal, soon.
#[test]
fn spacings_as_unequal_as_may_be() {
    for spacing in [[1.0, 1.0, 1e4], [1e4, 1.0, 1.0], [1.0, 1e4, 1e4], [1e-9, 1e-9, 1e-6], [1e9, 1e6, 1e9]] {
        let mask = ball(26, spacing);
        let mean = Spacing::new(spacing).unwrap().geometric_mean();
        for sigma in [None, Some(1.2 * mean), Some(10.0 * mean)] {
            for thickness in [None, Some(1e-3 * mean), Some(mean)] {
                let measurement = Measurement::default().sigma_mm(sigma).thickness_mm(thickness);
                let _ = at_once(|| measurement.run(&mask));
            }
        }
    }
}
