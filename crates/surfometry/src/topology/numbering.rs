//! Components that are joined, and numbered anew.

use super::face::{BACKGROUND, FOREGROUND, Kind};
use crate::tiling::DisjointSets;

/// The background component around the image.
pub(super) const OUTSIDE: u32 = 0;

/// What a component is called after so many others.
pub(super) fn shifted(kind: Kind, component: u32, offsets: [u32; 2]) -> u32 {
    if kind == BACKGROUND && component == OUTSIDE { OUTSIDE } else { component + offsets[kind] }
}

/// Components that are about to be joined: those of the background, of which the first is the outside, and
/// those of the foreground.
pub(super) struct Joining {
    sets: [DisjointSets; 2],
    outside: usize,
}

/// The same when all is joined: components have new numbers in the order in which they are asked for.
pub(super) struct Numbering {
    joined: Joining,
    numbers: [Vec<Option<u32>>; 2],
    next: [u32; 2],
}

impl Joining {
    /// Of the outside alone.
    pub(super) fn new() -> Self {
        let mut background = DisjointSets::default();
        let outside = background.add(1);
        Self { sets: [background, DisjointSets::default()], outside }
    }

    /// Of components that were found in one box, where the outside has no number yet.
    pub(super) fn of(mut background: DisjointSets, foreground: DisjointSets) -> Self {
        let outside = background.add(1);
        Self { sets: [background, foreground], outside }
    }

    /// Adds as many components of each kind besides the outside; what their numbers, from 1 and from 0, grow
    /// by.
    pub(super) fn add(&mut self, components: [u32; 2]) -> [u32; 2] {
        let first: [usize; 2] = std::array::from_fn(|kind| self.sets[kind].add(components[kind] as usize));
        [first[BACKGROUND] as u32 - 1, first[FOREGROUND] as u32]
    }

    pub(super) fn join(&mut self, kind: Kind, a: u32, b: u32) {
        self.sets[kind].join(a as usize, b as usize);
    }

    pub(super) fn join_outside(&mut self, background: usize) {
        self.sets[BACKGROUND].join(background, self.outside);
    }

    /// Number of components of each kind, besides the outside.
    pub(super) fn counts(&self) -> [u64; 2] {
        [self.sets[BACKGROUND].count() - 1, self.sets[FOREGROUND].count()]
    }

    pub(super) fn numbered(mut self) -> Numbering {
        let outside = self.sets[BACKGROUND].root(self.outside);
        let mut numbers = self.sets.each_ref().map(|sets| vec![None; sets.members()]);
        numbers[BACKGROUND][outside] = Some(OUTSIDE);
        Numbering { joined: self, numbers, next: [OUTSIDE + 1, 0] }
    }
}

impl Numbering {
    /// The new number of a component.
    pub(super) fn number(&mut self, kind: Kind, component: u32) -> u32 {
        let root = self.joined.sets[kind].root(component as usize);
        *self.numbers[kind][root].get_or_insert_with(|| {
            self.next[kind] += 1;
            self.next[kind] - 1
        })
    }

    /// How many components of each kind besides the outside have a number, and how many have none.
    pub(super) fn counts(&self) -> ([u32; 2], [u64; 2]) {
        let [background, foreground] = self.next;
        let numbered = [background - 1, foreground];
        let all = self.joined.counts();
        (numbered, std::array::from_fn(|kind| all[kind] - u64::from(numbered[kind])))
    }
}
