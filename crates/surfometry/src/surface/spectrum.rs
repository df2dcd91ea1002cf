//! How a surface lies in the grid: the Fourier coefficients of what is within it at the reciprocal lattice's first points.
//!
//! The volume of an object's voxels is off by the sum of its indicator's Fourier coefficients over the reciprocal lattice, each turned
//! by where the grid lies (Poisson's summation formula; Kendall 1948 for balls). Over all places of the grid their squares add up to
//! its variance. By the divergence theorem a coefficient is an integral over the surface, of (n . xi) exp(-2 pi i xi . x) / (2 pi
//! xi^2), to which only places with n along xi contribute: caps of a body, as a model for all directions has them on the mean
//! ([`ErrorModel`](crate::accuracy::ErrorModel)), and strips of a straight tube along the grid or faces as wholes, which it has not.

use super::local_scale::indices;
use super::{Mesh, TileMesh};
use crate::space::cross;
use crate::tiling::ExactSum;
use crate::volume::{Grid, Spacing};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// The first points of the reciprocal lattice, in its own units, one of xi and -xi: along axes, faces' and bodies' diagonals.
const FIRST: [[i8; 3]; 13] = [
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
    [1, -1, -1],
];

/// What some of a surface's triangles add to the coefficients, mm^3: of each, of those that face along xi and of those that face
/// against it, for how these meet tells of the very size of an object, and not of how well it is known.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spectrum {
    /// By point: real and imaginary part of either side.
    sides: [[ExactSum; 4]; FIRST.len()],
}

type Complex = [f64; 2];

impl Spectrum {
    /// Of a whole surface.
    pub(crate) fn of_mesh(mesh: &Mesh, grid: &Grid) -> Self {
        Self::of(&indices(&mesh.vertices, grid), &mesh.triangles, grid.spacing())
    }

    /// Of triangles of vertices at fractional voxel indices.
    fn of(positions: &[[f64; 3]], triangles: &[[u32; 3]], spacing: Spacing) -> Self {
        let h = spacing.mm();
        let phases: Vec<[Complex; 3]> = positions.iter().map(|p| p.map(phase)).collect();
        let factors: [f64; FIRST.len()] = std::array::from_fn(|n| 1.0 / (6.0 * PI * square(n, h)));
        let mut sides = [[0.0; 4]; FIRST.len()];
        for triangle in triangles {
            let corners = triangle.map(|vertex| positions[vertex as usize]);
            let area = area_over_spacing(corners, h);
            let waves = triangle.map(|vertex| waves(&phases[vertex as usize]));
            for (n, side) in sides.iter_mut().enumerate() {
                let along = (0..3).map(|a| f64::from(FIRST[n][a]) * area[a]).sum::<f64>() * factors[n];
                let [re, im] = [0, 1].map(|part| waves.iter().map(|wave| wave[n][part]).sum::<f64>());
                let (with, against) = (along.max(0.0), along.min(0.0));
                let terms = [with * re, with * im, against * re, against * im];
                side.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
        }
        let mut spectrum = Self::default();
        for (sums, values) in spectrum.sides.iter_mut().zip(sides) {
            sums.iter_mut().zip(values).for_each(|(sum, value)| sum.add(value));
        }
        spectrum
    }

    /// Of the part of a surface in a tile.
    pub(super) fn of_tile(mesh: &TileMesh, spacing: Spacing) -> Self {
        Self::of(&mesh.positions, &mesh.triangles, spacing)
    }

    pub(super) fn merge(&mut self, other: &Self) {
        let pairs = self.sides.as_flattened_mut().iter_mut().zip(other.sides.as_flattened());
        pairs.for_each(|(sum, part)| sum.merge(part));
    }

    /// Variance of the volume of the voxels over all places of the grid, mm^6. `lattice` is the sum of 1 / xi^4 over the reciprocal
    /// lattice, mm^4, by which it is told what lies beyond the first points: as much of tubes and faces as of bodies, to a few per
    /// cent.
    pub(crate) fn variance_of_volume(&self, spacing: Spacing, lattice: f64) -> f64 {
        let first: f64 = (0..FIRST.len()).map(|n| 2.0 / square(n, spacing.mm()).powi(2)).sum();
        let powers: f64 = self.sides.as_flattened().iter().map(|part| part.value().powi(2)).sum();
        2.0 * powers * lattice / first
    }
}

/// xi^2 of a point, 1/mm^2.
fn square(point: usize, spacing: [f64; 3]) -> f64 {
    FIRST[point].iter().zip(spacing).map(|(&n, h)| (f64::from(n) / h).powi(2)).sum()
}

/// exp(-2 pi i x); 1 of whole numbers, as two of three are of a vertex on an edge of the grid.
fn phase(x: f64) -> Complex {
    let part = x - x.floor();
    if part == 0.0 {
        return [1.0, 0.0];
    }
    let (sin, cos) = libm::sincos(TAU * part);
    [cos, -sin]
}

/// A triangle's area along each axis, outward, mm^2, over the axis' spacing.
fn area_over_spacing([a, b, c]: [[f64; 3]; 3], h: [f64; 3]) -> [f64; 3] {
    let [u, v]: [[f64; 3]; 2] = [b, c].map(|corner| std::array::from_fn(|n| (corner[n] - a[n]) * h[n]));
    let [x, y, z] = cross(u, v);
    [0.5 * x / h[0], 0.5 * y / h[1], 0.5 * z / h[2]]
}

/// exp(-2 pi i xi . x) at each of the first points.
#[inline(always)]
fn waves(&[x, y, z]: &[Complex; 3]) -> [Complex; FIRST.len()] {
    let times = |[a, b]: Complex, [c, d]: Complex| [a * c - b * d, a * d + b * c];
    let over = |a: Complex, [c, d]: Complex| times(a, [c, -d]);
    let (xy, x_y) = (times(x, y), over(x, y));
    [
        x,
        y,
        z,
        xy,
        x_y,
        times(x, z),
        over(x, z),
        times(y, z),
        over(y, z),
        times(xy, z),
        over(xy, z),
        times(x_y, z),
        over(x_y, z),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::ErrorModel;
    use crate::surface::extract;
    use crate::volume::{FieldImage, FieldValues};

    /// The standard deviation of the volume of a field's voxels that is told by its mesh.
    fn told(phi: impl Fn([f64; 3]) -> f64, spacing: [f64; 3]) -> f64 {
        let extent = [40.0, 40.0, 60.0];
        let size = std::array::from_fn(|a| (extent[a] / spacing[a]) as usize + 1);
        let grid = Grid::axis_aligned(size, spacing).unwrap();
        let values = (0..grid.voxel_count()).map(|number| {
            let index = grid.index_of(number);
            phi(std::array::from_fn(|a| index[a] as f64 * spacing[a] - 0.5 * extent[a]))
        });
        let field = FieldImage::new(grid, FieldValues::F64(values.collect())).unwrap();
        let mesh = extract(&&field, &grid);
        let lattice = ErrorModel::new(grid.spacing(), 1.0, 3.0).lattice();
        Spectrum::of_mesh(&mesh, &grid).variance_of_volume(grid.spacing(), lattice).sqrt()
    }

    /// 0.258 h^2 sqrt(A) of a ball; a disc's error, over all shifts R sum of 1 / xi^3 / (2 pi^2) squared (Kendall 1948; 9.03 of the
    /// square lattice), as often as there are slices of a tube along the grid, however it lies beside the voxels; and a slab's h /
    /// sqrt 12 for each of its two faces.
    #[test]
    fn balls_tubes_and_slabs() {
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        for moved in [0.0, 0.23, 0.5] {
            let ball = told(|[x, y, z]| length(&[x - moved, y + 0.1, z]) - 13.0, [1.0; 3]);
            let exact = 0.258 * (4.0 * PI * 169.0f64).sqrt();
            assert!((ball / exact - 1.0).abs() < 0.1, "{moved}: {ball} {exact}");
            let tube = told(|[x, y, z]| (length(&[x - moved, y]) - 9.0).max(z.abs() - 20.3), [1.0; 3]);
            let slice = (9.0 * 9.03 / (2.0 * PI * PI)).sqrt();
            assert!((tube / (40.6 * slice) - 1.0).abs() < 0.1, "{moved}: {tube} {slice}");
        }
    }
}
