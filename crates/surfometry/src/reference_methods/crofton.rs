//! Crofton's formulas: area from what lines hit, mean curvature from what planes cut.

use super::directions::shares;
use super::{ReferenceMethod, ReferenceValues};
use crate::surface::{cross, dot, length, unit};
use crate::volume::Mask;
use rayon::prelude::*;
use std::f64::consts::PI;

/// A from crossings along lattice lines, M from the Euler characteristics of lattice planes, with weights by
/// shares of the sphere (Ohser and Mücklich 2000), for any spacing. Right on the mean over orientations; a
/// flat face along the grid is off by up to 10 % (13 directions) or 50 % (3). Where spacings differ by 2,
/// curved shapes' A is off by up to 1.5 %, their M by up to 4 %.
#[derive(Debug, Clone, Copy)]
pub enum Crofton {
    /// Along the axes.
    Directions3,
    /// Along axes, face and space diagonals.
    Directions13,
}

/// Half of the 26 neighbours.
pub(super) const STEPS: [[i64; 3]; 13] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [1, -1, 0],
    [1, 0, 1],
    [1, 0, -1],
    [0, 1, 1],
    [0, 1, -1],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [-1, 1, 1],
];

/// Two lattice vectors that span a plane, for each of the planes that 2 x 2 x 2 voxels hold.
const PLANES: [[[i64; 3]; 2]; 13] = [
    [[0, 1, 0], [0, 0, 1]],
    [[0, 0, 1], [1, 0, 0]],
    [[1, 0, 0], [0, 1, 0]],
    [[1, -1, 0], [0, 0, 1]],
    [[1, 1, 0], [0, 0, 1]],
    [[1, 0, -1], [0, 1, 0]],
    [[1, 0, 1], [0, 1, 0]],
    [[0, 1, -1], [1, 0, 0]],
    [[0, 1, 1], [1, 0, 0]],
    [[1, -1, 0], [0, 1, -1]],
    [[1, -1, 0], [0, 1, 1]],
    [[1, 1, 0], [0, 1, 1]],
    [[1, 1, 0], [0, 1, -1]],
];

impl Crofton {
    fn count(self) -> usize {
        match self {
            Self::Directions3 => 3,
            Self::Directions13 => 13,
        }
    }
}

impl ReferenceMethod for Crofton {
    fn name(&self) -> &'static str {
        match self {
            Self::Directions3 => "crofton-3",
            Self::Directions13 => "crofton-13",
        }
    }

    fn measure(&self, mask: &Mask) -> ReferenceValues {
        ReferenceValues {
            volume_mm3: Some(mask.voxels() as f64 * mask.grid().spacing().cell_volume()),
            surface_area_mm2: Some(area(mask, &STEPS[..self.count()])),
            total_mean_curvature_mm: Some(total_mean_curvature(mask, &PLANES[..self.count()])),
            ..ReferenceValues::default()
        }
        .with_average()
    }
}

/// Lines along a step of length l are hit twice as often as the surface is projected along them, and there
/// are l / V of them to an area.
fn area(mask: &Mask, steps: &[[i64; 3]]) -> f64 {
    let h = mask.grid().spacing().mm();
    let vectors: Vec<[f64; 3]> = steps.iter().map(|step| scaled(*step, h)).collect();
    let shares = shares(&vectors.iter().map(|&v| unit(v)).collect::<Vec<_>>());
    let cell = mask.grid().spacing().cell_volume();
    let of_direction = |((&step, vector), share): ((&[i64; 3], &[f64; 3]), f64)| {
        // Ways out; there are as many ways in.
        let hits = 2.0 * count(mask, |at| mask.get(at) && !mask.get(plus(at, step))) as f64;
        // The mean of |cos| over the sphere is 1/2.
        2.0 * share * hits * cell / length(*vector)
    };
    steps.iter().zip(&vectors).zip(shares).map(of_direction).sum()
}

/// The mean breadth along a normal is the integral of the sections' Euler characteristics; M is 2 pi times
/// its mean over normals.
fn total_mean_curvature(mask: &Mask, planes: &[[[i64; 3]; 2]]) -> f64 {
    let h = mask.grid().spacing().mm();
    let normals: Vec<[f64; 3]> = planes.iter().map(|[a, b]| cross(scaled(*a, h), scaled(*b, h))).collect();
    let shares = shares(&normals.iter().map(|&n| unit(n)).collect::<Vec<_>>());
    let cell = mask.grid().spacing().cell_volume();
    let of_plane = |((&[a, b], normal), share): ((&[[i64; 3]; 2], &[f64; 3]), f64)| {
        let spacing = cell / length(*normal);
        2.0 * PI * share * spacing * section_euler(mask, a, b)
    };
    planes.iter().zip(&normals).zip(shares).map(of_plane).sum()
}

/// Sum over all planes that two steps span of the Euler characteristic of the section, triangulated along the
/// shorter diagonal of the steps; along either, on the mean, where they are equally long.
fn section_euler(mask: &Mask, a: [i64; 3], b: [i64; 3]) -> f64 {
    let h = mask.grid().spacing().mm();
    let square = |step: [i64; 3]| dot(scaled(step, h), scaled(step, h));
    let back = b.map(|c| -c);
    let (sum, difference) = (square(plus(a, b)), square(plus(a, back)));
    let triangulated = |b: [i64; 3]| {
        // Corners x, x + a, x + a + b and x, x + b, x + a + b, with the diagonal a + b.
        let diagonal = plus(a, b);
        count_signed(mask, |at| {
            let inside = |step: [i64; 3]| i64::from(mask.get(plus(at, step)));
            if !mask.get(at) {
                return 0;
            }
            let (with_a, with_b, with_both) = (inside(a), inside(b), inside(diagonal));
            1 - with_a - with_b - with_both + with_a * with_both + with_b * with_both
        }) as f64
    };
    if (sum - difference).abs() < 1e-9 * (sum + difference) {
        0.5 * (triangulated(b) + triangulated(back))
    } else if sum < difference {
        triangulated(b)
    } else {
        triangulated(back)
    }
}

fn scaled(step: [i64; 3], h: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|a| step[a] as f64 * h[a])
}

fn plus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

fn count(mask: &Mask, holds: impl Fn([i64; 3]) -> bool + Sync) -> i64 {
    count_signed(mask, |at| i64::from(holds(at)))
}

/// Sum over the voxels of the mask's box.
fn count_signed(mask: &Mask, value: impl Fn([i64; 3]) -> i64 + Sync) -> i64 {
    let bounds = mask.bounds();
    let rows: Vec<(i64, i64)> = bounds.rows().collect();
    let row =
        |&(y, z): &(i64, i64)| (bounds.lower[0]..bounds.upper[0]).map(|x| value([x, y, z])).sum::<i64>();
    rows.par_iter().map(row).sum()
}
