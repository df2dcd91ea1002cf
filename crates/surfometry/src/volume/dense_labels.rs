//! A part of a label image, voxel by voxel.

use super::LabelImage;
use crate::tiling::{Block, IndexBox};

impl LabelImage {
    /// What stands for the label of each voxel of a box, which may reach beyond the image, where there is background: a number
    /// by label.
    pub(crate) fn dense(&self, region: &IndexBox, number_of: impl Fn(i64) -> u32) -> Block<u32> {
        let mut block = Block::filled(*region, 0);
        let inside = region.intersection(&self.grid().index_box());
        for (y, z) in inside.rows() {
            let row = block.row_mut(y, z);
            let place =
                |x: usize| ((x as i64).clamp(region.lower[0], region.upper[0]) - region.lower[0]) as usize;
            for (run, label) in self.labelled_runs(y as usize, z as usize) {
                row[place(run.start)..place(run.end)].fill(number_of(label));
            }
        }
        block
    }
}
