//! Measured phantoms against their exact integrals: rotated, off the grid, on anisotropic spacings.

mod common;

use common::{SPACINGS, codes, compensated_errors, measure, phantom, poses};
use surfometry::Measurement;
use surfometry::phantoms::{
    Ball, Capsule, Ellipsoid, Genus, MinimalSurface, Periodic, Pose, RoundedBox, Shape, Shell, Torus,
    TwoBalls,
};

/// chi at sigma = 2 of the largest edge, whatever the spacing ratio.
#[test]
fn euler_characteristic_is_right_to_a_hundredth() {
    let measurement = Measurement::default().sigma_mm(2.0).thickness_mm(2.5);
    for spacing in SPACINGS {
        for pose in poses() {
            for (shape, chi) in [
                (Box::new(Torus { major: 30.0, minor: 10.0 }) as Box<dyn Shape>, 0.0),
                (Box::new(Ball { radius: 20.0 }), 2.0),
            ] {
                let measured = measure(&phantom(shape, pose, spacing), &measurement);
                let error = measured.blurred.euler_characteristic.unwrap() - chi;
                println!("{spacing:?} chi {chi}: {error:+.5}");
                assert!(error.abs() < 0.01, "{spacing:?}: chi off by {error}");
            }
        }
    }
}

/// Compensated V, A, M of shapes whose smallest radius is 10 of the largest voxel edge.
#[test]
fn compensated_integrals_describe_the_original_shape() {
    let shapes: [fn() -> Box<dyn Shape>; 5] = [
        || Box::new(Ball { radius: 10.0 }),
        || Box::new(Ball { radius: 20.0 }),
        // Smallest radius of curvature: 20^2 / 30 = 13.3; 17^2 / 26 = 11.1.
        || Box::new(Ellipsoid { radii: [30.0, 24.0, 20.0] }),
        || Box::new(Ellipsoid { radii: [26.0, 22.0, 17.0] }),
        || Box::new(Torus { major: 30.0, minor: 10.0 }),
    ];
    let mut worst = [0.0f64; 3];
    for spacing in SPACINGS {
        for shape in shapes {
            for pose in poses() {
                let phantom = phantom(shape(), pose, spacing);
                let errors = compensated_errors(&measure(&phantom, &sigma_two()), &phantom.truth().unwrap());
                println!("{spacing:?} V {:+.3} A {:+.3} M {:+.3} %", errors[0], errors[1], errors[2]);
                (0..3).for_each(|i| worst[i] = worst[i].max(errors[i].abs()));
            }
        }
    }
    println!("worst V {:.3} A {:.3} M {:.3} %", worst[0], worst[1], worst[2]);
    assert!(worst[0] < 0.4 && worst[1] < 0.3 && worst[2] < 0.3, "{worst:?}");
}

/// The same at automatic sigma and thickness, as far as sigma is at least the largest edge. Beyond (ratio 4
/// with two short edges: sigma 0.8) terraces are too high for what is taken off for them: the area is 0.5 %
/// low and M 0.5 % high (1 % both before), and the flag says so.
#[test]
fn automatic_lengths_keep_that_accuracy_until_they_are_flagged() {
    let shapes: [fn() -> Box<dyn Shape>; 3] = [
        || Box::new(Ball { radius: 10.0 }),
        || Box::new(Ellipsoid { radii: [26.0, 22.0, 17.0] }),
        || Box::new(Torus { major: 30.0, minor: 10.0 }),
    ];
    for spacing in SPACINGS {
        for shape in shapes {
            let phantom = phantom(shape(), poses()[0], spacing);
            let measured = measure(&phantom, &Measurement::default());
            let [volume, area, mean] = compensated_errors(&measured, &phantom.truth().unwrap());
            println!("{spacing:?} V {volume:+.3} A {area:+.3} M {mean:+.3} %");
            assert!(volume.abs() < 0.4, "{spacing:?} V {volume}");
            if codes(&measured).contains(&"sigma-below-spacing".to_owned()) {
                assert_eq!(spacing, [0.25, 0.25, 1.0]);
                assert!((-1.0..-0.3).contains(&area) && (0.2..0.9).contains(&mean), "A {area} M {mean}");
            } else {
                assert!(area.abs() < 0.3 && mean.abs() < 0.3, "{spacing:?} A {area} M {mean}");
            }
        }
    }
}

fn sigma_two() -> Measurement {
    Measurement::default().sigma_mm(2.0).thickness_mm(2.5)
}

/// Name, shape, bounds of the errors of V, A, M in %, bound of chi's error.
type Case = (&'static str, Box<dyn Shape>, [f64; 3], f64);

/// Every shape of the zoo: V, A, M, chi. Shapes whose curvature jumps (capsule, rounded box, genus) or whose
/// rims are sharp against sigma (the periodic ones) get what first-order compensation leaves of them.
#[test]
fn the_whole_zoo() {
    let zoo: [Case; 10] = [
        ("ball", Box::new(Ball { radius: 15.0 }), [0.3, 0.2, 0.2], 0.01),
        ("ellipsoid", Box::new(Ellipsoid { radii: [30.0, 20.0, 15.0] }), [0.3, 0.2, 0.3], 0.01),
        ("capsule", Box::new(Capsule { radius: 12.0, length: 40.0 }), [0.2, 0.2, 0.2], 0.01),
        ("torus", Box::new(Torus { major: 25.0, minor: 10.0 }), [0.2, 0.2, 0.2], 0.01),
        (
            "rounded box",
            Box::new(RoundedBox { radii: [30.0, 20.0, 15.0], radius: 10.0 }),
            [0.2, 0.2, 0.2],
            0.02,
        ),
        ("shell", Box::new(Shell { radius: 25.0, inner: 12.0 }), [0.2, 0.2, 0.4], 0.02),
        ("two balls", Box::new(TwoBalls { radius: 12.0, length: 40.0 }), [0.3, 0.3, 0.3], 0.02),
        ("genus 3", Box::new(Genus { genus: 3, major: 12.0, minor: 8.0 }), [0.4, 0.4, 0.5], 0.05),
        (
            "gyroid",
            Box::new(Periodic { surface: MinimalSurface::Gyroid, period: 60.0, size: 90.0 }),
            [1.5, 1.5, 3.0],
            0.1,
        ),
        (
            "schwarz-p",
            Box::new(Periodic { surface: MinimalSurface::SchwarzP, period: 40.0, size: 60.0 }),
            [0.3, 0.3, 0.4],
            0.02,
        ),
    ];
    let pose = Pose::new([17.0, 31.0, 12.0], [0.31, 0.17, 0.43]);
    let mut failures = Vec::new();
    for (name, shape, bounds, chi_bound) in zoo {
        let phantom = phantom(shape, pose, [1.0, 0.8, 0.6]);
        let measured = measure(&phantom, &Measurement::default().sigma_mm(1.8).thickness_mm(2.5));
        let truth = phantom.truth().expect("known");
        let errors = compensated_errors(&measured, &truth);
        let chi = measured.blurred.euler_characteristic.unwrap() - truth.euler_characteristic as f64;
        println!("{name}: V {:+.3} A {:+.3} M {:+.3} %, chi {chi:+.4}", errors[0], errors[1], errors[2]);
        let voxels = measured.topology.euler_characteristic_voxels_26;
        if (0..3).any(|i| errors[i].abs() > bounds[i]) || chi.abs() > chi_bound {
            failures.push(name);
        }
        assert_eq!(voxels, truth.euler_characteristic, "{name}: exact topology of the voxels");
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// The blur shrinks a convex body: V by (sigma^2 - band variance) M, A by 2 sigma^2 int H^2. Sign and size.
#[test]
fn plain_integrals_carry_the_known_bias() {
    for sigma in [1.5, 2.0, 3.0] {
        let phantom = phantom(Ball { radius: 25.0 }, poses()[0], [1.0, 0.7, 0.8]);
        let measured = measure(&phantom, &Measurement::default().sigma_mm(sigma).thickness_mm(2.5));
        let truth = phantom.truth().unwrap();
        let variance = 0.0327 * 2.5f64.powi(2);
        let volume = measured.blurred.volume_mm3.unwrap() - truth.volume;
        let expected = -(sigma * sigma - variance) * truth.total_mean_curvature;
        assert!(volume < 0.0 && (volume / expected - 1.0).abs() < 0.06, "sigma {sigma}: {volume} {expected}");
        let area = measured.blurred.surface_area_mm2.unwrap() - truth.surface_area;
        // int H^2 of a sphere is 4 pi; the band adds its variance times int K = 4 pi.
        let expected = -4.0 * std::f64::consts::PI * (2.0 * sigma * sigma - variance);
        assert!(area < 0.0 && (area / expected - 1.0).abs() < 0.06, "sigma {sigma}: {area} {expected}");
    }
}
