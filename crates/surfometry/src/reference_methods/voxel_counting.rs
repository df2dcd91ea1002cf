//! Counting voxels and their faces.

use super::{ReferenceMethod, ReferenceValues};
use crate::volume::Mask;

/// V of the voxels, without bias; A of their faces, 1.5 times a smooth surface's at any resolution.
#[derive(Debug, Clone, Copy)]
pub struct VoxelCounting;

impl ReferenceMethod for VoxelCounting {
    fn name(&self) -> &'static str {
        "voxels"
    }

    fn measure(&self, mask: &Mask) -> ReferenceValues {
        let [hx, hy, hz] = mask.grid().spacing().mm();
        let bounds = mask.bounds();
        let rows = || bounds.grown([1; 3]).rows();
        let along_x: u64 = rows().map(|(y, z)| 2 * mask.runs(y, z).count() as u64).sum();
        let changed = |step: [i64; 2]| -> u64 {
            let row = |y: i64, z: i64| {
                let (a, b) = (mask.row(y, z), mask.row(y + step[0], z + step[1]));
                let word = |row: &[u64], n: usize| row.get(n).copied().unwrap_or_default();
                (0..a.len().max(b.len()))
                    .map(|n| u64::from((word(a, n) ^ word(b, n)).count_ones()))
                    .sum::<u64>()
            };
            rows().map(|(y, z)| row(y, z)).sum()
        };
        let [along_x, along_y, along_z] = [along_x, changed([1, 0]), changed([0, 1])].map(|n| n as f64);
        ReferenceValues {
            volume_mm3: Some(mask.voxels() as f64 * mask.grid().spacing().cell_volume()),
            surface_area_mm2: Some(along_x * hy * hz + along_y * hx * hz + along_z * hx * hy),
            ..ReferenceValues::default()
        }
    }
}
