//! Contacts of labels against closed forms: turned, off the grid, on spacings that differ.

mod common;

use common::{SPACINGS, poses};
use std::f64::consts::PI;
use surfometry::Measurement;
use surfometry::measurement::Interface;
use surfometry::phantoms::Pose;
use surfometry::volume::{Affine, Grid, LabelImage};

/// An image of what a function of the turned position says, in a world whose origin is its middle.
fn image(half: f64, spacing: [f64; 3], pose: &Pose, label: impl Fn([f64; 3]) -> u8) -> LabelImage {
    let dimensions = spacing.map(|h| 2 * (half / h) as usize + 3);
    let mut affine = Affine::diagonal(spacing);
    affine.origin = std::array::from_fn(|a| -0.5 * (dimensions[a] - 1) as f64 * spacing[a]);
    let grid = Grid::new(dimensions, affine).unwrap();
    let voxel = |n: usize| label(pose.to_shape(affine.apply(grid.index_of(n).map(|i| i as f64))));
    let voxels: Vec<u8> = (0..grid.voxel_count()).map(voxel).collect();
    LabelImage::from_voxels(grid, &voxels).unwrap()
}

fn interfaces(image: &LabelImage) -> Vec<Interface> {
    Measurement::default().interfaces(image, &[]).unwrap()
}

/// Number of the octant of a point, from 1 on.
fn octant(p: [f64; 3]) -> u8 {
    1 + (0..3).map(|a| u8::from(p[a] > 0.0) << a).sum::<u8>()
}

fn labels(interface: &Interface) -> [i64; 2] {
    interface.labels.each_ref().map(|group| group.labels()[0])
}

fn area(interface: &Interface) -> f64 {
    interface.values.surface_area_mm2.unwrap_or_default()
}

/// Labels that meet in a line have voxels' faces in common, and an area that is 0 within its error.
fn assert_a_line(interface: &Interface) {
    assert!(area(interface) < 2.0 * interface.standard_error.surface_area_mm2.unwrap(), "{interface:?}");
}

/// Errors of area in their standard errors, and whether each is small.
#[derive(Default)]
struct Scores(Vec<f64>);

impl Scores {
    fn add(&mut self, what: &str, interface: &Interface, exact: f64, percent: f64) {
        let off = area(interface) - exact;
        let error = interface.standard_error.surface_area_mm2.unwrap();
        println!(
            "{what} {:?}: {:+.2} % z {:+.2} of {:.2} %",
            labels(interface),
            100.0 * off / exact,
            off / error,
            100.0 * error / exact
        );
        assert!(
            100.0 * off.abs() / exact < percent,
            "{what} {:?}: {:+.2} %",
            labels(interface),
            100.0 * off / exact
        );
        self.0.push(off / error);
    }

    /// Twice the error holds the truth in 95 of 100 cases or more.
    fn assert_covered(&self) {
        let within = self.0.iter().filter(|z| z.abs() <= 2.0).count() as f64 / self.0.len() as f64;
        let rms = common::rms(self.0.iter().copied());
        println!("{} cases, rms z {rms:.2}, within two errors {within:.3}", self.0.len());
        assert!(within >= 0.95, "{within}");
    }
}

/// Eight octants of a ball: quarters of discs within, eighths of the sphere without, and nothing of those that meet in a line.
#[test]
fn octants_of_a_ball() {
    let mut scores = Scores::default();
    for (pose, spacing) in poses().iter().zip(SPACINGS) {
        let radius = 20.0 * spacing.iter().copied().fold(0.0, f64::max);
        let inside = |p: [f64; 3]| p.iter().map(|v| v * v).sum::<f64>() < radius * radius;
        let found =
            interfaces(&image(1.1 * radius, spacing, pose, |p| if inside(p) { octant(p) } else { 0 }));
        for interface in &found {
            let [a, b] = labels(interface);
            match a {
                0 => scores.add("outer", interface, 0.5 * PI * radius * radius, 4.0),
                _ if ((a - 1) ^ (b - 1)).count_ones() == 1 => {
                    scores.add("inner", interface, 0.25 * PI * radius * radius, 6.0);
                }
                _ => assert_a_line(interface),
            }
        }
        let outer: f64 = found.iter().filter(|i| labels(i)[0] == 0).map(area).sum();
        assert!((outer / (4.0 * PI * radius * radius) - 1.0).abs() < 0.004, "{outer}");
        let inner = found.iter().filter(|i| ((labels(i)[0] - 1) ^ (labels(i)[1] - 1)).count_ones() == 1);
        assert_eq!(inner.filter(|i| labels(i)[0] > 0).count(), 12);
    }
    scores.assert_covered();
}

/// A box cut into eight: each has six rectangles, edges without are part of its area.
#[test]
fn a_box_cut_into_eight() {
    let mut scores = Scores::default();
    let sides = [30.0, 24.0, 36.0];
    let along = Pose::new([0.0; 3], [0.25; 3]);
    for (pose, spacing) in
        poses().iter().chain([&along]).zip([[1.0; 3], [0.6, 0.6, 1.2], [1.0, 0.7, 0.4], [1.0; 3]])
    {
        let inside = |p: [f64; 3]| (0..3).all(|a| p[a].abs() < 0.5 * sides[a]);
        let found = interfaces(&image(30.0, spacing, pose, |p| if inside(p) { octant(p) } else { 0 }));
        let rectangle = |axis: usize| (0..3).filter(|a| *a != axis).map(|a| 0.5 * sides[a]).product::<f64>();
        let outer: f64 = (0..3).map(rectangle).sum();
        for interface in &found {
            let [a, b] = labels(interface);
            let apart = (a - 1) ^ (b - 1);
            match a {
                0 => scores.add("outer", interface, outer, 4.0),
                _ if apart.count_ones() == 1 => {
                    // Along the grid a rectangle has whole voxels.
                    scores.add("inner", interface, rectangle(apart.trailing_zeros() as usize), 12.0);
                }
                _ => assert_a_line(interface),
            }
        }
    }
    scores.assert_covered();
}

/// Two balls with a flat contact, and a drop on a ball, whose contact is curved: lens and caps, with the sign of H by the
/// order of labels.
#[test]
fn balls_that_touch() {
    let mut scores = Scores::default();
    for (pose, spacing) in poses().iter().zip(SPACINGS) {
        let h = spacing.iter().copied().fold(0.0, f64::max);
        let (radius, apart) = (20.0 * h, 24.0 * h);
        let far = |p: [f64; 3], z: f64| p[0] * p[0] + p[1] * p[1] + (p[2] - z).powi(2);
        let halves = |p: [f64; 3]| {
            let z = if p[2] < 0.0 { -0.5 } else { 0.5 };
            if far(p, z * apart) < radius * radius { 1 + u8::from(z > 0.0) } else { 0 }
        };
        let found = interfaces(&image(36.0 * h, spacing, pose, halves));
        let cap = 2.0 * PI * radius * (radius + 0.5 * apart);
        for (interface, exact) in found.iter().zip([cap, cap, PI * (radius * radius - 0.25 * apart * apart)])
        {
            scores.add("halves", interface, exact, 3.0);
        }
        // From outside inwards a ball is hollow.
        let mean = |n: usize| found[n].values.average_mean_curvature_per_mm.unwrap() * radius;
        assert!((mean(0) + 1.0).abs() < 0.01 && (mean(1) + 1.0).abs() < 0.01, "{} {}", mean(0), mean(1));
        assert!(mean(2).abs() < 0.02, "{}", mean(2));
        // The first ball whole, the second without it.
        let bitten = |p: [f64; 3]| match (far(p, -0.5 * apart), far(p, 0.5 * apart)) {
            (first, _) if first < radius * radius => 2,
            (_, second) if second < radius * radius => 1,
            _ => 0,
        };
        let found = interfaces(&image(36.0 * h, spacing, pose, bitten));
        let bite = 2.0 * PI * radius * (radius - 0.5 * apart);
        for (interface, exact) in found.iter().zip([cap, cap, bite]) {
            scores.add("bitten", interface, exact, 3.0);
        }
        let error = found[2].standard_error.average_mean_curvature_per_mm.unwrap() * radius;
        let mean = found[2].values.average_mean_curvature_per_mm.unwrap() * radius;
        println!("H of the bite {mean:.3} +- {error:.3}");
        assert!((mean + 1.0).abs() < 2.0 * error && error < 0.1, "{mean} {error}");
    }
    scores.assert_covered();
}

/// A layer of two voxels between two others keeps its sides, though displacements are longer; one within a single label
/// loses some, and its error says so.
#[test]
fn thin_layers() {
    let pose = &poses()[0];
    let column = |p: [f64; 3]| p[0] * p[0] + p[1] * p[1] < 400.0 && p[2].abs() < 18.0;
    let layered = |p: [f64; 3]| match p[2] {
        _ if !column(p) => 0,
        z if z < -1.0 => 1,
        z if z < 1.0 => 2,
        _ => 3,
    };
    let found = interfaces(&image(30.0, [1.0; 3], pose, layered));
    let of = |pair: [i64; 2]| found.iter().find(|i| labels(i) == pair);
    for pair in [[1, 2], [2, 3]] {
        assert!((area(of(pair).unwrap()) / (400.0 * PI) - 1.0).abs() < 0.03, "{pair:?} {:?}", of(pair));
    }
    assert!(of([1, 3]).is_none_or(|i| area(i) < 15.0), "{:?}", of([1, 3]));
    let septum = |p: [f64; 3]| u8::from(column(p)) + u8::from(column(p) && p[2].abs() < 1.0);
    let found = interfaces(&image(30.0, [1.0; 3], pose, septum));
    let sides = found.iter().find(|i| labels(i) == [1, 2]).unwrap();
    let off = area(sides) - 800.0 * PI;
    println!(
        "septum {:+.1} % +- {:.1} %",
        off / 8.0 / PI,
        sides.standard_error.surface_area_mm2.unwrap() / 8.0 / PI
    );
    assert!(off.abs() < 2.0 * sides.standard_error.surface_area_mm2.unwrap(), "{sides:?}");
}

/// What pairs across a thin layer count for is not known where its sides touch elsewhere: a marrow rod in a cortex with open
/// ends, and sheets that lie on each other, of two to four voxels. No contact is null.
#[test]
fn thin_layers_with_open_ends() {
    let mut scores = Scores::default();
    for (n, wall) in (0..).zip([2.0, 2.5, 3.0, 4.0]) {
        let turned = &poses()[n % poses().len()];
        let along = Pose::new([0.0; 3], [0.2, 0.3, 0.0]);
        for pose in [turned, &along] {
            let rod = |p: [f64; 3]| match libm::hypot(p[0], p[1]) {
                _ if p[2].abs() >= 15.0 => 0,
                r if r < 6.0 => 1,
                r => 2 * u8::from(r < 6.0 + wall),
            };
            let found = interfaces(&image(26.0, [1.0; 3], pose, rod));
            let outer = 6.0 + wall;
            let ring = 2.0 * PI * (outer * outer - 36.0) + 60.0 * PI * outer;
            assert_eq!(found.len(), 3);
            for (interface, exact) in found.iter().zip([72.0 * PI, ring, 360.0 * PI]) {
                scores.add(&format!("cortex {wall}"), interface, exact, 90.0);
            }
            let sheets = |p: [f64; 3]| match (p[0], p[1].abs().max(p[2].abs()) < 20.0) {
                (x, true) if x.abs() < wall => 1 + u8::from(x > 0.0),
                _ => 0,
            };
            let found = interfaces(&image(34.0, [1.0; 3], pose, sheets));
            let sides = 1600.0 + 160.0 * wall;
            for (interface, exact) in found.iter().zip([sides, sides, 1600.0]) {
                scores.add(&format!("sheets {wall}"), interface, exact, 90.0);
            }
        }
    }
    scores.assert_covered();
}

/// A core within a shell of four sectors: its mean curvature is 1 / 2R to each, wherever the others bend what is beside them.
#[test]
fn a_core_within_sectors() {
    let (mut scores, mut shares) = (Vec::new(), Vec::new());
    for (pose, spacing) in poses().iter().zip(SPACINGS) {
        let h = spacing.iter().copied().fold(0.0, f64::max);
        for radius in [6.0 * h, 9.0 * h, 12.0 * h] {
            let (outer, half) = (radius + 8.0 * h, 14.0 * h);
            let sector = |p: [f64; 3]| match p[0].hypot(p[1]) {
                r if p[2].abs() > half || r > outer => 0,
                r if r < radius => 1,
                _ => 2 + u8::from(p[0] > 0.0) + 2 * u8::from(p[1] > 0.0),
            };
            let found = interfaces(&image(1.5 * outer + 3.0 * h, spacing, pose, sector));
            for interface in found.iter().filter(|i| labels(i)[0] == 1) {
                let values = [&interface.values, &interface.standard_error];
                let [Some(mean), Some(error)] = values.map(|v| v.average_mean_curvature_per_mm) else {
                    continue;
                };
                let (mean, error) = (2.0 * radius * mean, 2.0 * radius * error);
                println!(
                    "{spacing:?} R {radius:.1}: 2 R H {mean:.3} +- {error:.3}, share {:.2}",
                    interface.curvature_share
                );
                assert!((mean - 1.0).abs() < 0.35, "{mean}");
                scores.push((mean - 1.0) / error);
                shares.push(interface.curvature_share);
            }
        }
    }
    let within = scores.iter().filter(|z| z.abs() <= 2.0).count() as f64 / scores.len() as f64;
    println!(
        "{} interfaces, within two errors {within:.3}, rms z {:.2}",
        scores.len(),
        common::rms(scores.iter().copied())
    );
    assert!(scores.len() >= 20 && within >= 0.95, "{} {within}", scores.len());
}

/// A cut along the grid lies anywhere within a spacing, which the areas that end there are off by.
#[test]
fn halves_cut_along_the_grid() {
    let mut scores = Scores::default();
    for n in 0..12 {
        let (radius, off) = (12.0 + 0.37 * f64::from(n), 0.083 * f64::from(n) - 0.4);
        let half = |p: [f64; 3]| {
            let inside = p.iter().map(|v| v * v).sum::<f64>() < radius * radius;
            u8::from(inside) * (1 + u8::from(p[0] > off))
        };
        let found = interfaces(&image(radius + 3.0, [1.0; 3], &Pose::new([0.0; 3], [0.0; 3]), half));
        let caps = [2.0 * PI * radius * (radius + off), 2.0 * PI * radius * (radius - off)];
        for (interface, exact) in found.iter().zip([caps[0], caps[1], PI * (radius * radius - off * off)]) {
            scores.add("half", interface, exact, 9.0);
        }
    }
    scores.assert_covered();
}

/// Rough masks: the counted area follows roughness that a smooth surface has not, and its error says so.
#[test]
fn rough_masks() {
    let mut scores = Scores::default();
    for (pose, n) in poses().iter().zip(1_u32..) {
        // A tooth of a voxel at one voxel of eight.
        let noise = move |p: [f64; 3]| {
            let mixed = |hash: u32, v: f64| {
                (hash ^ (v + 100.0).floor() as u32).wrapping_mul(2_654_435_769).rotate_left(15)
            };
            if p.into_iter().fold(n, mixed) % 8 == 0 { 1.2 } else { 0.0 }
        };
        let rough = |p: [f64; 3]| u8::from(p.iter().map(|v| v * v).sum::<f64>().sqrt() < 18.0 + noise(p));
        let found = interfaces(&image(24.0, [1.0; 3], pose, rough));
        scores.add("rough", &found[0], 4.0 * PI * 18.15 * 18.15, 40.0);
    }
    scores.assert_covered();
}

/// Any number of threads gives the same bits; united labels are one object; a label that two objects have is refused.
#[test]
fn objects_of_labels() {
    let ball = image(14.0, [1.0; 3], &poses()[1], |p| {
        if p.iter().map(|v| v * v).sum::<f64>() < 144.0 { octant(p) } else { 0 }
    });
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (all, alone) = (interfaces(&ball), one.install(|| interfaces(&ball)));
    assert_eq!(format!("{all:?}"), format!("{alone:?}"));
    let group = |text: &str| match text.parse().unwrap() {
        surfometry::volume::LabelSelection::Groups(groups) => groups,
        surfometry::volume::LabelSelection::All => unreachable!(),
    };
    let halves = Measurement::default().interfaces(&ball, &group("1+2+3+4,5+6+7+8")).unwrap();
    assert_eq!(halves.len(), 3);
    assert!((area(&halves[2]) / (144.0 * PI) - 1.0).abs() < 0.03, "{:?}", halves[2]);
    let shared = Measurement::default().interfaces(&ball, &group("1+2,2+3"));
    assert!(shared.unwrap_err().to_string().contains("share a label"));
    let missing = Measurement::default().interfaces(&ball, &group("9"));
    assert!(missing.unwrap_err().to_string().contains('9'));
}
