//! One object as bits.

use super::Grid;
use crate::tiling::IndexBox;

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

    /// Builds a mask from the half-open runs of its rows, ascending, in image indices; what lies outside
    /// `bounds` is left out.
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

    /// A mask from the words of its rows, by number of the row and of the word in it.
    pub(crate) fn from_words(grid: Grid, bounds: IndexBox, word: impl Fn(usize, usize) -> u64) -> Self {
        let mut mask = Self::cleared(grid, bounds);
        for (number, row) in mask.bits.chunks_mut(mask.words_a_row.max(1)).enumerate() {
            row.iter_mut().enumerate().for_each(|(n, bits)| *bits = word(number, n));
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

    /// The bits of a voxel of the bounds and the others of its word: 64 voxels that begin a multiple of 64
    /// from the bounds' lower x.
    pub(crate) fn word(&self, [x, y, z]: [i64; 3]) -> u64 {
        self.row(y, z)[(x - self.bounds.lower[0]) as usize / WORD]
    }

    /// Puts those voxels inside whose bits are set in the same word.
    pub(crate) fn set_word(&mut self, [x, y, z]: [i64; 3], bits: u64) {
        let word = (x - self.bounds.lower[0]) as usize / WORD;
        self.row_mut(y, z)[word] |= bits;
    }

    /// The places at which this and another mask with the same bounds differ, x fastest.
    pub(crate) fn differences(&self, other: &Self) -> impl Iterator<Item = Place> {
        let rows = self.bits.chunks(self.words_a_row.max(1)).zip(other.bits.chunks(self.words_a_row.max(1)));
        rows.enumerate().flat_map(|(row, (a, b))| {
            let words = a.iter().zip(b).enumerate();
            words.flat_map(move |(word, (a, b))| {
                ones(a ^ b).map(move |bit| Place { row: row as u32, x: (word * WORD) as u32 + bit })
            })
        })
    }

    /// The places of the object's voxels, x fastest.
    pub(crate) fn places(&self) -> impl Iterator<Item = Place> {
        let words = self.bits.iter().enumerate().filter(|(_, word)| **word != 0);
        words.flat_map(|(number, &word)| {
            let (row, first) = (number / self.words_a_row, number % self.words_a_row * WORD);
            ones(word).map(move |bit| Place { row: row as u32, x: first as u32 + bit })
        })
    }

    /// The voxel at a place.
    pub(crate) fn voxel_at(&self, Place { row, x }: Place) -> [i64; 3] {
        let IndexBox { lower, upper } = self.bounds;
        let rows_a_slice = upper[1] - lower[1];
        let row = i64::from(row);
        [lower[0] + i64::from(x), lower[1] + row % rows_a_slice, lower[2] + row / rows_a_slice]
    }

    /// The 27 voxels around a place that has neighbours within the bounds on all sides, a bit each, x
    /// fastest.
    pub(crate) fn around(&self, Place { row, x }: Place) -> u32 {
        let rows_a_slice = self.bounds.extent()[1];
        let (word, shift) = ((x as usize - 1) / WORD, (x as usize - 1) % WORD);
        let first = (row as usize - rows_a_slice - 1) * self.words_a_row + word;
        let mut around = 0;
        for dz in 0..3 {
            for dy in 0..3 {
                let start = first + (dz * rows_a_slice + dy) * self.words_a_row;
                let mut bits = self.bits[start] >> shift;
                if shift > WORD - 3 {
                    bits |= self.bits[start + 1] << (WORD - shift);
                }
                around |= (bits as u32 & 7) << (3 * (3 * dz + dy));
            }
        }
        around
    }

    /// The places of the object's voxels among the 27 around one that has neighbours within the bounds on all
    /// sides, x fastest.
    pub(crate) fn places_around(&self, place: Place) -> impl Iterator<Item = Place> + use<> {
        self.places_among(place, self.around(place))
    }

    /// The places of some of the 27 voxels around one.
    pub(crate) fn places_among(&self, place: Place, around: u32) -> impl Iterator<Item = Place> + use<> {
        let rows_a_slice = self.bounds.extent()[1] as u32;
        let first = Place { row: place.row - rows_a_slice - 1, x: place.x - 1 };
        ones(u64::from(around)).map(move |bit| Place {
            row: first.row + bit / 9 * rows_a_slice + bit / 3 % 3,
            x: first.x + bit % 3,
        })
    }

    /// Whether the voxel at a place is inside.
    pub(crate) fn has(&self, Place { row, x }: Place) -> bool {
        self.bits[row as usize * self.words_a_row + x as usize / WORD] >> (x as usize % WORD) & 1 == 1
    }

    /// Puts the voxel at a place on the other side.
    pub(crate) fn toggle(&mut self, Place { row, x }: Place) {
        self.bits[row as usize * self.words_a_row + x as usize / WORD] ^= 1 << (x as usize % WORD);
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

    /// How far from x the nearest voxel of a row lies that is inside, or outside; `None` where there is none.
    pub(crate) fn nearest_in_row(&self, [x, y, z]: [i64; 3], inside: bool) -> Option<i64> {
        let words = self.row(y, z);
        let (x, bits) = (x - self.bounds.lower[0], (words.len() * WORD) as i64);
        // Beyond its bits a row goes on outside.
        let above = first_bit(words, x.max(0), inside).or((!inside).then_some(x.max(bits)));
        let below = last_bit(words, x.min(bits - 1), inside).or((!inside).then_some(x.min(-1)));
        let distances = [above.map(|above| above - x), below.map(|below| x - below)];
        distances.into_iter().flatten().min()
    }

    /// The same where they overlap x in [from, to), cut off there.
    pub(crate) fn runs_within(
        &self,
        y: i64,
        z: i64,
        (from, to): (i64, i64),
    ) -> impl Iterator<Item = (i64, i64)> + '_ {
        let offset = self.bounds.lower[0];
        let runs = Runs { words: self.row(y, z), position: (from - offset).max(0), offset };
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

/// Where a voxel lies in the bounds of a mask: the number of its row, y fastest, and how far along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Place {
    pub(crate) row: u32,
    pub(crate) x: u32,
}

/// Numbers of the bits that are set, ascending.
pub(crate) fn ones(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = (word != 0).then(|| word.trailing_zeros())?;
        word &= word - 1;
        Some(bit)
    })
}

/// The first bit from a position on that has a value.
fn first_bit(words: &[u64], position: i64, value: bool) -> Option<i64> {
    let flip = if value { 0 } else { u64::MAX };
    let start = position as usize / WORD;
    let mut keep = u64::MAX << (position as usize % WORD);
    for (number, word) in words.iter().enumerate().skip(start) {
        let word = (word ^ flip) & std::mem::replace(&mut keep, u64::MAX);
        if word != 0 {
            return Some((number * WORD) as i64 + i64::from(word.trailing_zeros()));
        }
    }
    None
}

/// The last bit up to a position, which may be negative, that has a value.
fn last_bit(words: &[u64], position: i64, value: bool) -> Option<i64> {
    let flip = if value { 0 } else { u64::MAX };
    let end = usize::try_from(position).ok()?;
    let mut keep = u64::MAX >> (WORD - 1 - end % WORD);
    for (number, word) in words.iter().enumerate().take(end / WORD + 1).rev() {
        let word = (word ^ flip) & std::mem::replace(&mut keep, u64::MAX);
        if word != 0 {
            return Some((number * WORD) as i64 + i64::from(word.ilog2()));
        }
    }
    None
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
    position: i64,
    offset: i64,
}

impl Iterator for Runs<'_> {
    type Item = (i64, i64);

    fn next(&mut self) -> Option<Self::Item> {
        let start = first_bit(self.words, self.position, true)?;
        self.position = first_bit(self.words, start, false).unwrap_or((self.words.len() * WORD) as i64);
        Some((self.offset + start, self.offset + self.position))
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
    fn neighbours_are_gathered_across_words() {
        let wanted = |[x, y, z]: [usize; 3]| (x * 7 + y * 5 + z * 3 + x * y * z) % 4 < 2;
        let mask = mask([140, 5, 4], wanted).on_bounds(IndexBox::new([-1; 3], [141, 6, 5]));
        for place in mask.places() {
            let [x, y, z] = mask.voxel_at(place);
            let at = |bit: i64| [x + bit % 3 - 1, y + bit / 3 % 3 - 1, z + bit / 9 - 1];
            let bits = (0..27).fold(0, |bits, bit| bits | u32::from(mask.get(at(bit))) << bit);
            assert_eq!(mask.around(place), bits);
            let around: Vec<_> = mask.places_around(place).map(|place| mask.voxel_at(place)).collect();
            assert_eq!(around, (0..27).map(at).filter(|&voxel| mask.get(voxel)).collect::<Vec<_>>());
        }
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
