//! Parts of objects by the regions of another image, against closed forms, off the grid and on other lattices.

mod common;

use common::{SPACINGS, phantom, poses};
use std::f64::consts::PI;
use surfometry::Measurement;
use surfometry::measurement::{Measured, Object, RegionPart, Regions, SurfaceValues};
use surfometry::phantoms::{Ball, Capsule, Ellipsoid, Shape, Torus};
use surfometry::volume::{Affine, Grid, LabelImage, LabelTable};

/// What a function says of the world, on a turned lattice around its origin.
fn regions(half: f64, spacing: [f64; 3], region: impl Fn([f64; 3]) -> u8) -> Regions {
    let (sin, cos) = 0.35f64.sin_cos();
    let turned = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, -1.0]];
    let dimensions = spacing.map(|h| 2 * (half / h) as usize + 2);
    let mut affine = Affine::from_directions(turned, spacing, [0.0; 3]);
    let middle = affine.apply(dimensions.map(|n| 0.5 * n as f64 - 0.37));
    affine.origin = middle.map(|v| -v);
    let grid = Grid::new(dimensions, affine).unwrap();
    let voxel = |n: usize| region(affine.apply(grid.index_of(n).map(|i| i as f64)));
    let voxels: Vec<u8> = (0..grid.voxel_count()).map(voxel).collect();
    let names = [(1, "below".to_owned()), (2, "above".to_owned())].into_iter().collect::<LabelTable>();
    Regions::new(LabelImage::from_voxels(grid, &voxels).unwrap(), names).unwrap()
}

fn object(
    shape: impl Shape + 'static,
    pose: usize,
    spacing: [f64; 3],
    choices: &Measurement,
) -> (Object, Measured) {
    let mask = phantom(shape, poses()[pose], spacing).labels().unwrap().mask(1);
    let object = choices.prepare(mask).unwrap();
    let measured = object.measure();
    (object, measured)
}

fn four(values: &SurfaceValues) -> [Option<f64>; 4] {
    [
        values.volume_mm3,
        values.surface_area_mm2,
        values.total_mean_curvature_mm,
        values.total_gaussian_curvature,
    ]
}

/// The numbers of a part.
type OfPart = fn(&RegionPart) -> &SurfaceValues;

fn assert_adds_up(parts: &[RegionPart], measured: &Measured) {
    let pick: [(OfPart, &SurfaceValues); 2] =
        [(|part| &part.values, &measured.values), (|part| &part.blurred, &measured.blurred.values)];
    for (of, whole) in pick {
        for (n, whole) in four(whole).into_iter().enumerate() {
            let sum: Option<f64> = parts.iter().map(|part| four(of(part))[n]).sum();
            let (sum, whole) = (sum.unwrap(), whole.unwrap());
            assert!((sum - whole).abs() <= 1e-9 * whole.abs().max(1.0), "{n}: {sum} for {whole}");
        }
    }
    assert_eq!(parts.iter().map(|part| part.voxels).sum::<u64>(), measured.voxels.count);
}

/// A ball cut by planes: caps and zones have V, A, M and the integral of K in closed form. Their errors hold them.
#[test]
fn slices_of_a_ball() {
    let (mut scores, mut smallest) = (Vec::new(), f64::INFINITY);
    for (n, spacing) in SPACINGS.into_iter().enumerate() {
        let h = spacing.iter().copied().fold(0.0, f64::max);
        let r = 16.0 * h;
        let normal = [[0.36, 0.48, 0.8], [0.0, 0.6, -0.8], [0.0, 0.0, 1.0]][n % 3];
        let (object, measured) = object(Ball { radius: r }, n % 3, spacing, &Measurement::default());
        let middle = poses()[n % 3].shift();
        let height = |p: [f64; 3]| (0..3).map(|a| normal[a] * (p[a] - middle[a])).sum::<f64>();
        let cuts = [-0.4 * r, 0.3 * r];
        // Above the upper cut there is no region.
        let region = |p: [f64; 3]| match height(p) {
            z if z < cuts[0] => 1,
            z if z < cuts[1] => 2,
            _ => 0,
        };
        let map = regions(1.6 * r, [0.9 * h, 0.6 * h, 1.3 * h], region);
        let parts = object.regions(&measured, &map);
        assert_adds_up(&parts, &measured);
        let ends = [[cuts[1], r], [-r, cuts[0]], cuts];
        let names = [None, Some("below"), Some("above")];
        assert_eq!(parts.iter().map(|part| part.region).collect::<Vec<_>>(), [0, 1, 2]);
        for ((part, [low, high]), name) in parts.iter().zip(ends).zip(names) {
            assert_eq!(part.name.as_deref(), name);
            let area = 2.0 * PI * r * (high - low);
            let primitive = |z: f64| PI * (r * r * z - z.powi(3) / 3.0);
            let exact = [primitive(high) - primitive(low), area, area / r, area / (r * r)];
            let found = four(&part.values).into_iter().zip(four(&part.standard_error)).zip(exact);
            for (n, ((value, error), exact)) in found.enumerate() {
                let (off, error) = (value.unwrap() - exact, error.unwrap());
                println!(
                    "{spacing:?} part {} number {n}: {:+.2} % z {:+.2}",
                    part.region,
                    100.0 * off / exact,
                    off / error
                );
                // A border along the grid is anywhere within a voxel of both lattices, all of it: numbers are off by that.
                let bound = if normal[2] == 1.0 { 2.0 * error } else { 0.04 * exact };
                assert!(off.abs() < bound, "{spacing:?} part {} number {n}: {off} of {exact}", part.region);
                assert!(
                    error < 0.15 * exact,
                    "{spacing:?} part {} number {n}: {error} of {exact}",
                    part.region
                );
                scores.push(off / error);
                smallest = smallest.min(error / exact);
            }
        }
    }
    let within = scores.iter().filter(|z| z.abs() <= 2.0).count() as f64 / scores.len() as f64;
    println!("{} numbers, within two errors {within:.3}, smallest error {smallest:.4}", scores.len());
    assert!(within >= 0.95, "{within}");
}

/// Regions that were painted into the object alone, with nothing or a neighbour around it: half of the band lies there, and belongs
/// to the object's regions all the same.
#[test]
fn regions_that_end_with_the_object() {
    for (n, spacing) in SPACINGS.into_iter().enumerate() {
        let h = spacing.iter().copied().fold(0.0, f64::max);
        let r = 16.0 * h;
        let (object, measured) = object(Ball { radius: r }, n % 3, spacing, &Measurement::default());
        let (middle, normal) = (poses()[n % 3].shift(), [0.36, 0.48, 0.8]);
        let height = |p: [f64; 3]| (0..3).map(|a| normal[a] * (p[a] - middle[a])).sum::<f64>();
        let cut = -0.4 * r;
        for around in [0, 9] {
            let grid = *object.grid();
            let voxel = |n: usize| {
                let index = grid.index_of(n);
                let below = height(grid.affine().apply(index.map(|i| i as f64))) < cut;
                if object.mask().get(index.map(|i| i as i64)) { 2 - u8::from(below) } else { around }
            };
            let voxels: Vec<u8> = (0..grid.voxel_count()).map(voxel).collect();
            let painted =
                Regions::new(LabelImage::from_voxels(grid, &voxels).unwrap(), LabelTable::default());
            let parts = object.regions(&measured, &painted.unwrap());
            assert_adds_up(&parts, &measured);
            assert_eq!(
                parts.iter().map(|part| part.region).collect::<Vec<_>>(),
                [1, 2],
                "{spacing:?} {around}"
            );
            for (part, width) in parts.iter().zip([r + cut, r - cut]) {
                let exact = [2.0 * PI * r * width, 2.0 * PI * width];
                let found = [part.values.surface_area_mm2, part.values.total_mean_curvature_mm];
                let errors =
                    [part.standard_error.surface_area_mm2, part.standard_error.total_mean_curvature_mm];
                for ((value, error), exact) in found.into_iter().zip(errors).zip(exact) {
                    let (off, error) = (value.unwrap() - exact, error.unwrap());
                    assert!(
                        off.abs() < 2.0 * error && off.abs() < 0.04 * exact,
                        "{spacing:?}: {off} of {exact} +- {error}"
                    );
                }
            }
        }
    }
}

/// The inner and the outer side of a torus, whose total curvatures are -4 pi and 4 pi.
#[test]
fn two_sides_of_a_torus() {
    let torus = Torus { major: 22.0, minor: 9.0 };
    let (object, measured) = object(torus, 1, [1.0; 3], &Measurement::default());
    let pose = poses()[1];
    let inner = |p: [f64; 3]| {
        let [x, y, _] = pose.to_shape(p);
        if x.hypot(y) < 22.0 { 1 } else { 2 }
    };
    let parts = object.regions(&measured, &regions(40.0, [0.8; 3], inner));
    assert_adds_up(&parts, &measured);
    let area = |side: f64| 2.0 * PI * 9.0 * (PI * 22.0 + side * 2.0 * 9.0);
    for (part, side) in parts.iter().zip([-1.0, 1.0]) {
        let found = [part.values.surface_area_mm2, part.values.total_gaussian_curvature].map(Option::unwrap);
        let errors = [part.standard_error.surface_area_mm2, part.standard_error.total_gaussian_curvature];
        for ((value, exact), error) in found.into_iter().zip([area(side), side * 4.0 * PI]).zip(errors) {
            assert!((value / exact - 1.0).abs() < 0.02, "{value} for {exact}");
            assert!((value - exact).abs() < 2.0 * error.unwrap(), "{value} for {exact} +- {error:?}");
        }
    }
}

/// The tube of a capsule and its caps, whose total curvatures are 0 and 4 pi: the blur carries some of that over the border,
/// where K jumps, and the errors say so.
#[test]
fn tube_and_caps() {
    let (mut scores, mut carried) = (Vec::new(), 0.0_f64);
    for (n, spacing) in SPACINGS.into_iter().enumerate() {
        let h = spacing.iter().copied().fold(0.0, f64::max);
        let (radius, length) = (7.5 * h, 22.0 * h);
        let (object, measured) = object(Capsule { radius, length }, n % 3, spacing, &Measurement::default());
        let pose = poses()[n % 3];
        let part = |p: [f64; 3]| 1 + u8::from(pose.to_shape(p)[2].abs() > 0.5 * length);
        let parts = object.regions(&measured, &regions(24.0 * h, [0.8 * h, 1.1 * h, 0.9 * h], part));
        assert_adds_up(&parts, &measured);
        let tube = [2.0 * PI * radius * length, PI * length, 0.0];
        let caps = [4.0 * PI * radius * radius, 4.0 * PI * radius, 4.0 * PI];
        for (part, exact) in parts.iter().filter(|part| part.region > 0).zip([tube, caps]) {
            let found = four(&part.values).into_iter().zip(four(&part.standard_error)).skip(1).zip(exact);
            for (n, ((value, error), exact)) in found.enumerate() {
                let (off, error) = (value.unwrap() - exact, error.unwrap());
                println!(
                    "{spacing:?} part {} number {n}: {off:+.3} of {exact:.3} z {:+.2}",
                    part.region,
                    off / error
                );
                scores.push(off / error);
                if n == 2 {
                    // Sigma, two spacings, is a fourth of the radius: half a turn or so.
                    carried = carried.max(off.abs());
                    assert!(error < 5.0, "{error}");
                }
            }
        }
    }
    let within = scores.iter().filter(|z| z.abs() <= 2.0).count() as f64 / scores.len() as f64;
    println!("{} numbers, within two errors {within:.3}, carried {carried:.2}", scores.len());
    assert!(within >= 0.95 && carried > 0.5, "{within} {carried}");
}

/// Of a thin rod in the embedding that gives it back, of the paper's blur and of one that leaves nothing, parts add up too; the
/// same bits come of one thread.
#[test]
fn parts_add_up_whatever_the_embedding() {
    use surfometry::measurement::EmbeddingKind;
    let rod = || Capsule { radius: 2.2, length: 30.0 };
    let halves = regions(40.0, [1.1; 3], |p| 1 + u8::from(p[2] > 0.0));
    for choices in [
        Measurement::default().embedding(EmbeddingKind::Recovering),
        Measurement::default().embedding(EmbeddingKind::Corrected).sigma_mm(1.6),
        Measurement::paper().sigma_mm(1.0),
    ] {
        let (object, measured) = object(rod(), 0, [1.0; 3], &choices);
        let parts = object.regions(&measured, &halves);
        assert_adds_up(&parts, &measured);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(one.install(|| object.regions(&measured, &halves)), parts);
    }
    let (object, measured) = object(rod(), 0, [1.0; 3], &Measurement::default().sigma_mm(6.0));
    let parts = object.regions(&measured, &halves);
    assert!(measured.surface_area_mm2.is_none() && parts.iter().all(|p| p.values.surface_area_mm2.is_none()));
    let volume: f64 = parts.iter().map(|part| part.values.volume_mm3.unwrap()).sum();
    assert!((volume - measured.volume_mm3.unwrap()).abs() < 1e-9);
}

/// A region that is all of a thin object, which is given back, has its errors; halves have those of independent halves or longer.
#[test]
fn regions_of_a_thin_object() {
    use surfometry::measurement::EmbeddingKind;
    let choices = Measurement::default().embedding(EmbeddingKind::Recovering);
    let (object, measured) = object(Ellipsoid { radii: [20.0, 4.0, 3.5] }, 1, [1.0; 3], &choices);
    let whole = four(&measured.standard_error).map(Option::unwrap);
    let all = object.regions(&measured, &regions(40.0, [1.1; 3], |_| 1));
    let found = four(&all[0].standard_error).map(Option::unwrap);
    for n in 0..3 {
        let ratio = found[n] / whole[n];
        assert!((0.999..1.3).contains(&ratio), "{n}: {} for {}", found[n], whole[n]);
    }
    let middle = poses()[1].shift();
    let halves = object.regions(&measured, &regions(40.0, [1.1; 3], |p| 1 + u8::from(p[2] > middle[2])));
    for part in &halves {
        let found = four(&part.standard_error).map(Option::unwrap);
        for n in 1..3 {
            assert!(found[n] > 0.6 * whole[n], "{n}: {} for {}", found[n], whole[n]);
        }
    }
}
