//! Numbers that come from counting voxels.

use super::VoxelSummary;
use crate::volume::Mask;

impl VoxelSummary {
    /// Counts an object's voxels. Sums of indices are whole numbers, so nothing is rounded before the last step.
    pub(super) fn of(mask: &Mask) -> Self {
        let bounds = mask.bounds();
        let (mut count, mut sums) = (0i128, [0i128; 3]);
        for (y, z) in bounds.rows() {
            for (a, b) in mask.runs(y, z) {
                let length = i128::from(b - a);
                count += length;
                sums[0] += length * i128::from(a + b - 1);
                sums[1] += length * 2 * i128::from(y);
                sums[2] += length * 2 * i128::from(z);
            }
        }
        let centroid = sums.map(|doubled| doubled as f64 / (2 * count) as f64);
        Self {
            count: count as u64,
            volume_mm3: count as f64 * mask.grid().spacing().cell_volume(),
            centroid_mm: mask.grid().affine().apply(centroid),
            bounding_box: [bounds.lower, bounds.upper.map(|u| u - 1)],
        }
    }
}
