//! Crofton's formulas: area from what lines hit, mean curvature from what planes cut.

use super::directions::shares;
use super::{Prepared, ReferenceMethod, ReferenceValues};
use crate::space::{HALF_OF_NEIGHBOURS, cross, dot, length, unit};
use crate::volume::{Mask, Spacing};
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
        self.prepared(mask.grid().spacing())(mask)
    }

    fn prepared(&self, spacing: Spacing) -> Prepared<'_> {
        let lines = lines(spacing, &HALF_OF_NEIGHBOURS[..self.count()]);
        let planes = planes(spacing, &PLANES[..self.count()]);
        Box::new(move |mask| {
            ReferenceValues {
                volume_mm3: Some(mask.voxels() as f64 * spacing.cell_volume()),
                surface_area_mm2: Some(lines.iter().map(|line| line.area(mask)).sum()),
                total_mean_curvature_mm: Some(
                    planes.iter().map(|plane| plane.total_mean_curvature(mask)).sum(),
                ),
                ..ReferenceValues::default()
            }
            .with_average()
        })
    }
}

/// Lattice lines along a step.
struct Lines {
    step: [i64; 3],
    /// Area that a hit stands for, mm^2.
    weight: f64,
}

/// Lines along a step of length l are hit twice as often as the surface is projected along them, and there
/// are l / V of them to an area.
fn lines(spacing: Spacing, steps: &[[i64; 3]]) -> Vec<Lines> {
    let vectors: Vec<[f64; 3]> = steps.iter().map(|step| scaled(*step, spacing.mm())).collect();
    let shares = shares(&vectors.iter().map(|&v| unit(v)).collect::<Vec<_>>());
    let of_direction = |((&step, vector), share): ((&[i64; 3], &[f64; 3]), f64)| {
        // The mean of |cos| over the sphere is 1/2.
        Lines { step, weight: 2.0 * share * spacing.cell_volume() / length(*vector) }
    };
    steps.iter().zip(&vectors).zip(shares).map(of_direction).collect()
}

impl Lines {
    fn area(&self, mask: &Mask) -> f64 {
        // Ways out; there are as many ways in.
        let out = count(mask, |at| i64::from(mask.get(at) && !mask.get(plus(at, self.step))));
        2.0 * out as f64 * self.weight
    }
}

/// Lattice planes that two steps span.
struct Planes {
    steps: [[i64; 3]; 2],
    /// Integral of H that an Euler characteristic of 1 of a section stands for, mm.
    weight: f64,
    /// Length of the steps' sum less that of their difference, squared and over their sum.
    skew: f64,
}

/// The mean breadth along a normal is the integral of the sections' Euler characteristics; M is 2 pi times
/// its mean over normals.
fn planes(spacing: Spacing, planes: &[[[i64; 3]; 2]]) -> Vec<Planes> {
    let h = spacing.mm();
    let normals: Vec<[f64; 3]> = planes.iter().map(|[a, b]| cross(scaled(*a, h), scaled(*b, h))).collect();
    let shares = shares(&normals.iter().map(|&n| unit(n)).collect::<Vec<_>>());
    let square = |step: [i64; 3]| dot(scaled(step, h), scaled(step, h));
    let of_plane = |((&[a, b], normal), share): ((&[[i64; 3]; 2], &[f64; 3]), f64)| {
        let apart = spacing.cell_volume() / length(*normal);
        let (sum, difference) = (square(plus(a, b)), square(plus(a, back(b))));
        Planes {
            steps: [a, b],
            weight: 2.0 * PI * share * apart,
            skew: (sum - difference) / (sum + difference),
        }
    };
    planes.iter().zip(&normals).zip(shares).map(of_plane).collect()
}

impl Planes {
    fn total_mean_curvature(&self, mask: &Mask) -> f64 {
        self.weight * self.section_euler(mask)
    }

    /// Sum over all planes of the Euler characteristic of the section, triangulated along the shorter diagonal
    /// of the steps; along either, on the mean, where they are equally long.
    fn section_euler(&self, mask: &Mask) -> f64 {
        let [a, b] = self.steps;
        if self.skew.abs() < 1e-9 {
            0.5 * (triangulated(mask, a, b) + triangulated(mask, a, back(b)))
        } else {
            triangulated(mask, a, if self.skew < 0.0 { b } else { back(b) })
        }
    }
}

/// Corners x, x + a, x + a + b and x, x + b, x + a + b, with the diagonal a + b.
fn triangulated(mask: &Mask, a: [i64; 3], b: [i64; 3]) -> f64 {
    let diagonal = plus(a, b);
    count(mask, |at| {
        let inside = |step: [i64; 3]| i64::from(mask.get(plus(at, step)));
        if !mask.get(at) {
            return 0;
        }
        let (with_a, with_b, with_both) = (inside(a), inside(b), inside(diagonal));
        1 - with_a - with_b - with_both + with_a * with_both + with_b * with_both
    }) as f64
}

fn back(step: [i64; 3]) -> [i64; 3] {
    step.map(|c| -c)
}

fn scaled(step: [i64; 3], h: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|a| step[a] as f64 * h[a])
}

fn plus(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Sum over the voxels of the mask's box.
fn count(mask: &Mask, value: impl Fn([i64; 3]) -> i64 + Sync) -> i64 {
    let bounds = mask.bounds();
    let rows: Vec<(i64, i64)> = bounds.rows().collect();
    let row =
        |&(y, z): &(i64, i64)| (bounds.lower[0]..bounds.upper[0]).map(|x| value([x, y, z])).sum::<i64>();
    rows.par_iter().map(row).sum()
}
