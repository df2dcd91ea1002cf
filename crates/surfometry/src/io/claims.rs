//! Whether voxels can be so many: a header may claim what takes hours to read, or fills the memory.

use super::ReadError;
use super::header::{Encoding, ImageHeader, VoxelData, Voxels};

/// Bytes of a slice, which is held as a whole, that any file may have, and so many times those that are stored.
const ANY_SLICE: u64 = 1 << 28;
const SLICE_A_BYTE: u64 = 1 << 8;
/// The same of all voxels: nothing compresses labels so well, and no segmentation is so sparse.
const ANY_IMAGE: u64 = 1 << 32;
const IMAGE_A_BYTE: u64 = 1 << 16;

/// Compares what a header claims with the bytes that are there. Raw voxels are compared one by one, when they are opened.
pub(super) fn check_claim(header: &ImageHeader) -> Result<(), ReadError> {
    let stored = match &header.data {
        Voxels::Stored(VoxelData { encoding: Encoding::Raw, .. }) => return Ok(()),
        Voxels::Stored(data) => data.path.metadata().map_err(|e| ReadError::io(&data.path, e))?.len(),
        Voxels::Assembled(assembled) => assembled.0.stored_bytes(),
    };
    let (dimensions, image) = (header.dimensions, header.voxel_bytes());
    let within = |claimed: u64, any: u64, a_byte: u64| claimed <= any.max(stored.saturating_mul(a_byte));
    if within(image / dimensions[2].max(1) as u64, ANY_SLICE, SLICE_A_BYTE)
        && within(image, ANY_IMAGE, IMAGE_A_BYTE)
    {
        Ok(())
    } else {
        Err(ReadError::Claim { dimensions, stored })
    }
}
