//! Consecutive slices of a label image as runs of labels.

use super::{Grid, Mask};
use crate::tiling::IndexBox;
use std::collections::VecDeque;

/// Neighbours of one label along x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Number of the label in the list of those that occur.
    pub(crate) code: u32,
}

/// The runs of one slice, background left out.
#[derive(Debug, Clone, Default)]
pub(crate) struct SliceRuns {
    /// First voxel and one past the last.
    spans: Vec<[u32; 2]>,
    codes: Codes,
    /// By row, one past its last run.
    ends: Vec<u32>,
}

/// Codes of a slice's runs: in most slices of a mask they are all the same.
#[derive(Debug, Clone)]
enum Codes {
    Same(u32),
    Each(Vec<u32>),
}

impl Default for Codes {
    fn default() -> Self {
        Self::Same(0)
    }
}

impl SliceRuns {
    pub(crate) fn push(&mut self, run: Run) {
        match &mut self.codes {
            Codes::Same(code) if self.spans.is_empty() => *code = run.code,
            Codes::Same(code) if *code == run.code => {}
            Codes::Same(code) => {
                let mut codes = vec![*code; self.spans.len()];
                codes.push(run.code);
                self.codes = Codes::Each(codes);
            }
            Codes::Each(codes) => codes.push(run.code),
        }
        self.spans.push([run.start, run.end]);
    }

    /// Ends the row to which runs were pushed.
    pub(crate) fn end_row(&mut self) {
        self.ends.push(u32::try_from(self.spans.len()).expect("a slice has fewer than 2^32 runs"));
    }

    /// Puts other codes in place of those that are there.
    pub(crate) fn recode(&mut self, codes: &[u32]) {
        match &mut self.codes {
            Codes::Same(code) => *code = codes[*code as usize],
            Codes::Each(each) => each.iter_mut().for_each(|code| *code = codes[*code as usize]),
        }
    }

    /// Gives back the memory that no run uses.
    pub(crate) fn shrink(&mut self) {
        self.spans.shrink_to_fit();
        if let Codes::Each(codes) = &mut self.codes {
            codes.shrink_to_fit();
        }
    }

    fn place(&self, y: usize) -> std::ops::Range<usize> {
        y.checked_sub(1).map_or(0, |before| self.ends[before] as usize)..self.ends[y] as usize
    }

    fn run(&self, number: usize) -> Run {
        let [start, end] = self.spans[number];
        let code = match &self.codes {
            Codes::Same(code) => *code,
            Codes::Each(codes) => codes[number],
        };
        Run { start, end, code }
    }

    fn row(&self, y: usize) -> impl Iterator<Item = Run> + '_ {
        self.place(y).map(|number| self.run(number))
    }

    fn code_at(&self, x: usize, y: usize) -> u32 {
        let place = self.place(y);
        let after = place.start + self.spans[place.clone()].partition_point(|span| span[0] as usize <= x);
        let before = (place.start..after).next_back().map(|number| self.run(number));
        before.filter(|run| x < run.end as usize).map_or(0, |run| run.code)
    }
}

/// Slices of an image or of a box of it, all or those that are in work. Segmentations are long runs of one
/// label, so that memory follows their surfaces.
#[derive(Debug, Clone)]
pub(crate) struct LabelRuns {
    grid: Grid,
    first_row: usize,
    first_slice: usize,
    slices: VecDeque<SliceRuns>,
}

impl LabelRuns {
    /// None yet, of a box of an image.
    pub(crate) fn new(grid: Grid, region: &IndexBox) -> Self {
        let [_, first_row, first_slice] = region.lower.map(|v| v as usize);
        Self { grid, first_row, first_slice, slices: VecDeque::new() }
    }

    /// Adds the next slice.
    pub(crate) fn push(&mut self, slice: SliceRuns) {
        self.slices.push_back(slice);
    }

    /// Forgets the slices before one.
    pub(crate) fn forget_before(&mut self, slice: usize) {
        while self.first_slice < slice && self.slices.pop_front().is_some() {
            self.first_slice += 1;
        }
    }

    /// One past the last slice.
    pub(crate) fn end(&self) -> usize {
        self.first_slice + self.slices.len()
    }

    fn slice(&self, z: usize) -> &SliceRuns {
        &self.slices[z - self.first_slice]
    }

    pub(super) fn row(&self, y: usize, z: usize) -> impl Iterator<Item = Run> + '_ {
        self.slice(z).row(y - self.first_row)
    }

    /// Code of the label at an index, 0 for background.
    pub(crate) fn code_at(&self, [x, y, z]: [usize; 3]) -> usize {
        self.slice(z).code_at(x, y - self.first_row) as usize
    }

    /// The box around the voxels of each label, by code, in the slices that are there.
    pub(crate) fn bounds(&self, codes: usize) -> Vec<IndexBox> {
        let mut bounds = vec![IndexBox::EMPTY; codes];
        for (z, slice) in (self.first_slice..).zip(&self.slices) {
            for row in 0..slice.ends.len() {
                for run in slice.row(row) {
                    let all = &mut bounds[run.code as usize];
                    *all = all.hull(&run.voxels(self.first_row + row, z));
                }
            }
        }
        bounds
    }

    /// The voxels of some labels in a box of the slices that are there, as one object; `codes` ascend.
    pub(crate) fn mask(&self, codes: &[usize], bounds: IndexBox) -> Mask {
        let is_member = |code: u32| match codes {
            [only] => code as usize == *only,
            _ => codes.binary_search(&(code as usize)).is_ok(),
        };
        Mask::from_runs(self.grid, bounds, |y, z| {
            self.row(y, z).filter(|run| is_member(run.code)).map(|run| (run.start as usize, run.end as usize))
        })
    }
}

impl Run {
    /// Its voxels in row y of slice z.
    pub(crate) fn voxels(&self, y: usize, z: usize) -> IndexBox {
        IndexBox::new(
            [i64::from(self.start), y as i64, z as i64],
            [i64::from(self.end), y as i64 + 1, z as i64 + 1],
        )
    }
}
