//! Soft segmentations.

use super::object::Content;
use super::scheme::Scheme;
use super::setup::Setup;
use super::{Clip, EmbeddingKind, MeasureError, Measured, Measurement, Object};
use crate::volume::{ProbabilityImage, Shared, VolumeError};
use std::sync::Arc;
use std::time::Instant;

impl Measurement {
    /// Sets up the object of a soft segmentation, phi = T - G_sigma * p ([`EmbeddingKind::Probability`], or
    /// the corrected one where that was chosen). Its voxels are those whose values exceed the level, where
    /// T - p is negative.
    ///
    /// Compensation takes the values for the shares of the voxels that the object fills, or for bits where
    /// all are 0 or 1 ([`SoftEdges`](crate::accuracy::SoftEdges)); then all numbers are those of
    /// [`Measurement::prepare`].
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, an image in which no value exceeds the level, or
    /// an object that its image cuts and of which the cut is to be left out.
    pub fn prepare_probability(&self, image: impl Shared<ProbabilityImage>) -> Result<Object, MeasureError> {
        let (image, start) = (image.shared(), Instant::now());
        let setup = Setup::of_probability(self, &image)?;
        let level = setup.parameters.level_or_half();
        let mask = image.above(level);
        if mask.is_empty() {
            return Err(VolumeError::NothingAbove { level, highest: image.highest() }.into());
        }
        if self.clip == Clip::Exclude && mask.touches_border() {
            return Err(MeasureError::Conflict(
                "a soft segmentation that the edge of its image cuts cannot be continued beyond it: close it there with a cap, or threshold it to a mask",
            ));
        }
        let leaves_something = Scheme::of_probability(&setup, &image)?.is_some();
        let content = if leaves_something { Content::Probability(image) } else { Content::Nothing };
        let preparation = start.elapsed();
        Ok(Object { mask: Arc::new(mask), setup, content, scales: Vec::new(), part: None, preparation })
    }

    /// Measures a soft segmentation; see [`Measurement::prepare_probability`].
    ///
    /// # Errors
    /// Those of [`Measurement::prepare_probability`].
    pub fn run_probability(&self, image: impl Shared<ProbabilityImage>) -> Result<Measured, MeasureError> {
        self.prepare_probability(image).map(|object| object.measure())
    }

    /// The same with an embedding that a soft segmentation can have.
    pub(super) fn of_probability(&self) -> Self {
        let embedding = match self.embedding {
            EmbeddingKind::Corrected => EmbeddingKind::Corrected,
            _ => EmbeddingKind::Probability,
        };
        Self { embedding, ..*self }
    }
}
