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
    /// In the image's first and last slice of each axis.
    at_edge: [[u64; 2]; 3],
}

impl Default for VoxelCounts {
    fn default() -> Self {
        Self { count: 0, sums: [0; 3], bounds: IndexBox::EMPTY, at_edge: [[0; 2]; 3] }
    }
}

impl VoxelCounts {
    /// Adds an object's voxels in a range of slices.
    pub(super) fn add(&mut self, mask: &Mask, slices: Range<i64>) {
        let IndexBox { lower, upper } = mask.bounds();
        let last = mask.grid().dimensions().map(|n| n as i64 - 1);
        for z in slices.start.max(lower[2])..slices.end.min(upper[2]) {
            for y in lower[1]..upper[1] {
                for (a, b) in mask.runs(y, z) {
                    let length = i128::from(b - a);
                    self.count += length;
                    self.sums[0] += length * i128::from(a + b - 1);
                    self.sums[1] += length * 2 * i128::from(y);
                    self.sums[2] += length * 2 * i128::from(z);
                    for (axis, voxels, [first, end]) in
                        [(0, 1, [a, b - 1]), (1, b - a, [y; 2]), (2, b - a, [z; 2])]
                    {
                        self.at_edge[axis][0] += if first == 0 { voxels as u64 } else { 0 };
                        self.at_edge[axis][1] += if end == last[axis] { voxels as u64 } else { 0 };
                    }
                    self.bounds = self.bounds.hull(&IndexBox::new([a, y, z], [b, y + 1, z + 1]));
                }
            }
        }
    }

    /// Area of the voxels' faces on the image's first and last slice of each axis, mm^2: where the image cuts the object.
    pub(super) fn cut_areas(&self, grid: &Grid) -> [[f64; 2]; 3] {
        let (volume, spacing) = (grid.spacing().cell_volume(), grid.spacing().mm());
        std::array::from_fn(|axis| self.at_edge[axis].map(|voxels| voxels as f64 * volume / spacing[axis]))
    }

    pub(super) fn summary(&self, grid: &Grid) -> VoxelSummary {
        let centroid = self.sums.map(|doubled| doubled as f64 / (2 * self.count) as f64);
        VoxelSummary {
            count: self.count as u64,
            volume_mm3: self.count as f64 * grid.spacing().cell_volume(),
            centroid_mm: grid.affine().apply(centroid),
            cut_area_mm2: self.cut_areas(grid).as_flattened().iter().sum(),
            bounding_box: [self.bounds.lower, self.bounds.upper.map(|u| u - 1)],
        }
    }
}
