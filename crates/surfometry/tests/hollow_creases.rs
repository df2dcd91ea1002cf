//! Creases into which round parts meet, as where two balls overlap: what a blur fills is in the errors of A and M. In closed
//! form, at angles and sizes on which nothing was calibrated.

mod common;

use common::{codes, held_out_pose, off_by, rms};
use surfometry::Measurement;
use surfometry::phantoms::{Phantom, TwoBalls};

/// What A and M are off, in shares of the truth and in standard errors.
fn off(radius: f64, length: f64, spacing: [f64; 3], number: usize) -> [[f64; 2]; 2] {
    let phantom = Phantom::new(TwoBalls { radius, length }, held_out_pose(number), spacing).unwrap();
    let truth = phantom.truth().unwrap();
    let measured = Measurement::default().run_settled(phantom.labels().unwrap().mask(1)).unwrap();
    let off = off_by(&measured, [truth.surface_area, truth.total_mean_curvature]);
    println!("{radius} {length} {spacing:?}: {off:?} {:?}", codes(&measured));
    off
}

#[test]
fn errors_of_overlapping_balls_hold() {
    for (radius, share) in [(9.0, 0.7), (13.0, 0.55), (13.0, 0.4), (20.0, 0.65), (28.0, 0.6)] {
        for spacing in [[1.0; 3], [0.6, 1.0, 1.4]] {
            let all: Vec<[[f64; 2]; 2]> =
                (0..4).map(|n| off(radius, 2.0 * share * radius, spacing, n)).collect();
            for quantity in 0..2 {
                let of_all = |kind: usize| all.iter().map(move |off| off[quantity][kind]);
                // A blur fills a crease: A and M, which is less of it for a hollow, are short.
                assert!(of_all(0).all(|share| share < 0.001), "{all:?}");
                let z = rms(of_all(1));
                assert!(of_all(1).all(|z| z.abs() < 2.5) && (0.3..1.9).contains(&z), "{z}: {all:?}");
            }
        }
    }
}

/// What is left is next to nothing on smooth bodies: their errors stay what they are.
#[test]
fn smooth_hollows_are_no_creases() {
    let errors = |spec: &str| {
        let phantom = Phantom::from_spec(spec).unwrap();
        let measured = Measurement::default().run(phantom.labels().unwrap().mask(1)).unwrap();
        measured.standard_error.surface_area_mm2.unwrap() / measured.surface_area_mm2.unwrap()
    };
    for (spec, most) in [
        ("torus?major=14&minor=5&rotate=20,30,40&shift=0.3,0.1,0.2", 0.028),
        ("torus?major=24&minor=8&rotate=20,30,40&spacing=0.8,1,1.2", 0.0035),
        ("shell?radius=16&inner=9&shift=0.3,0.1,0.2", 0.0015),
    ] {
        let share = errors(spec);
        assert!(share < most, "{spec}: {share}");
    }
}
