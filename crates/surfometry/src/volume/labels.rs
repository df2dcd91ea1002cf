//! Label images of any integer type, stored in as few bytes as their labels need.

use super::samples::for_samples;
use super::{Grid, LabelGroup, Mask, Scalar, Slab, SlabReader, VolumeError};
use crate::tiling::IndexBox;
use std::collections::HashMap;

/// A label image: each voxel holds a whole number, 0 being background.
///
/// Voxels are stored as codes of 1, 2 or 4 bytes into the list of the labels that occur, so an image of i64 or
/// float voxels costs no more than one of bytes.
#[derive(Debug, Clone)]
pub struct LabelImage {
    grid: Grid,
    /// Label of each code, in order of first appearance; code 0 is background.
    labels: Vec<i64>,
    codes: Codes,
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
}

#[derive(Debug, Clone)]
enum Codes {
    U8(Vec<u8>),
    U16(Vec<u16>),
    U32(Vec<u32>),
}

impl LabelImage {
    /// Reads an image from its slabs.
    ///
    /// # Errors
    /// The source's own, and [`VolumeError`] for voxels that are no labels, too few voxels, or too little memory.
    pub fn from_slabs<R: SlabReader>(reader: &mut R) -> Result<Self, R::Error> {
        let mut builder = Builder::new(*reader.grid())?;
        while let Some(slab) = reader.next_slab()? {
            builder.push(&slab)?;
        }
        Ok(builder.finish()?)
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
        let [nx, ny, _] = self.grid.dimensions();
        Mask::from_rows(self.grid, bounds, |y, z, row| {
            let start = (z * ny + y) * nx;
            self.codes.for_row(start + bounds.lower[0] as usize, row.len(), |x, code| {
                row[x] = codes.binary_search(&code).is_ok();
            });
        })
    }

    /// The label at an index.
    pub fn get(&self, [x, y, z]: [usize; 3]) -> i64 {
        let [nx, ny, _] = self.grid.dimensions();
        let mut label = 0;
        self.codes.for_row((z * ny + y) * nx + x, 1, |_, code| label = self.labels[code]);
        label
    }
}

impl Codes {
    fn len(&self) -> usize {
        match self {
            Self::U8(c) => c.len(),
            Self::U16(c) => c.len(),
            Self::U32(c) => c.len(),
        }
    }

    fn for_row(&self, start: usize, length: usize, mut visit: impl FnMut(usize, usize)) {
        let range = start..start + length;
        match self {
            Self::U8(c) => c[range].iter().enumerate().for_each(|(i, &code)| visit(i, code.into())),
            Self::U16(c) => c[range].iter().enumerate().for_each(|(i, &code)| visit(i, code.into())),
            Self::U32(c) => c[range].iter().enumerate().for_each(|(i, &code)| visit(i, code as usize)),
        }
    }

    fn push_run(&mut self, code: usize, length: usize) {
        match self {
            Self::U8(c) if code > usize::from(u8::MAX) => {
                *self = Self::U16(widened(c));
                self.push_run(code, length);
            }
            Self::U16(c) if code > usize::from(u16::MAX) => {
                *self = Self::U32(widened(c));
                self.push_run(code, length);
            }
            Self::U8(c) => c.resize(c.len() + length, code as u8),
            Self::U16(c) => c.resize(c.len() + length, code as u16),
            Self::U32(c) => c.resize(c.len() + length, code as u32),
        }
    }
}

fn widened<A: Copy, B: From<A>>(codes: &mut Vec<A>) -> Vec<B> {
    let mut wide = Vec::with_capacity(codes.capacity());
    wide.extend(codes.iter().map(|&c| B::from(c)));
    wide
}

struct Builder {
    grid: Grid,
    labels: Vec<i64>,
    code_of: HashMap<i64, usize>,
    codes: Codes,
    summaries: Vec<LabelSummary>,
}

impl Builder {
    fn new(grid: Grid) -> Result<Self, VolumeError> {
        let mut codes = Vec::new();
        codes
            .try_reserve_exact(grid.voxel_count())
            .map_err(|_| VolumeError::TooLarge { dimensions: grid.dimensions() })?;
        Ok(Self {
            grid,
            labels: vec![0],
            code_of: HashMap::from([(0, 0)]),
            codes: Codes::U8(codes),
            summaries: vec![LabelSummary::empty(0, 0)],
        })
    }

    fn push(&mut self, slab: &Slab) -> Result<(), VolumeError> {
        for_samples!(&slab.samples, values => self.push_values(values))
    }

    /// Appends voxels run by run: segmentations are long runs of one value, so the label is looked up once a run.
    fn push_values<T: Scalar>(&mut self, values: &[T]) -> Result<(), VolumeError> {
        let nx = self.grid.dimensions()[0];
        for row in values.chunks(nx) {
            let mut start = 0;
            for run in row.chunk_by(|a, b| a == b) {
                let offset = self.codes.len();
                let code = self.code(run[0], offset)?;
                let [_, y, z] = self.grid.index_of(offset);
                self.summaries[code].add_run(start, run.len(), y, z);
                self.codes.push_run(code, run.len());
                start += run.len();
            }
        }
        Ok(())
    }

    fn code<T: Scalar>(&mut self, value: T, offset: usize) -> Result<usize, VolumeError> {
        let label =
            value.to_label().ok_or_else(|| label_error(value.to_f64(), self.grid.index_of(offset)))?;
        if let Some(&code) = self.code_of.get(&label) {
            return Ok(code);
        }
        let code = self.labels.len();
        self.labels.push(label);
        self.summaries.push(LabelSummary::empty(label, code));
        self.code_of.insert(label, code);
        Ok(code)
    }

    fn finish(mut self) -> Result<LabelImage, VolumeError> {
        let (found, expected) = (self.codes.len(), self.grid.voxel_count());
        if found != expected {
            return Err(VolumeError::Incomplete { found, expected });
        }
        self.summaries.remove(0);
        self.summaries.sort_by_key(|s| s.label);
        Ok(LabelImage { grid: self.grid, labels: self.labels, codes: self.codes, summaries: self.summaries })
    }
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
        Self { label, voxels: 0, bounds: IndexBox::EMPTY, code }
    }

    fn add_run(&mut self, start: usize, length: usize, y: usize, z: usize) {
        self.voxels += length as u64;
        let run = IndexBox::new(
            [start as i64, y as i64, z as i64],
            [(start + length) as i64, y as i64 + 1, z as i64 + 1],
        );
        self.bounds = self.bounds.hull(&run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Samples;

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
