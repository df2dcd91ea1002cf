//! Pairs of voxels of different labels, counted.

use super::PairWeights;
use crate::tiling::{Block, IndexBox};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// Edge of the boxes in which pairs are counted, voxels.
const EDGE: i64 = 32;

/// What was counted of two labels.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contact {
    /// Pairs of voxels that cross their interface, by orbit of the displacement.
    pub(crate) pairs: Vec<u64>,
    /// How many more there were if pairs with a third label between them counted for what lies on their way: at rims they do
    /// not, in thin layers they should.
    pub(crate) by_way: Vec<i64>,
    /// Cells of 2 x 2 x 2 voxels in which a third label meets both.
    pub(crate) rim: u64,
    /// The boxes in which voxels of both share a face, each with the one around all such faces in and beside it.
    pub(crate) boxes: Vec<[IndexBox; 2]>,
}

impl Contact {
    fn new(orbits: usize) -> Self {
        Self { pairs: vec![0; orbits], by_way: vec![0; orbits], rim: 0, boxes: Vec::new() }
    }

    fn add(&mut self, other: Self) {
        self.pairs.iter_mut().zip(other.pairs).for_each(|(sum, count)| *sum += count);
        self.by_way.iter_mut().zip(other.by_way).for_each(|(sum, count)| *sum += count);
        self.rim += other.rim;
        self.boxes.extend(other.boxes);
    }
}

/// What was counted of any two labels, the lower first.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Contacts(pub(crate) BTreeMap<[u32; 2], Contact>);

impl Contacts {
    /// Counts over a box; `labels_of` gives the labels of any box. The same numbers for any number of threads.
    pub(crate) fn count(
        region: &IndexBox,
        weights: &PairWeights,
        labels_of: &(dyn Fn(&IndexBox) -> Block<u32> + Sync),
    ) -> Self {
        let tiles = region.grown(weights.reach()).tiles([EDGE; 3]);
        let of_tile = |tile: &IndexBox| {
            let labels = labels_of(&tile.grown(weights.reach()));
            Self::of_tile(tile, &labels, weights)
        };
        tiles.par_iter().map(of_tile).reduce(Self::default, Self::merged)
    }

    fn merged(mut self, other: Self) -> Self {
        for (key, more) in other.0 {
            self.of(key, more.pairs.len()).add(more);
        }
        self
    }

    fn of(&mut self, key: [u32; 2], orbits: usize) -> &mut Contact {
        self.0.entry(key).or_insert_with(|| Contact::new(orbits))
    }

    fn of_tile(tile: &IndexBox, labels: &Block<u32>, weights: &PairWeights) -> Self {
        let mut found = Self::default();
        let first = labels.values()[0];
        if labels.values().iter().all(|&label| label == first) {
            return found;
        }
        let touching = touching(labels);
        let origin = labels.offset(tile.lower) as i64;
        let offset = |d: [i64; 3]| {
            let to = std::array::from_fn(|a| tile.lower[a] + d[a]);
            labels.offset(to) as i64 - origin
        };
        for (displacement, orbit) in weights.displacements() {
            let path: Vec<i64> = between(*displacement).map(offset).collect();
            for (y, z) in tile.rows() {
                let start = labels.offset([tile.lower[0], y, z]);
                let of_orbit = (*orbit, weights.orbits());
                found.count_row(labels.values(), start..start + tile.extent()[0], &path, &touching, of_orbit);
            }
        }
        found.count_rims(tile, labels, weights.orbits());
        for (key, contact) in &mut found.0 {
            if weights.faces(&contact.pairs).iter().any(|&area| area > 0.0) {
                contact.boxes.extend(touching.get(key).map(|faces| [*tile, *faces]));
            }
        }
        found
    }

    /// Counts the pairs that start in a row; `path` leads from the one voxel to the other.
    ///
    /// A pair counts for its own two labels where these touch around here: what it counts too often or too seldom at rims
    /// then goes with the square of its length, and cancels. Where they do not, as on both sides of a layer, it counts for
    /// what lies on its way.
    fn count_row(
        &mut self,
        labels: &[u32],
        row: Range<usize>,
        path: &[i64],
        touching: &BTreeMap<[u32; 2], IndexBox>,
        (orbit, orbits): (usize, usize),
    ) {
        let end = path[path.len() - 1];
        let there = (row.start as i64 + end) as usize;
        if labels[row.clone()] == labels[there..][..row.len()] {
            return;
        }
        for place in row {
            let on_the_way = |step: i64| labels[(place as i64 + step) as usize];
            let (from, to) = (labels[place], on_the_way(end));
            if from == to {
                continue;
            }
            let crossed = crossings(from, path.iter().map(|&step| on_the_way(step)));
            if !touching.contains_key(&pair(from, to)) {
                crossed.for_each(|key| self.of(key, orbits).pairs[orbit] += 1);
                continue;
            }
            let own = self.of(pair(from, to), orbits);
            own.pairs[orbit] += 1;
            if path.iter().all(|&step| [from, to].contains(&on_the_way(step))) {
                continue;
            }
            own.by_way[orbit] -= 1;
            crossed.for_each(|key| self.of(key, orbits).by_way[orbit] += 1);
        }
    }

    fn count_rims(&mut self, tile: &IndexBox, labels: &Block<u32>, orbits: usize) {
        let [nx, ny, _] = labels.region().extent();
        let corners = [0, 1, nx, nx + 1].map(|n| [n, n + nx * ny]).concat();
        for (y, z) in tile.rows() {
            let start = labels.offset([tile.lower[0], y, z]);
            for place in start..start + tile.extent()[0] {
                let mut seen: Vec<u32> = Vec::new();
                for corner in &corners {
                    let label = labels.values()[place + corner];
                    if !seen.contains(&label) {
                        seen.push(label);
                    }
                }
                if seen.len() < 3 {
                    continue;
                }
                for (n, &a) in seen.iter().enumerate() {
                    for &b in &seen[n + 1..] {
                        self.of(pair(a, b), orbits).rim += 1;
                    }
                }
            }
        }
    }
}

/// The labels of which voxels share a face, and the box around all such voxels.
fn touching(labels: &Block<u32>) -> BTreeMap<[u32; 2], IndexBox> {
    let [nx, ny, _] = labels.region().extent();
    let (values, region) = (labels.values(), labels.region());
    let mut found = BTreeMap::<[u32; 2], IndexBox>::new();
    for (y, z) in region.rows() {
        let start = labels.offset([region.lower[0], y, z]);
        let [more_y, more_z] = [y + 1 < region.upper[1], z + 1 < region.upper[2]];
        for x in 0..nx {
            let next = [(x + 1 < nx, 1), (more_y, nx), (more_z, nx * ny)];
            for (axis, (_, step)) in next.into_iter().enumerate().filter(|(_, (is_there, _))| *is_there) {
                let key = pair(values[start + x], values[start + x + step]);
                if key[0] != key[1] {
                    let lower = [region.lower[0] + x as i64, y, z];
                    let mut upper = lower.map(|v| v + 1);
                    upper[axis] += 1;
                    let all = found.entry(key).or_insert(IndexBox::EMPTY);
                    *all = all.hull(&IndexBox::new(lower, upper));
                }
            }
        }
    }
    found
}

/// What a way crosses for good: it without its loops.
fn crossings(
    from: u32,
    way: impl DoubleEndedIterator<Item = u32> + ExactSizeIterator + Clone,
) -> impl Iterator<Item = [u32; 2]> {
    let (mut label, mut next) = (from, 0);
    std::iter::from_fn(move || {
        let last = way.clone().skip(next).rposition(|on_the_way| on_the_way == label);
        next += last.map_or(0, |n| n + 1);
        let entered = way.clone().nth(next)?;
        let crossed = pair(label, entered);
        label = entered;
        Some(crossed)
    })
}

fn pair(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The voxels on the way along a displacement, its end included, its beginning not.
fn between(displacement: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let steps = displacement.iter().map(|v| v.abs()).max().unwrap_or(1);
    let part = move |v: i64, k: i64| (2 * v * k + steps).div_euclid(2 * steps);
    (1..=steps).map(move |k| displacement.map(|v| part(v, k)))
}
