//! The field of an object and its derivatives, as the parameters choose them.

use super::pass::{ObjectSums, Pass};
use super::setup::Setup;
use super::{Derivatives, EmbeddingKind, MeasureError, Parameters};
use crate::embedding::{
    DistanceEmbedding, Embedding, GaussianEmbedding, GaussianKernel, Indicator, TRUNCATION,
    TRUNCATION_OF_BLUR,
};
use crate::integrals::Band;
use crate::local_geometry::{
    BandVoxel, Differentiation, FiniteDifferences, GaussianDerivatives, Jet, MatchedDifferences,
};
use crate::surface::{Surface, VertexExtras, cell_limits, cells_around};
use crate::tiling::IndexBox;
use crate::volume::{FieldImage, Grid, Mask, ProbabilityImage};

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
    pub(super) fn of_mask(setup: &Setup, mask: &'a Mask) -> Result<Option<Self>, MeasureError> {
        let survives = may_survive(setup, &mask.bounds(), || mask.voxels() as f64)?;
        Ok(survives.then(|| Self::of_part(setup, mask)))
    }

    /// Of a soft segmentation; `None` where the blur is known to leave nothing.
    pub(super) fn of_probability(
        setup: &Setup,
        image: &'a ProbabilityImage,
    ) -> Result<Option<Self>, MeasureError> {
        let survives = may_survive(setup, &image.bounds(), || image.sum(|p| p))?;
        Ok(Self::of_blur(setup, image).filter(|_| survives))
    }

    /// Refuses a blur or band that reaches over too many voxels.
    pub(super) fn check_reach(setup: &Setup) -> Result<(), MeasureError> {
        let (parameters, spacing) = (&setup.parameters, setup.grid.spacing());
        match parameters.sigma_mm {
            Some(sigma) => Parameters::check_reach("sigma", sigma, MOST_SIGMA_VOXELS, spacing),
            None => Parameters::check_reach("thickness", parameters.thickness_mm, MOST_BAND_VOXELS, spacing),
        }
    }

    /// Of a mask that may be a part of the object.
    pub(super) fn of_part(setup: &Setup, mask: &'a Mask) -> Self {
        if let Some(blurred) = Self::of_blur(setup, mask) {
            return blurred;
        }
        let distance = match setup.parameters.embedding {
            EmbeddingKind::DistanceToVoxels => DistanceEmbedding::to_boundary_voxels(mask),
            _ => DistanceEmbedding::new(mask),
        };
        Self::Distance(FiniteDifferences::new(distance, setup.grid.spacing().mm()))
    }

    /// Of whatever is blurred; `None` of an embedding without a blur.
    pub(super) fn of_blur(setup: &Setup, indicator: &'a dyn Indicator) -> Option<Self> {
        let profile = setup.parameters.profile()?;
        let (level, truncation) = (setup.parameters.level_or_half(), truncation_of(setup));
        let embedding = GaussianEmbedding::of_profile(indicator, &profile, level, truncation);
        Some(match setup.parameters.derivatives {
            Derivatives::Gaussian => Self::Gaussian(GaussianDerivatives::new(embedding)),
            Derivatives::Matched => Self::Matched(match setup.weights {
                Some(weights) => MatchedDifferences::with_weights(embedding, weights),
                None => MatchedDifferences::new(embedding),
            }),
            Derivatives::FiniteDifference => {
                Self::GaussianDifferences(FiniteDifferences::new(embedding, setup.grid.spacing().mm()))
            }
        })
    }

    /// Whether the band, and with it the surface, is known to be nowhere.
    pub(super) fn has_no_band(setup: &Setup, mask: &Mask) -> bool {
        let band = setup.parameters.level_or_half() - setup.band.delta().half_width();
        is_below(setup, &mask.bounds(), || mask.voxels() as f64, band * (1.0 - 1e-6))
    }

    /// A box, of voxels that are worked on together, outside which the band is known to be nowhere; `None` where no bound is known.
    pub(super) fn cells_of_band(setup: &Setup, mask: &Mask) -> Option<IndexBox> {
        // Fields are in single precision.
        const ROUNDING: f64 = 1e-4;
        let sigma = setup.parameters.sigma_mm?;
        let band = setup.parameters.level_or_half() - setup.band.delta().half_width() - ROUNDING;
        let (spacing, extent) = (setup.grid.spacing().mm(), mask.bounds().extent());
        let kernels = spacing.map(|h| GaussianKernel::new(sigma, h, 0, truncation_of(setup)));
        let weight = setup.parameters.embedding.profile(sigma).terms()[0].0;
        let highest: [f64; 3] = std::array::from_fn(|a| kernels[a].largest_sum(extent[a]));
        // Beside the object's box the blur is at most what comes of a box as wide, so far off along that axis.
        let reach = |a: usize| {
            let taps = &kernels[a].taps()[kernels[a].radius()..];
            let others = weight * highest[(a + 1) % 3] * highest[(a + 2) % 3];
            let is_below =
                |&distance: &usize| others * taps[distance..].iter().take(extent[a]).sum::<f64>() < band;
            (1..taps.len()).find(is_below).unwrap_or(taps.len()) as i64 - 1
        };
        (band > 0.0).then(|| cells_around(&mask.bounds().grown(std::array::from_fn(reach))))
    }

    /// Voxels around a box, on each side of each axis, in which an object must be known for what is summed over the box.
    pub(super) fn reach(&self, setup: &Setup) -> [i64; 3] {
        let half_width = setup.band.delta().half_width();
        let voxel = IndexBox::voxel([0; 3]);
        with_scheme!(self, s => {
            let (field, halo) = (s.field_region(&voxel), s.embedding().halo(half_width));
            std::array::from_fn(|a| {
                (field.upper[a] - voxel.upper[a]).max(voxel.lower[a] - field.lower[a]) + halo[a]
            })
        })
    }

    /// Box outside which the field is beyond the band.
    pub(super) fn limits(&self, half_width: f64) -> IndexBox {
        with_scheme!(self, s => cell_limits(s.embedding(), half_width))
    }

    pub(super) fn sums(&self, pass: &Pass) -> ObjectSums {
        with_scheme!(self, s => pass.sums(s))
    }

    pub(super) fn surface(
        &self,
        grid: &Grid,
        band: &Band,
        extras: &VertexExtras,
        region: Option<IndexBox>,
    ) -> Surface {
        with_scheme!(self, s => Surface::of(s, grid, band, extras, region))
    }

    /// The voxels of a tile where |phi| <= `half_width`, with the derivatives there.
    pub(super) fn band(&self, tile: &IndexBox, half_width: f64) -> Vec<BandVoxel> {
        with_scheme!(self, s => s.band(tile, half_width))
    }

    /// The field's derivatives at points near each other.
    pub(super) fn jets(&self, points: &[[f64; 3]]) -> Vec<Jet> {
        with_scheme!(self, s => s.jets(points))
    }
}

fn truncation_of(setup: &Setup) -> f64 {
    setup.measurement.truncation.unwrap_or(match setup.parameters.derivatives {
        Derivatives::Matched => TRUNCATION_OF_BLUR,
        Derivatives::Gaussian | Derivatives::FiniteDifference => TRUNCATION,
    })
}

/// Whether a blur may leave something of an object in a box, of which `total` adds up its voxels; one that reaches over too many voxels is refused.
fn may_survive(
    setup: &Setup,
    bounds: &IndexBox,
    total: impl Fn() -> f64,
) -> Result<bool, MeasureError> {
    // A hair below the level, for what rounding adds.
    if is_below(setup, bounds, total, setup.parameters.level_or_half() * (1.0 - 1e-6)) {
        return Ok(false);
    }
    Scheme::check_reach(setup).map(|()| true)
}

/// Whether the blurred indicator of an object in a box is known to stay below a value everywhere; without a blur it is not.
///
/// It is at most that of the box, whose maximum is a product over the axes of the largest sum of as many neighbouring taps as the box is wide; and at most
/// that of all voxels, `total`, in one place.
fn is_below(setup: &Setup, bounds: &IndexBox, total: impl Fn() -> f64, value: f64) -> bool {
    // From there on samples and the integral differ by less than the hundredth that is added.
    const FINE: f64 = 20.0;
    let Some(sigma) = setup.parameters.sigma_mm else { return false };
    let spacing = setup.grid.spacing().mm();
    let share = |a: usize, voxels: usize| {
        let width = voxels as f64 * spacing[a];
        if sigma > FINE * spacing[a] {
            (1.01 * libm::erf(width / (2.0 * std::f64::consts::SQRT_2 * sigma))).min(1.0)
        } else {
            GaussianKernel::new(sigma, spacing[a], 0, truncation_of(setup)).largest_sum(voxels)
        }
    };
    // Of a combination, what is taken off may be nothing.
    let weight = setup.parameters.embedding.profile(sigma).terms()[0].0;
    let extent = bounds.extent();
    let of_box = || (0..3).map(|a| share(a, extent[a])).product::<f64>();
    let of_voxels = || total() * (0..3).map(|a| share(a, 1)).product::<f64>();
    weight * of_box() < value || weight * of_voxels() < value
}
