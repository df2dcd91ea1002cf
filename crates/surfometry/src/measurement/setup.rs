//! What is decided before an object's voxels are known.

use super::detail::Watch;
use super::pass::Pass;
use super::{Derivatives, EmbeddingKind, MeasureError, Measurement, Parameters};
use crate::Control;
use crate::accuracy::{ErrorModel, SoftEdges, Terraces};
use crate::integrals::{Band, Quadrature, QuadratureRule, SmearedDelta};
use crate::local_geometry::MatchedWeights;
use crate::tiling::IndexBox;
use crate::volume::{Grid, Mask, ProbabilityImage, Spacing};
use std::sync::{Arc, Mutex, PoisonError};

/// The choices for one image, filled in.
#[derive(Debug, Clone)]
pub(super) struct Setup {
    pub(super) measurement: Measurement,
    pub(super) parameters: Parameters,
    pub(super) band: Band,
    pub(super) quadrature: Quadrature,
    pub(super) grid: Grid,
    /// For matched differences.
    pub(super) weights: Option<Arc<MatchedWeights>>,
    /// How far integrals are from exact; `None` where that was not studied.
    pub(super) errors: Option<ErrorModel>,
    /// What the blur leaves of the voxels' steps; `None` where errors are.
    pub(super) terraces: Option<Terraces>,
    /// What is known of the edges of a soft segmentation; `None` of a mask, and of one that holds nothing but
    /// zeros and ones.
    pub(super) soft: Option<SoftEdges>,
    /// Who may stop what is done with it.
    pub(super) control: Control,
}

/// Least sigma, in geometric means of the spacings, for which errors are modelled.
const LEAST_SIGMA: f64 = 1.2;
/// The same in largest spacings: of thicker slices the blur leaves steps that are no smooth surface.
const LEAST_SIGMA_OF_SLICES: f64 = 0.5;

/// The last that were made: of an image's blur and recovering embedding, and of some labels' own choices.
static LAST: Mutex<Vec<Setup>> = Mutex::new(Vec::new());
const MOST_KEPT: usize = 8;

impl Setup {
    /// For objects that are masks.
    pub(super) fn of_masks(measurement: &Measurement, grid: Grid) -> Result<Self, MeasureError> {
        if measurement.embedding == EmbeddingKind::Given {
            return Err(MeasureError::Conflict("a given embedding is a field, not a mask: use `run_field`"));
        }
        if measurement.embedding == EmbeddingKind::Probability {
            return Err(MeasureError::Conflict(
                "a soft segmentation is an image of values from 0 to 1, not a mask: use `run_probability`",
            ));
        }
        Self::new(measurement, grid)
    }

    /// For a soft segmentation.
    pub(super) fn of_probability(
        measurement: &Measurement,
        image: &ProbabilityImage,
    ) -> Result<Self, MeasureError> {
        let setup = Self::new(&measurement.of_probability(), *image.grid())?;
        let soft = Some(SoftEdges::of(image)).filter(|edges| !edges.are_hard());
        // Shares of voxels leave no terraces.
        let terraces = setup.terraces.filter(|_| soft.is_none());
        Ok(Self { terraces, soft, ..setup })
    }

    /// Of the last few, what was made before is taken again: weights and terraces are the same for all objects of an image,
    /// and would take longer than measuring a small one.
    fn new(measurement: &Measurement, grid: Grid) -> Result<Self, MeasureError> {
        let is_same = |made: &Self| made.measurement == *measurement && made.grid.spacing() == grid.spacing();
        let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
        let known = last().iter().find(|made| is_same(made)).cloned();
        if let Some(made) = known {
            return Ok(Self { grid, ..made });
        }
        let made = Self::make(measurement, grid)?;
        let mut last = last();
        last.truncate(MOST_KEPT - 1);
        last.insert(0, made.clone());
        Ok(made)
    }

    fn make(measurement: &Measurement, grid: Grid) -> Result<Self, MeasureError> {
        let parameters = Parameters::resolve(measurement, grid.spacing())?;
        let delta = SmearedDelta::new(measurement.delta, parameters.epsilon, parameters.saturation());
        let band = Band::new(delta, parameters.thickness_mm);
        let blurred = parameters.shift_sigma().zip(parameters.level);
        let errors = error_model(&parameters, grid.spacing());
        let modelled = errors.zip(parameters.profile());
        Ok(Self {
            measurement: *measurement,
            parameters,
            band: blurred.map_or(band, |(sigma, level)| band.of_blurred_edge(sigma, level)),
            quadrature: Quadrature::unbounded(measurement.quadrature),
            grid,
            weights: parameters
                .sigma_mm
                .filter(|_| parameters.derivatives == Derivatives::Matched)
                .map(|sigma| Arc::new(MatchedWeights::new(sigma, grid.spacing().mm()))),
            errors,
            terraces: modelled.map(|(model, profile)| model.terraces(&profile, &delta)),
            soft: None,
            control: Control::default(),
        })
    }

    pub(super) fn pass(&self, with_surface: bool) -> Pass<'_> {
        Pass {
            band: &self.band,
            quadrature: &self.quadrature,
            spacing: self.grid.spacing(),
            with_surface,
            with_ripples: self.errors.is_some(),
            with_spectrum: self.errors.is_some() && self.soft.is_none(),
            region: None,
            tiles: None,
            watch: None,
            control: &self.control,
        }
    }

    /// Compares the voxels of a box with the field that is made of them, where that is a blur.
    pub(super) fn watch<'a>(&self, mask: &'a Mask, owned: IndexBox) -> Option<Watch<'a>> {
        let shift = self.parameters.shift_sigma().unwrap_or(0.0);
        let blurs = self.parameters.embedding.is_blur();
        blurs.then(|| Watch::new(mask, owned, self.grid.spacing(), shift, &self.band))
    }

    /// Where kernels end, in sigma.
    pub(super) fn truncation(&self) -> f64 {
        self.measurement.truncation_with(self.parameters.derivatives)
    }
}

fn error_model(p: &Parameters, spacing: Spacing) -> Option<ErrorModel> {
    let least = (LEAST_SIGMA * spacing.geometric_mean()).max(LEAST_SIGMA_OF_SLICES * spacing.largest());
    let enough = |sigma: &f64| *sigma >= least;
    let sigma = p.sigma_mm.filter(|sigma| p.level == Some(0.5) && enough(sigma))?;
    let studied = p.derivatives != Derivatives::FiniteDifference && p.quadrature == QuadratureRule::Sum;
    studied.then(|| ErrorModel::new(spacing, sigma, p.thickness_mm))
}
