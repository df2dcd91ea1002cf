//! Parameters -> all stages -> result.

mod blur_bound;
mod box_sums;
mod boxes;
mod clip;
mod comparable;
mod detail;
mod evaluation;
mod explanation;
mod interfaces;
mod level_sets;
mod local_curvature;
mod local_scales;
mod object;
mod parameters;
mod pass;
mod probability;
mod recovery;
mod region_membership;
mod region_values;
mod regions;
mod result;
mod ripples;
mod scheme;

mod settling;
mod setup;
mod streaming;
mod voxel_map;
mod voxels;
mod warnings;

pub use boxes::{BoxShare, DecodeError, MergeError, PartialMeasurement};
pub use clip::{Clip, ClipSummary};
pub use detail::WrongSides;
#[cfg(feature = "io")]
pub(crate) use explanation::Looked;
pub use explanation::{ChangeStage, LocatedChange, TopologyExplanation, UNEXPLAINED, WeakestGradient};
pub use interfaces::{Interface, InterfaceValues};
pub use local_curvature::CurvatureScale;
pub use object::Object;
pub use parameters::{Derivatives, EmbeddingKind, MeasureError, Padding, Parameters};
pub use recovery::RecoverySummary;
pub use region_membership::RegionMembership;
pub use regions::{RegionPart, Regions};
pub use result::{
    BlurredValues, DescribedSurface, GridSummary, Measured, MeshSummary, StageSeconds, SurfaceValues,
    TopologySummary, VoxelSummary,
};
pub(crate) use scheme::MOST_SIGMA_VOXELS;
#[cfg(feature = "io")]
pub(crate) use settling::again;
pub use streaming::{Progress, StreamError, Streamed};
pub use voxel_map::{Outside, VoxelQuantity};

use crate::integrals::{QuadratureRule, Smearing};
use crate::volume::{FieldImage, LabelGroup, LabelImage, LabelSelection, Mask, Shared};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// How to measure. The defaults, and why they are what they are, stand in docs/decisions.md.
///
/// ```
/// use surfometry::Measurement;
/// let paper = Measurement::paper();
/// let finer = Measurement::default().sigma_mm(1.0).thickness_mm(2.5);
/// # let _ = (paper, finer);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    pub(crate) embedding: EmbeddingKind,
    pub(crate) derivatives: Option<Derivatives>,
    pub(crate) quadrature: QuadratureRule,
    pub(crate) delta: Smearing,
    pub(crate) sigma: Option<f64>,
    pub(crate) thickness: Option<f64>,
    pub(crate) epsilon: Option<f64>,
    pub(crate) level: Option<f64>,
    pub(crate) clip: Clip,
    #[serde(default)]
    pub(crate) padding: Option<Padding>,
    /// Whether it is the paper's, whose numbers are those of the blurred surface.
    pub(crate) paper: bool,
    truncation: Option<f64>,
    /// 1 / rms of the object's larger principal curvature, mm, where its surface is to have a scale of its own
    /// at each vertex.
    #[serde(skip)]
    pub(crate) radius_of_scales: Option<f64>,
}

impl Default for Measurement {
    fn default() -> Self {
        Self {
            embedding: EmbeddingKind::Gaussian,
            derivatives: None,
            quadrature: QuadratureRule::Sum,
            delta: Smearing::Sine,
            sigma: None,
            thickness: None,
            epsilon: None,
            level: None,
            clip: Clip::Cap,
            padding: None,
            paper: false,
            truncation: None,
            radius_of_scales: None,
        }
    }
}

/// Setters, each of which gives back the measurement, so that they can be chained.
impl Measurement {
    /// The paper's choices: fourth-order differences, Simpson's rule, sigma 2.0 mm, t 2.5 mm, level 0.5,
    /// sine; its numbers are those of the blurred surface.
    #[must_use]
    pub fn paper() -> Self {
        Self { quadrature: QuadratureRule::Simpson, paper: true, ..Self::default() }
            .derivatives(Derivatives::FiniteDifference)
            .sigma_mm(2.0)
            .thickness_mm(2.5)
    }

    /// Standard deviation of the blur in mm; `None`, the default, follows the spacing.
    #[must_use]
    pub fn sigma_mm(self, sigma: impl Into<Option<f64>>) -> Self {
        Self { sigma: sigma.into(), ..self }
    }

    /// Thickness t of the band in mm; `None`, the default, follows the spacing.
    #[must_use]
    pub fn thickness_mm(self, thickness: impl Into<Option<f64>>) -> Self {
        Self { thickness: thickness.into(), ..self }
    }

    /// Half-width of the delta in units of phi, instead of a thickness.
    #[must_use]
    pub fn epsilon(self, epsilon: impl Into<Option<f64>>) -> Self {
        Self { epsilon: epsilon.into(), ..self }
    }

    /// Level T of the blurred indicator that is the surface, between 0 and 1.
    #[must_use]
    pub fn level(self, level: f64) -> Self {
        Self { level: Some(level), ..self }
    }

    /// What becomes of objects that the edge of their image cuts.
    #[must_use]
    pub fn clip(self, clip: Clip) -> Self {
        Self { clip, ..self }
    }

    /// What lies beyond the edge of a given field, which closes what the edge cuts; `None`, the default, leaves
    /// its surface open there.
    #[must_use]
    pub fn padding(self, padding: impl Into<Option<Padding>>) -> Self {
        Self { padding: padding.into(), ..self }
    }

    /// How an object becomes a field.
    #[must_use]
    pub fn embedding(self, embedding: EmbeddingKind) -> Self {
        Self { embedding, ..self }
    }

    /// How the field is differentiated; by default of a blur by matched differences where sigma is 1.75 to 8 voxels
    /// along every axis, and with Gaussian derivatives where it is not; by finite differences of a distance or a given field.
    #[must_use]
    pub fn derivatives(self, derivatives: Derivatives) -> Self {
        Self { derivatives: Some(derivatives), ..self }
    }

    /// How band voxels are summed.
    #[must_use]
    pub fn quadrature(self, quadrature: QuadratureRule) -> Self {
        Self { quadrature, ..self }
    }

    /// Profile of the delta.
    #[must_use]
    pub fn delta(self, delta: Smearing) -> Self {
        Self { delta, ..self }
    }

    /// Cuts Gaussian kernels at another number of sigma than [`TRUNCATION`](crate::embedding::TRUNCATION), or
    /// [`TRUNCATION_OF_BLUR`](crate::embedding::TRUNCATION_OF_BLUR) where the blurred field is
    /// differentiated by differences.
    #[must_use]
    pub fn truncation(self, truncation: f64) -> Self {
        Self { truncation: Some(truncation), ..self }
    }

    /// Measures the selected labels of an image, each as an object of its own, in parallel. `progress` is
    /// told how many are done, of how many: first 0, then after each object, from whichever thread.
    ///
    /// # Errors
    /// [`MeasureError`] for a label that does not occur, an image without foreground, or parameters that make
    /// no sense.
    pub fn run_labels(
        &self,
        image: &LabelImage,
        selection: &LabelSelection,
        progress: impl Fn(usize, usize) + Sync,
    ) -> Result<Vec<(LabelGroup, Measured)>, MeasureError> {
        let groups = selection.resolve(image)?;
        let (done, total) = (AtomicUsize::new(0), groups.len());
        progress(0, total);
        let measure = |group: LabelGroup| {
            let start = Instant::now();
            let mask = image.group_mask(&group);
            let extraction = start.elapsed().as_secs_f64();
            let mut measured = self.run(mask)?;
            measured.timings.integrals += extraction;
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
            Ok((group, measured))
        };
        groups.into_par_iter().map(measure).collect()
    }

    /// Measures one object: the special case of one label.
    ///
    /// # Errors
    /// [`MeasureError`] for an empty mask or parameters that make no sense. An object that the blur removes
    /// is no error: its numbers are `None`, under the flag `surface-vanished`.
    pub fn run(&self, mask: impl Shared<Mask>) -> Result<Measured, MeasureError> {
        self.prepare(mask).map(|object| object.measure())
    }

    /// Measures the level set phi = 0 of a field that is an embedding already.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, a field without negative voxels, or one of fewer
    /// than six voxels along an axis.
    pub fn run_field(&self, field: impl Shared<FieldImage>) -> Result<Measured, MeasureError> {
        self.prepare_field(field).map(|object| object.measure())
    }
}
