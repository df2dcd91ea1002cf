//! Corrections that depend on each other.

use super::Listed;
use super::links::Links;
use super::pair_kernel::PairKernel;
use super::solver::{self, Cluster};
use super::voxel_list::VoxelList;
use crate::tiling::DisjointSets;
use rayon::prelude::*;

/// Voxels whose kernel is below this share of its peak are solved as if they did not see each other: what
/// that leaves, the next round, which evaluates phi with all of the kernel, sees.
const SEEN: f64 = 1e-4;

/// Which listed voxels see each other, and how much.
#[derive(Debug)]
pub(super) struct Clusters {
    /// What a voxel's lambda does to the others' -s phi, by number on the list.
    links: Links,
    /// Numbers of each cluster's voxels, ascending; clusters in order of their first.
    members: Vec<Vec<u32>>,
}

/// One voxel of so many tells how many pairs there are.
const LOOKED_AT: usize = 64;

/// Voxels that are listed together: each thread lists some hundred before it needs memory again.
const AT_A_TIME: usize = 512;

impl Clusters {
    pub(super) fn new(list: &VoxelList, directions: &[f64], kernel: &PairKernel) -> Self {
        let (reach, least) = (kernel.reach_above(SEEN), SEEN * kernel.peak());
        let add_links = |links: &mut Links, number: usize| {
            links.begin();
            list.for_each_within(list.place(number), reach, |other, distance| {
                let value = kernel.at(distance);
                if other != number && value.abs() >= least {
                    links.push(other as u32, (directions[number] * directions[other] * value) as f32);
                }
            });
        };
        let of_some = |first: usize| {
            let mut links = Links::default();
            (first..list.len().min(first + AT_A_TIME)).for_each(|number| add_links(&mut links, number));
            links
        };
        let parts: Vec<Links> = (0..list.len()).into_par_iter().step_by(AT_A_TIME).map(of_some).collect();
        let links = Links::joined(parts);
        let members = groups(&links, list.len());
        Self { links, members }
    }

    /// How many pairs of a list see each other, about: one voxel of some dozens is looked at.
    pub(super) fn pairs(list: &VoxelList, kernel: &PairKernel) -> usize {
        let (reach, least) = (kernel.reach_above(SEEN), SEEN * kernel.peak());
        let seen_from = |number: usize| {
            let mut seen = 0;
            list.for_each_within(list.place(number), reach, |_, distance| {
                seen += usize::from(kernel.at(distance).abs() >= least);
            });
            seen
        };
        (0..list.len()).into_par_iter().step_by(LOOKED_AT).map(seen_from).sum::<usize>() * LOOKED_AT
    }

    pub(super) fn count(&self) -> u64 {
        self.members.len() as u64
    }

    /// Lambdas that give every voxel its `given` back where that is negative, as far as caps allow; it is
    /// what -s phi is above the margin now.
    pub(super) fn solve(self, listed: &[Listed], given: &[f64], peak: f64) -> Vec<f64> {
        let cluster_of = |links: Links, members: &[u32]| {
            let of = |values: &dyn Fn(usize) -> f64| members.iter().map(|&m| values(m as usize)).collect();
            Cluster {
                links,
                lambdas: of(&|m| listed[m].lambda),
                caps: of(&|m| listed[m].cap),
                excess: of(&|m| given[m]),
            }
        };
        // Most of what there are many of hang together: they are not copied.
        if let [all] = self.members.as_slice() {
            return solver::solve(cluster_of(self.links, all), peak);
        }
        let mut place = vec![0u32; listed.len()];
        for members in &self.members {
            for (n, &member) in (0..).zip(members) {
                place[member as usize] = n;
            }
        }
        let solved = self
            .members
            .par_iter()
            .map(|members| solver::solve(cluster_of(self.links.of_members(members, &place), members), peak));
        let solved: Vec<Vec<f64>> = solved.collect();
        let mut lambdas = vec![0.0; listed.len()];
        for (members, values) in self.members.iter().zip(solved) {
            for (&member, value) in members.iter().zip(values) {
                lambdas[member as usize] = value;
            }
        }
        lambdas
    }
}

/// The connected groups of a list.
fn groups(links: &Links, count: usize) -> Vec<Vec<u32>> {
    let mut sets = DisjointSets::default();
    sets.add(count);
    for number in 0..count {
        for &(other, _) in links.of(number).iter().filter(|link| (link.0 as usize) < number) {
            sets.join(number, other as usize);
        }
    }
    // The member that stands for a set is its first.
    let mut group_of = vec![0; count];
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for number in 0..count {
        let root = sets.root(number);
        if root == number {
            group_of[number] = groups.len();
            groups.push(Vec::new());
        }
        groups[group_of[root]].push(number as u32);
    }
    groups
}
