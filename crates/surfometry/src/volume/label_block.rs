//! A box of a label image.

use super::{Grid, LabelImage, LabelRuns, LabelSummary, Scalar, VolumeError};
use crate::tiling::IndexBox;

/// The labels in a box of an image, of which the rest is somewhere else or never held.
#[derive(Debug, Clone)]
pub struct LabelBlock {
    region: IndexBox,
    labels: LabelImage,
}

impl LabelBlock {
    /// Of an array in memory, x fastest, of the voxels of a box of an image with the given lattice.
    ///
    /// # Errors
    /// [`VolumeError`] for a box that reaches beyond the image or has no voxel, voxels that are no labels, or
    /// too few of them.
    pub fn from_voxels<T: Scalar>(grid: Grid, region: IndexBox, voxels: &[T]) -> Result<Self, VolumeError> {
        if region.is_empty() || !grid.index_box().holds(&region) {
            return Err(VolumeError::BoxBeyondImage { region, image: grid.index_box() });
        }
        LabelImage::of_part(grid, region, voxels).map(|labels| Self { region, labels })
    }

    /// The lattice of the image.
    pub fn grid(&self) -> &Grid {
        self.labels.grid()
    }

    /// The box.
    pub fn region(&self) -> &IndexBox {
        &self.region
    }

    /// The labels' runs, and each label's code in them and the box around its voxels.
    pub(crate) fn runs(&self) -> (&LabelRuns, impl Iterator<Item = (i64, usize, IndexBox)>) {
        let labels = self.labels.summaries().iter().map(LabelSummary::coded);
        (self.labels.runs(), labels)
    }
}

/// All of an image.
impl From<LabelImage> for LabelBlock {
    fn from(labels: LabelImage) -> Self {
        Self { region: labels.grid().index_box(), labels }
    }
}
