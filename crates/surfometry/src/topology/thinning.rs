//! From one object towards another, as far as topology stays.

use super::bricks::{Bricks, Set};
use super::simple_voxel::is_simple;
use crate::tiling::WorkTime;
use crate::volume::{Mask, Place};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// An object on its way to another.
pub(super) struct Thinned {
    /// The object after all changes that are of no consequence; its bounds leave a voxel on all sides of both objects.
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

/// Voxels in which the objects differ are changed where that is of no consequence (simple points), one after the other, those of low
/// `rank` first; one that was of consequence is looked at again when a neighbour has changed.
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
        for first in order {
            let mut next = Some(first);
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
