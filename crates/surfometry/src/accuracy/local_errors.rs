//! Standard errors of local curvature.

use super::rms_spacing;
use crate::local_geometry::Curvature;
use crate::volume::Spacing;

/// Standard errors of a vertex' curvature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvatureErrors {
    /// Of H, 1/mm.
    pub mean_curvature: f32,
    /// Of K, 1/mm^2.
    pub gaussian_curvature: f32,
    /// Of k1 and of k2, 1/mm.
    pub principal: f32,
    /// Of the shape index, at most 1.
    pub shape_index: f32,
}

/// By how much the curvature of the embedding that is not corrected differs, in magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvatureDifferences {
    /// H, 1/mm.
    pub mean_curvature: f32,
    /// K, 1/mm^2.
    pub gaussian_curvature: f32,
    /// The larger of those of k1 and k2, 1/mm.
    pub principal: f32,
}

impl CurvatureDifferences {
    /// Of two curvatures.
    pub(crate) fn of(a: &Curvature, b: &Curvature) -> Self {
        let of = |a: f64, b: f64| (a - b).abs() as f32;
        let [k1, k2] = [0, 1].map(|n| of(a.principal()[n], b.principal()[n]));
        Self {
            mean_curvature: of(a.mean_curvature, b.mean_curvature),
            gaussian_curvature: of(a.gaussian_curvature, b.gaussian_curvature),
            principal: k1.max(k2),
        }
    }
}

impl CurvatureErrors {
    /// Where there is no curvature: that of a voxel's size, which is all that can be said.
    pub(crate) fn unknown(spacing: Spacing) -> Self {
        let most = 1.0 / spacing.smallest();
        Self {
            mean_curvature: most as f32,
            gaussian_curvature: (most * most) as f32,
            principal: most as f32,
            shape_index: 1.0,
        }
    }
}

/// Noise of H with the corrected embedding, in units of h^2 / sigma^3.
const NOISE: f64 = 0.136;
/// Cosine of 11 degrees: where the normal is nearer to an axis of the grid, the voxels' steps are wide and
/// noise is larger.
const NEAR_AXIS: f64 = 0.9816;
/// Noise there, and elsewhere, in units of its rms over all directions.
const SHARES: [f64; 2] = [2.5, 0.85];
/// Share of the difference between corrected and plain curvature that may be left as bias.
const BIAS: f64 = 0.65;
/// Bias of H, K and k1 or k2 that is left where curvature varies, in units of sigma^4 / R^5, sigma^4 / R^6
/// and again the first.
///
/// This and the share above are larger than a first study had them (0.35 and 1), with which 71 to 95 % of the
/// surface of ellipsoids lay within the bars; with these it is 90 to 100 % on smooth shapes
/// (`surfometry validate`, docs/accuracy.md). Where curvature jumps, as along the seam of a flat and a round
/// part, no model of this kind holds: 50 to 85 % there.
const REMAINDER: [f64; 3] = [4.0, 6.0, 6.0];

/// Shares of the local rms change from the next finer scale, and of the local rms difference between the
/// corrected and the plain blur, that may be left as bias where each vertex has its own scale. On smooth shapes
/// errors are a half to a fifth of these bars; so large they are for the seams of flat and round parts, where
/// curvature jumps and 89 to 96 % lie within (`experiments/local_scale`).
const OF_CHANGES: [f64; 2] = [0.9, 1.2];

/// Standard errors at a vertex with a scale of its own, from the noise of H there and the local rms changes of
/// curvature from the next finer scale and from the plain blur.
pub(crate) fn scaled_errors(
    curvature: &Curvature,
    noise: f64,
    changes: [CurvatureDifferences; 2],
) -> CurvatureErrors {
    let total = |noise: f64, change: fn(&CurvatureDifferences) -> f32| {
        let [finer, plain] = [0, 1].map(|n| OF_CHANGES[n] * f64::from(change(&changes[n])));
        libm::hypot(noise, libm::hypot(finer, plain)) as f32
    };
    let principal = total(std::f64::consts::SQRT_2 * noise, |c| c.principal);
    CurvatureErrors {
        mean_curvature: total(noise, |c| c.mean_curvature),
        gaussian_curvature: total(noise_of_product(curvature, noise), |c| c.gaussian_curvature),
        principal,
        shape_index: shape_index_error(curvature, principal),
    }
}

/// Noise of H is that of (k1 + k2) / 2 with k1 and k2 independent; K = k1 k2 then has 2 noise
/// sqrt((k1^2 + k2^2) / 2), and its square.
fn noise_of_product(curvature: &Curvature, noise: f64) -> f64 {
    libm::hypot(2.0 * noise * curvature.curvedness(), 2.0 * noise * noise)
}

/// S = 2/pi times the angle of (H, (k1 - k2) / 2), a vector as long as the curvedness, of which each part is off
/// by 1/sqrt 2 of k1's error.
fn shape_index_error(curvature: &Curvature, principal: f32) -> f32 {
    let angle = f64::from(principal) / (std::f64::consts::SQRT_2 * curvature.curvedness());
    (angle * std::f64::consts::FRAC_2_PI).min(1.0) as f32
}

/// What the standard error of curvature at a vertex follows from: the grid's noise, a share of what the
/// correction did, and the order that is left, sigma^4 / R^5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalErrorModel {
    noise: f64,
    remainder: f64,
    radius: f64,
}

impl LocalErrorModel {
    /// For sigma and the object's radius of curvature in mm.
    pub fn new(sigma: f64, spacing: Spacing, radius: f64) -> Self {
        let noise = NOISE * rms_spacing(spacing).powi(2) / sigma.powi(3);
        Self { noise, remainder: sigma.powi(4) / radius.powi(5), radius }
    }

    /// Of a vertex, from the largest component of its normal along the grid's axes and the differences
    /// between corrected and plain curvature there.
    pub fn errors(
        &self,
        curvature: &Curvature,
        along_axis: f64,
        differences: &CurvatureDifferences,
    ) -> CurvatureErrors {
        let ([near, away], [of_mean, of_gaussian, of_principal]) = (SHARES, REMAINDER);
        let noise = self.noise * if along_axis > NEAR_AXIS { near } else { away };
        let total = |noise: f64, difference: f32, remainder: f64| {
            libm::hypot(libm::hypot(noise, BIAS * f64::from(difference)), remainder) as f32
        };
        let of_product = noise_of_product(curvature, noise);
        let principal =
            total(std::f64::consts::SQRT_2 * noise, differences.principal, of_principal * self.remainder);
        CurvatureErrors {
            mean_curvature: total(noise, differences.mean_curvature, of_mean * self.remainder),
            gaussian_curvature: total(
                of_product,
                differences.gaussian_curvature,
                of_gaussian * self.remainder / self.radius,
            ),
            principal,
            shape_index: shape_index_error(curvature, principal),
        }
    }
}
