//! Scanco ISQ: reconstructions of micro-CT scanners, and segmentations in the same form.
//!
//! # References
//! The layout is that of AimIO (MIT), <https://github.com/Numerics88/AimIO>. There are no directions: the axes are
//! taken for those of the world. Values are as they are stored, without the scanner's calibration.

use super::binary_header::BinaryHeader;
use super::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use super::packed::Packed;
use super::{Format, ReadError};
use crate::volume::{Affine, ScalarType};
use std::path::Path;

/// Bytes of the first header, and of each of those that may follow it.
const BLOCK: usize = 512;
const MAGIC: &[u8; 16] = b"CTDATA-HEADER_V1";
const UM_PER_MM: f64 = 1000.0;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::Isq.name(), reason: reason.into() }
}

/// Reads the header of an .isq file. `nr_of_bytes` is not looked at: it overflows above 2 GiB.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let file = Packed::open(path)?;
    let fields =
        BinaryHeader::new(Format::Isq.name(), file.start(BLOCK as u64)?.0, ByteOrder::Little, BLOCK)?;
    if fields.bytes(0) != *MAGIC {
        return Err(error("no CTDATA-HEADER_V1 in front; is this a Scanco ISQ file?"));
    }
    let voxels = [44, 48, 52].map(|at| i64::from(fields.i32(at)));
    let sizes: Vec<usize> = voxels.iter().map(|&n| fields.size("dim_p", n)).collect::<Result<_, _>>()?;
    let dimensions = three_dimensions(&sizes)?;
    let lengths = [56, 60, 64].map(|at| f64::from(fields.i32(at)));
    let spacing: [f64; 3] = std::array::from_fn(|a| lengths[a] / dimensions[a] as f64 / UM_PER_MM);
    let offset = u64::try_from(fields.i32(508))
        .map_err(|_| error("data_offset is negative; copy or export the file again"))?;
    let data = file.data((1 + offset) * BLOCK as u64, Encoding::Raw, ByteOrder::Little)?;
    Ok(ImageHeader {
        affine: Some(Affine::diagonal(spacing)),
        stated_spacing: Some(spacing),
        ..ImageHeader::new(path, Format::Isq, dimensions, ScalarType::I16, Voxels::Stored(data))
    })
}
