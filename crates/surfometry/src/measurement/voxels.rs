//! Numbers that come from counting voxels.

use super::VoxelSummary;
use crate::tiling::IndexBox;
use crate::volume::{Grid, Mask};
use std::ops::Range;

/// Counts of an object's voxels. Sums of indices are whole numbers, so nothing is rounded before the last step.
#[derive(Debug, Clone, Copy)]
pub(super) struct VoxelCounts {
    count: i128,
    /// Of twice the indices.
    sums: [i128; 3],
    bounds: IndexBox,
}

impl Default for VoxelCounts {
    fn default() -> Self {
        Self { count: 0, sums: [0; 3], bounds: IndexBox::EMPTY }
    }
}

impl VoxelCounts {
    /// Adds an object's voxels in a range of slices.
    pub(super) fn add(&mut self, mask: &Mask, slices: Range<i64>) {
        let IndexBox { lower, upper } = mask.bounds();
        for z in slices.start.max(lower[2])..slices.end.min(upper[2]) {
            for y in lower[1]..upper[1] {
                for (a, b) in mask.runs(y, z) {
                    let length = i128::from(b - a);
                    self.count += length;
                    self.sums[0] += length * i128::from(a + b - 1);
                    self.sums[1] += length * 2 * i128::from(y);
                    self.sums[2] += length * 2 * i128::from(z);
                    self.bounds = self.bounds.hull(&IndexBox::new([a, y, z], [b, y + 1, z + 1]));
                }
            }
        }
    }

    /// The box around the voxels.
    pub(super) fn bounds(&self) -> &IndexBox {
        &self.bounds
    }

    pub(super) fn summary(&self, grid: &Grid) -> VoxelSummary {
        let centroid = self.sums.map(|doubled| doubled as f64 / (2 * self.count) as f64);
        VoxelSummary {
            count: self.count as u64,
            volume_mm3: self.count as f64 * grid.spacing().cell_volume(),
            centroid_mm: grid.affine().apply(centroid),
            bounding_box: [self.bounds.lower, self.bounds.upper.map(|u| u - 1)],
        }
    }
}
