//! When voxels and runs of voxels are connected.

use crate::tiling::DisjointSets;

/// What is counted and when two voxels are neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Connectivity {
    /// Inside voxels that share a face, an edge or a corner.
    Foreground26,
    /// Outside voxels that share a face; everything beyond the bounding box is one of the components.
    Background6,
}

impl Connectivity {
    /// The (y, z) of the rows before one, relative to it, whose runs may touch its runs.
    pub(super) fn earlier_rows(self) -> &'static [(i64, i64)] {
        match self {
            Self::Foreground26 => &[(-1, 0), (-1, -1), (0, -1), (1, -1)],
            Self::Background6 => &[(-1, 0), (0, -1)],
        }
    }

    /// How far apart two runs of neighbouring rows may end and still touch.
    pub(super) fn slack(self) -> i64 {
        match self {
            Self::Foreground26 => 1,
            Self::Background6 => 0,
        }
    }

    /// The neighbours of a voxel.
    pub(super) fn neighbours(self, [x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
        let most: i64 = if self == Self::Foreground26 { 3 } else { 1 };
        let steps = (0..27i64).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]);
        let near = move |d: &[i64; 3]| (1..=most).contains(&d.iter().map(|v| v.abs()).sum());
        steps.filter(near).map(move |[dx, dy, dz]| [x + dx, y + dy, z + dz])
    }
}

/// A run of equal voxels in a row: half-open in x.
pub(super) type Run = (i64, i64);

/// What lies between runs on x0..x1.
pub(super) fn gaps(runs: impl Iterator<Item = Run>, x0: i64, x1: i64) -> impl Iterator<Item = Run> {
    let ends = runs.chain([(x1, x1)]);
    let gap = |start: &mut i64, (a, b): Run| Some((std::mem::replace(start, b), a));
    ends.scan(x0, gap).filter(|(start, end)| start < end)
}

pub(super) fn join_touching(
    sets: &mut DisjointSets,
    (first, runs): (usize, &[Run]),
    (other_first, other): (usize, &[Run]),
    slack: i64,
) {
    let (mut i, mut j) = (0, 0);
    while i < runs.len() && j < other.len() {
        if runs[i].0 < other[j].1 + slack && other[j].0 < runs[i].1 + slack {
            sets.join(first + i, other_first + j);
        }
        if runs[i].1 < other[j].1 { i += 1 } else { j += 1 }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::topology::ComponentLabels;
    use crate::volume::{Grid, Mask};
    use proptest::prelude::*;

    /// Flood fill on a padded array: slow and plain.
    pub(in crate::topology) fn flood(n: [usize; 3], on: &[bool], connectivity: Connectivity) -> u64 {
        let [nx, ny, nz] = n.map(|v| v as i64 + 2);
        let inside = |p: [i64; 3]| {
            (0..3).all(|a| p[a] > 0 && p[a] <= n[a] as i64)
                && on[((p[2] as usize - 1) * n[1] + p[1] as usize - 1) * n[0] + p[0] as usize - 1]
        };
        let wanted = |p: [i64; 3]| inside(p) == (connectivity == Connectivity::Foreground26);
        let mut seen = std::collections::HashSet::new();
        let mut count = 0;
        for start in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]) {
            if !wanted(start) || !seen.insert(start) {
                continue;
            }
            count += 1;
            let mut stack = vec![start];
            while let Some(p) = stack.pop() {
                for d in (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]) {
                    let steps: i64 = d.iter().map(|v: &i64| v.abs()).sum();
                    let q = [p[0] + d[0], p[1] + d[1], p[2] + d[2]];
                    let in_box = (0..3).all(|a| q[a] >= 0 && q[a] < [nx, ny, nz][a]);
                    let neighbour = connectivity == Connectivity::Foreground26 || steps == 1;
                    if in_box && neighbour && wanted(q) && seen.insert(q) {
                        stack.push(q);
                    }
                }
            }
        }
        count
    }

    proptest! {
        #[test]
        fn agrees_with_flood_fill(on in prop::collection::vec(prop::bool::weighted(0.35), 7 * 5 * 4)) {
            let n = [7, 5, 4];
            let grid = Grid::axis_aligned(n, [1.0; 3]).unwrap();
            let mask = Mask::from_predicate(grid, |[x, y, z]| on[(z * n[1] + y) * n[0] + x]);
            prop_assume!(!mask.is_empty());
            for connectivity in [Connectivity::Foreground26, Connectivity::Background6] {
                let all = flood(n, &on, connectivity);
                prop_assert_eq!(ComponentLabels::of(&mask, connectivity).count(), all);
            }
        }
    }
}
