//! From one object towards another, as far as topology stays.

use super::bricks::{Bricks, FETCHED, Set};
use super::simple_voxel::is_simple;
use crate::tiling::WorkTime;
use crate::volume::{Mask, Place};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// An object on its way to another.
pub(super) struct Thinned {
    /// The object after all changes that are of no consequence; its bounds leave a voxel on all sides of both
    /// objects.
    pub(super) state: Mask,
    /// The voxels that still differ.
    pub(super) rest: Mask,
}

/// A voxel in the order of work: the lowest rank comes first, and of equal ranks the first along z, y, x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Waiting {
    rank: u32,
    place: Place,
}

impl Waiting {
    fn new(rank: f32, place: Place) -> Self {
        // Whole numbers in the order of the ranks.
        let bits = rank.to_bits();
        Self { rank: if rank.is_sign_negative() { !bits } else { bits | 1 << 31 }, place }
    }
}

/// Voxels in which the objects differ are changed where that is of no consequence (simple points), one after
/// the other, those of low `rank` first; one that was of consequence is looked at again when a neighbour has
/// changed.
pub(super) fn thinned(
    before: &Mask,
    after: &Mask,
    rank: &(impl Fn([i64; 3]) -> f32 + Sync),
    time: &WorkTime,
) -> Thinned {
    let region = before.bounds().hull(&after.bounds()).grown([1; 3]);
    let before = time.of(|| before.on_bounds(region));
    let order = in_order(&before, &time.of(|| after.on_bounds(region)), rank, time);
    time.of(|| {
        let mut bricks = Bricks::of(&before);
        // Only those come back that had their turn, so all of them come before the next in order.
        let mut again = BinaryHeap::new();
        for part in order.chunks(FETCHED) {
            bricks.fetch(part.iter().map(|waiting| waiting.place));
            for first in part {
                let mut next = Some(*first);
                while let Some(Waiting { place, .. }) = next {
                    if is_simple(bricks.around(Set::Object, place)) {
                        bricks.toggle(Set::Object, place);
                        for neighbour in before.places_among(place, bricks.around(Set::Rest, place)) {
                            bricks.toggle(Set::Rest, neighbour);
                            again.push(Reverse(Waiting::new(rank(before.voxel_at(neighbour)), neighbour)));
                        }
                    } else {
                        bricks.toggle(Set::Rest, place);
                    }
                    next = again.pop().map(|Reverse(waiting)| waiting);
                }
            }
        }
        Thinned { state: bricks.mask(Set::Object, &before), rest: bricks.mask(Set::Rest, &before) }
    })
}

/// The voxels in which two masks with the same bounds differ, in the order of work.
fn in_order(
    before: &Mask,
    after: &Mask,
    rank: &(impl Fn([i64; 3]) -> f32 + Sync),
    time: &WorkTime,
) -> Vec<Waiting> {
    let waiting = |place| Waiting::new(rank(before.voxel_at(place)), place);
    let mut order: Vec<Waiting> = time.of(|| before.differences(after).map(waiting).collect());
    time.of(|| order.sort_unstable());
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::Connectivity;
    use crate::volume::Grid;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    const N: [usize; 3] = [66, 4, 4];

    fn mask(on: &[bool]) -> Mask {
        let grid = Grid::axis_aligned(N, [1.0; 3]).unwrap();
        Mask::from_predicate(grid, |[x, y, z]| on[(z * N[1] + y) * N[0] + x])
    }

    /// The same by looking for the lowest rank of all that wait, voxel by voxel.
    fn plainly_thinned(before: &Mask, after: &Mask, rank: impl Fn([i64; 3]) -> f32) -> (Mask, Vec<[i64; 3]>) {
        let region = before.bounds().hull(&after.bounds()).grown([1; 3]);
        let (mut state, target) = (before.on_bounds(region), after.on_bounds(region));
        // Ranks here are whole numbers.
        let waiting = |[x, y, z]: [i64; 3]| (rank([x, y, z]) as i64, [z, y, x]);
        let voxels: Vec<_> = state.differences(&target).map(|place| state.voxel_at(place)).collect();
        let mut queue: BTreeSet<_> = voxels.iter().map(|&voxel| waiting(voxel)).collect();
        while let Some((_, [z, y, x])) = queue.pop_first() {
            let at = |bit: i64| [x + bit % 3 - 1, y + bit / 3 % 3 - 1, z + bit / 9 - 1];
            let around = (0..27).fold(0, |bits, bit| bits | u32::from(state.get(at(bit))) << bit);
            if is_simple(around) {
                state.set([x, y, z], !state.get([x, y, z]));
                let neighbours = Connectivity::Foreground26.neighbours([x, y, z]);
                queue.extend(neighbours.filter(|&v| state.get(v) != target.get(v)).map(waiting));
            }
        }
        let rest = voxels.into_iter().filter(|&voxel| state.get(voxel) != target.get(voxel)).collect();
        (state, rest)
    }

    proptest! {
        #[test]
        fn agrees_with_the_plain_way(
            a in prop::collection::vec(prop::bool::weighted(0.5), 66 * 4 * 4),
            b in prop::collection::vec(prop::bool::weighted(0.5), 66 * 4 * 4),
            ranks in prop::collection::vec(-9..9i32, 66 * 4 * 4),
        ) {
            let (before, after) = (mask(&a), mask(&b));
            prop_assume!(!before.is_empty() && !after.is_empty());
            let rank = |[x, y, z]: [i64; 3]| ranks[((z as usize) * N[1] + y as usize) * N[0] + x as usize] as f32;
            let thinned = thinned(&before, &after, &rank, &WorkTime::default());
            let (state, rest) = plainly_thinned(&before, &after, rank);
            prop_assert_eq!(thinned.rest.places().map(|p| state.voxel_at(p)).collect::<Vec<_>>(), rest);
            prop_assert_eq!(thinned.state, state);
        }
    }
}
