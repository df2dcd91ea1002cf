//! Soft segmentations: shares of voxels of shapes with exact truth, masks, and what is neither.

mod common;

use common::{phantom, poses, rms};
use surfometry::Measurement;
use surfometry::measurement::Measured;
use surfometry::phantoms::{Ball, Ellipsoid, Phantom, Pose, Shape, Torus};
use surfometry::volume::ProbabilityImage;

/// Shares of the voxels that a shape fills, from 8 x 8 x 8 points in each.
fn occupancies(phantom: &Phantom) -> ProbabilityImage {
    const SIDE: usize = 8;
    let grid = *phantom.grid();
    let mask = phantom.labels().unwrap().mask(1);
    let inside =
        |index: [f64; 3]| phantom.shape().value(phantom.pose().to_shape(grid.affine().apply(index))) < 0.0;
    let share = |index: [i64; 3]| {
        let neighbours = (0..27).map(|n| [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1]);
        let here = mask.get(index);
        if neighbours.into_iter().all(|step| mask.get(std::array::from_fn(|a| index[a] + step[a])) == here) {
            return f32::from(u8::from(here));
        }
        let place = |n: usize| (n as f64 + 0.5) / SIDE as f64 - 0.5;
        let points = (0..SIDE.pow(3)).map(|n| [n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE]);
        let hits = points.filter(|p| inside(std::array::from_fn(|a| index[a] as f64 + place(p[a])))).count();
        hits as f32 / SIDE.pow(3) as f32
    };
    let values = (0..grid.voxel_count()).map(|n| share(grid.index_of(n).map(|v| v as i64))).collect();
    ProbabilityImage::new(grid, values).unwrap()
}

fn errors(measured: &Measured, phantom: &Phantom) -> [f64; 3] {
    common::compensated_errors(measured, &phantom.truth().unwrap())
}

/// rms over the vertices of H less that of the original surface beside them.
fn error_of_h(object: &surfometry::measurement::Object, phantom: &Phantom) -> f64 {
    let surface = object.surface();
    let pairs = surface.mesh.vertices.iter().zip(&surface.vertices);
    rms(pairs.map(|(v, g)| g.curvature.mean - phantom.surface_point(*v).unwrap().curvature.mean))
}

fn shapes(scale: f64) -> [(&'static str, Box<dyn Shape>); 3] {
    [
        ("ball", Box::new(Ball { radius: scale })),
        ("ellipsoid", Box::new(Ellipsoid { radii: [1.5 * scale, 1.2 * scale, scale] })),
        ("torus", Box::new(Torus { major: 2.2 * scale, minor: scale })),
    ]
}

#[test]
#[ignore]
fn study() {
    for spacing in [[1.0; 3], [0.7, 1.0, 1.6]] {
        for scale in [10.0, 14.0, 20.0, 28.0] {
            for number in 0..3 {
                for (n, pose) in poses().into_iter().enumerate().take(if scale > 20.0 { 1 } else { 3 }) {
                    let (name, shape) = shapes(scale).into_iter().nth(number).unwrap();
                    let phantom = phantom(shape, pose, spacing);
                    let image = occupancies(&phantom);
                    let mask = phantom.labels().unwrap().mask(1);
                    let m = Measurement::default();
                    let soft = m.prepare_probability(&image).unwrap();
                    let hard = m.prepare(&mask).unwrap();
                    let measured = soft.measure();
                    let e = errors(&measured, &phantom);
                    let eh = errors(&hard.measure(), &phantom);
                    let h = [error_of_h(&soft, &phantom), error_of_h(&hard, &phantom)];
                    println!(
                        "{spacing:?} {name} {scale} pose {n}: V A M soft {:+.4} {:+.4} {:+.4} %, mask {:+.4} {:+.4} {:+.4} %; H {:.5} {:.5} ratio {:.1} {:?}",
                        e[0],
                        e[1],
                        e[2],
                        eh[0],
                        eh[1],
                        eh[2],
                        h[0],
                        h[1],
                        h[1] / h[0],
                        common::codes(&measured)
                    );
                }
            }
        }
    }
}

#[test]
#[ignore]
fn study_errors() {
    let mut all: Vec<f64> = Vec::new();
    let mut seed = 0.0f64;
    let mut chance = move || {
        seed += 0.618_033_988_749;
        (seed * 7919.0).fract()
    };
    for spacing in [[1.0; 3], [0.8, 1.0, 1.3], [0.5, 0.5, 1.5]] {
        for sigma in [None, Some(1.5), Some(3.0)] {
            for scale in [8.0, 12.0, 17.0, 25.0] {
                for number in 0..3 {
                    let (name, shape) =
                        shapes(scale * (0.9 + 0.2 * chance())).into_iter().nth(number).unwrap();
                    let pose =
                        Pose::new([(); 3].map(|()| 180.0 * chance()), [(); 3].map(|()| chance() - 0.5));
                    let phantom = phantom(shape, pose, spacing);
                    let image = occupancies(&phantom);
                    let measured = Measurement::default().sigma_mm(sigma).run_probability(&image).unwrap();
                    let e = errors(&measured, &phantom);
                    let truth = phantom.truth().unwrap();
                    let se = measured.compensated.standard_error;
                    let se = [
                        se.volume_mm3.map(|v| v / truth.volume),
                        se.surface_area_mm2.map(|v| v / truth.surface_area),
                        se.total_mean_curvature_mm.map(|v| v / truth.total_mean_curvature),
                    ]
                    .map(|v| 100.0 * v.unwrap_or(f64::NAN));
                    let z: Vec<f64> = (0..3).map(|n| e[n] / se[n]).collect();
                    all.extend(&z);
                    println!(
                        "{spacing:?} {sigma:?} {name} {scale}: {:+.4} {:+.4} {:+.4} % se {:.4} {:.4} {:.4} z {:+.2} {:+.2} {:+.2} {:?}",
                        e[0],
                        e[1],
                        e[2],
                        se[0],
                        se[1],
                        se[2],
                        z[0],
                        z[1],
                        z[2],
                        common::codes(&measured)
                    );
                }
            }
        }
    }
    for n in 0..3 {
        let z: Vec<f64> = all.iter().skip(n).step_by(3).copied().filter(|z| z.is_finite()).collect();
        println!(
            "{n}: rms z {:.2}, within 2: {} of {}, max {:.2}",
            rms(z.iter().copied()),
            z.iter().filter(|z| z.abs() <= 2.0).count(),
            z.len(),
            z.iter().fold(0.0f64, |a, b| a.max(b.abs()))
        );
    }
}
