//! A box of a label image.

use super::labels::RunEncoder;
use super::{Grid, LabelImage, LabelRuns, LabelSummary, Samples, Scalar, VolumeError};
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
        check_within(&grid, region)?;
        LabelImage::of_part(grid, region, voxels).map(|labels| Self { region, labels })
    }

    /// The labels as an image of which nothing else is known.
    #[cfg(feature = "io")]
    pub(crate) fn image(&self) -> &LabelImage {
        &self.labels
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

fn check_within(grid: &Grid, region: IndexBox) -> Result<(), VolumeError> {
    let image = grid.index_box();
    if region.is_empty() || !image.holds(&region) {
        return Err(VolumeError::BoxBeyondImage { region, image });
    }
    Ok(())
}

/// A block that is made of some slices at a time, so that its voxels need not be in memory at once.
///
/// ```
/// use surfometry::tiling::IndexBox;
/// use surfometry::volume::{Grid, LabelBlockBuilder, Samples};
/// let grid = Grid::axis_aligned([4, 4, 4], [1.0; 3])?;
/// let mut builder = LabelBlockBuilder::new(grid, IndexBox::new([1, 1, 2], [3, 3, 4]))?;
/// builder.push(&Samples::U8(vec![1, 1, 0, 7]))?;
/// builder.push(&Samples::U8(vec![1, 1, 0, 0]))?;
/// assert_eq!(builder.finish()?.region().voxels(), 8);
/// # Ok::<(), surfometry::volume::VolumeError>(())
/// ```
pub struct LabelBlockBuilder {
    grid: Grid,
    region: IndexBox,
    encoder: RunEncoder,
    runs: LabelRuns,
}

impl LabelBlockBuilder {
    /// None of the slices yet of a box of an image.
    ///
    /// # Errors
    /// [`VolumeError`] for a box that reaches beyond the image or has no voxel.
    pub fn new(grid: Grid, region: IndexBox) -> Result<Self, VolumeError> {
        check_within(&grid, region)?;
        let (encoder, runs) = (RunEncoder::new(region), LabelRuns::new(grid, &region));
        Ok(Self { grid, region, encoder, runs })
    }

    /// Adds the next slices of the box, x fastest.
    ///
    /// # Errors
    /// [`VolumeError`] for voxels that are no labels.
    pub fn push(&mut self, slices: &Samples) -> Result<(), VolumeError> {
        self.encoder.push_samples(slices, &mut self.runs)
    }

    /// The block.
    ///
    /// # Errors
    /// [`VolumeError`] where slices are missing.
    pub fn finish(self) -> Result<LabelBlock, VolumeError> {
        Ok(LabelBlock { region: self.region, labels: self.encoder.finish(self.grid, self.runs)? })
    }
}
