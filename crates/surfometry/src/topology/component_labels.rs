//! Which component a voxel belongs to.

use super::components::{Connectivity, Run, gaps, join_touching};
use crate::tiling::DisjointSets;
use crate::tiling::IndexBox;
use crate::volume::Mask;
use std::collections::HashMap;

/// The connected components of an object, or of the background around and within it. Memory is proportional
/// to the number of runs, not of voxels.
#[derive(Debug, Clone)]
pub struct ComponentLabels {
    connectivity: Connectivity,
    region: IndexBox,
    runs: Vec<Run>,
    /// By row of the region, one past its last run.
    ends: Vec<usize>,
    /// A member a run, and one more for each voxel that was added later.
    sets: DisjointSets,
}

impl ComponentLabels {
    /// Labels the components of a mask. Everything beyond its bounding box is one of the background's.
    pub fn of(mask: &Mask, connectivity: Connectivity) -> Self {
        // A rim of background joins what reaches it.
        let region = match connectivity {
            Connectivity::Foreground26 => mask.bounds(),
            Connectivity::Background6 => mask.bounds().grown([1; 3]),
        };
        Self::in_box(mask, connectivity, region)
    }

    /// Labels what lies in a box, as if nothing were beyond it.
    pub(super) fn in_box(mask: &Mask, connectivity: Connectivity, region: IndexBox) -> Self {
        let (x0, x1) = (region.lower[0], region.upper[0]);
        let mut labels =
            Self { connectivity, region, runs: Vec::new(), ends: Vec::new(), sets: DisjointSets::default() };
        for (y, z) in region.rows() {
            let first = labels.runs.len();
            let inside = mask.runs_within(y, z, (x0, x1));
            match connectivity {
                Connectivity::Foreground26 => labels.runs.extend(inside),
                Connectivity::Background6 => labels.runs.extend(gaps(inside, x0, x1)),
            }
            labels.sets.add(labels.runs.len() - first);
            labels.ends.push(labels.runs.len());
            for (dy, dz) in connectivity.earlier_rows() {
                let (here, there) = (labels.row(y, z), labels.row(y + dy, z + dz));
                let runs = |row: &std::ops::Range<usize>| &labels.runs[row.clone()];
                let (here, there) = ((here.start, runs(&here)), (there.start, runs(&there)));
                join_touching(&mut labels.sets, here, there, connectivity.slack());
            }
        }
        labels
    }

    /// Number of components.
    pub fn count(&self) -> u64 {
        self.sets.count()
    }

    /// The components of an object as objects, the largest first; of equal ones, the one that begins first.
    pub fn masks(&mut self, mask: &Mask) -> Vec<Mask> {
        let mut boxes: HashMap<usize, (usize, u64, IndexBox)> = HashMap::new();
        let rows: Vec<(i64, i64)> = self.region.rows().collect();
        for &(y, z) in &rows {
            for number in self.row(y, z) {
                let (a, b) = self.runs[number];
                let root = self.sets.root(number);
                let (_, voxels, all) = boxes.entry(root).or_insert((number, 0, IndexBox::EMPTY));
                *voxels += (b - a) as u64;
                *all = all.hull(&IndexBox::new([a, y, z], [b, y + 1, z + 1]));
            }
        }
        let mut components: Vec<_> = boxes.into_iter().collect();
        components.sort_by_key(|(_, (first, voxels, _))| (std::cmp::Reverse(*voxels), *first));
        let mut component = |(root, (_, _, all)): (usize, (usize, u64, IndexBox))| {
            let mut part = Mask::cleared(*mask.grid(), all);
            for (y, z) in all.rows() {
                for number in self.row(y, z) {
                    if self.sets.root(number) == root {
                        part.set_run(self.runs[number], y, z);
                    }
                }
            }
            part
        };
        components.into_iter().map(&mut component).collect()
    }

    /// Adds voxels of the mask's bounds that were not labelled, to which none that was added before is a
    /// neighbour; by how much the number of components grows.
    pub(super) fn grow(&mut self, voxels: &mut [[i64; 3]]) -> i64 {
        let first = self.sets.add(voxels.len());
        voxels.sort_unstable();
        for (voxel, number) in voxels.iter().zip(first..) {
            let earlier = self.connectivity.neighbours(*voxel).filter(|neighbour| neighbour < voxel);
            for other in earlier.filter_map(|neighbour| voxels.binary_search(&neighbour).ok()) {
                self.sets.join(number, first + other);
            }
        }
        let mut touching = Vec::new();
        for (&voxel, number) in voxels.iter().zip(first..) {
            self.for_each_beside(voxel, |member| touching.push((number, member)));
        }
        let touched = self.distinct(touching.iter().map(|&(_, member)| member));
        for (number, member) in touching {
            self.sets.join(number, member);
        }
        self.distinct(first..first + voxels.len()) - touched
    }

    /// How many sets some members belong to.
    fn distinct(&mut self, members: impl Iterator<Item = usize>) -> i64 {
        let mut roots: Vec<usize> = members.map(|member| self.sets.root(member)).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len() as i64
    }

    /// Visits the labelled runs that a voxel touches.
    fn for_each_beside(&self, [x, y, z]: [i64; 3], mut visit: impl FnMut(usize)) {
        let all = self.connectivity == Connectivity::Foreground26;
        for (dy, dz) in (-1..=1).flat_map(|dz| (-1..=1).map(move |dy| (dy, dz))) {
            if !all && dy * dz != 0 {
                continue;
            }
            let along = i64::from(all || (dy, dz) == (0, 0));
            let row = self.row(y + dy, z + dz);
            let runs = &self.runs[row.clone()];
            let mut place = runs.partition_point(|run| run.1 <= x - along);
            while place < runs.len() && runs[place].0 <= x + along {
                visit(row.start + place);
                place += 1;
            }
        }
    }

    /// The runs of a row that was labelled, and the first one's number among the members of the sets.
    pub(super) fn row_runs(&self, y: i64, z: i64) -> (usize, &[Run]) {
        let row = self.row(y, z);
        (row.start, &self.runs[row])
    }

    /// What is connected with what, each run a member.
    pub(super) fn into_sets(self) -> DisjointSets {
        self.sets
    }

    /// The runs of a row that was labelled; none elsewhere.
    fn row(&self, y: i64, z: i64) -> std::ops::Range<usize> {
        let [_, y0, z0] = self.region.lower;
        let [_, y1, _] = self.region.upper;
        if y < y0 || y >= y1 || z < z0 {
            return 0..0;
        }
        let number = ((z - z0) * (y1 - y0) + (y - y0)) as usize;
        let end = self.ends.get(number).copied().unwrap_or_default();
        number.checked_sub(1).map_or(0, |before| self.ends.get(before).copied().unwrap_or(end))..end
    }
}

/// Parts of objects, for inputs that are prepared.
#[cfg(feature = "io")]
impl ComponentLabels {
    /// The rows and runs of all components but the largest; of equal ones, but the one that begins first.
    pub(crate) fn beside_largest(&mut self) -> Vec<((i64, i64), Run)> {
        let sizes = self.sizes();
        // A component's root is its first run; of equal maxima the last would win.
        let largest = sizes.iter().max_by_key(|(root, voxels)| (**voxels, std::cmp::Reverse(**root)));
        let largest = largest.map(|(root, _)| *root);
        let dropped = self.placed_runs().into_iter().filter(|(root, ..)| Some(*root) != largest);
        dropped.map(|(_, row, run)| (row, run)).collect()
    }

    /// The rows and runs of all components of the background but the outer one, each with its component's number of voxels.
    pub(crate) fn enclosed(&mut self) -> Vec<(u64, (i64, i64), Run)> {
        let sizes = self.sizes();
        // The rim begins with it.
        let outside = self.sets.root(0);
        let enclosed = self.placed_runs().into_iter().filter(|(root, ..)| *root != outside);
        enclosed.map(|(root, row, run)| (sizes[&root], row, run)).collect()
    }

    /// Voxels of each component, by its root.
    fn sizes(&mut self) -> HashMap<usize, u64> {
        let mut sizes = HashMap::new();
        for (number, &(a, b)) in self.runs.iter().enumerate() {
            *sizes.entry(self.sets.root(number)).or_default() += (b - a) as u64;
        }
        sizes
    }

    /// Root, row and extent of each run.
    fn placed_runs(&mut self) -> Vec<(usize, (i64, i64), Run)> {
        let mut placed = Vec::with_capacity(self.runs.len());
        for (row, &end) in self.region.rows().zip(&self.ends) {
            for number in placed.len()..end {
                placed.push((self.sets.root(number), row, self.runs[number]));
            }
        }
        placed
    }
}
