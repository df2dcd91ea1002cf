//! What makes the surfaces of two images of an object comparable.

use super::clip::RIM;
use super::object::Content;
use super::{EmbeddingKind, Measurement, Object};
use crate::accuracy::PositionNoise;
use crate::volume::FieldOfView;

/// The least, in voxels, of a cap that nothing blurs.
const LEAST: f64 = 1.5;

impl Object {
    /// The measurement whose surface of the same object in another image, on whatever grid, is to be compared with this one's:
    /// at the same blur, so that what a blur does to both is the same.
    pub fn comparable(&self) -> Measurement {
        self.setup.measurement.sigma_mm(self.setup.parameters.sigma_mm)
    }

    /// The box around its voxels.
    #[cfg(feature = "io")]
    pub(crate) fn place(&self) -> Option<FieldOfView> {
        FieldOfView::new(self.grid(), &self.mask().bounds())
    }

    /// Where its surface is known to be its own: within its image, as far as it is measured, and farther from what cuts it than the
    /// cap is told.
    pub fn field_of_view(&self) -> Option<FieldOfView> {
        if let Some(part) = &self.part {
            return FieldOfView::new(self.grid(), &part.region);
        }
        let parameters = &self.setup.parameters;
        let image = self.grid().index_box();
        let whole = FieldOfView::new(self.grid(), &image)?;
        if parameters.embedding == EmbeddingKind::Given && parameters.padding.is_none() {
            // It ends at the centres of voxels, open.
            return Some(whole.without([[0.5; 2]; 3]));
        }
        let (bounds, spacing) = (self.mask.bounds(), self.grid().spacing().mm());
        // As far as `Clip::Exclude` stays away from a cut.
        let reach = RIM * parameters.sigma_mm.unwrap_or_default();
        let cut = |is_cut: bool, a: usize| if is_cut { (reach / spacing[a]).max(LEAST) } else { 0.0 };
        let cuts =
            |a: usize| [cut(bounds.lower[a] == image.lower[a], a), cut(bounds.upper[a] == image.upper[a], a)];
        Some(whole.without(std::array::from_fn(cuts)))
    }

    /// How far its surface is off by where its voxels happen to lie; `None` where no model of that holds: of soft
    /// segmentations, given fields, distances, other levels than 0.5, and surfaces of which each vertex has a scale of its own. (Of
    /// those one scale lies where another does but for what each leaves of the shape: of two masks of a rounded box a voxel's
    /// noise says half of what they differ by.)
    pub fn position_noise(&self) -> Option<PositionNoise> {
        let parameters = &self.setup.parameters;
        let is_mask = matches!(self.content, Content::Mask(_) | Content::Corrected(..));
        parameters.compensable_sigma().filter(|_| is_mask && !self.has_scales_of_vertices())?;
        Some(PositionNoise::new(self.grid(), parameters.sigma_mm?, parameters.embedding.is_corrected()))
    }
}
