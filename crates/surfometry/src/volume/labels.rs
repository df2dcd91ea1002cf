//! Label images of any integer type, stored as runs of labels.

use super::label_runs::{LabelRuns, Run, SliceRuns};
use super::samples::for_samples;
use super::{Grid, LabelGroup, Mask, Samples, Scalar, Slab, SlabReader, VolumeError};
use crate::tiling::IndexBox;
use crate::vectors;
use fearless_simd::dispatch;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// A label image: each voxel holds a whole number, 0 being background.
///
/// Stored as runs of one label along x, of 8 bytes (12 in slices of several labels), whatever type of voxel
/// the file has, so that memory follows the objects' surfaces: a gyroid of period 64 voxels takes 0.1 bytes a
/// voxel; noise, the worst case, 6.
#[derive(Debug, Clone)]
pub struct LabelImage {
    grid: Grid,
    /// Label of each code, in order of first appearance; code 0 is background.
    labels: Vec<i64>,
    runs: LabelRuns,
    summaries: Vec<LabelSummary>,
}

/// What one pass over the image tells of a label.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelSummary {
    /// The label.
    pub label: i64,
    /// Number of voxels.
    pub voxels: u64,
    /// Bounding box.
    pub bounds: IndexBox,
    code: usize,
    /// Runs along x that its voxels are in.
    runs: u64,
}

impl LabelImage {
    /// Reads an image from its slabs.
    ///
    /// # Errors
    /// The source's own, and [`VolumeError`] for voxels that are no labels, too few voxels, or too little
    /// memory.
    pub fn from_slabs<R: SlabReader>(reader: &mut R) -> Result<Self, R::Error> {
        let grid = *reader.grid();
        let mut encoder = RunEncoder::new(grid.index_box());
        let mut runs = LabelRuns::new(grid, &grid.index_box());
        while let Some(slab) = reader.next_slab()? {
            encoder.push(&slab, &mut runs)?;
        }
        Ok(encoder.finish(grid, runs)?)
    }

    /// Of an array in memory, x fastest, of as many voxels as the grid has.
    ///
    /// # Errors
    /// [`VolumeError`] for voxels that are no labels, or too few of them.
    pub fn from_voxels<T: Scalar>(grid: Grid, voxels: &[T]) -> Result<Self, VolumeError> {
        Self::of_part(grid, grid.index_box(), voxels)
    }

    /// Of the voxels of a box of an image, of which nothing else is known.
    pub(super) fn of_part<T: Scalar>(
        grid: Grid,
        region: IndexBox,
        voxels: &[T],
    ) -> Result<Self, VolumeError> {
        let (mut encoder, mut runs) = (RunEncoder::new(region), LabelRuns::new(grid, &region));
        encoder.push_values(voxels, &mut runs)?;
        encoder.finish(grid, runs)
    }

    /// The runs of labels.
    pub(super) fn runs(&self) -> &LabelRuns {
        &self.runs
    }

    /// The image's lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// What occurs in the image, background left out, in ascending order of label.
    pub fn summaries(&self) -> &[LabelSummary] {
        &self.summaries
    }

    /// What is known of one label; `None` for one that does not occur, or background.
    pub fn summary(&self, label: i64) -> Option<&LabelSummary> {
        self.summaries.binary_search_by_key(&label, |s| s.label).ok().map(|n| &self.summaries[n])
    }

    /// The voxels of one label.
    ///
    /// The mask of a label that does not occur is empty.
    pub fn mask(&self, label: i64) -> Mask {
        self.group_mask(&LabelGroup::single(label))
    }

    /// The voxels of all the labels in a group, as one object.
    pub fn group_mask(&self, group: &LabelGroup) -> Mask {
        let members: Vec<&LabelSummary> = group.labels().iter().filter_map(|&l| self.summary(l)).collect();
        let bounds = members.iter().fold(IndexBox::EMPTY, |bounds, s| bounds.hull(&s.bounds));
        let mut codes: Vec<usize> = members.iter().map(|s| s.code).collect();
        codes.sort_unstable();
        self.runs.mask(&codes, bounds)
    }

    /// The labels that occur, background left out, ascending.
    #[cfg(feature = "io")]
    pub(crate) fn labels(&self) -> impl Iterator<Item = i64> + '_ {
        self.summaries.iter().map(|summary| summary.label)
    }

    /// The runs of labels in a row, background left out, ascending.
    pub(crate) fn labelled_runs(&self, y: usize, z: usize) -> impl Iterator<Item = (Range<usize>, i64)> + '_ {
        let labels = &self.labels;
        self.runs.row(y, z).map(|run| (run.start as usize..run.end as usize, labels[run.code as usize]))
    }

    /// Whether there are so many values, so mixed, that they are more likely grey values than labels.
    pub fn looks_grey(&self) -> bool {
        look_grey(self.summaries.iter().map(|s| (s.voxels, s.bounds.voxels() as u64)))
    }

    /// Whether nearly every voxel differs from the next one, too: then the values are no labels.
    pub(crate) fn is_grey(&self) -> bool {
        are_grey(&self.summaries)
    }

    /// The label at an index.
    pub fn get(&self, index: [usize; 3]) -> i64 {
        self.labels[self.runs.code_at(index)]
    }
}

/// Labels from which on an image may be a grey one, and the share of the boxes around them that labels then have, times their
/// number, or as it is where that is more: each grey value lies all over the object.
const GREY_LABELS: usize = 32;
const GREY_SHARES: f64 = 2.0;
const GREY_SHARE: f64 = 0.01;

/// Whether labels, of each the voxels and those of the box around it, are more likely grey values.
pub(crate) fn look_grey(labels: impl ExactSizeIterator<Item = (u64, u64)>) -> bool {
    let count = labels.len();
    if count < GREY_LABELS {
        return false;
    }
    let sums = labels.fold((0.0, 0.0), |sums, (voxels, of)| (sums.0 + voxels as f64, sums.1 + of as f64));
    sums.0 < GREY_SHARE.max(GREY_SHARES / count as f64) * sums.1
}

/// Voxels of a run along x, on the average, below which a value is a grey one: that of labels are parts of objects.
const GREY_RUN: u64 = 2;

/// Whether values are grey ones: they lie all over each other, and most of them in runs as short as of noise. Thin
/// objects that wind about, as nerve cells, have longer ones.
fn are_grey(summaries: &[LabelSummary]) -> bool {
    let short = |s: &&LabelSummary| s.voxels < GREY_RUN * s.runs;
    look_grey(summaries.iter().map(|s| (s.voxels, s.bounds.voxels() as u64)))
        && 2 * summaries.iter().filter(short).count() > summaries.len()
}

/// Turns slabs into runs, and counts what occurs.
pub(crate) struct RunEncoder {
    /// The image, or the box of it that is known.
    region: IndexBox,
    /// Label of each code, in order of first appearance; code 0 is background.
    labels: Vec<i64>,
    code_of: HashMap<i64, usize>,
    summaries: Vec<LabelSummary>,
    voxels: usize,
    /// Largest magnitude that was rounded to background.
    faint: f64,
}

impl RunEncoder {
    pub(crate) fn new(region: IndexBox) -> Self {
        Self {
            region,
            labels: vec![0],
            code_of: HashMap::from([(0, 0)]),
            summaries: vec![LabelSummary::empty(0, 0)],
            voxels: 0,
            faint: 0.0,
        }
    }

    pub(super) fn finish(self, grid: Grid, runs: LabelRuns) -> Result<LabelImage, VolumeError> {
        self.check_complete()?;
        if self.region == grid.index_box() {
            self.check_foreground()?;
        }
        let Self { labels, mut summaries, .. } = self;
        summaries.remove(0);
        summaries.sort_by_key(|s| s.label);
        Ok(LabelImage { grid, labels, runs, summaries })
    }

    /// Adds a slab's slices to those that are there.
    pub(crate) fn push(&mut self, slab: &Slab, runs: &mut LabelRuns) -> Result<(), VolumeError> {
        self.push_samples(&slab.samples, runs)
    }

    /// The same of their samples.
    pub(super) fn push_samples(
        &mut self,
        samples: &Samples,
        runs: &mut LabelRuns,
    ) -> Result<(), VolumeError> {
        for_samples!(samples, values => self.push_values(values, runs))
    }

    /// The labels that have occurred, by code; the first is background.
    pub(crate) fn labels(&self) -> &[i64] {
        &self.labels
    }

    /// Refuses grey values, as far as they have gone by.
    pub(crate) fn check_labels(&self) -> Result<(), VolumeError> {
        let labels = self.summaries.len() - 1;
        if are_grey(&self.summaries[1..]) { Err(VolumeError::GreyValues { labels }) } else { Ok(()) }
    }

    pub(crate) fn check_complete(&self) -> Result<(), VolumeError> {
        let expected = self.region.voxels();
        if self.voxels == expected {
            Ok(())
        } else {
            Err(VolumeError::Incomplete { found: self.voxels, expected })
        }
    }

    /// Whether an image without labels is one of values that only round to background.
    pub(crate) fn check_foreground(&self) -> Result<(), VolumeError> {
        if self.labels.len() == 1 && self.faint > 0.0 {
            Err(VolumeError::FaintForeground { largest: self.faint })
        } else {
            Ok(())
        }
    }

    /// Slices are encoded in parallel, each with a list of its own labels, and joined in their order.
    fn push_values<T: Scalar>(&mut self, values: &[T], runs: &mut LabelRuns) -> Result<(), VolumeError> {
        let [nx, ny, _] = self.region.extent();
        let [x, y, z] = self.region.lower.map(|v| v as usize);
        let first = z + self.voxels / (nx * ny);
        let encode = |(number, slice): (usize, &[T])| dispatch!(vectors::level(), _simd => EncodedSlice::of(slice, nx, [x, y, first + number]));
        let encoded: Vec<_> = values.par_chunks(nx * ny).enumerate().map(encode).collect();
        for slice in encoded {
            let EncodedSlice { runs: mut slice_runs, summaries, faint } = slice?;
            self.faint = self.faint.max(faint);
            let codes: Vec<u32> = summaries.iter().map(|summary| self.add(summary)).collect();
            slice_runs.recode(&codes);
            runs.push(slice_runs);
        }
        self.voxels += values.len();
        Ok(())
    }

    /// Adds what a slice says of a label; the label's code.
    fn add(&mut self, part: &LabelSummary) -> u32 {
        let next = self.labels.len();
        let code = *self.code_of.entry(part.label).or_insert(next);
        if code == next {
            self.labels.push(part.label);
            self.summaries.push(LabelSummary::empty(part.label, code));
        }
        let all = &mut self.summaries[code];
        all.voxels += part.voxels;
        all.runs += part.runs;
        all.bounds = all.bounds.hull(&part.bounds);
        u32::try_from(code).expect("fewer than 2^32 labels")
    }
}

/// One slice, its labels numbered on their own; the first is background.
struct EncodedSlice {
    runs: SliceRuns,
    summaries: Vec<LabelSummary>,
    /// Largest magnitude that was rounded to background.
    faint: f64,
}

impl EncodedSlice {
    /// Of the voxels of a slice in rows of `nx`, of which `first` is the first one's index. Run by run: a
    /// label is looked up once a run, and not where it is that of a run just before.
    #[inline(always)]
    fn of<T: Scalar>(slice: &[T], nx: usize, [x, y, z]: [usize; 3]) -> Result<Self, VolumeError> {
        let summaries = vec![LabelSummary::empty(0, 0)];
        let mut encoded = Self { runs: SliceRuns::default(), summaries, faint: 0.0 };
        let mut code_of = HashMap::from([(0, 0)]);
        let mut recent: [Option<(T, usize)>; 2] = [None; 2];
        for (y, row) in (y..).zip(slice.chunks(nx)) {
            let mut start = 0;
            while start < row.len() {
                let value = row[start];
                let end = start + run_length(&row[start..]);
                let known = recent.into_iter().flatten().find(|(known, _)| *known == value);
                let code = if let Some((_, code)) = known {
                    code
                } else {
                    let label =
                        value.to_label().ok_or_else(|| label_error(value.to_f64(), [x + start, y, z]))?;
                    if label == 0 {
                        encoded.faint = encoded.faint.max(value.to_f64().abs());
                    }
                    let next = encoded.summaries.len();
                    let code = *code_of.entry(label).or_insert(next);
                    if code == next {
                        encoded.summaries.push(LabelSummary::empty(label, code));
                    }
                    recent = [Some((value, code)), recent[0]];
                    code
                };
                if code != 0 {
                    let [start, end] = [x + start, x + end].map(|x| x as u32);
                    let run = Run { start, end, code: code as u32 };
                    encoded.summaries[code].add_run(&run, y, z);
                    encoded.runs.push(run);
                }
                start = end;
            }
            encoded.runs.end_row();
        }
        encoded.runs.shrink();
        Ok(encoded)
    }
}

/// How many values at the start of a row that has any are the same.
#[inline(always)]
fn run_length<T: Scalar>(row: &[T]) -> usize {
    const TOGETHER: usize = 64;
    let first = row[0];
    let mut length = 1;
    // Without a way out of the inner loop it is done with vectors.
    for chunk in row[1..].chunks_exact(TOGETHER) {
        let mut same = true;
        for value in chunk {
            same &= *value == first;
        }
        if !same {
            break;
        }
        length += TOGETHER;
    }
    length + row[length..].iter().take_while(|value| **value == first).count()
}

fn label_error(value: f64, index: [usize; 3]) -> VolumeError {
    if !value.is_finite() {
        VolumeError::NotFinite { index, value }
    } else if value.fract() == 0.0 {
        VolumeError::LabelOutOfRange { index, value }
    } else {
        VolumeError::Fractional { index, value }
    }
}

impl LabelSummary {
    fn empty(label: i64, code: usize) -> Self {
        Self { label, voxels: 0, bounds: IndexBox::EMPTY, code, runs: 0 }
    }

    /// The label, its code, and the box around its voxels.
    pub(super) fn coded(&self) -> (i64, usize, IndexBox) {
        (self.label, self.code, self.bounds)
    }

    fn add_run(&mut self, run: &Run, y: usize, z: usize) {
        self.voxels += u64::from(run.end - run.start);
        self.runs += 1;
        self.bounds = self.bounds.hull(&run.voxels(y, z));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Whole(Grid, Option<Slab>);

    impl SlabReader for Whole {
        type Error = VolumeError;
        fn grid(&self) -> &Grid {
            &self.0
        }
        fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
            Ok(self.1.take())
        }
    }

    fn image(dimensions: [usize; 3], samples: Samples) -> Result<LabelImage, VolumeError> {
        let grid = Grid::axis_aligned(dimensions, [1.0; 3])?;
        LabelImage::from_slabs(&mut Whole(grid, Some(Slab { slices: 0..dimensions[2], samples })))
    }

    #[test]
    fn summaries_count_and_bound() {
        let image = image([4, 2, 1], Samples::I16(vec![0, -5, -5, 7, 0, -5, 0, 0])).unwrap();
        let labels: Vec<i64> = image.summaries().iter().map(|s| s.label).collect();
        assert_eq!(labels, [-5, 7]);
        let minus_five = &image.summaries()[0];
        assert_eq!(minus_five.voxels, 3);
        assert_eq!(minus_five.bounds, IndexBox::new([1, 0, 0], [3, 2, 1]));
        assert_eq!(image.get([3, 0, 0]), 7);
        let mask = image.mask(-5);
        assert_eq!(mask.voxels(), 3);
        assert!(mask.get([1, 1, 0]) && !mask.get([2, 1, 0]) && !mask.get([-1, 0, 0]));
        assert_eq!(image.mask(99).voxels(), 0);
    }

    #[test]
    fn many_labels_widen_the_codes() {
        let values: Vec<i32> = (0..70_000).collect();
        let image = image([70_000, 1, 1], Samples::I32(values)).unwrap();
        for label in [1, 255, 256, 65_535, 65_536, 69_999] {
            assert_eq!(image.get([label as usize, 0, 0]), label);
        }
    }

    #[test]
    fn voxels_that_are_no_labels_are_named() {
        let fractional = image([2, 1, 1], Samples::F32(vec![0.0, 0.25]));
        assert_eq!(fractional.unwrap_err(), VolumeError::Fractional { index: [1, 0, 0], value: 0.25 });
        assert!(matches!(
            image([1, 1, 2], Samples::F64(vec![1.0, f64::NAN])),
            Err(VolumeError::NotFinite { .. })
        ));
        assert!(matches!(
            image([1, 1, 1], Samples::U64(vec![u64::MAX])),
            Err(VolumeError::LabelOutOfRange { .. })
        ));
        assert!(matches!(image([2, 1, 1], Samples::U8(vec![1])), Err(VolumeError::Incomplete { .. })));
    }
}
