//! Low waves on round bodies, and creases of soft segmentations: what compensation leaves of both is in the errors of A and M.

mod common;

use common::off_by;
use std::f64::consts::PI;
use surfometry::Measurement;
use surfometry::measurement::EmbeddingKind;
use surfometry::volume::{Grid, Mask, ProbabilityImage};

/// A body of revolution about an axis that no axis of the grid is: r = R (1 + a cos(k cos theta)).
struct Waved {
    radius: f64,
    height: f64,
    waves: f64,
}

impl Waved {
    fn radius_at(&self, cosine: f64) -> f64 {
        self.radius * (1.0 + self.height * (self.waves * cosine).cos())
    }

    fn holds(&self, [x, y, z]: [f64; 3]) -> bool {
        let r = (x * x + y * y + z * z).sqrt();
        r < self.radius_at((0.48 * x + 0.6 * y + 0.64 * z) / r.max(1e-9))
    }

    /// A and M, by quadrature over the meridian.
    fn truth(&self) -> [f64; 2] {
        let Self { radius, height, waves } = *self;
        let count = 200_000;
        let piece = |n: usize| {
            let theta = (n as f64 + 0.5) * PI / count as f64;
            let (s, c) = theta.sin_cos();
            let (sine, cosine) = (waves * c).sin_cos();
            let r = radius * (1.0 + height * cosine);
            let slope = radius * height * waves * s * sine;
            let bend = radius * height * waves * (c * sine - waves * s * s * cosine);
            let length = (r * r + slope * slope).sqrt();
            let along = (r * r + 2.0 * slope * slope - r * bend) / length.powi(3);
            let around = (r - slope * c / s) / (r * length);
            let area = 2.0 * PI * r * s * length;
            [area, 0.5 * area * (along + around)]
        };
        let sum = (0..count).map(piece).fold([0.0; 2], |sum, piece| [sum[0] + piece[0], sum[1] + piece[1]]);
        sum.map(|sum| sum * PI / count as f64)
    }
}

/// Waves of 9 to 15 voxels, some tenths of a voxel high.
#[test]
fn what_is_missing_of_waves_is_in_the_errors() {
    for (spacing, radius, height, waves) in [
        ([1.0; 3], 30.0, 0.02, 18.0),
        ([1.0; 3], 30.0, 0.025, 14.0),
        ([1.0; 3], 24.0, 0.01, 16.0),
        ([0.7, 0.9, 1.25], 26.0, 0.02, 15.0),
    ] {
        let body = Waved { radius, height, waves };
        let size = spacing.map(|h| (2.3 * radius / h) as usize + 8);
        let centre: [f64; 3] = std::array::from_fn(|a| 0.5 * size[a] as f64 + [0.13, 0.41, 0.27][a]);
        let grid = Grid::axis_aligned(size, spacing).unwrap();
        let at = |index: [usize; 3]| std::array::from_fn(|a| (index[a] as f64 - centre[a]) * spacing[a]);
        let mask = Mask::from_predicate(grid, |index| body.holds(at(index)));
        let choices = Measurement::default().embedding(EmbeddingKind::Gaussian);
        let found = off_by(&choices.run(&mask).unwrap(), body.truth());
        println!("{radius} {height} {waves} {spacing:?}: {found:?}");
        for [share, z] in found {
            // The area of waves is what a blur takes: it is never gained.
            assert!((-0.012..-0.0005).contains(&share) && (-1.5..-0.15).contains(&z), "{share} {z}");
        }
    }
}

/// Two balls and a rod between them, of which the shares of voxels are known.
#[test]
fn creases_of_soft_segmentations_are_in_the_errors() {
    for (radius, apart, rod) in [(12.0_f64, 15.0_f64, 9.0_f64), (14.0, 18.0, 6.0)] {
        let foot = (radius * radius - rod * rod).sqrt();
        let (cap, length) = (2.0 * PI * radius * (radius - foot), 2.0 * (apart - foot));
        let area = 2.0 * (4.0 * PI * radius * radius - cap) + 2.0 * PI * rod * length;
        let crease = 2.0 * 2.0 * PI * rod * (rod / radius).acos();
        let mean = 2.0 * (4.0 * PI * radius * radius - cap) / radius + PI * length - 0.5 * crease;
        let side = (2.0 * (apart + radius)) as usize + 12;
        let centre = [0.21, 0.37, 0.44].map(|shift| 0.5 * side as f64 + shift);
        let holds = |at: [f64; 3]| {
            let along = 0.48 * at[0] + 0.6 * at[1] + 0.64 * at[2];
            let square: f64 = at.iter().map(|v| v * v).sum();
            let across = square - along * along;
            let ball = |middle: f64| across + (along - middle).powi(2) < radius * radius;
            ball(apart) || ball(-apart) || along.abs() < apart && across < rod * rod
        };
        let mut values = Vec::with_capacity(side.pow(3));
        for voxel in 0..side.pow(3) {
            let index = [voxel % side, voxel / side % side, voxel / (side * side)];
            let points =
                (0..64).map(|n| [n % 4, n / 4 % 4, n / 16].map(|step| 0.25 * f64::from(step) - 0.375));
            let inside =
                points.filter(|shift| holds(std::array::from_fn(|a| index[a] as f64 + shift[a] - centre[a])));
            values.push(inside.count() as f32 / 64.0);
        }
        let grid = Grid::axis_aligned([side; 3], [1.0; 3]).unwrap();
        let image = ProbabilityImage::new(grid, values).unwrap();
        let choices = Measurement::default().embedding(EmbeddingKind::Probability);
        let measured = choices.run_probability(&image).unwrap();
        let found = off_by(&measured, [area, mean]);
        println!("{radius} {apart} {rod}: {found:?}");
        for [share, z] in found {
            assert!((-0.016..-0.003).contains(&share) && (-2.0..-0.4).contains(&z), "{share} {z}");
        }
    }
}
