//! The field of an object and its derivatives, as the parameters choose them.

use super::blur_bound::BlurBound;
use super::pass::{ObjectSums, Pass};
use super::setup::Setup;
use super::{Derivatives, EmbeddingKind, MeasureError, Parameters};
use crate::Control;
use crate::embedding::{ClosedField, DistanceEmbedding, Embedding, GaussianEmbedding, Indicator};
use crate::integrals::Band;
use crate::local_geometry::{
    BandVoxel, Differentiation, FiniteDifferences, GaussianDerivatives, Jet, MatchedDifferences, Unsheared,
};
use crate::surface::{Surface, VertexExtras, cell_limits};
use crate::tiling::IndexBox;
use crate::volume::{FieldImage, Grid, Mask, ProbabilityImage};
use std::sync::Arc;

/// Largest sigma in voxels: the kernels' reach, five times that, is what a tile needs around it.
pub(crate) const MOST_SIGMA_VOXELS: f64 = 400.0;
/// Largest band of a distance in voxels: a tile is transformed with half of that around it.
const MOST_BAND_VOXELS: f64 = 60.0;

/// All embeddings with all their derivatives.
pub(super) enum Scheme<'a> {
    Gaussian(Unsheared<GaussianDerivatives<'a>>),
    Matched(Unsheared<MatchedDifferences<'a>>),
    GaussianDifferences(Unsheared<FiniteDifferences<GaussianEmbedding<'a>>>),
    Distance(Unsheared<FiniteDifferences<DistanceEmbedding<'a>>>),
    Given(Unsheared<FiniteDifferences<&'a FieldImage>>),
    Closed(Unsheared<FiniteDifferences<ClosedField<'a>>>),
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
            Scheme::Closed($s) => $body,
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
        Self::Distance(differences(distance, setup))
    }

    /// Of whatever is blurred; `None` of an embedding without a blur.
    pub(super) fn of_blur(setup: &Setup, indicator: &'a dyn Indicator) -> Option<Self> {
        let profile = setup.parameters.profile()?;
        let (level, truncation) = (setup.parameters.level_or_half(), setup.truncation());
        let embedding = GaussianEmbedding::of_profile(indicator, &profile, level, truncation);
        Some(match setup.parameters.derivatives {
            Derivatives::Gaussian => {
                Self::Gaussian(Unsheared::new(GaussianDerivatives::new(embedding), &setup.grid))
            }
            Derivatives::Matched => {
                let matched = match &setup.weights {
                    Some(weights) => MatchedDifferences::with_weights(embedding, Arc::clone(weights)),
                    None => MatchedDifferences::new(embedding),
                };
                Self::Matched(Unsheared::new(matched, &setup.grid))
            }
            Derivatives::FiniteDifference => Self::GaussianDifferences(differences(embedding, setup)),
        })
    }

    /// Of a field that was given; closed where its image cuts it, where there is something beyond its edge.
    pub(super) fn of_field(setup: &Setup, field: &'a FieldImage) -> Self {
        let parameters = &setup.parameters;
        match parameters.padding {
            None => Self::Given(differences(field, setup)),
            Some(background) => {
                let slope = 2.0 * parameters.epsilon / parameters.thickness_mm;
                Self::Closed(differences(ClosedField::new(field, background, slope), setup))
            }
        }
    }

    /// Voxels around a box, on each side of each axis, in which an object must be known for what is summed
    /// over the box.
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
        control: &Control,
    ) -> Surface {
        with_scheme!(self, s => Surface::of(s, grid, band, extras, region, control))
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

fn differences<E: Embedding>(embedding: E, setup: &Setup) -> Unsheared<FiniteDifferences<E>> {
    Unsheared::new(FiniteDifferences::new(embedding, setup.grid.spacing().mm()), &setup.grid)
}

/// Whether a blur may leave something of an object in a box, of which `total` adds up its voxels; one that
/// reaches over too many voxels is refused.
fn may_survive(setup: &Setup, bounds: &IndexBox, total: impl Fn() -> f64) -> Result<bool, MeasureError> {
    // A hair below the level, for what rounding adds.
    let level = setup.parameters.level_or_half() * (1.0 - 1e-6);
    if BlurBound::of(setup).is_some_and(|bound| bound.is_below(bounds, total, level)) {
        return Ok(false);
    }
    Scheme::check_reach(setup).map(|()| true)
}
