//! Images arrive as slabs of whole slices, so that no reader ever has to hold one.

use super::{Grid, Samples, VolumeError};
use rayon::prelude::*;
use std::ops::Range;
use std::time::Duration;

/// Some consecutive z slices of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Slab {
    /// The z indices that it covers.
    pub slices: Range<usize>,
    /// Their voxels, x fastest, then y, then z.
    pub samples: Samples,
}

/// A source of an image, front to back.
pub trait SlabReader {
    /// What reading can end in.
    type Error: From<VolumeError>;

    /// The image's lattice.
    fn grid(&self) -> &Grid;

    /// The next slab, in order of z without gaps; `None` after the last slice.
    ///
    /// # Errors
    /// Whatever keeps the source from delivering.
    fn next_slab(&mut self) -> Result<Option<Slab>, Self::Error>;

    /// How long a file has taken to yield its bytes so far, decompression left out; nothing where there is no
    /// file.
    fn file_time(&self) -> Duration {
        Duration::ZERO
    }
}

impl<R: SlabReader + ?Sized> SlabReader for Box<R> {
    type Error = R::Error;

    fn grid(&self) -> &Grid {
        (**self).grid()
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, R::Error> {
        (**self).next_slab()
    }

    fn file_time(&self) -> Duration {
        (**self).file_time()
    }
}

/// The next slab of an image that is made slice by slice, of which `next` is the first; `slice` fills one
/// with its voxels, which are 0 before.
pub(crate) fn made_slab(
    dimensions: [usize; 3],
    next: &mut usize,
    slice: impl Fn(usize, &mut [u8]) + Sync,
) -> Result<Option<Slab>, VolumeError> {
    let first = *next;
    if first == dimensions[2] {
        return Ok(None);
    }
    let last = (first + slices_a_slab(dimensions, 1)).min(dimensions[2]);
    let size = dimensions[0] * dimensions[1];
    let mut voxels = Vec::new();
    let all = size * (last - first);
    voxels.try_reserve_exact(all).map_err(|_| VolumeError::TooLarge { dimensions })?;
    voxels.resize(all, 0);
    voxels.par_chunks_mut(size).zip(first..last).for_each(|(voxels, z)| slice(z, voxels));
    *next = last;
    Ok(Some(Slab { slices: first..last, samples: Samples::U8(voxels) }))
}

/// Voxels of a slice, and of all slices, beyond which nobody waits for an image to be made: 32,768 squared,
/// 4096 cubed.
const MOST_MADE: [usize; 2] = [1 << 30, 1 << 36];

/// Refuses what would take days to make, or a slice that fills the memory.
pub(crate) fn check_made(dimensions: [usize; 3]) -> Result<(), VolumeError> {
    let slice = dimensions[0].saturating_mul(dimensions[1]);
    if slice > MOST_MADE[0] || slice.saturating_mul(dimensions[2]) > MOST_MADE[1] {
        return Err(VolumeError::TooMuchToMake { dimensions });
    }
    Ok(())
}

/// Most slices of a slab: each takes some hundred bytes while it is made into runs.
const MOST_SLICES: usize = 1 << 12;

/// Slices a slab should hold so that it stays near 8 MiB: large enough to share its slices among threads,
/// small against any image.
pub fn slices_a_slab(dimensions: [usize; 3], bytes_a_voxel: usize) -> usize {
    let slice = dimensions[0] * dimensions[1] * bytes_a_voxel;
    ((8 << 20) / slice.max(1)).clamp(1, MOST_SLICES).min(dimensions[2])
}
