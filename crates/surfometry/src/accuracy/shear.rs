//! What axes that are not perpendicular leave to be said, where areas and curvature are those of the true axes.

use super::{Flag, FlagCode};
use crate::integrals::SurfaceIntegrals;
use crate::volume::Grid;

/// Standard errors of A and M, mm^2 and mm, by a blur of sigma mm that is round along the image's axes and so, with these
/// strained by E, is not in space: half of the most that can do.
///
/// Its covariance is sigma^2 (1 + 2 E), so it moves the surface by -sigma^2 (H + E : S), S being the shape operator, of which
/// compensation takes -sigma^2 H off. What is left changes A by the integral of 2 H and M by that of K times sigma^2 E : S, which
/// is at most twice the strain times the larger principal curvature.
pub(crate) fn shear_errors(strain: f64, sigma: f64, surface: &SurfaceIntegrals) -> [f64; 2] {
    let third = libm::sqrt(surface.larger_squared * surface.larger_fourth);
    [2.0 * sigma * sigma * strain * surface.larger_squared, sigma * sigma * strain * third]
}

/// The warning of such axes, where all is measured along them.
pub(crate) fn sheared(grid: &Grid) -> Option<Flag> {
    flag(
        grid,
        "volume, area and curvature are those in space, but a blur is so much wider in some directions than in others; half of what \
         that can do is in the standard errors",
    )
}

/// The same where numbers are taken as if they were perpendicular.
#[cfg(feature = "io")]
pub(crate) fn taken_as_perpendicular(grid: &Grid) -> Option<Flag> {
    flag(
        grid,
        "volumes are exact, areas and curvature are those of perpendicular axes; an image that is resampled to an orthogonal grid has \
         none of it",
    )
}

fn flag(grid: &Grid, consequence: &str) -> Option<Flag> {
    let strain = grid.strain();
    let message = format!(
        "the image's axes are not perpendicular, as of a tilted gantry, and lengths up to {:.2} % off what they would be then: \
         {consequence}",
        100.0 * strain
    );
    (strain > 0.0).then(|| Flag::new(FlagCode::ShearedGrid, message))
}
