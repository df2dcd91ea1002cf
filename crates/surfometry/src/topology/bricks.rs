//! Voxels whose neighbours lie close to them in memory.

use crate::volume::{Mask, Place};
use std::hint::black_box;

/// Voxels of a brick along each axis.
const EDGE: usize = 4;
/// Bits of a row of a brick.
const ROW: u64 = 0b1111;
/// Bricks of a row that a mask's word is cut into.
const BRICKS_A_WORD: usize = u64::BITS as usize / EDGE;

/// Voxels whose bricks are fetched at once.
pub(super) const FETCHED: usize = 16;

/// Two sets of voxels of a box, in bricks of 4 x 4 x 4, a word each: a voxel and those around it lie in two
/// or three lines of a processor's cache. In a mask they lie in nine, and most of the time of a walk that
/// jumps from place to place is waiting for them.
pub(super) struct Bricks {
    /// Voxels of the box along y.
    rows_a_slice: usize,
    /// Bricks along x, with an empty one at both ends, and along y.
    along: [usize; 2],
    words: Vec<[u64; 2]>,
}

/// One of the two sets.
#[derive(Debug, Clone, Copy)]
pub(super) enum Set {
    Object = 0,
    Rest = 1,
}

impl Bricks {
    /// An object, and no rest.
    pub(super) fn of(object: &Mask) -> Self {
        let [nx, ny, nz] = object.bounds().extent();
        let along = [nx.div_ceil(EDGE) + 2, ny.div_ceil(EDGE)];
        let bricks = vec![[0; 2]; along[0] * along[1] * nz.div_ceil(EDGE)];
        let mut all = Self { rows_a_slice: ny, along, words: bricks };
        for (number, (y, z)) in object.bounds().rows().enumerate() {
            let (first, shift) = all.row(number);
            for (n, word) in object.row(y, z).iter().enumerate() {
                let rows = (0..BRICKS_A_WORD).map(|k| (k, word >> (k * EDGE) & ROW)).filter(|row| row.1 != 0);
                rows.for_each(|(k, row)| all.words[first + n * BRICKS_A_WORD + k][0] |= row << shift);
            }
        }
        all
    }

    /// A set as a mask, on the bounds of the object.
    pub(super) fn mask(&self, set: Set, object: &Mask) -> Mask {
        Mask::from_words(*object.grid(), object.bounds(), |number, n| {
            let (first, shift) = self.row(number);
            let bricks = &self.words[first..first + self.along[0] - 2];
            let bricks = bricks.iter().skip(n * BRICKS_A_WORD).take(BRICKS_A_WORD).enumerate();
            bricks.fold(0, |word, (k, brick)| word | (brick[set as usize] >> shift & ROW) << (k * EDGE))
        })
    }

    /// The 27 voxels around a place that has neighbours within the box on all sides, a bit each, x fastest:
    /// which belong to a set.
    pub(super) fn around(&self, set: Set, Place { row, x }: Place) -> u32 {
        let (y, z) = (row as usize % self.rows_a_slice, row as usize / self.rows_a_slice);
        let (column, shift) = (x as usize / EDGE, x as usize % EDGE);
        let mut around = 0;
        for (n, z) in (z - 1..=z + 1).enumerate() {
            for (m, y) in (y - 1..=y + 1).enumerate() {
                let first = (z / EDGE * self.along[1] + y / EDGE) * self.along[0] + column;
                let bit = (z % EDGE * EDGE + y % EDGE) * EDGE;
                let rows = &self.words[first..first + 3];
                let [left, middle, right] = [0, 1, 2].map(|k| (rows[k][set as usize] >> bit & ROW) as u32);
                around |= ((left >> (EDGE - 1) | middle << 1 | right << (EDGE + 1)) >> shift & 7)
                    << (3 * (3 * n + m));
            }
        }
        around
    }

    /// Gets what voxels and those around them need from memory, of several at once: what a walk has near when
    /// it comes to them costs it no waiting.
    pub(super) fn fetch(&self, places: impl Iterator<Item = Place>) {
        let mut near = [0; 4 * FETCHED];
        for (near, Place { row, x }) in near.chunks_mut(4).zip(places) {
            let (y, z) = (row as usize % self.rows_a_slice, row as usize / self.rows_a_slice);
            let brick = |y: usize, z: usize| (z / EDGE * self.along[1] + y / EDGE) * self.along[0];
            let corners =
                [brick(y - 1, z - 1), brick(y + 1, z - 1), brick(y - 1, z + 1), brick(y + 1, z + 1)];
            near.copy_from_slice(&corners.map(|first| first + x as usize / EDGE + 1));
        }
        black_box(near.iter().fold(0, |all, &brick| all ^ self.words[brick][0]));
    }

    /// Puts the voxel at a place into a set, or takes it out.
    pub(super) fn toggle(&mut self, set: Set, Place { row, x }: Place) {
        let (first, shift) = self.row(row as usize);
        self.words[first + x as usize / EDGE][set as usize] ^= 1 << (shift + x as usize % EDGE);
    }

    /// The first brick of a row, and where the row begins in it.
    fn row(&self, number: usize) -> (usize, usize) {
        let (y, z) = (number % self.rows_a_slice, number / self.rows_a_slice);
        let first = (z / EDGE * self.along[1] + y / EDGE) * self.along[0] + 1;
        (first, (z % EDGE * EDGE + y % EDGE) * EDGE)
    }
}
