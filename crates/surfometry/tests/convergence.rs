//! Slopes: how errors shrink, not only that they are small.

mod common;

use common::{measure, phantom, poses};
use surfometry::Measurement;
use surfometry::embedding::{Embedding, GaussianEmbedding, TRUNCATION};
use surfometry::local_geometry::{Curvature, Differentiation, FiniteDifferences, GaussianDerivatives};
use surfometry::measurement::{Derivatives, Measured};
use surfometry::phantoms::{Ball, Torus};
use surfometry::tiling::TILE;
use surfometry::volume::{FieldImage, FieldValues, Grid};

fn slope(errors: &[(f64, f64)]) -> f64 {
    let (x, y): (Vec<f64>, Vec<f64>) = errors.iter().map(|(x, e)| (x.ln(), e.abs().ln())).unzip();
    let (mx, my) = (x.iter().sum::<f64>() / x.len() as f64, y.iter().sum::<f64>() / y.len() as f64);
    let cross: f64 = x.iter().zip(&y).map(|(a, b)| (a - mx) * (b - my)).sum();
    cross / x.iter().map(|a| (a - mx).powi(2)).sum::<f64>()
}

/// Fourth-order differences are of fourth order, inside the image and at its edge, on anisotropic grids.
#[test]
fn differences_converge_with_the_fourth_power() {
    let value =
        |p: [f64; 3]| (0.9 * p[0] + 0.3 * p[1]).sin() + (0.7 * p[1] - 0.4 * p[2]).cos() + 0.5 * p[2] * p[0];
    // H at one point by analytic derivatives of that function.
    let exact = |p: [f64; 3]| {
        let (a, b) = (0.9 * p[0] + 0.3 * p[1], 0.7 * p[1] - 0.4 * p[2]);
        let jet = surfometry::local_geometry::Jet {
            value: 0.0,
            gradient: [0.9 * a.cos() + 0.5 * p[2], 0.3 * a.cos() - 0.7 * b.sin(), 0.4 * b.sin() + 0.5 * p[0]],
            hessian: [
                -0.81 * a.sin(),
                -0.09 * a.sin() - 0.49 * b.cos(),
                -0.16 * b.cos(),
                -0.27 * a.sin(),
                0.5,
                0.28 * b.cos(),
            ],
        };
        Curvature::of(&jet).unwrap()
    };
    for (position, order) in [("inside", 3.8), ("at the edge", 3.8)] {
        let errors: Vec<(f64, f64)> = [0.05, 0.025, 0.0125]
            .into_iter()
            .map(|h| {
                let spacing = [h, 0.8 * h, 1.3 * h];
                let grid = Grid::axis_aligned([9; 3], spacing).unwrap();
                let point = |i: [usize; 3]| std::array::from_fn(|a| 0.3 + i[a] as f64 * spacing[a]);
                let values = (0..grid.voxel_count()).map(|o| value(point(grid.index_of(o))));
                let field = FieldImage::new(grid, FieldValues::F64(values.collect())).unwrap();
                let index = if position == "inside" { [4, 4, 4] } else { [0, 8, 1] };
                let band = FiniteDifferences::new(&field, spacing).band(&grid.index_box(), f64::INFINITY);
                let found = band.iter().find(|v| v.index == index.map(|i| i as i64)).unwrap();
                let (found, exact) = (Curvature::of(&found.jet).unwrap(), exact(point(index)));
                (
                    h,
                    (found.mean_curvature - exact.mean_curvature).abs()
                        + (found.gaussian_curvature - exact.gaussian_curvature).abs(),
                )
            })
            .collect();
        let slope = slope(&errors);
        println!("{position}: slope {slope:.2}, {errors:?}");
        assert!(slope > order, "{position}: {slope} {errors:?}");
    }
}

/// The blur's bias grows with sigma^2, what compensation leaves with sigma^4: so both are what they are said
/// to be.
#[test]
fn bias_is_quadratic_in_sigma_and_compensation_removes_that_order() {
    // Three poses and half voxels keep the grid's noise below the errors looked for.
    let phantoms = poses().map(|pose| phantom(Ball { radius: 20.0 }, pose, [0.5; 3]));
    let exact = phantoms[0].truth().unwrap().total_mean_curvature;
    let (mut plain, mut compensated) = (Vec::new(), Vec::new());
    for sigma in [3.6, 4.2, 4.8] {
        let m = Measurement::default().sigma_mm(sigma).thickness_mm(1.5).truncation(8.0);
        let results = phantoms.each_ref().map(|p| measure(p, &m));
        let mean = |value: fn(&Measured) -> Option<f64>| {
            results.iter().map(|r| value(r).unwrap()).sum::<f64>() / results.len() as f64 - exact
        };
        plain.push((sigma, mean(|r| r.blurred.total_mean_curvature_mm)));
        compensated.push((sigma, mean(|r| r.total_mean_curvature_mm)));
    }
    assert!(plain.iter().all(|(_, e)| *e < 0.0));
    println!("plain {plain:?}\ncompensated {compensated:?}");
    assert!((slope(&plain) - 2.0).abs() < 0.25, "plain {}", slope(&plain));
    assert!((slope(&compensated) - 4.0).abs() < 0.5, "compensated {}", slope(&compensated));
    // What is left is what the blurred ball's closed form leaves, 4 pi (r + sigma^2 / r - R) with r its level
    // 1/2: 1/2 (erf a + erf b) - sigma / (r sqrt(2 pi)) (exp(-a^2) - exp(-b^2)) = 1/2, a, b = (R -+ r) /
    // (sqrt2 sigma).
    for ((_, left), exact) in compensated.iter().zip([0.094_694, 0.180_436, 0.318_296]) {
        assert!((left / exact - 1.0).abs() < 0.06, "{left} {exact}");
    }
}

/// The plain sum's chi by finite differences falls with (h / sigma)^4; Gaussian derivatives are there at
/// once.
#[test]
fn euler_error_of_differences_falls_with_the_fourth_power_of_sigma() {
    let phantom = phantom(Torus { major: 30.0, minor: 10.0 }, poses()[0], [1.0; 3]);
    let chi = |sigma, derivatives| {
        let m = Measurement::default().sigma_mm(sigma).thickness_mm(2.5).derivatives(derivatives);
        measure(&phantom, &m).blurred.euler_characteristic.unwrap()
    };
    let errors: Vec<(f64, f64)> =
        [1.5, 1.75, 2.0].map(|s| (s, chi(s, Derivatives::FiniteDifference))).to_vec();
    println!("slope {:.2} {errors:?}", slope(&errors));
    assert!(errors.iter().all(|(_, e)| *e > 0.0), "differences overestimate chi: {errors:?}");
    assert!((-6.0..-3.5).contains(&slope(&errors)), "{}", slope(&errors));
    assert!(chi(1.5, Derivatives::Gaussian).abs() < 0.1 * errors[0].1);
}

/// Noise of local H from a mask falls with sigma at fixed spacing with about its third power.
#[test]
fn local_noise_falls_with_sigma() {
    let phantom = phantom(Ball { radius: 60.0 }, poses()[2], [1.0; 3]);
    let mask = phantom.labels().unwrap().mask(1);
    let noise = |sigma: f64| {
        let scheme = GaussianDerivatives::new(GaussianEmbedding::new(&mask, sigma, 0.5, TRUNCATION));
        let mut values = Vec::new();
        for tile in scheme.embedding().support(0.05).tiles(TILE) {
            values.extend(
                scheme.band(&tile, 0.05).iter().map(|v| Curvature::of(&v.jet).unwrap().mean_curvature),
            );
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    };
    let errors = [2.0, 3.0, 4.0].map(|s| (s, noise(s)));
    println!("slope {:.2} {errors:?}", slope(&errors));
    assert!((-3.6..-2.0).contains(&slope(&errors)), "{}", slope(&errors));
}
