//! How a surface lies in the grid: the Fourier coefficients of what is within it at the reciprocal lattice's first points.
//!
//! The volume of an object's voxels is off by the sum of its indicator's Fourier coefficients over the reciprocal lattice, each turned
//! by where the grid lies (Poisson's summation formula; Kendall 1948 for balls). Over all places of the grid their squares add up to
//! its variance. By the divergence theorem a coefficient is an integral over the surface, of (n . xi) exp(-2 pi i xi . x) / (2 pi
//! xi^2), to which only places with n along xi contribute: caps of a body, as a model for all directions has them on the mean
//! ([`ErrorModel`](crate::accuracy::ErrorModel)), and strips of a straight tube along the grid or faces as wholes, which it has not.

use super::local_scale::indices;
use super::{Mesh, TileMesh};
use crate::space::{HALF_OF_NEIGHBOURS, cross, dot, length};
use crate::tiling::ExactSum;
use crate::volume::{Grid, Spacing};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The first points of the reciprocal lattice, in its own units, one of xi and -xi: along axes, faces' and bodies' diagonals.
const FIRST: [[i64; 3]; 13] = HALF_OF_NEIGHBOURS;

/// What some of a surface's triangles add to the coefficients, mm^3: of each, of those that face along xi and of those that face
/// against it, for how these meet tells of the very size of an object, and not of how well it is known.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spectrum {
    /// By point: real and imaginary part of either side.
    sides: [[ExactSum; 4]; FIRST.len()],
}

type Complex = [f64; 2];

/// Cosines of the angles between n and xi at which a place begins to count, 35 degrees, and counts in full, 15 degrees. Farther off,
/// waves are shorter than triangles, and what the sum over these is off by would add up; nearer, of radii of less than five voxels,
/// some of what contributes would be lost.
const COUNTED: [f64; 2] = [0.819, 0.966];

/// What waves of at least this share of a blur's sigma are, in units of 1 / xi: longer ones are seen in the blurred surface as terraces
/// that all lie alike in the grid, by which it tells of more than the object has. Of balls and tubes in slices of 1.2 sigma, it is
/// 2.1 to 3.4 times as much; of 0.72 sigma, 1.5 times; of half a sigma, up to 1.2 times.
const SEEN_THROUGH: f64 = 0.55;

impl Spectrum {
    /// Of a whole surface.
    pub(crate) fn of_mesh(mesh: &Mesh, grid: &Grid) -> Self {
        Self::of(&indices(&mesh.vertices, grid), &mesh.triangles, grid.spacing())
    }

    /// Of the part of a surface in a tile.
    pub(crate) fn of_tile(mesh: &TileMesh, spacing: Spacing) -> Self {
        Self::of(&mesh.positions, &mesh.triangles, spacing)
    }

    /// Of triangles of vertices at fractional voxel indices; each by the middles of its edges.
    fn of(positions: &[[f64; 3]], triangles: &[[u32; 3]], spacing: Spacing) -> Self {
        let h = spacing.mm();
        let halves: Vec<[Complex; 3]> = positions.iter().map(|p| p.map(half_turn)).collect();
        let points: [Point; FIRST.len()] = std::array::from_fn(|n| Point::new(FIRST[n], h));
        let mut sides = [[0.0; 4]; FIRST.len()];
        for triangle in triangles {
            let area = area(triangle.map(|vertex| positions[vertex as usize]), h);
            let whole = length(area);
            let [a, b, c] = triangle.map(|vertex| &halves[vertex as usize]);
            let middles =
                [(a, b), (b, c), (c, a)].map(|(a, b)| [0, 1, 2].map(|axis| times(a[axis], b[axis])));
            for (point, side) in points.iter().zip(&mut sides) {
                let along = dot(area, point.place);
                let counted = point.counted(along, whole);
                if counted > 0.0 {
                    let wave = middles.iter().map(|middle| point.wave(middle)).fold([0.0; 2], plus);
                    let term = wave.map(|part| counted * along * point.factor * part);
                    let first = if along > 0.0 { 0 } else { 2 };
                    side[first] += term[0];
                    side[first + 1] += term[1];
                }
            }
        }
        let mut spectrum = Self::default();
        for (sums, values) in spectrum.sides.iter_mut().zip(sides) {
            sums.iter_mut().zip(values).for_each(|(sum, value)| sum.add(value));
        }
        spectrum
    }

    #[must_use]
    pub(crate) fn merged(mut self, other: &Self) -> Self {
        let pairs = self.sides.as_flattened_mut().iter_mut().zip(other.sides.as_flattened());
        pairs.for_each(|(sum, part)| sum.merge(part));
        self
    }

    /// Variance of the volume of the voxels over all places of the grid, mm^6, of a surface after a blur of sigma mm. `lattice` is the
    /// sum of 1 / xi^4 over the reciprocal lattice, mm^4, by which it is told what lies beyond the first points: of tubes and faces as
    /// much as of bodies, to a few per cent.
    pub(crate) fn variance_of_volume(&self, spacing: Spacing, sigma: f64, lattice: f64) -> f64 {
        let points = FIRST.map(|index| Point::new(index, spacing.mm()));
        let first: f64 = points.iter().map(|point| 2.0 / point.square.powi(2)).sum();
        let power = |(point, sides): (&Point, &[ExactSum; 4])| {
            let seen = (SEEN_THROUGH * sigma * point.magnitude).min(1.0);
            seen * seen * sides.iter().map(|part| part.value().powi(2)).sum::<f64>()
        };
        2.0 * points.iter().zip(&self.sides).map(power).sum::<f64>() * lattice / first
    }
}

/// A point xi of the reciprocal lattice.
struct Point {
    index: [i64; 3],
    /// 1/mm.
    place: [f64; 3],
    square: f64,
    magnitude: f64,
    /// Of (n . xi) times a triangle's area and the sum of the wave at its three middles.
    factor: f64,
}

impl Point {
    fn new(index: [i64; 3], spacing: [f64; 3]) -> Self {
        let place = std::array::from_fn(|a| index[a] as f64 / spacing[a]);
        let square = dot(place, place);
        Self { index, place, square, magnitude: square.sqrt(), factor: 1.0 / (6.0 * PI * square) }
    }

    /// How much a triangle of an area counts, of which the part along xi is `along` over its magnitude: smoothly from nothing to
    /// all, for a sharp end would itself be seen.
    fn counted(&self, along: f64, area: f64) -> f64 {
        let [none, all] = COUNTED;
        let share = (along.abs() - none * self.magnitude * area) / ((all - none) * self.magnitude * area);
        // Also where there is no area.
        if share > 0.0 { share.min(1.0).powi(2) * (3.0 - 2.0 * share.min(1.0)) } else { 0.0 }
    }

    /// exp(-2 pi i xi . x), from that of each axis.
    fn wave(&self, axes: &[Complex; 3]) -> Complex {
        let turned = |wave: Complex, (&[re, im], step): (&Complex, i64)| match step {
            0 => wave,
            1 => times(wave, [re, im]),
            _ => times(wave, [re, -im]),
        };
        axes.iter().zip(self.index).fold([1.0, 0.0], turned)
    }
}

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

fn plus([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a + c, b + d]
}

/// exp(-pi i x): of a vertex on an edge of the grid two of three are 1 or -1.
fn half_turn(x: f64) -> Complex {
    let part = x - 2.0 * (0.5 * x).floor();
    if part == 0.0 || part == 1.0 {
        return [1.0 - 2.0 * part, 0.0];
    }
    let (sin, cos) = libm::sincos(PI * part);
    [cos, -sin]
}

/// A triangle's area as a vector, outward, mm^2.
fn area([a, b, c]: [[f64; 3]; 3], h: [f64; 3]) -> [f64; 3] {
    let [u, v]: [[f64; 3]; 2] = [b, c].map(|corner| std::array::from_fn(|n| (corner[n] - a[n]) * h[n]));
    cross(u, v).map(|part| 0.5 * part)
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
        ErrorModel::new(grid.spacing(), 2.0, 3.0).variance_of_volume(&Spectrum::of_mesh(&mesh, &grid)).sqrt()
    }

    /// 0.258 h^2 sqrt(A) of a ball; a disc's variance, R times the square lattice's sum of 1 / xi^3, 9.03, over 2 pi^2 (Kendall 1948), in
    /// each slice of a tube along the grid, which are off together, however it lies beside the voxels; and faces along the grid, flat
    /// ends and a slab's, whose place is known to h / sqrt 12.
    #[test]
    fn balls_tubes_and_slabs() {
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        for moved in [0.0, 0.23, 0.5] {
            let ball = told(|[x, y, z]| norm(&[x - moved, y + 0.1, z]) - 13.0, [1.0; 3]);
            let exact = 0.258 * (4.0 * PI * 169.0f64).sqrt();
            assert!((ball / exact - 1.0).abs() < 0.1, "{moved}: {ball} {exact}");
            let ends = 2.0 * (PI * 81.0f64).powi(2) / 12.0;
            let tube = told(|[x, y, z]| (norm(&[x - moved, y]) - 9.0).max(z.abs() - 20.3), [1.0; 3]);
            let slices = 40.6f64.powi(2) * 9.0 * 9.03 / (2.0 * PI * PI);
            assert!((tube / (slices + ends).sqrt() - 1.0).abs() < 0.15, "{moved}: {tube} {slices} {ends}");
            let plate =
                |[x, y, z]: [f64; 3]| ((x - moved).abs() - 4.0).max(y.abs() - 15.2).max(z.abs() - 20.3);
            let faces = [30.4 * 40.6, 8.0 * 40.6, 8.0 * 30.4f64].map(|face| 2.0 * face * face / 12.0);
            let plate = told(plate, [1.0; 3]);
            assert!(
                (plate / faces.iter().sum::<f64>().sqrt() - 1.0).abs() < 0.1,
                "{moved}: {plate} {faces:?}"
            );
        }
    }
}
