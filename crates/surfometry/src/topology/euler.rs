//! Euler numbers of a binary image, 64 voxels at a time.

use crate::tiling::IndexBox;
use crate::volume::Mask;
use serde::{Deserialize, Serialize};

/// Euler numbers of the solid in some boxes; those of disjoint boxes add up.
///
/// # References
/// Odgaard and Gundersen 1993; Ohser and Mücklich 2000 (inclusion-exclusion over vertices, edges, faces and
/// cubes).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct EulerNumbers {
    /// With 26-connected foreground: vertices - edges + faces - cubes of closed voxels.
    pub(crate) foreground_26: i64,
    /// With 6-connected foreground: voxel centres - bonds + squares - cubes, all of whose voxels are inside.
    pub(crate) foreground_6: i64,
}

impl EulerNumbers {
    /// Of the part of an object in a box.
    pub(crate) fn within(mask: &Mask, region: &IndexBox) -> Self {
        let (part, mut numbers) = (mask.on_bounds(*region), Self::default());
        numbers.add(&part, &region.grown([1; 3]));
        numbers
    }

    /// What is added by the neighbourhoods of 2 x 2 x 2 voxels whose first voxel lies in a box.
    pub(crate) fn add(&mut self, mask: &Mask, first: &IndexBox) {
        let around = mask.bounds().grown([1; 3]);
        let IndexBox { lower, upper } = around.intersection(first);
        // Bit 0 of a row is the voxel before the mask's first.
        let [start, end] = [lower[0], upper[0]].map(|x| (x - around.lower[0]) as usize);
        let mut rows = vec![vec![0u64; (around.upper[0] - around.lower[0]) as usize / 64 + 2]; 4];
        for z in lower[2]..upper[2] {
            shifted(mask.row(lower[1], z), &mut rows[2]);
            shifted(mask.row(lower[1], z + 1), &mut rows[3]);
            for y in lower[1]..upper[1] {
                rows.swap(0, 2);
                rows.swap(1, 3);
                shifted(mask.row(y + 1, z), &mut rows[2]);
                shifted(mask.row(y + 1, z + 1), &mut rows[3]);
                for word in start / 64..end.div_ceil(64) {
                    // The voxels of a word, and their neighbours along x: at y and y + 1, each at z and z +
                    // 1.
                    let [here, above, behind, across] = [0, 1, 2, 3].map(|row| {
                        let row = &rows[row];
                        [row[word], row[word] >> 1 | row[word + 1] << 63]
                    });
                    let counted = bits_from(start, word) & !bits_from(end, word);
                    self.foreground_26 -= alternating_sum(|a, b| a | b, here, above, behind, across, counted);
                    self.foreground_6 += alternating_sum(|a, b| a & b, here, above, behind, across, counted);
                }
            }
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.foreground_26 += other.foreground_26;
        self.foreground_6 += other.foreground_6;
    }
}

/// The bits of a word of a row from a place in the row on.
fn bits_from(place: usize, word: usize) -> u64 {
    match place.saturating_sub(word * 64) {
        shift @ 0..64 => u64::MAX << shift,
        _ => 0,
    }
}

/// Voxels - pairs + fours - eights that begin at the voxels of a word that count, of those whose voxels the
/// operation unites. For closed voxels pairs are faces, fours edges and eights vertices; for open ones pairs
/// are bonds, fours squares and eights cubes.
fn alternating_sum(
    unite: impl Fn(u64, u64) -> u64,
    here: [u64; 2],
    above: [u64; 2],
    behind: [u64; 2],
    across: [u64; 2],
    counted: u64,
) -> i64 {
    let count = |word: u64| i64::from((word & counted).count_ones());
    let along_x = |row: [u64; 2]| unite(row[0], row[1]);
    let along_y = unite(here[0], behind[0]);
    let along_z = unite(here[0], above[0]);
    let (x_here, x_above, x_behind, x_across) =
        (along_x(here), along_x(above), along_x(behind), along_x(across));
    let (xy, xz) = (unite(x_here, x_behind), unite(x_here, x_above));
    let yz = unite(along_y, unite(above[0], across[0]));
    let xyz = unite(xy, unite(x_above, x_across));
    count(here[0]) - count(x_here) - count(along_y) - count(along_z) + count(xy) + count(xz) + count(yz)
        - count(xyz)
}

/// A row with one voxel of background in front, so that its first neighbourhood begins before it.
fn shifted(row: &[u64], out: &mut [u64]) {
    out.fill(0);
    for (n, word) in row.iter().enumerate() {
        out[n] |= word << 1;
        out[n + 1] |= word >> 63;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;
    use proptest::prelude::*;

    fn euler(dimensions: [usize; 3], inside: impl Fn([usize; 3]) -> bool) -> (i64, i64) {
        let mask = Mask::from_predicate(Grid::axis_aligned(dimensions, [1.0; 3]).unwrap(), inside);
        let mut numbers = EulerNumbers::default();
        numbers.add(&mask, &mask.grid().index_box().grown([1; 3]));
        (numbers.foreground_26, numbers.foreground_6)
    }

    /// How often each of the 256 configurations of 2 x 2 x 2 voxels occurs; histograms of disjoint boxes add
    /// up.
    ///
    /// Bit x + 2 y + 4 z of a configuration is the voxel at that corner.
    #[derive(Debug, Clone, PartialEq, Eq)]
    struct ConfigurationHistogram([u64; 256]);

    impl ConfigurationHistogram {
        /// Counts the configurations whose first voxel lies in a box.
        fn of(mask: &Mask, region: &IndexBox) -> Self {
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

        /// Euler number of the solid with 26-connected foreground: vertices - edges + faces - cubes of closed
        /// voxels.
        fn euler_26(&self) -> i64 {
            self.weighted(|configuration| {
                let present =
                    |voxels: &[usize]| i64::from(voxels.iter().any(|v| configuration >> v & 1 == 1));
                octant_sum(present, [8, 4, 2, 1])
            })
        }

        /// Euler number of the solid with 6-connected foreground: voxel centres, bonds, squares and cubes all
        /// inside.
        fn euler_6(&self) -> i64 {
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

    /// Alternating sum over the cells around the corner that the eight voxels share: the corner itself (8
    /// voxels), its 6 edges (4 voxels), 12 faces (2) and 8 cubes (1). A cell has as many such corners as its
    /// share in eighths says.
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

    proptest! {
        /// Another way to the same numbers, by the table of neighbourhoods; in parts.
        #[test]
        fn agrees_with_the_table(
            on in prop::collection::vec(prop::bool::weighted(0.4), 130 * 4 * 5), cut in -1..131i64, axis in 0usize..3
        ) {
            let n = [130, 4, 5];
            let grid = Grid::axis_aligned(n, [1.0; 3]).unwrap();
            let mask = Mask::from_predicate(grid, |[x, y, z]| on[(z * n[1] + y) * n[0] + x]);
            let table = ConfigurationHistogram::of(&mask, &mask.bounds().grown([1; 3]));
            let mut numbers = EulerNumbers::default();
            let (mut before, mut behind) = (grid.index_box().grown([1; 3]), grid.index_box().grown([1; 3]));
            (before.upper[axis], behind.lower[axis]) = (cut.min(n[axis] as i64), cut.min(n[axis] as i64));
            for part in [before, behind] {
                numbers.add(&mask, &IndexBox::new(part.lower, part.upper));
            }
            prop_assert_eq!(numbers.foreground_26, table.euler_26());
            prop_assert_eq!(numbers.foreground_6, table.euler_6());
        }
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
