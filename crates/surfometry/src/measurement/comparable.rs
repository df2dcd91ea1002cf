//! What makes the surfaces of two images of an object comparable.

use super::object::Content;
use super::{Measurement, Object};
use crate::accuracy::PositionNoise;

impl Object {
    /// The measurement whose surface of the same object in another image, on whatever grid, is to be compared with this one's:
    /// at the same blur, so that what a blur does to both is the same.
    pub fn comparable(&self) -> Measurement {
        self.setup.measurement.sigma_mm(self.setup.parameters.sigma_mm)
    }

    /// How far its surface is off by where its voxels happen to lie; `None` where no model of that holds: of soft
    /// segmentations, given fields, distances, and other levels than 0.5.
    pub fn position_noise(&self) -> Option<PositionNoise> {
        let parameters = &self.setup.parameters;
        let is_mask = matches!(self.content, Content::Mask(_) | Content::Corrected(..));
        parameters.compensable_sigma().filter(|_| is_mask)?;
        Some(PositionNoise::new(self.grid(), parameters.sigma_mm?, parameters.embedding.is_corrected()))
    }
}
