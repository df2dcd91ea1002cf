//! A label image as slabs again, with some of its voxels changed on the way.

use super::{Grid, LabelImage, Samples, Slab, SlabReader, VolumeError, collected, slices_a_slab};
use std::borrow::Cow;
use std::ops::Range;

/// A run of voxels that become background, or, where they are background, a label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LabelRewrite {
    start: usize,
    end: usize,
    y: usize,
    z: usize,
    /// What they become; 0 is background.
    pub(crate) label: i64,
}

impl LabelRewrite {
    /// Of a run that is half-open in x, in row y of slice z of the image.
    pub(crate) fn new((start, end): (i64, i64), y: i64, z: i64, label: i64) -> Self {
        let [start, end, y, z] = [start, end, y, z].map(|v| v as usize);
        Self { start, end, y, z, label }
    }

    pub(crate) fn voxels(&self) -> u64 {
        (self.end - self.start) as u64
    }

    fn write(&self, row: &mut [i64]) {
        for voxel in &mut row[self.start..self.end] {
            if self.label == 0 || *voxel == 0 {
                *voxel = self.label;
            }
        }
    }
}

impl LabelImage {
    /// The image with runs of it changed, one after the other.
    pub(crate) fn rewritten(&self, mut rewrites: Vec<LabelRewrite>) -> Result<Self, VolumeError> {
        // Within a slice they keep their order.
        rewrites.sort_by_key(|rewrite| rewrite.z);
        Self::from_slabs(&mut LabelSlabs { image: Cow::Borrowed(self), rewrites, next: 0 })
    }
}

/// A label image as slabs.
pub(crate) struct LabelSlabs<'a> {
    image: Cow<'a, LabelImage>,
    /// In order of slice.
    rewrites: Vec<LabelRewrite>,
    next: usize,
}

impl LabelSlabs<'static> {
    /// As it is.
    pub(crate) fn of(image: LabelImage) -> Self {
        Self { image: Cow::Owned(image), rewrites: Vec::new(), next: 0 }
    }
}

impl LabelSlabs<'_> {
    fn rewrites_of(&self, slices: &Range<usize>) -> &[LabelRewrite] {
        let place = |z: usize| self.rewrites.partition_point(|rewrite| rewrite.z < z);
        &self.rewrites[place(slices.start)..place(slices.end)]
    }
}

impl SlabReader for LabelSlabs<'_> {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        self.image.grid()
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        let dimensions = self.grid().dimensions();
        let [nx, ny, nz] = dimensions;
        if self.next == nz {
            return Ok(None);
        }
        let slices = self.next..(self.next + slices_a_slab(dimensions, size_of::<i64>())).min(nz);
        let all = std::iter::repeat_n(0, nx * ny * slices.len());
        let mut voxels = collected(all).map_err(|_| VolumeError::TooLarge { dimensions })?;
        for (slice, z) in voxels.chunks_mut(nx * ny).zip(slices.clone()) {
            for (y, row) in slice.chunks_mut(nx).enumerate() {
                for (run, label) in self.image.labelled_runs(y, z) {
                    row[run].fill(label);
                }
            }
        }
        for rewrite in self.rewrites_of(&slices) {
            let first = ((rewrite.z - slices.start) * ny + rewrite.y) * nx;
            rewrite.write(&mut voxels[first..first + nx]);
        }
        self.next = slices.end;
        Ok(Some(Slab { slices, samples: Samples::I64(voxels) }))
    }
}
