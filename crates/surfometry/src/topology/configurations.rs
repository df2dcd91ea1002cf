//! Euler numbers from the 2 x 2 x 2 configurations of a binary image.

use crate::tiling::IndexBox;
use crate::volume::Mask;

/// How often each of the 256 configurations of 2 x 2 x 2 voxels occurs; histograms of disjoint boxes add up.
///
/// Bit x + 2 y + 4 z of a configuration is the voxel at that corner.
///
/// # References
/// Odgaard and Gundersen 1993; Ohser and Mücklich 2000 (inclusion-exclusion over vertices, edges, faces and cubes).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigurationHistogram([u64; 256]);

impl ConfigurationHistogram {
    /// Counts the configurations whose first voxel lies in a box.
    pub fn of(mask: &Mask, region: &IndexBox) -> Self {
        let mut counts = [0; 256];
        let nx = region.extent()[0];
        let mut rows = vec![vec![0u8; nx + 1]; 4];
        for (y, z) in region.rows() {
            for (row, (dy, dz)) in rows.iter_mut().zip([(0, 0), (1, 0), (0, 1), (1, 1)]) {
                expand(mask, y + dy, z + dz, region.lower[0], row);
            }
            for x in 0..nx {
                let pair = |r: usize| (rows[r][x] | rows[r][x + 1] << 1) << (2 * r);
                counts[usize::from(pair(0) | pair(1) | pair(2) | pair(3))] += 1;
            }
        }
        Self(counts)
    }

    /// Euler number of the solid with 26-connected foreground: vertices - edges + faces - cubes of closed voxels.
    pub fn euler_26(&self) -> i64 {
        self.weighted(|configuration| {
            let present = |voxels: &[usize]| i64::from(voxels.iter().any(|v| configuration >> v & 1 == 1));
            octant_sum(present, [8, 4, 2, 1])
        })
    }

    /// Euler number of the solid with 6-connected foreground: voxel centres, bonds, squares and cubes all inside.
    pub fn euler_6(&self) -> i64 {
        self.weighted(|configuration| {
            let all = |voxels: &[usize]| i64::from(voxels.iter().all(|v| configuration >> v & 1 == 1));
            -octant_sum(all, [8, 4, 2, 1])
        })
    }

    fn weighted(&self, eighths: impl Fn(usize) -> i64) -> i64 {
        let sum: i64 = (0..256).map(|c| self.0[c] as i64 * eighths(c)).sum();
        debug_assert_eq!(sum % 8, 0, "an Euler number is whole");
        sum / 8
    }
}

/// Alternating sum over the cells around the corner that the eight voxels share: the corner itself (8 voxels), its 6
/// edges (4 voxels), 12 faces (2) and 8 cubes (1). A cell has as many such corners as its share in eighths says.
fn octant_sum(counts: impl Fn(&[usize]) -> i64, eighths: [i64; 4]) -> i64 {
    let with = |fixed: &[(usize, usize)]| -> Vec<usize> {
        (0..8).filter(|v| fixed.iter().all(|&(axis, side)| v >> axis & 1 == side)).collect()
    };
    let sides = [0, 1];
    let mut sum = eighths[0] * counts(&with(&[]));
    for axis in 0..3 {
        for side in sides {
            sum -= eighths[1] * counts(&with(&[(axis, side)]));
        }
    }
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        for (s, t) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            sum += eighths[2] * counts(&with(&[(a, s), (b, t)]));
        }
    }
    for voxel in 0..8 {
        sum -= eighths[3] * counts(&[voxel]);
    }
    sum
}

fn expand(mask: &Mask, y: i64, z: i64, x0: i64, row: &mut [u8]) {
    row.fill(0);
    let end = x0 + row.len() as i64;
    for (a, b) in mask.runs(y, z) {
        let (a, b) = (a.clamp(x0, end), b.clamp(x0, end));
        row[(a - x0) as usize..(b - x0) as usize].fill(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;

    fn euler(dimensions: [usize; 3], inside: impl Fn([usize; 3]) -> bool) -> (i64, i64) {
        let mask = Mask::from_predicate(Grid::axis_aligned(dimensions, [1.0; 3]).unwrap(), inside);
        let histogram = ConfigurationHistogram::of(&mask, &mask.bounds().grown([1; 3]));
        (histogram.euler_26(), histogram.euler_6())
    }

    #[test]
    fn known_objects() {
        assert_eq!(euler([1, 1, 1], |_| true), (1, 1));
        assert_eq!(euler([5, 4, 3], |_| true), (1, 1));
        // A square ring, a hollow cube, and two separate voxels.
        assert_eq!(euler([3, 3, 1], |[x, y, _]| (x, y) != (1, 1)), (0, 0));
        assert_eq!(euler([3, 3, 3], |v| v != [1, 1, 1]), (2, 2));
        assert_eq!(euler([3, 1, 1], |[x, _, _]| x != 1), (2, 2));
        // Voxels that touch at a corner or an edge: one object for 26, two for 6.
        assert_eq!(euler([2, 2, 2], |v| v == [0, 0, 0] || v == [1, 1, 1]), (1, 2));
        assert_eq!(euler([2, 2, 1], |v| v == [0, 0, 0] || v == [1, 1, 0]), (1, 2));
    }
}
