//! The field of an object and its derivatives, as the parameters choose them.

use super::pass::{ObjectSums, Pass};
use super::{Derivatives, EmbeddingKind, MeasureError, Measurement, Parameters};
use crate::embedding::{
    DistanceEmbedding, GaussianEmbedding, GaussianKernel, TRUNCATION, TRUNCATION_OF_BLUR,
};
use crate::integrals::Band;
use crate::local_geometry::{FiniteDifferences, GaussianDerivatives, MatchedDifferences};
use crate::surface::Surface;
use crate::volume::{FieldImage, Grid, Mask};

/// Largest sigma in voxels: the kernels' reach, five times that, is what a tile needs around it.
const MOST_SIGMA_VOXELS: f64 = 400.0;
/// Largest band of a distance in voxels: a tile is transformed with half of that around it.
const MOST_BAND_VOXELS: f64 = 60.0;

/// All embeddings with all their derivatives.
pub(super) enum Scheme<'a> {
    Gaussian(GaussianDerivatives<'a>),
    Matched(MatchedDifferences<'a>),
    GaussianDifferences(FiniteDifferences<GaussianEmbedding<'a>>),
    Distance(FiniteDifferences<DistanceEmbedding<'a>>),
    Given(FiniteDifferences<&'a FieldImage>),
}

/// Does the same with whichever it is.
macro_rules! with_scheme {
    ($scheme:expr, $s:ident => $body:expr) => {
        match $scheme {
            Scheme::Gaussian($s) => $body,
            Scheme::Matched($s) => $body,
            Scheme::GaussianDifferences($s) => $body,
            Scheme::Distance($s) => $body,
            Scheme::Given($s) => $body,
        }
    };
}

pub(super) use with_scheme;

impl<'a> Scheme<'a> {
    /// Of a mask; `None` where the blur is known to leave nothing.
    pub(super) fn of_mask(
        measurement: &Measurement,
        mask: &'a Mask,
        parameters: &Parameters,
    ) -> Result<Option<Self>, MeasureError> {
        let spacing = mask.grid().spacing();
        let Some(sigma) = parameters.sigma_mm else {
            if measurement.embedding == EmbeddingKind::Given {
                return Err(MeasureError::Conflict(
                    "a given embedding is a field, not a mask: use `run_field`",
                ));
            }
            Parameters::check_reach("thickness", parameters.thickness_mm, MOST_BAND_VOXELS, spacing)?;
            let scheme = FiniteDifferences::new(DistanceEmbedding::new(mask), spacing.mm());
            return Ok(Some(Self::Distance(scheme)));
        };
        if vanishes_for_certain(measurement, mask, sigma, truncation_of(measurement, parameters.derivatives)) {
            return Ok(None);
        }
        Parameters::check_reach("sigma", sigma, MOST_SIGMA_VOXELS, spacing)?;
        let truncation = truncation_of(measurement, parameters.derivatives);
        let embedding = GaussianEmbedding::new(mask, sigma, measurement.level, truncation);
        Ok(Some(match parameters.derivatives {
            Derivatives::Gaussian => Self::Gaussian(GaussianDerivatives::new(embedding)),
            Derivatives::Matched => Self::Matched(MatchedDifferences::new(embedding)),
            Derivatives::FiniteDifference => {
                Self::GaussianDifferences(FiniteDifferences::new(embedding, spacing.mm()))
            }
        }))
    }

    pub(super) fn sums(&self, pass: &Pass) -> ObjectSums {
        with_scheme!(self, s => pass.sums(s))
    }

    /// `shift_sigma` is the blur whose shift is told at each vertex, where that is defined.
    pub(super) fn surface(&self, grid: &Grid, band: &Band, shift_sigma: Option<f64>) -> Surface {
        with_scheme!(self, s => Surface::of(s, grid, band, shift_sigma))
    }
}

fn truncation_of(measurement: &Measurement, derivatives: Derivatives) -> f64 {
    measurement.truncation.unwrap_or(match derivatives {
        Derivatives::Matched => TRUNCATION_OF_BLUR,
        Derivatives::Gaussian | Derivatives::FiniteDifference => TRUNCATION,
    })
}

/// Whether the blurred indicator stays below the level everywhere: it is at most that of the bounding box, whose
/// maximum is a product over the axes of the largest sum of as many neighbouring taps as the box is wide.
fn vanishes_for_certain(measurement: &Measurement, mask: &Mask, sigma: f64, truncation: f64) -> bool {
    // From there on samples and the integral differ by less than the hundredth that is added.
    const FINE: f64 = 20.0;
    let (spacing, extent) = (mask.grid().spacing().mm(), mask.bounds().extent());
    let share = |a: usize| {
        let width = extent[a] as f64 * spacing[a];
        if sigma > FINE * spacing[a] {
            (1.01 * libm::erf(width / (2.0 * std::f64::consts::SQRT_2 * sigma))).min(1.0)
        } else {
            GaussianKernel::new(sigma, spacing[a], 0, truncation).largest_sum(extent[a])
        }
    };
    (0..3).map(share).product::<f64>() < measurement.level * (1.0 - 1e-6)
}
