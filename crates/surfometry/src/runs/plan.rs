//! What is asked of every input of a run.

use super::object::{looked_at, what_is_explained};
use super::{CalledObjects, LabelScales, RegionImage, SampleImage, ScaleLedger};
use crate::inputs::OpenOptions;
use crate::measurement::{CurvatureScale, EmbeddingKind, MeasureError, Measured, Measurement};
use crate::volume::LabelSelection;
use std::collections::BTreeSet;

/// What is asked of every input of a run.
///
/// ```
/// use surfometry::{Measurement, runs::Plan, measurement::EmbeddingKind};
/// let given = Measurement::default().embedding(EmbeddingKind::Given);
/// let plan = Plan { measurement: given, per_component: true, ..Plan::default() };
/// assert!(plan.check().is_err());
/// ```
#[derive(Debug, Clone)]
pub struct Plan {
    /// How objects are measured.
    pub measurement: Measurement,
    /// Blur and thickness of labels that have their own.
    pub scales: LabelScales,
    /// Which inputs had them.
    pub scale_ledger: ScaleLedger,
    /// What the caller knows better than the input.
    pub open: OpenOptions,
    /// Which labels.
    pub labels: LabelSelection,
    /// What of these and of the scales is called by names, which each input has its own labels for.
    pub called: CalledObjects,
    /// At which blur surfaces are mapped; of no meaning to integrals.
    pub curvature: CurvatureScale,
    /// Whether each 26-connected piece is an object of its own.
    pub per_component: bool,
    /// When it is said where the blur and the band change topology.
    pub explain_topology: ExplainTopology,
    /// Whether objects of which the default blur loses detail are measured in the recovering embedding instead, where its
    /// errors are smaller. Choices of the caller's own are kept to.
    pub recover: bool,
    /// Regions that each object is split by, beside its own numbers.
    pub regions: Option<RegionImage>,
    /// Whether the contacts between objects, and with background, are measured.
    pub interfaces: bool,
    /// Volumes that are put on surfaces; of no meaning to integrals.
    pub samples: Vec<SampleImage>,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            measurement: Measurement::default(),
            scales: LabelScales::default(),
            scale_ledger: ScaleLedger::default(),
            open: OpenOptions::default(),
            labels: LabelSelection::default(),
            called: CalledObjects::default(),
            curvature: CurvatureScale::default(),
            per_component: false,
            explain_topology: ExplainTopology::default(),
            recover: true,
            regions: None,
            interfaces: false,
            samples: Vec::new(),
        }
    }
}

/// When it is looked into where the blur and the band change an object's topology.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExplainTopology {
    /// Never.
    Never,
    /// What the blur changed, where its surface and the voxels disagree: that takes no longer than measuring.
    /// Not where it puts more voxels on the other side than an eighth of the band's, or 2^22.
    #[default]
    Disagreements,
    /// Always, and what the band changes too: that may take several times as long as measuring.
    Always,
}

impl Plan {
    /// Whether objects are not those of labels, or not measured alike, so that they must be known as wholes.
    pub(super) fn needs_all(&self) -> bool {
        let beside = self.regions.is_some() || self.interfaces;
        !self.measurement.embedding.is_of_labels() || self.per_component || self.has_scales() || beside
    }

    /// Whether some objects have lengths of their own.
    pub(super) fn has_scales(&self) -> bool {
        !self.scales.is_empty() || self.called.has_lengths()
    }

    /// Whether an object that was measured while its slices went by is to be known as a whole: the blur loses detail of
    /// it, or voxels and mesh disagree. Where it is not, that is said in its flags.
    pub(super) fn wants_whole(&self, measured: &mut Measured) -> bool {
        let recovers = self.recover && self.measurement.recovering().is_some();
        let wanted =
            looked_at(measured, self.explain_topology).is_some() || recovers && measured.is_doubtful();
        if !wanted {
            what_is_explained(measured, self.explain_topology);
        }
        wanted
    }

    /// Refuses what contradicts itself, whatever the input.
    ///
    /// # Errors
    /// [`MeasureError`].
    pub fn check(&self) -> Result<(), MeasureError> {
        self.measurement.check()?;
        for label in self.scales.labels() {
            self.scales.of(label, self.measurement).check()?;
        }
        let conflict = |text| Err(MeasureError::Conflict(text));
        let names: BTreeSet<&str> = self.samples.iter().map(SampleImage::name).collect();
        if names.len() < self.samples.len() {
            return conflict(
                "two samples have one name, which their arrays would share: give each its own, as NAME=FILE",
            );
        }
        let mapped_apart = self.curvature != CurvatureScale::AsMeasured;
        match self.measurement.embedding {
            EmbeddingKind::Given if mapped_apart => {
                conflict("a field has no blur of its own, so it has no scale of curvature: leave that out")
            }
            kind if self.per_component && !kind.is_of_labels() => conflict(
                "a field or soft segmentation has no labels whose pieces could be told apart: measure it as one object",
            ),
            kind if self.interfaces && (self.per_component || !kind.is_of_labels()) => conflict(
                "interfaces are those of labels: leave them out of fields, soft segmentations and pieces of labels",
            ),
            kind if !self.open.preparation.is_none() && !kind.is_of_labels() => conflict(
                "a threshold, the largest component and filled cavities make a label image: leave them out, or measure that in another embedding",
            ),
            kind if self.has_scales() && !kind.is_of_labels() => conflict(
                "a field or soft segmentation has no labels: give one blur and one thickness for the whole",
            ),
            kind if self.labels != LabelSelection::All && !kind.is_of_labels() => {
                conflict("a field or soft segmentation has no labels: leave the choice of labels out")
            }
            kind if mapped_apart && !kind.is_blur() => conflict(
                "a scale for curvature belongs to the embeddings that blur (gaussian, corrected, recovering, probability): leave it out",
            ),
            _ => Ok(()),
        }
    }
}
