//! What axes that are not perpendicular do to numbers that are taken as if they were.

use super::{Flag, FlagCode};
use crate::integrals::SurfaceIntegrals;
use crate::volume::Grid;

/// Standard errors of A and M, mm^2 and mm: half of the most that a strain can change. A map of strain E changes dA by
/// -N . E N, and M by half of the integral of (2 H P - S) : E, P being the tangent plane's projection and S the shape
/// operator, whose norm the squares of the principal curvatures bound.
pub(crate) fn shear_errors(strain: f64, surface: &SurfaceIntegrals) -> [f64; 2] {
    let squares = 2.0 * surface.total_squared_mean_curvature - surface.total_gaussian_curvature;
    [strain * surface.area / 2.0, strain * libm::sqrt((surface.area * squares).max(0.0)) / 2.0]
}

/// The warning of such axes.
pub(crate) fn sheared(grid: &Grid) -> Option<Flag> {
    let strain = grid.strain();
    let message = format!(
        "the image's axes are not perpendicular, as of a tilted gantry: volumes are exact, lengths are up to {:.2} % off where they run \
         between two axes, and half of what that can do to area and curvature is in their standard errors; an image that is resampled to an \
         orthogonal grid has none of it",
        100.0 * strain
    );
    (strain > 0.0).then(|| Flag::new(FlagCode::ShearedGrid, message))
}
