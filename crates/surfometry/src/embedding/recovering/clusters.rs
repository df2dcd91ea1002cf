//! Corrections that depend on each other.

use super::Listed;
use super::pair_kernel::PairKernel;
use super::solver::{self, Cluster};
use super::voxel_list::VoxelList;
use crate::topology::DisjointSets;
use rayon::prelude::*;

/// Voxels whose kernel is below this share of its peak are solved as if they did not see each other: what
/// that leaves, the next round, which evaluates phi with all of the kernel, sees.
const SEEN: f64 = 1e-4;

/// Which listed voxels see each other, and how much.
#[derive(Debug)]
pub(super) struct Clusters {
    /// What a voxel's lambda does to the others' -s phi, by number on the list, ascending: 8 bytes a pair.
    links: Vec<Vec<(u32, f32)>>,
    /// Numbers of each cluster's voxels, ascending; clusters in order of their first.
    members: Vec<Vec<u32>>,
}

impl Clusters {
    pub(super) fn new(list: &VoxelList, directions: &[f64], kernel: &PairKernel) -> Self {
        let (reach, least) = (kernel.reach_above(SEEN), SEEN * kernel.peak());
        let links_of = |number: usize| {
            let mut links = Vec::new();
            list.for_each_within(list.place(number), reach, &list.bounds(), |other, distance| {
                let value = kernel.at(distance);
                if other != number && value.abs() >= least {
                    links.push((other as u32, (directions[number] * directions[other] * value) as f32));
                }
            });
            links
        };
        let links: Vec<Vec<(u32, f32)>> = (0..list.len()).into_par_iter().map(links_of).collect();
        let members = groups(&links);
        Self { links, members }
    }

    pub(super) fn count(&self) -> u64 {
        self.members.len() as u64
    }

    /// Lambdas that give every voxel its `given` back where that is negative, as far as caps allow; it is
    /// what -s phi is above the margin now.
    pub(super) fn solve(&self, listed: &[Listed], given: &[f64], peak: f64) -> Vec<f64> {
        let mut place = vec![0u32; listed.len()];
        for members in &self.members {
            for (n, &member) in (0..).zip(members) {
                place[member as usize] = n;
            }
        }
        let solved: Vec<Vec<f64>> = self
            .members
            .par_iter()
            .map(|members| {
                let of =
                    |values: &dyn Fn(usize) -> f64| members.iter().map(|&m| values(m as usize)).collect();
                let link = |&(other, value): &(u32, f32)| (place[other as usize], value);
                let links = members.iter().map(|&m| self.links[m as usize].iter().map(link).collect());
                let mut cluster = Cluster {
                    links: links.collect(),
                    lambdas: of(&|m| listed[m].lambda),
                    caps: of(&|m| listed[m].cap),
                    excess: of(&|m| given[m]),
                };
                solver::solve(&mut cluster, peak);
                cluster.lambdas
            })
            .collect();
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
fn groups(links: &[Vec<(u32, f32)>]) -> Vec<Vec<u32>> {
    let mut sets = DisjointSets::default();
    sets.add(links.len());
    for (number, links) in links.iter().enumerate() {
        for &(other, _) in links.iter().filter(|link| (link.0 as usize) < number) {
            sets.join(number, other as usize);
        }
    }
    // The member that stands for a set is its first.
    let mut group_of = vec![0; links.len()];
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for number in 0..links.len() {
        let root = sets.root(number);
        if root == number {
            group_of[number] = groups.len();
            groups.push(Vec::new());
        }
        groups[group_of[root]].push(number as u32);
    }
    groups
}
