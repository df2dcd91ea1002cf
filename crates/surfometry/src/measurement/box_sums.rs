//! What one box of an image adds to the measurement of each object.

use super::blur_bound::BlurBound;
use super::evaluation::Totals;
use super::pass::{ObjectSums, Pass};
use super::scheme::Scheme;
use super::setup::Setup;
use super::voxels::VoxelCounts;
use crate::tiling::{Cover, IndexBox, Joint};
use crate::topology::BoxTopology;
use crate::volume::{Grid, LabelRuns, LabelSelection};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// What is known of an object in some boxes. Equal parts may have taken different times.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct ObjectPart {
    sums: ObjectSums,
    topology: BoxTopology,
    voxels: VoxelCounts,
    /// Time until the integrals were known.
    integrated: Duration,
    topology_time: Duration,
}

impl PartialEq for ObjectPart {
    fn eq(&self, other: &Self) -> bool {
        (&self.sums, &self.topology, &self.voxels) == (&other.sums, &other.topology, &other.voxels)
    }
}

impl ObjectPart {
    /// Adds what is known in other boxes.
    pub(super) fn merge(&mut self, other: Self, image: &IndexBox, joint: &Joint) {
        self.sums = std::mem::take(&mut self.sums).merged(&other.sums);
        self.topology.merge(other.topology, image, joint);
        self.voxels.merge(&other.voxels);
        self.integrated = self.integrated.saturating_add(other.integrated);
        self.topology_time = self.topology_time.saturating_add(other.topology_time);
    }

    /// Adds boxes in which the object does not occur.
    pub(super) fn merge_nothing(&mut self, image: &IndexBox, joint: &Joint) {
        if self.topology.meets(joint) {
            self.topology.merge(BoxTopology::default(), image, joint);
        }
    }

    /// Of an object of which all boxes are known.
    pub(super) fn totals(&self, cover: &Cover) -> Totals {
        Totals {
            sums: self.sums.clone(),
            topology: self.topology.topology(cover),
            voxels: self.voxels,
            integrated: self.integrated,
            topology_time: self.topology_time,
            ..Totals::default()
        }
    }

    /// Whether a part that was read can be one of an image.
    pub(super) fn is_valid(&self, grid: &Grid, cover: &Cover) -> bool {
        self.voxels.are_valid(grid) && self.topology.is_valid(cover)
    }
}

/// The labels that are known in and around a box.
pub(super) struct Labels<'a> {
    runs: &'a LabelRuns,
    /// Label, its code in the runs, and the box around its voxels, in ascending order.
    coded: Vec<(i64, usize, IndexBox)>,
}

/// Labels that are measured as one object.
struct Group {
    key: Vec<i64>,
    codes: Vec<usize>,
    bounds: IndexBox,
}

impl<'a> Labels<'a> {
    pub(super) fn new(runs: &'a LabelRuns, mut coded: Vec<(i64, usize, IndexBox)>) -> Self {
        coded.retain(|(_, _, bounds)| !bounds.is_empty());
        coded.sort_unstable_by_key(|(label, ..)| *label);
        Self { runs, coded }
    }

    /// The labels.
    pub(super) fn present(&self) -> impl Iterator<Item = i64> {
        self.coded.iter().map(|(label, ..)| *label)
    }

    fn groups(&self, selection: &LabelSelection) -> Vec<Group> {
        let of = |labels: &[i64]| {
            let known = |label: &i64| {
                self.coded.binary_search_by_key(label, |(label, ..)| *label).ok().map(|n| &self.coded[n])
            };
            let members: Vec<_> = labels.iter().filter_map(known).collect();
            let mut codes: Vec<usize> = members.iter().map(|(_, code, _)| *code).collect();
            codes.sort_unstable();
            let bounds = members.iter().fold(IndexBox::EMPTY, |all, (.., bounds)| all.hull(bounds));
            Group { key: labels.to_vec(), codes, bounds }
        };
        match selection {
            LabelSelection::All => self.present().map(|label| of(&[label])).collect(),
            LabelSelection::Groups(groups) => groups.iter().map(|group| of(group.labels())).collect(),
        }
    }

    /// What a box adds to each of the selected objects, by the labels of its group; `reach` is how far around
    /// the box they are known.
    pub(super) fn sums(
        &self,
        setup: &Setup,
        region: &IndexBox,
        reach: [i64; 3],
        selection: &LabelSelection,
    ) -> BTreeMap<Vec<i64>, Box<ObjectPart>> {
        let known = region.grown(reach);
        let mut groups = self.groups(selection);
        for group in &mut groups {
            group.bounds = group.bounds.intersection(&known);
        }
        groups.retain(|group| !group.bounds.is_empty());
        let bound = BlurBound::of(setup);
        let part = |group: Group| {
            let part = self.part(setup, bound.as_ref(), &group, region);
            (part != ObjectPart::default()).then(|| (group.key, Box::new(part)))
        };
        let parts: Vec<_> = groups.into_par_iter().filter_map(part).collect();
        parts.into_iter().collect()
    }

    fn part(&self, setup: &Setup, bound: Option<&BlurBound>, group: &Group, region: &IndexBox) -> ObjectPart {
        let start = Instant::now();
        let mask = self.runs.mask(&group.codes, group.bounds);
        let image = setup.grid.index_box();
        // What is in reach of the box decides; so a small object costs nothing, however far a blur spreads
        // it.
        let tiles = tiles_of(region, &image);
        let watch = setup.watch(&mask, tiles);
        let sums = if bound.is_some_and(|bound| bound.has_no_band(&mask)) {
            let detail = watch.map(|watch| watch.outside(&IndexBox::EMPTY)).unwrap_or_default();
            ObjectSums { detail, ..ObjectSums::default() }
        } else {
            let cells = bound.and_then(|bound| bound.cells_of_band(&mask));
            let pass = Pass { tiles: Some(tiles), region: cells, watch, ..setup.pass(true) };
            Scheme::of_part(setup, &mask).sums(&pass)
        };
        let integrated = sums.times.share_of_integrals(start.elapsed());
        let start = Instant::now();
        let topology = BoxTopology::of(&mask, &image, region);
        let voxels = VoxelCounts::of(&mask, region);
        ObjectPart { sums, topology, voxels, integrated, topology_time: start.elapsed() }
    }
}

/// Where the tiles begin that belong to a box: where the image ends with the box, those beyond are its own.
fn tiles_of(region: &IndexBox, image: &IndexBox) -> IndexBox {
    let mut tiles = *region;
    for axis in 0..3 {
        if region.lower[axis] == image.lower[axis] {
            tiles.lower[axis] = i64::MIN;
        }
        if region.upper[axis] == image.upper[axis] {
            tiles.upper[axis] = i64::MAX;
        }
    }
    tiles
}
