//! Soft segmentations: shares of voxels of shapes with exact truth, masks, and what is neither.

mod common;

use common::{phantom, poses, rms};
use surfometry::Measurement;
use surfometry::accuracy::FlagCode;
use surfometry::measurement::{
    Clip, CurvatureScale, Derivatives, EmbeddingKind, MeasureError, Measured, Object,
};
use surfometry::phantoms::{Ball, Ellipsoid, Phantom, Pose, Shape, Torus};
use surfometry::runs::Plan;
use surfometry::volume::{Grid, ProbabilityImage, VolumeError};

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
fn error_of_h(object: &Object, phantom: &Phantom) -> f64 {
    let surface = object.surface();
    let pairs = surface.mesh.vertices.iter().zip(&surface.vertices);
    rms(pairs.map(|(v, g)| {
        g.curvature.mean_curvature - phantom.surface_point(*v).unwrap().curvature.mean_curvature
    }))
}

fn shapes(scale: f64) -> [(&'static str, Box<dyn Shape>); 3] {
    [
        ("ball", Box::new(Ball { radius: scale })),
        ("ellipsoid", Box::new(Ellipsoid { radii: [1.5 * scale, 1.2 * scale, scale] })),
        ("torus", Box::new(Torus { major: 2.2 * scale, minor: scale })),
    ]
}

const SPACINGS: [[f64; 3]; 2] = [[1.0; 3], [0.7, 1.0, 1.6]];

/// V, A and M of the original object are right to 0.05 % from radii of curvature of 7 sigma on, on unequal
/// spacings too, and H at the vertices has less than a third of the error that it has from the mask at the
/// same sigma.
#[test]
fn shares_of_voxels_tell_the_shape() {
    for (spacing, scale) in [(SPACINGS[0], 14.0), (SPACINGS[0], 20.0), (SPACINGS[1], 14.0)] {
        for ((name, shape), pose) in shapes(scale).into_iter().zip(poses()) {
            let phantom = phantom(shape, pose, spacing);
            let soft = Measurement::default().prepare_probability(occupancies(&phantom)).unwrap();
            let mask = Measurement::default().prepare(phantom.labels().unwrap().mask(1)).unwrap();
            let found = errors(&soft.measure(), &phantom);
            let [ours, masks] = [&soft, &mask].map(|object| error_of_h(object, &phantom));
            println!("{name} {scale} {spacing:?}: V A M {found:+.4?} %, H {ours:.5} (mask {masks:.5})");
            assert!(found.iter().all(|error| error.abs() < 0.05), "{name} {scale} {spacing:?}: {found:?}");
            assert!(3.0 * ours < masks, "{name} {scale} {spacing:?}: {ours} {masks}");
        }
    }
}

/// What is left at smaller radii is the blur's, of order sigma^4: at a radius of 5 sigma up to 0.1 %, and
/// with a narrower blur, which no terraces forbid, 0.05 % again.
#[test]
fn what_is_left_at_small_radii_is_the_blurs() {
    for ((name, shape), pose) in shapes(10.0).into_iter().zip(poses()) {
        let phantom = phantom(shape, pose, [1.0; 3]);
        let image = occupancies(&phantom);
        for (sigma, bound) in [(2.0, 0.1), (1.5, 0.05)] {
            let measured = Measurement::default().sigma_mm(sigma).run_probability(&image).unwrap();
            let found = errors(&measured, &phantom);
            println!("{name} sigma {sigma}: V A M {found:+.4?} %");
            assert!(found.iter().all(|error| error.abs() < bound), "{name} {sigma}: {found:?}");
        }
    }
}

/// Noise alone, on a ball of 5 sigma, whose blurred surface has the same curvature everywhere: a tenth of the
/// mask's.
#[test]
fn curvature_has_a_tenth_of_the_masks_noise() {
    let phantom = phantom(Ball { radius: 10.0 }, poses()[1], [1.0; 3]);
    let soft = Measurement::default().prepare_probability(occupancies(&phantom)).unwrap();
    let mask = Measurement::default().prepare(phantom.labels().unwrap().mask(1)).unwrap();
    let [ours, masks] = [soft, mask].map(|object| {
        let found: Vec<f64> = object.surface().vertices.iter().map(|v| v.curvature.mean_curvature).collect();
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        rms(found.into_iter().map(|h| h - mean))
    });
    println!("{ours:.6} {masks:.6}");
    assert!(10.0 * ours < masks, "{ours} {masks}");
}

/// An image of zeros and ones is a mask: all numbers, codes of flags and the surface are the same, to the bit.
#[test]
fn zeros_and_ones_are_a_mask() {
    let phantom = phantom(Torus { major: 14.0, minor: 6.0 }, poses()[0], [0.9, 1.0, 1.2]);
    let mask = phantom.labels().unwrap().mask(1);
    let image = ProbabilityImage::from_slabs(&mut phantom.slabs()).unwrap();
    let m = Measurement::default();
    let kinds = [Derivatives::Matched, Derivatives::Gaussian, Derivatives::FiniteDifference];
    for m in [m, m.derivatives(kinds[1]), m.derivatives(kinds[2]), m.sigma_mm(1.3), m.level(0.4)] {
        let (soft, hard) = (m.prepare_probability(&image).unwrap(), m.prepare(&mask).unwrap());
        let (mut found, expected) = (soft.measure(), hard.measure());
        assert_eq!(found.parameters.embedding, EmbeddingKind::Probability);
        found.parameters.embedding = EmbeddingKind::Gaussian;
        found.timings = expected.timings;
        // What helps is another embedding for masks alone.
        for (soft, hard) in found.flags.iter_mut().zip(&expected.flags) {
            soft.message.clone_from(&hard.message);
        }
        assert_eq!(found, expected);
        assert_eq!(soft.surface(), hard.surface());
    }
}

/// How many of V, A and M lie within two standard errors, and of how many cases, in poses and sizes that follow
/// from a seed.
fn within_two_errors(seed: f64) -> ([usize; 3], usize) {
    let mut number = 0.0f64;
    let mut chance = move || {
        number += 0.618_033_988_749;
        (number * 7919.0 + seed).fract()
    };
    let mut within = [0; 3];
    let mut cases = 0;
    for spacing in [[1.0; 3], [0.8, 1.0, 1.3], [0.6, 0.6, 1.2], [0.5, 0.5, 1.5]] {
        for sigma in [1.4, 2.3] {
            for (name, shape) in shapes(8.0 + 8.0 * chance()) {
                let pose = Pose::new([(); 3].map(|()| 180.0 * chance()), [(); 3].map(|()| chance() - 0.5));
                let phantom = phantom(shape, pose, spacing);
                let measured =
                    Measurement::default().sigma_mm(sigma).run_probability(occupancies(&phantom)).unwrap();
                let (found, truth) = (errors(&measured, &phantom), phantom.truth().unwrap());
                let bars = &measured.standard_error;
                let bars = [
                    bars.volume_mm3.unwrap() / truth.volume,
                    bars.surface_area_mm2.unwrap() / truth.surface_area,
                    bars.total_mean_curvature_mm.unwrap() / truth.total_mean_curvature,
                ];
                let shares: [f64; 3] = std::array::from_fn(|n| found[n] / (100.0 * bars[n]));
                println!("{name} {spacing:?} {sigma}: {found:+.4?} %, in standard errors {shares:+.2?}");
                (0..3).for_each(|n| within[n] += usize::from(shares[n].abs() <= 2.0));
                cases += 1;
            }
        }
    }
    (within, cases)
}

/// Standard errors hold on shapes, poses and spacings that nothing was fitted to, and V's are a fraction of a
/// mask's. SOFT_SEEDS, a list of numbers between 0 and 1, tries others.
#[test]
fn standard_errors_hold() {
    let seeds = std::env::var("SOFT_SEEDS").unwrap_or_else(|_| "0.61".to_owned());
    for seed in seeds.split(',').map(|seed| seed.parse().unwrap()) {
        let (within, cases) = within_two_errors(seed);
        println!("seed {seed}: {within:?} of {cases}");
        assert!(within.iter().all(|&n| 20 * n >= 19 * cases), "{within:?} of {cases}");
    }
    let ball = phantom(Ball { radius: 25.0 }, poses()[2], [1.0; 3]);
    let soft = Measurement::default().run_probability(occupancies(&ball)).unwrap();
    let hard = common::measure(&ball, &Measurement::default());
    let [soft, hard] = [soft, hard].map(|measured| measured.standard_error.volume_mm3.unwrap());
    assert!(10.0 * soft < hard, "{soft} {hard}");
}

/// An edge that is wider than a voxel is told of, and has no standard errors: compensation takes nothing off
/// but the voxels' own blur.
#[test]
fn edges_softer_than_voxels_are_told_of() {
    let phantom = phantom(Ball { radius: 14.0 }, poses()[0], [1.0; 3]);
    let grid = *phantom.grid();
    let centre = phantom.pose().shift();
    let distance = |index: [usize; 3]| {
        let p = grid.affine().apply(index.map(|v| v as f64));
        (0..3).map(|a| (p[a] - centre[a]).powi(2)).sum::<f64>().sqrt() - 14.0
    };
    let image = |width: f64| {
        let value = |n| (1.0 / (1.0 + (distance(grid.index_of(n)) / width).exp())) as f32;
        ProbabilityImage::new(grid, (0..grid.voxel_count()).map(value).collect()).unwrap()
    };
    let flagged = |measured: &Measured| common::codes(measured).contains(&"softer-than-voxels".to_owned());
    let soft = Measurement::default().run_probability(image(0.6)).unwrap();
    assert!(flagged(&soft) && soft.standard_error.volume_mm3.is_none());
    assert!(common::codes(&soft).contains(&"not-computed".to_owned()));
    let as_voxels = Measurement::default().run_probability(image(0.159)).unwrap();
    assert!(!flagged(&as_voxels) && as_voxels.standard_error.volume_mm3.is_some());
}

/// Voxels are those above the level, and a soft segmentation is compared with the sum of its values.
#[test]
fn voxels_are_those_above_the_level() {
    let phantom = phantom(Ball { radius: 9.0 }, poses()[0], [1.0; 3]);
    let image = occupancies(&phantom);
    for level in [0.25, 0.5, 0.75] {
        let object = Measurement::default().level(level).prepare_probability(&image).unwrap();
        assert_eq!(object.mask(), &image.above(level));
        assert_eq!(object.measure().voxels.count, image.above(level).voxels());
    }
    // A block of which every voxel is 0.6 has 1.7 times as many voxels above 1/2 as its values add up to.
    let grid = Grid::axis_aligned([40; 3], [1.0; 3]).unwrap();
    let block = |value: f32| {
        let inside = |n| grid.index_of(n).iter().all(|v| (10..30).contains(v));
        let values = (0..grid.voxel_count()).map(|n| if inside(n) { value } else { 0.0 }).collect();
        ProbabilityImage::new(grid, values).unwrap()
    };
    let measured = Measurement::default().run_probability(block(0.6)).unwrap();
    assert_eq!(measured.voxels.count, 8000);
    let thin = measured.flags.iter().find(|flag| flag.code == FlagCode::ThinForSigma).unwrap();
    let off = measured.volume_mm3.unwrap() / (f64::from(0.6f32) * 8000.0) - 1.0;
    assert!(thin.message.contains(&format!("{:+.1} %", 100.0 * off)), "{} {off}", thin.message);
}

/// Maps of the original object's curvature too: the corrected embedding of the values, at a scale that it
/// finds itself.
#[test]
fn local_curvature_of_the_original_object() {
    let phantom = phantom(Ellipsoid { radii: [16.0, 13.0, 11.0] }, poses()[0], [1.0; 3]);
    let image = occupancies(&phantom);
    let m = Measurement::default();
    let plain = m.prepare_probability(&image).unwrap();
    let local = m.for_local_curvature_of_probability(&image, CurvatureScale::Auto).unwrap();
    let corrected = local.prepare_probability(&image).unwrap();
    assert_eq!(corrected.parameters().embedding, EmbeddingKind::Corrected);
    let [before, after] = [&plain, &corrected].map(|object| error_of_h(object, &phantom));
    println!("H off by {before:.5}, corrected {after:.5} at sigma {:?}", corrected.parameters().sigma_mm);
    assert!(after < 0.7 * before, "{before} {after}");
    assert!(corrected.surface().vertices.iter().all(|vertex| vertex.errors.is_some()));
    assert!(plain.surface().vertices.iter().all(|vertex| vertex.displacement.is_some()));
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let grid = Grid::axis_aligned([20; 3], [1.0; 3]).unwrap();
    let image = |value: f32| ProbabilityImage::new(grid, vec![value; 8000]).unwrap();
    let m = Measurement::default();
    let low = m.run_probability(image(0.5)).unwrap_err();
    assert!(matches!(low, MeasureError::Volume(VolumeError::NothingAbove { .. })), "{low}");
    assert!(m.level(0.3).run_probability(image(0.5)).is_ok());
    let cut = m.clip(Clip::Exclude).run_probability(image(1.0));
    assert!(matches!(cut, Err(MeasureError::Conflict(_))));
    let mask = image(1.0).above(0.5);
    let bits = m.embedding(EmbeddingKind::Probability).run(mask);
    assert!(matches!(bits, Err(MeasureError::Conflict(text)) if text.contains("run_probability")));
    let plan = Plan { measurement: m.embedding(EmbeddingKind::Probability), ..Plan::default() };
    assert!(plan.check().is_ok());
    assert!(Plan { per_component: true, ..plan.clone() }.check().is_err());
    assert!(Plan { labels: "2".parse().unwrap(), ..plan }.check().is_err());
}
