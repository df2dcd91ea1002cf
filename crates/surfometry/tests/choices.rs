//! What each choice does to the numbers: sign and size of its known effect against the truth.

mod common;

use common::{compensated_errors, measure, phantom, poses};
use surfometry::Measurement;
use surfometry::integrals::{QuadratureRule, Smearing};
use surfometry::measurement::Derivatives;
use surfometry::phantoms::{Ball, Phantom, Pose};

fn ball(radius: f64) -> Phantom {
    phantom(Ball { radius }, poses()[1], [1.0, 0.8, 0.9])
}

fn sigma_two() -> Measurement {
    Measurement::default().sigma_mm(2.0).thickness_mm(2.5)
}

/// The hyperbolic tangent has the sine's second moment, so where its narrow core is sampled it gives the same
/// numbers.
#[test]
fn tanh_agrees_with_sine_on_a_thick_enough_band() {
    let ball = ball(20.0);
    let truth = ball.truth().unwrap();
    for thickness in [3.5, 5.0] {
        let sine = measure(&ball, &sigma_two().thickness_mm(thickness));
        let tanh = measure(&ball, &sigma_two().thickness_mm(thickness).delta(Smearing::Tanh));
        for m in [&sine, &tanh] {
            let errors = compensated_errors(m, &truth);
            println!("t {thickness}: {errors:.3?} chi {:?}", m.blurred.euler_characteristic);
            assert!(errors.iter().all(|e| e.abs() < 0.25), "t {thickness}: {errors:?}");
            assert!((m.blurred.euler_characteristic.unwrap() - 2.0).abs() < 0.03);
        }
        let change = tanh.blurred.volume_mm3.unwrap() / sine.blurred.volume_mm3.unwrap() - 1.0;
        assert!(change.abs() < 1e-3, "{change}");
    }
}

/// At level T the surface lies where a blurred flat edge has that value: sqrt2 sigma erfinv(1 - 2 T) outward.
#[test]
fn the_level_moves_the_surface_by_the_edges_profile() {
    let (radius, sigma) = (30.0, 2.0);
    let ball = ball(radius);
    // Quantiles of the normal distribution: level 0.4 and 0.6 lie 0.253347 sigma from 0.5.
    for (level, shift) in [(0.4, 0.253_347), (0.5, 0.0), (0.6, -0.253_347)] {
        let m = measure(&ball, &sigma_two().level(level));
        // The blur's own shift is -sigma^2 / R; the band adds 0.0327 t^2 to r^2.
        let r = radius + shift * sigma - sigma * sigma / radius;
        let area = 4.0 * std::f64::consts::PI * (r * r + 0.0327 * 6.25);
        let found = m.blurred.surface_area_mm2.unwrap();
        println!("level {level}: {found} {area}");
        assert!((found / area - 1.0).abs() < 2e-3, "level {level}: {found} {area}");
    }
}

/// Fourth-order differences lose area: 0.2 % more than Gaussian derivatives at sigma = 2 voxels, and
/// more at 1.5, never less.
#[test]
fn differences_lose_area() {
    let ball = phantom(Ball { radius: 20.0 }, poses()[1], [1.0; 3]);
    let loss = |sigma| {
        let m = Measurement::default().sigma_mm(sigma).thickness_mm(2.5);
        let area = |d| measure(&ball, &m.derivatives(d)).blurred.surface_area_mm2.unwrap();
        1.0 - area(Derivatives::FiniteDifference) / area(Derivatives::Gaussian)
    };
    println!("{:.5} {:.5}", loss(2.0), loss(1.5));
    assert!((0.0018..0.0028).contains(&loss(2.0)), "{}", loss(2.0));
    assert!((0.004..0.008).contains(&loss(1.5)), "{}", loss(1.5));
}

/// Simpson's rule lets the 2 h grid's error in: the area scatters with the position on the grid, here by 0.7
/// % against the plain sum's 0.08 %, which is the sampled ball's own.
#[test]
fn simpson_scatters_with_the_grid() {
    let spread = |rule| {
        let areas: Vec<f64> = (0..6)
            .map(|i| {
                let shift = f64::from(i) / 6.0;
                let pose = Pose::new([0.0; 3], [shift, 0.7 * shift, 0.3 * shift]);
                let m = sigma_two().quadrature(rule);
                measure(&phantom(Ball { radius: 20.0 }, pose, [1.0; 3]), &m).blurred.surface_area_mm2.unwrap()
            })
            .collect();
        let mean = areas.iter().sum::<f64>() / areas.len() as f64;
        (areas.iter().map(|a| (a / mean - 1.0).powi(2)).sum::<f64>() / areas.len() as f64).sqrt()
    };
    let (sum, simpson) = (spread(QuadratureRule::Sum), spread(QuadratureRule::Simpson));
    println!("relative spread of the area: sum {sum:.1e}, Simpson {simpson:.1e}");
    assert!(sum < 1e-3 && simpson > 3.0 * sum, "{sum} {simpson}");
}
