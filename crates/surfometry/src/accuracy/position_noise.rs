//! How far the surface of a mask's blur is off, by where its voxels happen to lie.

use super::terraces::{inverse_fourth_powers, is_primitive};
use crate::space::dot;
use crate::volume::Grid;
use std::f64::consts::PI;

/// Largest index, along an axis, of the reciprocal lattice's points that are looked at one by one: waves are as high as 1 / xi.
const REACH: i64 = 2;
/// Multiples of each that are looked at: what lies beyond has 1 % of the variance of a face along the grid.
const MULTIPLES: u32 = 40;
/// 1 + 1 / 2^4 + 1 / 3^4 + ..: of all multiples of a point, in the sum of 1 / xi^4.
const OF_MULTIPLES: f64 = 1.082_323_233_711_138;
/// Integral of u times the square of what is left at a phase of u, of the plain blur whose shift is taken off and of the
/// corrected one.
const LEFT_OF_ALL: [f64; 2] = [1.25, 11.0 / 12.0];
/// Phase over which a blur leaves nothing of a wave.
const GONE: f64 = 6.0;

/// The standard deviation of a surface's position along its normal, of a mask's blur whose shift is taken off.
///
/// On a plane, the sampled indicator's spectrum at a point xi of the reciprocal lattice is a wave of height 1 / (2 pi xi), of
/// which a blur leaves exp(-2 pi^2 sigma^2 xi_t^2), xi_t being xi's part along the plane, and taking the shift off some more.
/// Their sum is that of a sub-voxel shift at random. On faces along the grid it is h^2 / 12, and over all directions the law of
/// lattice points, by which V scatters (`accuracy/uncertainty.rs`): no constant is fitted.
#[derive(Debug, Clone)]
pub struct PositionNoise {
    /// Points of the reciprocal lattice in the world, 1/mm: one of each and its opposite, none a multiple of another.
    frequencies: Vec<[f64; 3]>,
    /// Of all others the sum of 1 / xi^4, mm^4: they are as many in any direction.
    others: f64,
    sigma: f64,
    is_corrected: bool,
}

impl PositionNoise {
    /// Of a blur of sigma mm on a grid: of the corrected one, or of the plain one whose shift -sigma^2 H is taken off.
    pub(crate) fn new(grid: &Grid, sigma: f64, is_corrected: bool) -> Self {
        let reciprocal = grid.affine().reciprocal();
        let all = || -REACH..=REACH;
        let indices = all().flat_map(|i| all().flat_map(move |j| all().map(move |k| [i, j, k])));
        let of_half = indices.filter(|&index| index > [0; 3] && is_primitive(index));
        let in_world = |index: [i64; 3]| -> [f64; 3] {
            std::array::from_fn(|w| (0..3).map(|a| index[a] as f64 * reciprocal[a][w]).sum())
        };
        let frequencies: Vec<[f64; 3]> = of_half.map(in_world).collect();
        let known: f64 = frequencies.iter().map(|f| 2.0 * OF_MULTIPLES / dot(*f, *f).powi(2)).sum();
        let others = (inverse_fourth_powers(grid.spacing()) - known).max(0.0);
        Self { frequencies, others, sigma, is_corrected }
    }

    /// The variance, mm^2, where the surface has a unit normal in the world, and another sigma, mm, where it has one of its own
    /// there.
    pub(crate) fn variance(&self, normal: [f64; 3], sigma: Option<f64>) -> f64 {
        let sigma = sigma.unwrap_or(self.sigma);
        let phase = 2.0 * PI * sigma;
        let of_wave = |frequency: &[f64; 3]| {
            let square = dot(*frequency, *frequency);
            let across = dot(*frequency, normal);
            let along = phase * (square - across * across).max(0.0).sqrt();
            let left = (1..=MULTIPLES).map(|n| (f64::from(n), f64::from(n) * along));
            let left = left.take_while(|(_, phase)| *phase < GONE);
            left.map(|(n, phase)| (self.left_at(phase) / n).powi(2)).sum::<f64>() / (2.0 * PI * PI * square)
        };
        let spread = self.others / (8.0 * PI.powi(3)) * LEFT_OF_ALL[usize::from(self.is_corrected)];
        spread / (2.0 * PI * sigma * sigma) + self.frequencies.iter().map(of_wave).sum::<f64>()
    }

    /// Sigma, mm, where no other is known.
    pub(crate) fn sigma(&self) -> f64 {
        self.sigma
    }

    /// What is left of a wave of so many radians a sigma along the surface.
    fn left_at(&self, phase: f64) -> f64 {
        let half_square = 0.5 * phase * phase;
        let blurred = libm::exp(-half_square);
        // The corrected blur's two terms, of which the wider weighs -1 on an edge; and a wave's shift by its curvature.
        if self.is_corrected { (2.0 - blurred) * blurred } else { (1.0 + half_square) * blurred }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Affine;

    /// A face along the grid is anywhere between two slices; over all directions, of an unblurred surface's long waves, noise is
    /// that of the lattice-point law, A / (8 pi^3 xi^4) of V, spread by the blur over 4 pi sigma^2.
    #[test]
    fn faces_and_the_mean_over_directions_are_known_laws() {
        const N: i32 = 300;
        let spacing = [0.7, 0.8, 1.1];
        let grid = Grid::axis_aligned([4; 3], spacing).unwrap();
        let turned =
            Affine { linear: [[0.0, 0.8, 0.0], [0.7, 0.0, 0.0], [0.0, 0.0, -1.1]], origin: [5.0; 3] };
        let turned = Grid::new([4; 3], turned).unwrap();
        for (axis, h) in spacing.into_iter().enumerate() {
            let normal = std::array::from_fn(|a| f64::from(u8::from(a == axis)));
            let noise = PositionNoise::new(&grid, 2.0, true).variance(normal, None);
            assert!((noise / (h * h / 12.0) - 1.0).abs() < 0.04, "{axis}: {noise}");
        }
        let normal = [0.6, 0.8, 0.0];
        let [a, b] = [(&grid, normal), (&turned, [0.8, 0.6, 0.0])]
            .map(|(grid, normal)| PositionNoise::new(grid, 1.5, false).variance(normal, None));
        assert!((a / b - 1.0).abs() < 1e-12);
        let sigma = 4.0;
        let noise = PositionNoise::new(&grid, sigma, false);
        let (mut sum, mut area) = (0.0, 0.0);
        for i in 0..N {
            // Even in the angle to the pole, which is a peak as the other axes are.
            let (r, z) = (0.5 * PI * (f64::from(i) + 0.5) / f64::from(N)).sin_cos();
            for j in 0..2 * N {
                let (sin, cos) = (PI * (f64::from(j) + 0.5) / f64::from(N)).sin_cos();
                (sum, area) = (sum + r * noise.variance([r * cos, r * sin, z], None), area + r);
            }
        }
        let spectrum = inverse_fourth_powers(grid.spacing()) / (8.0 * PI.powi(3));
        let expected = 2.5 * spectrum / (4.0 * PI * sigma * sigma);
        assert!((sum / area / expected - 1.0).abs() < 0.03, "{} {expected}", sum / area);
    }
}
