//! One object as bits.

use super::Grid;
use crate::tiling::{Block, IndexBox};

const WORD: usize = u64::BITS as usize;

/// A binary object on a grid: one bit a voxel of its bounding box, background everywhere else.
///
/// Because everything outside the box is background, also beyond the image's edge, an object that touches the
/// border is closed there (the paper's padding) without a copy.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    grid: Grid,
    bounds: IndexBox,
    words_a_row: usize,
    bits: Vec<u64>,
}

impl Mask {
    /// A mask without voxels.
    pub(crate) fn empty(grid: Grid) -> Self {
        Self { grid, bounds: IndexBox::EMPTY, words_a_row: 0, bits: Vec::new() }
    }

    /// Builds a mask from the half-open runs of its rows, ascending, in image indices; what lies outside `bounds` is left out.
    pub(crate) fn from_runs<R: Iterator<Item = (usize, usize)>>(
        grid: Grid,
        bounds: IndexBox,
        runs: impl Fn(usize, usize) -> R,
    ) -> Self {
        let mut mask = Self::cleared(grid, bounds);
        for (y, z) in bounds.rows() {
            for (start, end) in runs(y as usize, z as usize) {
                mask.set_run((start as i64, end as i64), y, z);
            }
        }
        mask
    }

    /// A mask of the voxels where a predicate of the index (x, y, z) holds.
    pub fn from_predicate(grid: Grid, inside: impl Fn([usize; 3]) -> bool) -> Self {
        let (region, mut bounds) = (grid.index_box(), IndexBox::EMPTY);
        let mut whole = Self::cleared(grid, region);
        for (y, z) in region.rows() {
            for x in region.lower[0]..region.upper[0] {
                if inside([x, y, z].map(|v| v as usize)) {
                    whole.set([x, y, z], true);
                    bounds = bounds.hull(&IndexBox::voxel([x, y, z]));
                }
            }
        }
        whole.on_bounds(bounds)
    }

    /// A mask without voxels, which may be set in a box.
    pub(crate) fn cleared(grid: Grid, bounds: IndexBox) -> Self {
        let [nx, ny, nz] = bounds.extent();
        let words_a_row = nx.div_ceil(WORD);
        Self { grid, bounds, words_a_row, bits: vec![0; words_a_row * ny * nz] }
    }

    /// The voxels of a block whose values are inside, with the block's box as its bounds.
    pub(crate) fn of_values<T: Copy>(grid: Grid, values: &Block<T>, inside: impl Fn(T) -> bool) -> Self {
        let region = values.region();
        let mut mask = Self::cleared(grid, region);
        for (y, z) in region.rows() {
            for (word, chunk) in mask.row_mut(y, z).iter_mut().zip(values.row(y, z).chunks(WORD)) {
                *word = chunk.iter().enumerate().fold(0, |w, (bit, &v)| w | u64::from(inside(v)) << bit);
            }
        }
        mask
    }

    /// The part in a box, with the box as its bounds.
    pub(crate) fn on_bounds(&self, bounds: IndexBox) -> Self {
        let mut part = Self::cleared(self.grid, bounds);
        for (y, z) in bounds.rows() {
            self.runs(y, z).for_each(|run| part.set_run(run, y, z));
        }
        part
    }

    /// Puts a voxel of the bounds inside or outside.
    pub(crate) fn set(&mut self, [x, y, z]: [i64; 3], inside: bool) {
        let x = (x - self.bounds.lower[0]) as usize;
        let word = &mut self.row_mut(y, z)[x / WORD];
        let bit = 1 << (x % WORD);
        *word = if inside { *word | bit } else { *word & !bit };
    }

    /// Puts a run of a row of the bounds inside; what lies outside them is left out.
    pub(crate) fn set_run(&mut self, (start, end): (i64, i64), y: i64, z: i64) {
        let (x0, x1) = (self.bounds.lower[0], self.bounds.upper[0]);
        let (start, end) = (start.max(x0), end.min(x1));
        if start < end {
            set_bits(self.row_mut(y, z), (start - x0) as usize, (end - x0) as usize);
        }
    }

    fn row_mut(&mut self, y: i64, z: i64) -> &mut [u64] {
        let start = self.row_start(y, z);
        &mut self.bits[start..][..self.words_a_row]
    }

    /// Where the bits of a row of the bounds begin.
    fn row_start(&self, y: i64, z: i64) -> usize {
        let IndexBox { lower, upper } = self.bounds;
        ((z - lower[2]) * (upper[1] - lower[1]) + (y - lower[1])) as usize * self.words_a_row
    }

    /// The voxels in which two masks with the same bounds differ, x fastest.
    pub(crate) fn differences(&self, other: &Self) -> Vec<[i64; 3]> {
        let mut voxels = Vec::new();
        for (y, z) in self.bounds.rows() {
            let words: Vec<u64> = self.row(y, z).iter().zip(other.row(y, z)).map(|(a, b)| a ^ b).collect();
            let runs = Runs { words: &words, position: 0, offset: self.bounds.lower[0] };
            voxels.extend(runs.flat_map(|(a, b)| a..b).map(|x| [x, y, z]));
        }
        voxels
    }

    /// The grid of the image that the object lies in.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Box outside which there is only background, in image indices.
    pub fn bounds(&self) -> IndexBox {
        self.bounds
    }

    /// Number of voxels.
    pub fn voxels(&self) -> u64 {
        self.bits.iter().map(|w| u64::from(w.count_ones())).sum()
    }

    /// Whether the object has no voxel.
    pub fn is_empty(&self) -> bool {
        self.bits.iter().all(|&w| w == 0)
    }

    /// Whether a voxel is inside; any index may be asked for.
    pub fn get(&self, index: [i64; 3]) -> bool {
        if !self.bounds.contains(index) {
            return false;
        }
        let x = (index[0] - self.bounds.lower[0]) as usize;
        self.row(index[1], index[2])[x / WORD] >> (x % WORD) & 1 == 1
    }

    /// Bits of the row at y, z of the bounds, from their lower x on; empty outside.
    pub(crate) fn row(&self, y: i64, z: i64) -> &[u64] {
        let [_, y0, z0] = self.bounds.lower;
        let [_, y1, z1] = self.bounds.upper;
        if y < y0 || y >= y1 || z < z0 || z >= z1 {
            return &[];
        }
        &self.bits[self.row_start(y, z)..][..self.words_a_row]
    }

    /// Runs of inside voxels in the row at y, z, as half-open x intervals in image indices, ascending.
    pub(crate) fn runs(&self, y: i64, z: i64) -> Runs<'_> {
        Runs { words: self.row(y, z), position: 0, offset: self.bounds.lower[0] }
    }

    /// The same where they overlap x in [from, to), cut off there.
    pub(crate) fn runs_within(
        &self,
        y: i64,
        z: i64,
        (from, to): (i64, i64),
    ) -> impl Iterator<Item = (i64, i64)> + '_ {
        let offset = self.bounds.lower[0];
        let runs = Runs { words: self.row(y, z), position: (from - offset).max(0) as usize, offset };
        runs.take_while(move |run| run.0 < to).map(move |(a, b)| (a, b.min(to)))
    }

    /// `Some(value)` where every voxel of a box has that value.
    pub(crate) fn uniform_in(&self, region: &IndexBox) -> Option<bool> {
        let inner = region.intersection(&self.bounds);
        if inner.is_empty() {
            return Some(false);
        }
        let all_in_bounds = inner == *region;
        let (x0, x1) = (inner.lower[0], inner.upper[0]);
        let covered = |y, z| self.runs(y, z).map(|(a, b)| (b.min(x1) - a.max(x0)).max(0)).sum::<i64>();
        let value = covered(inner.lower[1], inner.lower[2]) > 0;
        if value && !all_in_bounds {
            return None;
        }
        let expected = if value { x1 - x0 } else { 0 };
        inner.rows().all(|(y, z)| covered(y, z) == expected).then_some(value)
    }

    /// Whether the object has voxels in the first or last slice of any axis of the image.
    pub fn touches_border(&self) -> bool {
        self.grid.is_touched_by(&self.bounds)
    }
}

/// Sets the bits from `start` up to, not including, `end`, of which there is at least one.
fn set_bits(words: &mut [u64], start: usize, end: usize) {
    let (first, last) = (start / WORD, (end - 1) / WORD);
    let from = u64::MAX << (start % WORD);
    let to = u64::MAX >> (WORD - 1 - (end - 1) % WORD);
    if first == last {
        words[first] |= from & to;
    } else {
        words[first] |= from;
        words[first + 1..last].fill(u64::MAX);
        words[last] |= to;
    }
}

/// Iterator over the runs of a row; see [`Mask::runs`].
#[derive(Debug, Clone)]
pub(crate) struct Runs<'a> {
    words: &'a [u64],
    position: usize,
    offset: i64,
}

impl Runs<'_> {
    /// First position from `self.position` on whose bit equals `value`; the row's length if none.
    fn first_bit(&self, value: bool) -> usize {
        let flip = if value { 0 } else { u64::MAX };
        let mut index = self.position / WORD;
        let mut shift = self.position % WORD;
        while index < self.words.len() {
            let word = (self.words[index] ^ flip) >> shift;
            if word != 0 {
                return index * WORD + shift + word.trailing_zeros() as usize;
            }
            index += 1;
            shift = 0;
        }
        self.words.len() * WORD
    }
}

impl Iterator for Runs<'_> {
    type Item = (i64, i64);

    fn next(&mut self) -> Option<Self::Item> {
        let start = self.first_bit(true);
        if start == self.words.len() * WORD {
            return None;
        }
        self.position = start;
        self.position = self.first_bit(false);
        Some((self.offset + start as i64, self.offset + self.position as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(dimensions: [usize; 3], inside: impl Fn([usize; 3]) -> bool) -> Mask {
        Mask::from_predicate(Grid::axis_aligned(dimensions, [1.0; 3]).unwrap(), inside)
    }

    #[test]
    fn runs_are_the_bits() {
        let wanted = |x: usize| x % 7 < 3 || (60..70).contains(&x) || x >= 190;
        let mask = mask([200, 1, 1], |[x, _, _]| wanted(x));
        let mut seen = vec![false; 200];
        for (a, b) in mask.runs(0, 0) {
            assert!(a < b && !seen[a as usize]);
            (a..b).for_each(|x| seen[x as usize] = true);
        }
        assert_eq!(seen, (0..200).map(wanted).collect::<Vec<_>>());
        for (from, to) in [(-9, 3), (61, 66), (2, 140), (185, 260), (230, 240)] {
            let within = mask.runs_within(0, 0, (from, to)).flat_map(|(a, b)| a..b);
            let expected = (from.max(0)..to.min(200)).filter(|&x| wanted(x as usize));
            assert_eq!(within.collect::<Vec<_>>(), expected.collect::<Vec<_>>());
        }
        assert_eq!(mask.voxels() as usize, seen.iter().filter(|&&v| v).count());
    }

    #[test]
    fn bounds_are_tight_and_uniformity_is_exact() {
        let mask = mask([100, 9, 9], |[x, y, z]| {
            (10..90).contains(&x) && (2..7).contains(&y) && (2..7).contains(&z)
        });
        assert_eq!(mask.bounds(), IndexBox::new([10, 2, 2], [90, 7, 7]));
        assert!(!mask.touches_border());
        assert_eq!(mask.uniform_in(&IndexBox::new([10, 2, 2], [90, 7, 7])), Some(true));
        assert_eq!(mask.uniform_in(&IndexBox::new([9, 2, 2], [90, 7, 7])), None);
        assert_eq!(mask.uniform_in(&IndexBox::new([0, 0, 0], [10, 9, 9])), Some(false));
        assert_eq!(mask.uniform_in(&IndexBox::new([-5, -5, -5], [0, 0, 0])), Some(false));
    }
}
