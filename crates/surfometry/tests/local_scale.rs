//! A scale at each vertex, against exact shapes.

mod common;

use common::{phantom, poses, rms};
use surfometry::Measurement;
use surfometry::measurement::CurvatureScale;
use surfometry::phantoms::{Ellipsoid, Phantom, Torus};
use surfometry::surface::Surface;
use surfometry::volume::{Grid, Mask, ProbabilityImage};

fn surface(mask: &Mask, scale: CurvatureScale) -> Surface {
    Measurement::default().for_local_curvature(mask, scale).unwrap().prepare(mask).unwrap().surface()
}

/// Rms errors of H in % of 1/R, of K in % of 1/R^2, of the place in mm, and the shares of vertices in % where H,
/// K, k1 and the shape index lie within their bars.
fn errors(phantom: &Phantom, surface: &Surface) -> ([f64; 3], [f64; 4]) {
    let curvature = phantom.rms_curvature();
    let (mut parts, mut covered, mut total) = ([Vec::new(), Vec::new(), Vec::new()], [0.0; 4], 0.0);
    for (place, vertex) in surface.mesh.vertices.iter().zip(&surface.vertices).step_by(3) {
        let point = phantom.surface_point(*place).unwrap();
        let (found, exact, bars) = (vertex.curvature, point.curvature, vertex.errors.unwrap());
        let mean = found.mean_curvature - exact.mean_curvature;
        let gaussian = found.gaussian_curvature - exact.gaussian_curvature;
        let errors = [
            (mean, bars.mean_curvature),
            (gaussian, bars.gaussian_curvature),
            (found.principal()[0] - exact.principal()[0], bars.principal),
            (found.shape_index() - exact.shape_index(), bars.shape_index),
        ];
        for (covered, (error, bar)) in covered.iter_mut().zip(errors) {
            *covered += f64::from(u8::from(error.abs() <= 1.96 * f64::from(bar)));
        }
        parts[0].push(100.0 * mean / curvature);
        parts[1].push(100.0 * gaussian / (curvature * curvature));
        parts[2].push(point.distance);
        total += 1.0;
    }
    (parts.map(|part| rms(part.into_iter())), covered.map(|sum| 100.0 * sum / total))
}

/// Ellipsoids and tori, turned, on cubic and on unequal voxels: H within 3.3, K within 4.7 % (those of one scale
/// for all have 1.4 to 3 times that), the surface in its place, and bars that hold.
#[test]
fn smooth_shapes_are_better_than_with_one_scale() {
    for (number, pose) in poses().into_iter().enumerate() {
        let spacing = [[1.0; 3], [1.0, 0.8, 0.6], [0.5, 1.0, 0.5]][number];
        let ellipsoid = phantom(Ellipsoid { radii: [20.0, 15.0, 10.0] }, pose, spacing);
        let mask = ellipsoid.labels().unwrap().mask(1);
        let [one, own] = [CurvatureScale::Object, CurvatureScale::Local]
            .map(|scale| errors(&ellipsoid, &surface(&mask, scale)));
        println!("ellipsoid {spacing:?}: one {one:.3?}, own {own:.3?}");
        let ([mean, gaussian, place], covered) = own;
        assert!(mean < 3.3 && gaussian < 4.7 && place < 0.05, "{own:?}");
        assert!(
            mean < 0.7 * one.0[0] && gaussian < 0.8 * one.0[1] && place < 0.7 * one.0[2],
            "{one:?} {own:?}"
        );
        assert!(covered.iter().all(|&share| share > 90.0), "{covered:?}");
        let torus = phantom(Torus { major: 18.0, minor: 8.0 }, pose, spacing);
        let ([mean, gaussian, place], covered) =
            errors(&torus, &surface(&torus.labels().unwrap().mask(1), CurvatureScale::Local));
        println!("torus {spacing:?}: {mean:.2} {gaussian:.2} {place:.3} {covered:.0?}");
        assert!(mean < 2.0 && gaussian < 3.0 && place < 0.05 && covered.iter().all(|&share| share > 90.0));
    }
}

/// A mask of cubic voxels of 1 mm whose inside is where a function is negative, about a middle off the grid.
fn mask_of(edge: usize, inside: impl Fn([f64; 3]) -> bool) -> Mask {
    let middle = edge as f64 / 2.0;
    let shift = [0.31, 0.17, -0.22];
    Mask::from_predicate(Grid::axis_aligned([edge; 3], [1.0; 3]).unwrap(), |index| {
        inside(std::array::from_fn(|a| index[a] as f64 - middle - shift[a]))
    })
}

/// A ball of 24 with a dimple 3 deep and 4 wide in the direction (1, 2, 2): at its bottom H is -0.199. A scale
/// that a pilot at a larger one chose saw nothing of it. What is found is too flat by 10 to 40 %, a known bias,
/// and the bars say so.
#[test]
fn a_dimple_is_seen() {
    let (radius, depth, width) = (24.0, 3.0, 4.0);
    let axis = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
    let mask = mask_of(60, |p| {
        let r = p.iter().map(|v| v * v).sum::<f64>().sqrt();
        let cosine = p.iter().zip(axis).map(|(v, a)| v * a).sum::<f64>() / r.max(1e-9);
        let arc = radius * cosine.clamp(-1.0, 1.0).acos();
        r < radius - depth * (-arc * arc / (2.0 * width * width)).exp()
    });
    // k = 1/r - r'' / r^2 with derivatives by the angle, at the bottom.
    let bottom = radius - depth;
    let exact = 1.0 / bottom - depth * (radius / width).powi(2) / (bottom * bottom);
    let lowest = |scale| {
        let surface = surface(&mask, scale);
        let at = |place: &[f64; 3]| {
            let from: [f64; 3] = std::array::from_fn(|a| place[a] - 30.0 - [0.31, 0.17, -0.22][a]);
            (0..3).map(|a| (from[a] - bottom * axis[a]).powi(2)).sum::<f64>()
        };
        let nearest = (0..surface.vertices.len())
            .min_by(|&a, &b| at(&surface.mesh.vertices[a]).total_cmp(&at(&surface.mesh.vertices[b])));
        surface.vertices[nearest.unwrap()]
    };
    let [one, own] = [CurvatureScale::Object, CurvatureScale::Local].map(lowest);
    let (found, bar) = (own.curvature.mean_curvature, f64::from(own.errors.unwrap().mean_curvature));
    println!("exact {exact:.3}, one {:.3}, own {found:.3} +- {bar:.3}", one.curvature.mean_curvature);
    assert!(one.curvature.mean_curvature > 0.3 * exact);
    assert!((0.6..0.9).contains(&(found / exact)), "{found} {exact}");
    assert!((found - exact).abs() < 1.96 * bar);
}

/// Balls of 26 and 6 in one mask: both have their curvature and place, where one scale took a voxel off the
/// small one.
#[test]
fn a_small_ball_beside_a_large_one() {
    let (small, far) = (6.0, [0.0, 0.0, 37.0]);
    let mask = mask_of(100, |p| {
        let distance = |c: [f64; 3]| (0..3).map(|a| (p[a] - c[a]).powi(2)).sum::<f64>().sqrt();
        distance([0.0; 3]) < 26.0 || distance(far) < small
    });
    let at = |scale| {
        let surface = surface(&mask, scale);
        let centre: [f64; 3] = std::array::from_fn(|a| 50.0 + [0.31, 0.17, -0.22][a] + far[a]);
        let distance = |p: &[f64; 3]| (0..3).map(|a| (p[a] - centre[a]).powi(2)).sum::<f64>().sqrt();
        let near = surface.mesh.vertices.iter().zip(&surface.vertices).filter(|(p, _)| distance(p) < 9.0);
        let (places, curvatures): (Vec<f64>, Vec<f64>) =
            near.map(|(p, v)| (distance(p) - small, v.curvature.mean_curvature * small - 1.0)).unzip();
        (rms(places.into_iter()), rms(curvatures.into_iter()))
    };
    let ((shift, _), (place, curvature)) = (at(CurvatureScale::Object), at(CurvatureScale::Local));
    println!("one scale {shift:.2} voxels off, own {place:.3}, H {:.1} % off", 100.0 * curvature);
    assert!(shift > 0.5 && place < 0.08 && curvature < 0.05, "{shift} {place} {curvature}");
}

/// Noise is not given back: a mask with a twentieth of the voxels beside its boundary flipped has one scale, the
/// one that the object has, to the bit; so has a soft segmentation.
#[test]
fn noisy_and_soft_objects_have_one_scale() {
    let clean = mask_of(40, |p| p.iter().map(|v| v * v).sum::<f64>() < 196.0);
    let mut state = 1u64;
    let mut chance = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let near = |index: [usize; 3]| {
        let square: f64 = (0..3).map(|a| (index[a] as f64 - 20.0 - [0.31, 0.17, -0.22][a]).powi(2)).sum();
        (square.sqrt() - 14.0).abs() < 0.8
    };
    let bits: Vec<bool> = (0..64_000)
        .map(|n| {
            let index = [n % 40, n / 40 % 40, n / 1600];
            let flipped = chance() < 0.05 && near(index);
            clean.get(index.map(|i| i as i64)) != flipped
        })
        .collect();
    let noisy = Mask::from_predicate(*clean.grid(), |[x, y, z]| bits[x + 40 * y + 1600 * z]);
    assert_eq!(surface(&noisy, CurvatureScale::Local), surface(&noisy, CurvatureScale::Object));
    let values = bits.iter().map(|&bit| f32::from(u8::from(bit))).collect();
    let soft = ProbabilityImage::new(*clean.grid(), values).unwrap();
    let [own, one] = [CurvatureScale::Local, CurvatureScale::Object]
        .map(|scale| Measurement::default().for_local_curvature_of_probability(&soft, scale).unwrap());
    assert_eq!(own, one);
    let own = surface(&clean, CurvatureScale::Local);
    assert_eq!(own, surface(&clean, CurvatureScale::Auto));
    assert!(own.vertices.iter().all(|v| v.curvature_sigma.is_some_and(|sigma| (1.5..8.1).contains(&sigma))));
    let named = |surface: &Surface| surface.arrays().iter().any(|array| array.name == "curvature_sigma_mm");
    assert!(named(&own) && !named(&surface(&clean, CurvatureScale::Object)));
}

/// One thread and two give the same bits.
#[test]
fn threads_do_not_change_a_bit() {
    let pose = poses()[1];
    let mask =
        phantom(Ellipsoid { radii: [14.0, 10.0, 7.0] }, pose, [1.0, 0.8, 0.9]).labels().unwrap().mask(1);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| surface(&mask, CurvatureScale::Local))
    };
    assert_eq!(on(1), on(2));
}
