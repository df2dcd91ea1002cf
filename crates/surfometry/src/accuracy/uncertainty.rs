//! Standard errors of integrals.

use super::Terraces;
use super::occupancy_noise::OccupancyNoise;
use super::terraces::inverse_fourth_powers;
use crate::embedding::EdgeProfile;
use crate::integrals::{Integrals, SmearedDelta, SurfaceIntegrals};
use crate::surface::Spectrum;
use crate::volume::Spacing;
use std::f64::consts::PI;

/// Standard errors of an object's integrals, or the part of them that the grid makes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntegralErrors {
    /// Of V, mm^3.
    pub volume: f64,
    /// Of A, mm^2.
    pub area: f64,
    /// Of M, mm.
    pub total_mean_curvature: f64,
    /// Of M / A, 1/mm.
    pub average_mean_curvature: f64,
    /// Of the integral of K.
    pub total_gaussian_curvature: f64,
    /// Of the integral of H^2.
    pub total_squared_mean_curvature: f64,
}

impl IntegralErrors {
    /// The same with more of a cause that is independent of the others.
    #[must_use]
    pub fn with(self, area: f64, total_mean_curvature: f64, surface: &SurfaceIntegrals) -> Self {
        let values = [surface.area, surface.total_mean_curvature];
        let average = of_average(values, [area, total_mean_curvature], 0.0);
        Self {
            area: libm::hypot(self.area, area),
            total_mean_curvature: libm::hypot(self.total_mean_curvature, total_mean_curvature),
            average_mean_curvature: libm::hypot(self.average_mean_curvature, average),
            ..self
        }
    }

    /// The same of an object of which so much of V, mm^3, is off in the same direction beside what these know of: its surface moves
    /// as a whole, as a tube's does.
    #[must_use]
    pub(crate) fn moved(self, volume: f64, surface: &SurfaceIntegrals) -> Self {
        let mean = volume * surface.total_gaussian_curvature.abs() / surface.area;
        let errors = self.with(rms_curvature(surface) * volume, mean, surface);
        Self { volume: libm::hypot(self.volume, volume), ..errors }
    }
}

/// What is left after compensation, in units of sigma^4 times the integral of the third, fourth and fifth
/// power of the larger principal curvature for V, A and M. On balls of R = 5 sigma it is 0.117, 0.29 and 0.34
/// of that (closed form); somewhat more here, as calibrated on the zoo (docs/accuracy.md).
const REMAINDER: [f64; 3] = [0.16, 0.38, 0.40];
/// The same of A at edges, where the surface turns within a few sigma, in units of sigma^6 times the integral
/// of the sixth power.
const EDGES: f64 = 3.0;
/// Noise of A and M in units of what V's, spread over a ball of radius R, would make of them.
const AREA_NOISE: f64 = 1.0;
const MEAN_NOISE: f64 = 1.0;
/// What is left after terraces are taken off on the mean over directions: shares of A and M in units of the
/// sum over the axes of (h / sigma)^4. Of cubic voxels at a blur of two they are 0.04 %; of slices six times as thick as
/// wide, 2 %, as happens to bodies, bones and tubes there.
const TERRACES: [f64; 2] = [0.0022, 0.0018];
/// Share of A that faces a few degrees off the grid gain at most, in units of (h / sigma)^2: slabs have 2.0, 1.3, 0.7 and
/// 0.1 % at 4, 7, 9 and 12 degrees and a blur of two voxels.
const TILTED_EXCESS: f64 = 0.048;
/// Share of A up to which as much of a smooth body lies so: three times that of a ball.
const USUALLY_TILTED: f64 = 0.23;
/// M that is nearly 0, as of minimal surfaces, counts as this share of A / R there.
const LEAST_MEAN: f64 = 0.25;
/// The change of M by compensation, which may cancel over a surface, counts as at least this share of sigma^2
/// A / R^3.
const LEAST_CHANGE: f64 = 0.15;
/// Noise of chi of a surface of one ball's total curvature, in units of (h / sigma)^2.
const EULER_NOISE: f64 = 0.006;

/// Correlation of the errors of A and M: where voxels happen to make an object larger, both grow, and terraces and what
/// compensation leaves have one sign in both. It is 0.6 to 0.9 over random poses of organs, tubes and ellipsoids.
pub(crate) const SHARED: f64 = 0.7;

/// What errors follow from beside the integrals: the grid, the blur and the band, the same for all objects of
/// an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorModel {
    spacing: Spacing,
    pub(super) sigma: f64,
    /// [`inverse_fourth_powers`].
    pub(super) lattice: f64,
    /// By how much the band's sum is off on faces along the grid, by axis.
    face_excess: [f64; 3],
    /// Of shares of voxels instead of bits.
    pub(super) occupancies: Option<OccupancyNoise>,
}

impl ErrorModel {
    /// For surfaces after a blur of sigma mm, integrated over a band of some thickness in mm.
    pub fn new(spacing: Spacing, sigma: f64, thickness: f64) -> Self {
        let face_excess = spacing.mm().map(|h| face_excess(thickness / h));
        let lattice = inverse_fourth_powers(spacing);
        Self { spacing, sigma, lattice, face_excess, occupancies: None }
    }

    /// The same of an object of which the shares of voxels are known, seen by a band's delta.
    #[must_use]
    pub fn of_occupancies(self, profile: &EdgeProfile, delta: &SmearedDelta) -> Self {
        Self { occupancies: Some(OccupancyNoise::new(self.spacing, profile, delta)), ..self }
    }

    /// What the blur leaves of the voxels' terraces, seen by a band's delta: for
    /// [`compensation_terms`](super::compensation_terms).
    pub fn terraces(&self, profile: &EdgeProfile, delta: &SmearedDelta) -> Terraces {
        Terraces::new(self.spacing, self.lattice, profile, delta)
    }

    /// Standard deviation, over sub-voxel shifts, of the volume of the voxels of a body with a smooth curved surface, mm^3.
    ///
    /// It is that of a sum of the indicator's Fourier coefficients over the reciprocal lattice, which fall as A / (8 pi^3
    /// xi^4) on the mean over directions (Kendall 1948 for balls): 0.258 h^2 sqrt(A) on cubic voxels.
    pub(crate) fn volume_of_curved(&self, area: f64) -> f64 {
        (area / (8.0 * PI.powi(3)) * self.lattice).sqrt()
    }

    /// The variance of V, mm^6, by how a surface lies in the grid.
    pub(crate) fn variance_of_volume(&self, spectrum: &Spectrum) -> f64 {
        spectrum.variance_of_volume(self.spacing, self.sigma, self.lattice)
    }

    /// What open rims of so much length, mm, add to the standard error of M.
    ///
    /// Moving a surface by u changes the integral of H by that of u K, and along a rim by half of that of u's derivative across
    /// it: of a closed surface's noise H sees next to nothing, of an open one's it sees how steep that is at the rim. The noise of a
    /// blurred mask has the spectrum exp(-sigma^2 k^2): where H scatters by sqrt(S / (64 pi^4)) / sigma^3 (docs/method.md; S is the
    /// sum of 1 / xi^4 over the reciprocal lattice) its slope does by sigma times that, and along a line it forgets itself over
    /// 2 sqrt(pi) sigma.
    pub(crate) fn mean_of_open_rims(&self, length: f64) -> f64 {
        let slope = self.lattice.sqrt() / (8.0 * PI * PI * self.sigma * self.sigma);
        0.5 * slope * (2.0 * PI.sqrt() * self.sigma * length).sqrt()
    }

    /// Standard deviations of V, mm^3, and A, mm^2, by flat faces along the grid, of an area by axis: the place of one is
    /// known to h / sqrt 12 alone, as a whole, and it moves its rims.
    pub(crate) fn of_faces(&self, faces: [f64; 3]) -> [f64; 2] {
        let variances = (0..3).map(|a| {
            let (face, step) = (with_rim(faces[a], self.sigma), self.spacing.mm()[a] / libm::sqrt(12.0));
            [(step * face).powi(2), step * step * 4.0 * PI * face]
        });
        variances.fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]).map(f64::sqrt)
    }

    /// Spread over sub-voxel shifts and rotations of what a smooth, curved object's voxels give, and of what
    /// faces along the grid do. A blur moves the surface, and with it this noise.
    pub fn grid_noise(&self, integrals: &Integrals) -> IntegralErrors {
        let surface = &integrals.surface;
        let curvature = rms_curvature(surface);
        let faces = integrals.faces.map(|area| with_rim(area, self.sigma));
        let curved = self.volume_of_curved(surface.area);
        let [flat, rims] = self.of_faces(integrals.faces);
        let volume = libm::hypot(curved, flat);
        let excess: f64 = (0..3).map(|a| (self.face_excess[a] * faces[a]).powi(2)).sum();
        let balls = (surface.area * curvature.powi(2) / (4.0 * PI)).max(1.0);
        let ratio = (self.spacing.largest() / self.sigma).powi(2);
        let [rough_area, rough_mean] = left_of_terraces(self.spacing, self.sigma);
        let least_mean = least_mean(surface);
        let area = libm::hypot(
            libm::hypot(AREA_NOISE * 2.0 * curvature * curved, libm::hypot(rims, excess.sqrt())),
            rough_area * surface.area,
        );
        let mean = libm::hypot(
            MEAN_NOISE * curvature.powi(2) * volume,
            rough_mean * surface.total_mean_curvature.abs().max(least_mean),
        );
        let gaussian = 2.0 * PI * EULER_NOISE * ratio * balls.sqrt();
        let average = surface.error_of_average(area, mean);
        let bits = IntegralErrors {
            volume,
            area,
            total_mean_curvature: mean,
            average_mean_curvature: average,
            total_gaussian_curvature: gaussian,
            total_squared_mean_curvature: gaussian,
        };
        let Some(occupancies) = &self.occupancies else { return bits };
        // The place of a face is known then, up to what the sampled Heaviside makes of it.
        let face_steps: [f64; 3] =
            std::array::from_fn(|a| self.face_excess[a] * self.spacing.mm()[a] / (2.0 * PI) * faces[a]);
        let flat_volume = face_steps.iter().map(|step| step * step).sum::<f64>().sqrt();
        let shares = occupancies.of(surface, least_mean, [flat_volume, excess.sqrt()], &bits);
        IntegralErrors {
            average_mean_curvature: surface.error_of_average(shares.area, shares.total_mean_curvature),
            ..shares
        }
    }

    /// Errors of an object that consists of so many copies of one part, which are all off in the same direction: a shell
    /// that is thicker by d than it should be has 2 d / R more area and d / R^2 more M.
    #[must_use]
    pub fn of_copies(&self, copies: f64, errors: IntegralErrors, integrals: &Integrals) -> IntegralErrors {
        let curvature = rms_curvature(&integrals.surface);
        let more = self.grid_noise(integrals).volume * (copies - 1.0).sqrt();
        errors.with(2.0 * curvature * more, curvature * curvature * more, &integrals.surface)
    }

    /// What wide terraces of flat faces a few degrees off the grid add to A. Taking terraces off on the mean over
    /// directions leaves it where more of a surface lies so than of a smooth body.
    fn tilted_faces(&self, integrals: &Integrals) -> f64 {
        let ratio = (self.spacing.geometric_mean() / self.sigma).powi(2);
        let usual = USUALLY_TILTED * integrals.surface.area;
        TILTED_EXCESS * ratio * (integrals.tilted - usual).max(0.0)
    }

    /// Standard errors of compensated values: the grid's noise, and the bias that is left. It is at most what
    /// compensation changed: where the surface turns within a sigma, as where slices are thick, powers of
    /// curvature only tell noise. Of A and M it is at least what the gradient of H tells, mm^2 and mm; 0 where that is not known.
    pub fn compensated(
        &self,
        integrals: &Integrals,
        [ripples_of_area, ripples_of_mean]: [f64; 2],
    ) -> IntegralErrors {
        let noise = self.grid_noise(integrals);
        let surface = &integrals.surface;
        let curvature = rms_curvature(surface);
        // The integrals of the third and fifth power, from those of the second and fourth: equal where
        // curvature is the same everywhere.
        let second = surface.area * curvature.powi(2);
        let third = (second * surface.larger_fourth).sqrt();
        let fifth = surface.larger_fourth * (surface.larger_fourth / second).sqrt();
        let (square, fourth) = (self.sigma.powi(2), self.sigma.powi(4));
        let [of_volume, of_area, of_mean] = REMAINDER;
        let edges = EDGES * self.sigma.powi(6) * surface.larger_sixth;
        let most_of_mean = (square * surface.mean_times_gaussian.abs())
            .max(LEAST_CHANGE * square * surface.area * curvature.powi(3));
        let volume = (of_volume * fourth * third).min(square * surface.area * curvature);
        let area = libm::hypot(of_area * fourth * surface.larger_fourth, edges)
            .min(2.0 * square * surface.total_squared_mean_curvature);
        let mean = (of_mean * fourth * fifth).min(most_of_mean);
        let directed = self.occupancies.map_or([0.0; 3], |occupancies| occupancies.directed(surface));
        // Powers of curvature and its gradient tell of the same: where a surface turns, they are both large.
        let bias = [volume, area.max(ripples_of_area), mean.max(ripples_of_mean)];
        let [volume, area, mean] = std::array::from_fn(|n| libm::hypot(bias[n], directed[n]));
        let area = libm::hypot(area, self.tilted_faces(integrals));
        let (area, mean) = (libm::hypot(noise.area, area), libm::hypot(noise.total_mean_curvature, mean));
        IntegralErrors {
            volume: libm::hypot(noise.volume, volume),
            area,
            total_mean_curvature: mean,
            average_mean_curvature: surface.error_of_average(area, mean),
            ..noise
        }
    }
}

impl SurfaceIntegrals {
    fn error_of_average(&self, area_error: f64, mean_error: f64) -> f64 {
        of_average([self.area, self.total_mean_curvature], [area_error, mean_error], SHARED)
    }
}

/// What terraces leave in A and M, as shares of them.
pub(crate) fn left_of_terraces(spacing: Spacing, sigma: f64) -> [f64; 2] {
    let fourths = spacing.mm().map(|h| (h / sigma).powi(4));
    TERRACES.map(|share| share * fourths.iter().sum::<f64>())
}

/// What M that cancels over a surface counts as at least, mm.
pub(super) fn least_mean(surface: &SurfaceIntegrals) -> f64 {
    LEAST_MEAN * surface.area * rms_curvature(surface)
}

/// 1/R, the rms of the larger principal curvature.
fn rms_curvature(surface: &SurfaceIntegrals) -> f64 {
    (surface.larger_squared / surface.area).sqrt()
}

/// Error of M / A, from those of A and M and their correlation.
pub(crate) fn of_average(
    [area, mean]: [f64; 2],
    [area_error, mean_error]: [f64; 2],
    correlation: f64,
) -> f64 {
    let (of_mean, of_area) = (mean_error / area, area_error * mean / (area * area));
    (of_mean * of_mean + of_area * of_area - 2.0 * correlation * of_mean * of_area).max(0.0).sqrt()
}

/// A face's area, from that of which the normal is an axis: the blur rounds a rim two sigma wide. A cap of a
/// curved surface is small and has none to speak of.
fn with_rim(area: f64, sigma: f64) -> f64 {
    let radius = (area / PI).sqrt();
    if radius > 0.0 { area * (1.0 + 2.0 * sigma / radius).min(2.0).powi(2) } else { 0.0 }
}

/// How far the sum over a band of the sine delta is off 1 on a flat face between voxels, where all faces
/// along the grid lie: 4.7 % at a thickness of 2.5 voxels, 0 at 3. In any other direction, offsets average
/// out.
fn face_excess(thickness: f64) -> f64 {
    let sample = |x: f64| (1.0 + libm::cos(2.0 * PI * x / thickness)) / thickness;
    let inside = (0..1000).map(|n| f64::from(n) + 0.5).take_while(|x| *x < 0.5 * thickness);
    2.0 * inside.map(sample).sum::<f64>() - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_of_whole_voxels_is_exact_on_faces() {
        assert!((face_excess(2.5) - 0.047).abs() < 1e-3, "{}", face_excess(2.5));
        assert!([2.0, 3.0, 4.0, 7.0].iter().all(|&t| face_excess(t).abs() < 1e-12));
    }
}
