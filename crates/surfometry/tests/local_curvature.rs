//! Local H and K against closed forms on rotated ellipsoids, and the paper's printed K, which must fail
//! there.

mod common;

use common::{phantom, poses};
use surfometry::embedding::{Embedding, GaussianEmbedding, TRUNCATION};
use surfometry::local_geometry::{
    BandVoxel, Curvature, Differentiation, FiniteDifferences, GaussianDerivatives, Jet,
};
use surfometry::phantoms::{Ellipsoid, Phantom};
use surfometry::tiling::TILE;
use surfometry::volume::{FieldImage, FieldValues};

const RADII: [f64; 3] = [40.0, 28.0, 22.0];

/// Gaussian and mean curvature of the ellipsoid through a point (do Carmo; Goldman 2005), in the ellipsoid's
/// frame.
fn closed_form(radii: [f64; 3], p: [f64; 3]) -> (f64, f64) {
    // The level set through p is the ellipsoid scaled by s.
    let s = (0..3).map(|a| (p[a] / radii[a]).powi(2)).sum::<f64>().sqrt();
    let r = radii.map(|v| v * s);
    let w: f64 = (0..3).map(|a| p[a].powi(2) / r[a].powi(4)).sum();
    let product: f64 = r.iter().product();
    let gaussian = 1.0 / (product * w).powi(2);
    let squares: f64 = r.iter().map(|v| v * v).sum();
    let radius: f64 = p.iter().map(|v| v * v).sum();
    let mean = (squares - radius) / (2.0 * product.powi(2) * w.powf(1.5));
    (mean, gaussian)
}

/// K as the paper's appendix prints it: the last term has phi_x phi_y where phi_x phi_z belongs.
fn printed_gaussian(jet: &Jet) -> f64 {
    let [x, y, z] = jet.gradient;
    let [xx, yy, zz, xy, xz, yz] = jet.hessian;
    (x * x * (yy * zz - yz * yz)
        + y * y * (xx * zz - xz * xz)
        + z * z * (xx * yy - xy * xy)
        + 2.0 * x * y * (xz * yz - xy * zz)
        + 2.0 * y * z * (xy * xz - yz * xx)
        + 2.0 * x * y * (xy * yz - xz * yy))
        / (x * x + y * y + z * z).powi(2)
}

fn band(scheme: &impl Differentiation, half_width: f64) -> Vec<BandVoxel> {
    let tiles = scheme.embedding().support(half_width).tiles(TILE);
    tiles.iter().flat_map(|tile| scheme.band(tile, half_width)).collect()
}

/// Root mean square errors of H, K and the printed K, relative to the largest principal curvature and its
/// square.
fn errors(phantom: &Phantom, band: &[BandVoxel]) -> [f64; 3] {
    let scale = RADII[0] / RADII[2].powi(2);
    let mut squares = [0.0; 3];
    for voxel in band {
        let world = phantom.grid().affine().apply(voxel.index.map(|i| i as f64));
        let (mean, gaussian) = closed_form(RADII, phantom.pose().to_shape(world));
        let curvature = Curvature::of(&voxel.jet).expect("a normal");
        squares[0] += ((curvature.mean_curvature - mean) / scale).powi(2);
        squares[1] += ((curvature.gaussian_curvature - gaussian) / scale.powi(2)).powi(2);
        squares[2] += ((printed_gaussian(&voxel.jet) - gaussian) / scale.powi(2)).powi(2);
    }
    squares.map(|s| (s / band.len() as f64).sqrt())
}

#[test]
fn differences_of_a_smooth_field_are_nearly_exact() {
    for pose in poses() {
        for spacing in [[1.0; 3], [0.8, 1.3, 2.0]] {
            let phantom = phantom(Ellipsoid { radii: RADII }, pose, spacing);
            let field = sampled(&phantom);
            let band = band(&FiniteDifferences::new(&field, spacing), 1.0);
            let [mean, gaussian, printed] = errors(&phantom, &band);
            println!("H {mean:.2e} K {gaussian:.2e}, printed K {printed:.2e}");
            // The function is a quadratic, on which fourth-order differences are exact.
            assert!(mean < 1e-9 && gaussian < 1e-9, "H {mean} K {gaussian}");
            assert!(printed > 0.01, "the paper's printed K must fail: {printed}");
        }
    }
}

fn sampled(phantom: &Phantom) -> FieldImage {
    let grid = *phantom.grid();
    let values = (0..grid.voxel_count()).map(|offset| {
        let world = grid.affine().apply(grid.index_of(offset).map(|i| i as f64));
        phantom.shape().value(phantom.pose().to_shape(world))
    });
    FieldImage::new(grid, FieldValues::F64(values.collect())).unwrap()
}

#[test]
fn gaussian_derivatives_of_a_mask_are_right_on_rotated_ellipsoids() {
    for pose in poses() {
        for spacing in [[1.0; 3], [1.0, 0.7, 0.5]] {
            let phantom = phantom(Ellipsoid { radii: RADII }, pose, spacing);
            let mask = phantom.labels().unwrap().mask(1);
            let embedding = GaussianEmbedding::new(&mask, 4.0, 0.5, TRUNCATION);
            // A thin band: voxels within about half a voxel of the surface.
            let band = band(&GaussianDerivatives::new(embedding), 0.05);
            let [mean, gaussian, printed] = errors(&phantom, &band);
            println!("H {mean:.4} K {gaussian:.4}, printed K {printed:.4}");
            assert!(mean < 0.05 && gaussian < 0.07, "H {mean} K {gaussian}");
            assert!(
                printed > 2.0 * gaussian,
                "the paper's printed K must fail: {printed} against {gaussian}"
            );
        }
    }
}

/// The band's voxels of a blurred mask see H too high on a convex body, by sigma^2 / R^2 of it.
#[test]
fn local_mean_curvature_of_a_ball_has_the_blurs_bias() {
    let (radius, sigma) = (20.0, 3.0);
    let phantom = phantom(surfometry::phantoms::Ball { radius }, poses()[1], [0.8, 1.0, 0.6]);
    let mask = phantom.labels().unwrap().mask(1);
    let band = band(&GaussianDerivatives::new(GaussianEmbedding::new(&mask, sigma, 0.5, TRUNCATION)), 0.04);
    let mean =
        band.iter().map(|v| Curvature::of(&v.jet).unwrap().mean_curvature).sum::<f64>() / band.len() as f64;
    let bias = mean * radius - 1.0;
    let expected = (sigma / radius).powi(2);
    assert!((bias / expected - 1.0).abs() < 0.15, "bias {bias}, expected {expected}");
}
