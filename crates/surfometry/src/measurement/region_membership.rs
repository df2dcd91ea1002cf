//! Which region the surface of an object belongs to, place by place.

use super::object::Object;
use super::regions::Regions;
use crate::volume::{Affine, Mask};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Sigmas beside the band within which an object's voxels are looked for: a blur moves the surface of thin parts that far.
const SIGMAS: f64 = 2.0;

/// The regions of an object's voxels, and of what lies around them.
///
/// Half of a band lies outside the object, where regions that were painted into it have no label, and those of its neighbours
/// have theirs. So a place outside has its own region where that is one of the object's, and else that of the object's nearest
/// voxel.
pub struct RegionMembership<'a> {
    regions: &'a Regions,
    mask: &'a Mask,
    to_world: Affine,
    to_index: Option<Affine>,
    /// Of the object's voxels; without 0.
    present: BTreeSet<i64>,
    /// Steps to other voxels, the nearest first.
    steps: Vec<[i64; 3]>,
}

impl Object {
    /// Where its surface and voxels belong.
    pub fn membership<'a>(&'a self, regions: &'a Regions) -> RegionMembership<'a> {
        let parameters = &self.setup.parameters;
        let reach = 0.5 * parameters.thickness_mm + SIGMAS * parameters.sigma_mm.unwrap_or_default();
        let to_world = *self.grid().affine();
        let mut membership = RegionMembership {
            regions,
            mask: self.mask(),
            to_world,
            to_index: to_world.inverted(),
            present: BTreeSet::new(),
            steps: steps_within(reach, self.grid().spacing().mm()),
        };
        membership.present = membership.of_all_voxels();
        membership
    }
}

impl RegionMembership<'_> {
    /// The region of a voxel, inside the object or near it.
    pub fn of_voxel(&self, index: [i64; 3]) -> i64 {
        let own = self.own(index);
        if self.mask.get(index) { own } else { self.outside(index, own) }
    }

    /// The region of a point of the surface, mm.
    pub fn of_point(&self, world: [f64; 3]) -> i64 {
        let own = self.regions.at(world);
        let index = self.to_index.map(|to_index| to_index.apply(world).map(|v| libm::floor(v + 0.5) as i64));
        index.map_or(own, |index| self.outside(index, own))
    }

    fn outside(&self, index: [i64; 3], own: i64) -> i64 {
        if self.present.contains(&own) {
            return own;
        }
        let stepped = |step: &[i64; 3]| std::array::from_fn(|a| index[a] + step[a]);
        let nearest = self.steps.iter().map(stepped).find(|&there| self.mask.get(there));
        nearest.map_or(own, |there| self.own(there))
    }

    fn own(&self, index: [i64; 3]) -> i64 {
        self.regions.at(self.to_world.apply(index.map(|v| v as f64)))
    }

    fn of_all_voxels(&self) -> BTreeSet<i64> {
        let bounds = self.mask.bounds();
        let in_slice = |z: i64| {
            let in_row = |y: i64| self.mask.runs_within(y, z, (bounds.lower[0], bounds.upper[0]));
            let rows = (bounds.lower[1]..bounds.upper[1]).map(|y| (y, in_row(y)));
            let voxels =
                rows.flat_map(|(y, runs)| runs.flat_map(move |(a, b)| (a..b).map(move |x| [x, y, z])));
            voxels.map(|index| self.own(index)).filter(|&region| region != 0).collect::<BTreeSet<i64>>()
        };
        let slices = (bounds.lower[2]..bounds.upper[2]).into_par_iter().map(in_slice);
        slices.reduce(BTreeSet::new, |a, b| &a | &b)
    }
}

/// All steps up to a length, by length.
fn steps_within(reach: f64, spacing: [f64; 3]) -> Vec<[i64; 3]> {
    let most = spacing.map(|h| libm::ceil(reach / h) as i64);
    let axis = |a: usize| -most[a]..=most[a];
    let all = axis(2).flat_map(|z| axis(1).flat_map(move |y| axis(0).map(move |x| [x, y, z])));
    let length = |step: &[i64; 3]| (0..3).map(|a| (step[a] as f64 * spacing[a]).powi(2)).sum::<f64>();
    let mut steps: Vec<[i64; 3]> = all.filter(|step| length(step) <= reach * reach).collect();
    steps.sort_by(|a, b| length(a).total_cmp(&length(b)).then(a.cmp(b)));
    steps
}
