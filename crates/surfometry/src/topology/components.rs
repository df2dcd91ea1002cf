//! Connected components of a mask and of its background, by runs.

use super::DisjointSets;
use crate::tiling::IndexBox;
use crate::volume::Mask;
use std::ops::Range;

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

/// Counts components slices by slices, remembering the last slice alone.
#[derive(Debug, Clone)]
pub(crate) struct ComponentCounter {
    connectivity: Connectivity,
    sets: DisjointSets,
    /// Components that no later slice can reach.
    finished: u64,
    /// The runs of the slice before, with the number of each row's first; `None` where it has no voxel of the object.
    previous: Option<SliceOfRuns>,
}

#[derive(Debug, Clone)]
struct SliceOfRuns {
    first_row: i64,
    rows: Vec<(usize, Vec<Run>)>,
}

impl SliceOfRuns {
    fn row(&self, y: i64) -> Option<&(usize, Vec<Run>)> {
        usize::try_from(y - self.first_row).ok().and_then(|row| self.rows.get(row))
    }

    fn members(&self) -> impl Iterator<Item = usize> + '_ {
        self.rows.iter().flat_map(|(first, runs)| *first..*first + runs.len())
    }
}

/// Slices after which sets that can grow no more are forgotten.
const SLICES_REMEMBERED: i64 = 8;
/// Number of the background's set that everything beyond the object's box belongs to.
const OUTSIDE: usize = 0;

impl ComponentCounter {
    pub(crate) fn new(connectivity: Connectivity) -> Self {
        let mut sets = DisjointSets::default();
        if connectivity == Connectivity::Background6 {
            sets.add(1);
        }
        Self { connectivity, sets, finished: 0, previous: None }
    }

    /// Adds the next slices. The mask holds the object's part in them and in the slice before.
    pub(crate) fn add(&mut self, mask: &Mask, slices: Range<i64>) {
        let bounds = mask.bounds();
        let box_of_runs = bounds.grown([1, 1, 0]);
        let inside = slices.start.max(bounds.lower[2])..slices.end.min(bounds.upper[2]);
        if self.previous.is_some() && inside.start > slices.start {
            self.end_object();
        }
        for z in inside.clone() {
            self.add_slice(mask, z, &box_of_runs);
            if z % SLICES_REMEMBERED == 0 {
                self.compact();
            }
        }
        if inside.end < slices.end {
            self.end_object();
        }
        self.compact();
    }

    /// Number of components of what was added.
    pub(crate) fn count(&self) -> u64 {
        self.finished + self.sets.count()
    }

    /// After a slice without the object: what was open behind belongs to the outside.
    fn end_object(&mut self) {
        let Some(previous) = self.previous.take() else { return };
        if self.connectivity == Connectivity::Background6 {
            previous.members().for_each(|gap| self.sets.join(gap, OUTSIDE));
        }
    }

    fn add_slice(&mut self, mask: &Mask, z: i64, region: &IndexBox) {
        let foreground = self.connectivity == Connectivity::Foreground26;
        let (x0, x1) = (region.lower[0], region.upper[0]);
        let mut current = SliceOfRuns { first_row: region.lower[1], rows: Vec::new() };
        let previous = self.previous.take();
        for y in region.lower[1]..region.upper[1] {
            let runs = if foreground { mask.runs(y, z).collect() } else { gaps(mask.runs(y, z), x0, x1) };
            let first = self.sets.add(runs.len());
            for &(dy, dz) in self.connectivity.earlier_rows() {
                let slice = if dz < 0 { previous.as_ref() } else { Some(&current) };
                if let Some((other_first, other)) = slice.and_then(|slice| slice.row(y + dy)) {
                    join_touching(
                        &mut self.sets,
                        (first, &runs),
                        (*other_first, other),
                        self.connectivity.slack(),
                    );
                }
            }
            if !foreground {
                // Beyond its box, and beside a slice without the object, there is background.
                let previous_row = previous.as_ref().and_then(|slice| slice.row(y));
                for (number, run) in (first..).zip(&runs) {
                    let beyond = previous_row.is_none_or(|(_, row)| {
                        row.first().is_none_or(|r| run.0 < r.0) || row.last().is_none_or(|r| run.1 > r.1)
                    });
                    if beyond || run.0 == x0 || run.1 == x1 {
                        self.sets.join(number, OUTSIDE);
                    }
                }
            }
            current.rows.push((first, runs));
        }
        self.previous = Some(current);
    }

    /// Forgets the sets that the last slice does not meet.
    fn compact(&mut self) {
        let background = self.connectivity == Connectivity::Background6;
        let mut members: Vec<usize> = if background { vec![OUTSIDE] } else { Vec::new() };
        members.extend(self.previous.iter().flat_map(SliceOfRuns::members));
        self.finished += self.sets.keep(&members);
        let mut next = usize::from(background);
        for (first, runs) in self.previous.iter_mut().flat_map(|slice| &mut slice.rows) {
            *first = next;
            next += runs.len();
        }
    }
}

/// What lies between runs on x0..x1.
pub(super) fn gaps(runs: impl Iterator<Item = Run>, x0: i64, x1: i64) -> Vec<Run> {
    let mut gaps = Vec::new();
    let mut start = x0;
    for (a, b) in runs {
        if start < a {
            gaps.push((start, a));
        }
        start = b;
    }
    if start < x1 {
        gaps.push((start, x1));
    }
    gaps
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
mod tests {
    use super::*;
    use crate::topology::ComponentLabels;
    use crate::volume::Grid;
    use proptest::prelude::*;

    /// Flood fill on a padded array: slow and plain.
    fn flood(n: [usize; 3], on: &[bool], connectivity: Connectivity) -> u64 {
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
                // In parts, each of which holds no more than its slices and the one before.
                for cuts in [[-1, 1, 5], [-1, 2, 5], [-1, 3, 5], [-1, 0, 5]] {
                    let mut counter = ComponentCounter::new(connectivity);
                    for pair in cuts.windows(2) {
                        let part = Mask::from_predicate(grid, |[x, y, z]| {
                            (pair[0] - 1..pair[1]).contains(&(z as i64)) && mask.get([x, y, z].map(|v| v as i64))
                        });
                        counter.add(&part, pair[0]..pair[1]);
                    }
                    prop_assert_eq!(counter.count(), all);
                }
            }
        }
    }
}
