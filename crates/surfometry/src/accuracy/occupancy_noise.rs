//! What the grid leaves of an object of which the shares of voxels are known.

use super::IntegralErrors;
use super::terraces::SampledDelta;
use crate::embedding::EdgeProfile;
use crate::integrals::{SmearedDelta, SurfaceIntegrals};
use crate::volume::Spacing;
use std::f64::consts::PI;

/// Noise of integrals over the blurred shares of voxels.
///
/// Shares have no terraces: averaging over a voxel takes away, of the object's spectrum, the frequencies that
/// its samples would fold back. What is left is that the band's smooth delta is summed at the voxels, not
/// integrated. A frequency xi of the reciprocal lattice adds to A the delta's spectrum D(xi) times the
/// integral of exp(2 pi i xi x) over the surface, of which only the points count where the normal is along
/// xi: a variance of D^2 / (xi^2 K) each, on the mean over directions D^2 A / (2 pi xi^2) of all, and twice
/// that where the ends of an object are in step, as of balls and all that is symmetric about a point: that is
/// what counts here. The smeared Heaviside has the spectrum D / (2 pi xi).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OccupancyNoise {
    /// Sums over the reciprocal lattice of D^2 / xi^2, mm^2, and of D^2 / xi^4, mm^4.
    sampling: [f64; 2],
    /// Standard deviation, over the axes, of a voxel's variance h^2 / 12, mm^2.
    spread: f64,
    /// Share of A and M that is not known.
    least: f64,
}

/// By how much variances are larger where opposite ends are in step.
const IN_STEP: f64 = 2.0;
/// Shares are counted, computed or stored to this share of the noise of bits (8 x 8 x 8 points in a voxel: 1
/// / 64).
const INEXACT: f64 = 1.0 / 30.0;
/// What differences, cut kernels and the mean over directions leave of A and M, as a share of them.
const LEAST: f64 = 1.5e-4;
/// The same of what a blur as narrow as the largest spacing leaves of its slices; it falls steeply (A was off
/// by -0.1 % at that blur, -0.03 % at 1.15 spacings, -0.01 % at 1.35).
const SLICES: f64 = 1e-3;
/// How much of the spread of a voxel's variance over the axes an object may meet that has no direction like
/// another.
const DIRECTED: f64 = 0.5;

impl OccupancyNoise {
    pub(super) fn new(spacing: Spacing, profile: &EdgeProfile, delta: &SmearedDelta) -> Self {
        let mut sampling = [0.0; 2];
        let sampled = SampledDelta::new(spacing, profile, delta);
        for frequency in sampled.frequencies() {
            for xi in sampled.harmonics(frequency) {
                // One of xi and -xi is told.
                let square = 2.0 * (sampled.spectrum(xi, 0.0) / xi).powi(2);
                sampling[0] += square;
                sampling[1] += square / (xi * xi);
            }
        }
        let variances = spacing.mm().map(|h| h * h / 12.0);
        let mean = variances.iter().sum::<f64>() / 3.0;
        let spread = (variances.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 3.0).sqrt();
        let least = LEAST + SLICES * (spacing.largest() / profile.sigma()).powi(8);
        Self { sampling, spread, least }
    }

    /// From the noise of bits, and the noise of V and A that flat faces have because the delta is sampled.
    pub(super) fn of(
        &self,
        surface: &SurfaceIntegrals,
        least_mean: f64,
        [flat_volume, flat_area]: [f64; 2],
        bits: &IntegralErrors,
    ) -> IntegralErrors {
        let [squares, fourths] = self.sampling;
        let root = |a: f64, b: f64, c: f64| (a * a + b * b + c * c).sqrt();
        IntegralErrors {
            volume: root(
                (IN_STEP * surface.area * fourths / (8.0 * PI.powi(3))).sqrt(),
                INEXACT * bits.volume,
                flat_volume,
            ),
            area: root(
                (IN_STEP * surface.area * squares / (2.0 * PI)).sqrt(),
                self.least * surface.area,
                flat_area,
            ),
            total_mean_curvature: root(
                (IN_STEP * surface.total_squared_mean_curvature * squares / (2.0 * PI)).sqrt(),
                self.least * surface.total_mean_curvature.abs().max(least_mean),
                0.0,
            ),
            ..*bits
        }
    }

    /// How far V, A and M may be off because compensation takes a voxel's variance on the mean over
    /// directions.
    pub(super) fn directed(&self, surface: &SurfaceIntegrals) -> [f64; 3] {
        let changes = [
            surface.total_mean_curvature,
            2.0 * surface.total_squared_mean_curvature,
            surface.mean_times_gaussian,
        ];
        changes.map(|change| DIRECTED * self.spread * change.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::epsilon_of_blur;
    use crate::integrals::Smearing;

    /// Sums of the delta over balls at random places, against the law; the field is the flat edge's profile
    /// at the distance from the sphere, exact.
    #[test]
    fn sampling_noise_is_that_of_sums_over_balls() {
        let spacing = Spacing::new([1.0, 1.0, 1.3]).unwrap();
        let profile = EdgeProfile::blurred(2.0);
        let delta = SmearedDelta::new(Smearing::Sine, epsilon_of_blur(&profile, 2.5), 0.5);
        let noise = OccupancyNoise::new(spacing, &profile, &delta);
        let h = spacing.mm();
        let area_of = |radius: f64, shift: [f64; 3]| {
            let reach = h.map(|h| ((radius + 3.0) / h).ceil() as i64);
            let mut sum = 0.0;
            for z in -reach[2]..=reach[2] {
                for y in -reach[1]..=reach[1] {
                    for x in -reach[0]..=reach[0] {
                        let at: [f64; 3] = std::array::from_fn(|a| [x, y, z][a] as f64 * h[a] - shift[a]);
                        let distance = at.iter().map(|v| v * v).sum::<f64>().sqrt() - radius;
                        if distance.abs() < 2.0 {
                            sum += delta.delta(profile.value(distance)) * profile.slope(distance);
                        }
                    }
                }
            }
            sum * spacing.cell_volume()
        };
        let areas: Vec<f64> = (0..60)
            .map(|n| {
                let part = |share: f64| (f64::from(n) * share).fract();
                let radius = 10.0 + 2.0 * part(0.754_877_666);
                let shift = [part(0.618_033_989), part(0.569_840_291), 1.3 * part(0.324_717_957)];
                let exact = 4.0 * PI * radius * radius;
                // Beside noise, the band adds its variance times 4 pi, the same at all radii.
                (area_of(radius, shift) - exact) / radius
            })
            .collect();
        let mean = areas.iter().sum::<f64>() / areas.len() as f64;
        let found = (areas.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / areas.len() as f64).sqrt();
        let law = (4.0 * PI * IN_STEP * noise.sampling[0] / (2.0 * PI)).sqrt();
        assert!((found / law - 1.0).abs() < 0.3, "{found} {law}");
    }
}
