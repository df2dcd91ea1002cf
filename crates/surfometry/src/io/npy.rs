//! NumPy arrays. They hold no spacing: the caller gives it.
//!
//! The header is read by `npyz`; voxels are decoded in bulk here, since that crate does it one by one.

use super::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use super::packed::Packed;
use super::{Format, ReadError};
use crate::volume::ScalarType;
use npyz::{DType, Endianness, NpyHeader, Order, TypeChar};
use std::io::Cursor;
use std::path::Path;

/// Longer than any header (2^16 bytes in version 1); bounds what is read of a file that is none.
const LONGEST: u64 = 1 << 20;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: "NumPy", reason: reason.into() }
}

/// Reads the header of a .npy file: in C order the last axis is x, in Fortran order the first.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let file = Packed::open(path)?;
    let mut start = Cursor::new(file.start(LONGEST)?.0);
    let header = NpyHeader::from_reader(&mut start)
        .map_err(|e| error(format!("{e}; save the array again with numpy.save")))?;
    let mut shape = header.shape().iter().map(|&n| n as usize).collect::<Vec<_>>();
    if header.order() == Order::C {
        shape.reverse();
    }
    // Axes of one element, as of a batch or channel, are dropped on either side of three.
    let single = shape.iter().take_while(|n| **n == 1).count();
    let shape = &shape[single.min(shape.len().saturating_sub(3))..];
    let (scalar, order) = voxel_type(&header.dtype())?;
    let dimensions = three_dimensions(shape)?;
    let data = Voxels::Stored(file.data(start.position(), Encoding::Raw, order)?);
    Ok(ImageHeader::new(path, Format::Npy, dimensions, scalar, data))
}

fn voxel_type(dtype: &DType) -> Result<(ScalarType, ByteOrder), ReadError> {
    let unsupported = || ReadError::VoxelType(format!("NumPy {}", dtype.descr()));
    let DType::Plain(plain) = dtype else { return Err(unsupported()) };
    let scalar = match (plain.type_char(), plain.size_field()) {
        (TypeChar::Uint | TypeChar::Bool, 1) => ScalarType::U8,
        (TypeChar::Int, 1) => ScalarType::I8,
        (TypeChar::Uint, 2) => ScalarType::U16,
        (TypeChar::Int, 2) => ScalarType::I16,
        (TypeChar::Uint, 4) => ScalarType::U32,
        (TypeChar::Int, 4) => ScalarType::I32,
        (TypeChar::Uint, 8) => ScalarType::U64,
        (TypeChar::Int, 8) => ScalarType::I64,
        (TypeChar::Float, 4) => ScalarType::F32,
        (TypeChar::Float, 8) => ScalarType::F64,
        _ => return Err(unsupported()),
    };
    let order = if plain.endianness() == Endianness::Big { ByteOrder::Big } else { ByteOrder::Little };
    Ok((scalar, order))
}
