//! Results for the original object: the blur's and the band's leading effects taken off.

use super::Terraces;
use crate::integrals::{Globals, Integrals};

/// What compensation adds, by cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompensationTerms {
    /// For the surface's shift by the blur: sigma^2 (M + M_c) / 2, 2 sigma^2 int H^2, sigma^2 int H K.
    pub shift: Globals,
    /// For the band's averaging over parallel surfaces: minus its variance times M and times the integral of
    /// K.
    pub band: Globals,
    /// For what the blur leaves of the voxels' terraces: minus 3/2 of their mean square slope times A and M,
    /// and how the band samples them.
    pub terraces: Globals,
}

/// Undoes, to first order in sigma^2, what the blur did, to second order in t what the band did, and the
/// terraces' part on the mean over directions.
///
/// The blur moves the surface by -sigma^2 H along its normal. Moving it back changes A by 2 sigma^2 int H^2
/// and M by sigma^2 int H K. V changes by M at every step of the way, so by sigma^2 times the mean of M on
/// the blurred and on the compensated surface: the trapezoid rule, which leaves a quarter of the error that M
/// of the blurred surface alone would (a ball of R = 5 sigma: -0.08 % instead of -0.32 %).
///
/// The smeared Heaviside and delta average over parallel surfaces with a mean square distance `variance`: V
/// is too large by `variance` M and A by `variance` int K (Steiner), and M is right because its second
/// derivative along the normal vanishes.
///
/// Terraces with the mean square slope q make A larger by q/2 A and, their integral of H^2 being q / (2
/// sigma^2), its shift by q A; the same holds of M, whose second variation is H / 2 times the slope squared.
/// The band's samples lie on the terraces' own grid, which changes A by their excess. Faces along the grid
/// have none.
///
/// `sigma` is 0 where the embedding has no leading shift
/// ([`GaussianEmbedding::corrected`](crate::embedding::GaussianEmbedding::corrected)): then the band's part
/// alone is taken off.
///
/// What is left is of order sigma^4 / R^4: on a ball up to 0.2 % at R = 5 sigma, 3 % at R = 2.5 sigma. Valid
/// at level 0.5 only.
pub fn compensation_terms(
    plain: &Integrals,
    sigma: f64,
    variance: f64,
    terraces: Option<&Terraces>,
) -> CompensationTerms {
    let surface = &plain.surface;
    let square = sigma * sigma;
    let mean = square * surface.mean_times_gaussian;
    let slope = terraces.map_or(0.0, |t| if sigma > 0.0 { 1.5 } else { 0.5 } * t.square_slope);
    let excess = terraces.map_or(0.0, |t| t.sampling_excess);
    let off_grid = (surface.area - plain.faces.iter().sum::<f64>()).max(0.0);
    CompensationTerms {
        shift: Globals {
            volume: square * 0.5 * (surface.total_mean_curvature + (surface.total_mean_curvature + mean)),
            area: 2.0 * square * surface.total_squared_mean_curvature,
            total_mean_curvature: mean,
        },
        band: Globals {
            volume: -variance * surface.total_mean_curvature,
            area: -variance * surface.total_gaussian_curvature,
            total_mean_curvature: 0.0,
        },
        terraces: Globals {
            volume: 0.0,
            area: -(slope + excess) * off_grid,
            total_mean_curvature: -slope * surface.total_mean_curvature,
        },
    }
}

impl CompensationTerms {
    /// The object before the blur, from the integrals that the terms are of.
    pub fn added_to(&self, plain: &Integrals) -> Globals {
        [self.shift, self.band, self.terraces].iter().fold(plain.globals(), |sum, term| sum.plus(term))
    }
}
