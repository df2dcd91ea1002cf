//! Weights of displacements that make areas of counts.

use crate::local_geometry::solved;
use crate::space::{dot, half_sphere, length};
use crate::volume::Spacing;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Length of the longest displacement, in geometric means of the spacings and in largest ones.
const LONGEST: f64 = 5.2;
const LONGEST_OF_SLICES: f64 = 3.6;
/// Of the short ones, which fine roughness tells from the others, in the same units.
const SHORT: f64 = 2.3;
const SHORT_OF_SLICES: f64 = 1.8;
/// Most displacements: where slices are so thick that there would be more, the longest are shorter.
const MOST: usize = 3000;
/// Directions in which the conditions are asked for.
const DIRECTIONS: usize = 300;
/// What the conditions weigh: faces of any direction, the grid's own, rims, cylinders, balls; and the noise.
const FACES: f64 = 40.0;
const GRID_FACES: f64 = 180.0;
const RIMS: f64 = 2.0;
const CYLINDERS: f64 = 0.3;
const BALLS: f64 = 6.0;
const NOISE: f64 = 1e-4;
/// The same of displacements that are to weigh nothing.
const LEFT_OUT: f64 = 1e15;

/// Displacements, one of each pair d, -d, and the weights of pairs of voxels so far apart. Mirror images along the grid's
/// axes weigh the same and are an orbit.
#[derive(Debug, Clone)]
pub(crate) struct PairWeights {
    displacements: Vec<([i64; 3], usize)>,
    /// By orbit, in 1/mm of area over volume.
    weights: Vec<f64>,
    /// The same, of short displacements alone.
    short: Vec<f64>,
    /// The orbits of the three shortest displacements along the axes.
    along_axes: [usize; 3],
    spacing: Spacing,
    longest: f64,
}

impl PairWeights {
    /// For a lattice.
    pub(crate) fn new(spacing: Spacing) -> Self {
        let (displacements, longest) = displacements(spacing);
        let mut orbits = BTreeMap::new();
        for d in &displacements {
            let next = orbits.len();
            orbits.entry(d.map(i64::abs)).or_insert(next);
        }
        let orbit = |d: &[i64; 3]| orbits[&d.map(i64::abs)];
        let displacements: Vec<_> = displacements.iter().map(|d| (*d, orbit(d))).collect();
        let along_axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|d| orbit(&d));
        let none = vec![0.0; orbits.len()];
        let made = Self { displacements, weights: none.clone(), short: none, along_axes, spacing, longest };
        let short = (SHORT * spacing.geometric_mean()).max(SHORT_OF_SLICES * spacing.largest());
        Self { weights: made.balanced(longest), short: made.balanced(short), ..made }
    }

    /// Displacements, each with the number of its orbit.
    pub(crate) fn displacements(&self) -> &[([i64; 3], usize)] {
        &self.displacements
    }

    /// How many orbits there are.
    pub(crate) fn orbits(&self) -> usize {
        self.weights.len()
    }

    /// Voxels along each axis that the longest displacement reaches.
    pub(crate) fn reach(&self) -> [i64; 3] {
        let largest = |a: usize| self.displacements.iter().map(|(d, _)| d[a].abs()).max();
        std::array::from_fn(|a| largest(a).unwrap_or_default())
    }

    /// Area, mm^2, of what so many pairs of each orbit cross.
    pub(crate) fn area(&self, counts: &[u64]) -> f64 {
        self.weighed(counts.iter().map(|&count| count as f64), &self.weights)
    }

    /// The same of short displacements alone, which rough surfaces make smaller.
    pub(crate) fn area_of_short(&self, counts: &[u64]) -> f64 {
        self.weighed(counts.iter().map(|&count| count as f64), &self.short)
    }

    /// By how much an area changes with counts.
    pub(crate) fn change(&self, counts: &[i64]) -> f64 {
        self.weighed(counts.iter().map(|&count| count as f64), &self.weights)
    }

    fn weighed(&self, counts: impl Iterator<Item = f64>, weights: &[f64]) -> f64 {
        counts.zip(weights).map(|(count, weight)| count * weight).sum::<f64>() * self.spacing.cell_volume()
    }

    /// Area of the voxels' faces that such pairs cross, mm^2, by axis.
    pub(crate) fn faces(&self, counts: &[u64]) -> [f64; 3] {
        let volume = self.spacing.cell_volume();
        std::array::from_fn(|a| counts[self.along_axes[a]] as f64 * volume / self.spacing.mm()[a])
    }

    /// Share by which faces of a layer of one label within another may be off, at most, where it is so thick, mm, or thicker.
    pub(crate) fn loss_of_layer(&self, thickness: f64) -> f64 {
        let step = 0.1 * self.spacing.geometric_mean();
        let steps = ((self.longest - thickness).max(0.0) / step) as usize;
        let normals: Vec<[f64; 3]> = half_sphere(24).collect();
        let beyond = |n: [f64; 3], t: f64| self.sum(|d| (dot(d, n).abs() - t).max(0.0));
        let off = |k: usize| {
            let t = thickness + k as f64 * step;
            normals.iter().map(|n| beyond(*n, t)).sum::<f64>() / normals.len() as f64
        };
        (0..=steps).map(|k| off(k).abs()).fold(0.0, f64::max)
    }

    /// Weighted sum of a function of the displacement in mm.
    fn sum(&self, value: impl Fn([f64; 3]) -> f64) -> f64 {
        self.displacements.iter().map(|(d, orbit)| self.weights[*orbit] * value(self.mm(*d))).sum()
    }

    fn mm(&self, displacement: [i64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| displacement[a] as f64 * self.spacing.mm()[a])
    }

    /// The weights of displacements up to a length that meet the conditions best, in the sense of least squares.
    fn balanced(&self, longest: f64) -> Vec<f64> {
        let scale = self.longest / 3.0;
        let mut system = vec![vec![0.0; self.orbits() + 1]; self.orbits()];
        let mut ask = |weight: f64, wanted: f64, value: &dyn Fn([f64; 3]) -> f64| {
            let row = self.row(|d| weight * value(d));
            for (n, line) in system.iter_mut().enumerate() {
                line.iter_mut().zip(&row).for_each(|(sum, entry)| *sum += row[n] * entry);
                line[row.len()] += row[n] * weight * wanted;
            }
        };
        let normals: Vec<[f64; 3]> = half_sphere(DIRECTIONS).collect();
        for (n, &normal) in normals.iter().enumerate() {
            let other = normals[(7 * n + 3) % DIRECTIONS];
            let (along, across) = frame(normal, n as f64);
            ask(FACES, 1.0, &|d| dot(d, normal).abs());
            ask(RIMS / scale, 0.0, &|d| dot(d, normal).abs() * dot(d, along).abs());
            ask(RIMS / scale, 0.0, &|d| dot(d, normal).abs() * dot(d, other).abs());
            let beside = |d| libm::hypot(dot(d, normal), dot(d, along));
            ask(CYLINDERS / (scale * scale), 0.0, &|d| beside(d).powi(3));
            debug_assert!(dot(across, normal).abs() < 1e-9);
        }
        for axis in 0..3 {
            ask(GRID_FACES, 1.0, &|d| d[axis].abs());
        }
        ask(BALLS / (scale * scale), 0.0, &|d| dot(d, d).sqrt().powi(3));
        let noise = NOISE * DIRECTIONS as f64 * scale * scale;
        for (d, orbit) in &self.displacements {
            system[*orbit][*orbit] += if length(self.mm(*d)) > longest { LEFT_OUT } else { noise };
        }
        solved(system).into_iter().map(|solution| solution[0]).collect()
    }

    /// A function of the displacement, summed over each orbit.
    fn row(&self, value: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
        let mut row = vec![0.0; self.orbits()];
        for (d, orbit) in &self.displacements {
            row[*orbit] += value(self.mm(*d));
        }
        row
    }
}

/// One of each pair d, -d up to a length, and that length, mm.
fn displacements(spacing: Spacing) -> (Vec<[i64; 3]>, f64) {
    let mm = spacing.mm();
    let mut longest = (LONGEST * spacing.geometric_mean()).max(LONGEST_OF_SLICES * spacing.largest());
    let in_ball = |length: f64| 2.0 / 3.0 * PI * length.powi(3) / spacing.cell_volume();
    longest *= libm::cbrt((MOST as f64 / in_ball(longest)).min(1.0));
    let most = mm.map(|h| (longest / h) as i64);
    let mut all = Vec::new();
    for z in 0..=most[2] {
        for y in -most[1]..=most[1] {
            for x in -most[0]..=most[0] {
                let length: f64 = [x, y, z].iter().zip(mm).map(|(v, h)| (*v as f64 * h).powi(2)).sum();
                if [z, y, x] > [0, 0, 0] && length.sqrt() <= longest {
                    all.push([x, y, z]);
                }
            }
        }
    }
    (all, longest)
}

/// Two directions across a normal and each other, turned about it.
fn frame(normal: [f64; 3], turn: f64) -> ([f64; 3], [f64; 3]) {
    let [x, y, z] = normal;
    // Duff et al. 2017, for z >= 0.
    let a = -1.0 / (1.0 + z);
    let (u, v) = ([1.0 + a * x * x, a * x * y, -x], [a * x * y, 1.0 + a * y * y, -y]);
    let (sin, cos) = libm::sincos(TAU * (turn * 0.618_034).fract());
    let along = std::array::from_fn(|i| cos * u[i] + sin * v[i]);
    (along, std::array::from_fn(|i| cos * v[i] - sin * u[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions, rims and lengths on which nothing was asked.
    #[test]
    fn faces_count_alike_and_rims_cancel() {
        for (mm, face, rim) in
            [([1.0; 3], 0.006, 0.05), ([0.4, 0.4, 1.0], 0.015, 0.08), ([0.3, 0.7, 0.5], 0.015, 0.06)]
        {
            let spacing = Spacing::new(mm).unwrap();
            let weights = PairWeights::new(spacing);
            for (n, normal) in half_sphere(97).enumerate() {
                let (along, _) = frame(normal, 0.37 * n as f64);
                let area = weights.sum(|d| dot(d, normal).abs());
                assert!((area - 1.0).abs() < face, "{mm:?} {normal:?}: {area}");
                let lost = weights.sum(|d| dot(d, normal).abs() * dot(d, along).abs()) / weights.longest;
                assert!(lost.abs() < rim, "{mm:?} {normal:?}: {lost}");
            }
            assert!(weights.loss_of_layer(weights.longest) < 1e-12);
            assert!((weights.loss_of_layer(0.0) - 1.0).abs() < 0.05);
        }
    }
}
