//! The classical estimators against exact shapes: right where they are right, off by what they are known to
//! be off.

mod common;

use common::{phantom, poses};
use surfometry::phantoms::{Ball, Ellipsoid, RoundedBox, Shape, Torus};
use surfometry::reference_methods::{BoneValues, METHODS, ReferenceValues};

fn by(name: &str, mask: &surfometry::volume::Mask) -> ReferenceValues {
    METHODS.iter().find(|method| method.name() == name).expect("a method").measure(mask)
}

const SHAPES: [fn() -> Box<dyn Shape>; 3] = [
    || Box::new(Ball { radius: 20.0 }),
    || Box::new(Ellipsoid { radii: [30.0, 22.0, 16.0] }),
    || Box::new(Torus { major: 28.0, minor: 11.0 }),
];

/// Errors of V, A and M in %, on the mean and at worst over shapes and poses.
fn errors(name: &str, spacing: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let (mut mean, mut worst, mut count) = ([0.0; 3], [0.0f64; 3], 0.0);
    for shape in SHAPES {
        for pose in poses() {
            let phantom = phantom(shape(), pose, spacing);
            let truth = phantom.truth().unwrap();
            let found = by(name, &phantom.labels().unwrap().mask(1));
            let pairs = [
                (found.volume_mm3, truth.volume),
                (found.surface_area_mm2, truth.surface_area),
                (found.total_mean_curvature_mm, truth.total_mean_curvature),
            ];
            for (n, (value, exact)) in pairs.into_iter().enumerate() {
                let error = value.map_or(f64::NAN, |v| 100.0 * (v / exact - 1.0));
                mean[n] += error;
                worst[n] = worst[n].max(error.abs());
            }
            count += 1.0;
        }
    }
    let mean = mean.map(|sum| sum / count);
    println!("{name} {spacing:?}: mean {mean:.2?}, worst {worst:.2?} %");
    (mean, worst)
}

/// 1.5 times the area at any resolution and spacing.
#[test]
fn faces_of_voxels() {
    for spacing in [[1.0; 3], [0.7, 0.9, 1.4]] {
        let ([volume, area, _], _) = errors("voxels", spacing);
        assert!(volume.abs() < 0.1 && (48.0..52.0).contains(&area), "{volume} {area}");
    }
}

/// 8.2 % too large on cubic voxels whatever the resolution (marching cubes' tables, which triangulate the
/// same vertices differently, 8.8; and the oracle test); and the mask smoothed by 0.8 voxel, which shrinks by
/// sigma^2 / R.
#[test]
fn triangulated_masks() {
    let ([volume, area, _], _) = errors("triangulation", [1.0; 3]);
    assert!(volume.abs() < 0.3 && (7.8..8.6).contains(&area), "{volume} {area}");
    let ([_, fine, _], _) = errors("triangulation", [0.5; 3]);
    assert!((fine - area).abs() < 0.3, "{fine} {area}");
    for spacing in [[1.0; 3], [0.7, 0.9, 1.2]] {
        let ([volume, area, mean], worst) = errors("triangulation-smoothed", spacing);
        assert!((-0.6..0.1).contains(&volume) && area.abs() < 1.5 && mean.abs() < 4.0, "{worst:?}");
    }
}

/// dA/dr is 2 M + r int K: one-sided differences of a ball are 4 pi r too large, of a torus not, but for the
/// terraces that 0.8 voxel leaves (0.2 % of M).
#[test]
fn one_sided_dilation_is_biased_by_the_integral_of_k() {
    for (shape, chi) in [(SHAPES[0](), 2.0), (SHAPES[2](), 0.0)] {
        let mask = phantom(shape, poses()[1], [1.0; 3]).labels().unwrap().mask(1);
        let of = |name: &str| by(name, &mask).total_mean_curvature_mm.unwrap();
        let apart = of("triangulation-smoothed-one-sided") - of("triangulation-smoothed");
        // Half of 0.5 mm times 2 pi chi.
        let expected = 0.25 * std::f64::consts::TAU * chi;
        assert!((-0.5..1.8).contains(&(apart - expected)), "{apart} {expected}");
    }
}

/// A ball has 4, a thin ring nearly 3 as a rod; and all what 12 V M / A^2 is of the exact shape.
#[test]
fn structure_model_indices() {
    let shapes: [(Box<dyn Shape>, Option<f64>); 3] = [
        (Box::new(Ball { radius: 20.0 }), Some(4.0)),
        (Box::new(Torus { major: 40.0, minor: 8.0 }), Some(3.0)),
        (Box::new(RoundedBox { radii: [45.0, 45.0, 8.0], radius: 5.0 }), None),
    ];
    for (shape, known) in shapes {
        let phantom = phantom(shape, poses()[1], [1.0; 3]);
        let truth = phantom.truth().unwrap();
        let exact = 12.0 * truth.volume * truth.total_mean_curvature / truth.surface_area.powi(2);
        assert!(known.is_none_or(|known| (exact - known).abs() < 1e-6), "{exact}");
        let found =
            by("triangulation-smoothed", &phantom.labels().unwrap().mask(1)).structure_model_index.unwrap();
        println!("SMI {found:.3}, exact {exact:.3}");
        assert!((found / exact - 1.0).abs() < 0.04, "{found} {exact}");
    }
}

/// Right on the mean over orientations, on cubic voxels to 0.1 and 0.3 % of shapes that have them all; where
/// spacings differ, thirteen directions are unevenly spread, and A is off by up to 1.5, M by up to 4 %. Three
/// directions scatter more.
#[test]
fn crofton_of_any_spacing() {
    for (spacing, most) in [([1.0; 3], [0.2, 0.4]), ([0.7, 0.9, 1.4], [2.0, 4.5])] {
        let ([volume, area, mean], [_, worst_area, worst_mean]) = errors("crofton-13", spacing);
        assert!(volume.abs() < 0.1 && area.abs() < 0.6 && mean.abs() < 1.0, "{area} {mean}");
        assert!(worst_area < most[0] && worst_mean < most[1], "{worst_area} {worst_mean}");
        let (_, [_, three, _]) = errors("crofton-3", spacing);
        assert!(three > worst_area && three < 12.0, "{three}");
    }
}

/// Without bias on planes of all directions, so on large curved shapes, at any spacing.
#[test]
fn lindblad_of_any_spacing() {
    for (spacing, most) in [([1.0; 3], 0.4), ([0.7, 0.9, 1.4], 1.5)] {
        let ([volume, area, _], [_, worst, _]) = errors("lindblad", spacing);
        assert!(volume.abs() < 0.1 && area.abs() < most && worst < 1.5 * most, "{area} {worst}");
    }
}

/// Twice scikit-image's `euler_number`, as `tests/oracles` shows of random masks; here of known shapes.
#[test]
fn euler_numbers() {
    for (shape, chi) in SHAPES.into_iter().zip([2.0, 2.0, 0.0]) {
        let mask = phantom(shape(), poses()[2], [1.0; 3]).labels().unwrap().mask(1);
        for name in ["odgaard-gundersen-26", "odgaard-gundersen-6", "triangulation", "triangulation-smoothed"]
        {
            assert_eq!(by(name, &mask).euler_characteristic, Some(chi), "{name}");
        }
        let bone = BoneValues::new(&by("triangulation", &mask), 1e6);
        assert!((bone.connectivity_density_per_mm3.unwrap() - (1.0 - 0.5 * chi) / 1e6).abs() < 1e-12);
    }
}
