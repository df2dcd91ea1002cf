//! NumPy arrays. They hold no spacing: the caller gives it.
//!
//! The header is read by `npyz`; voxels are decoded in bulk here, since that crate does it one by one.

use super::ReadError;
use super::header::{
    ByteOrder, DataOffset, Encoding, Format, ImageHeader, OpenedFile, VoxelData, open_file, three_dimensions,
};
use crate::volume::ScalarType;
use npyz::{DType, Endianness, NpyHeader, Order, TypeChar};
use std::io::{BufReader, Seek};
use std::path::Path;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: "NumPy", reason: reason.into() }
}

/// Reads the header of a .npy file: in C order the last axis is x, in Fortran order the first.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let (file, _) = open_file(path)?;
    let mut reader = BufReader::new(file);
    let header = NpyHeader::from_reader(&mut reader)
        .map_err(|e| error(format!("{e}; save the array again with numpy.save")))?;
    let offset = reader.stream_position().map_err(|e| ReadError::io(path, e))?;
    let mut shape = header.shape().iter().map(|&n| n as usize).collect::<Vec<_>>();
    // Axes of one element in front, as of a batch or channel, are dropped.
    if header.order() == Order::C {
        shape.reverse();
    }
    let (scalar, order) = voxel_type(&header.dtype())?;
    Ok(ImageHeader {
        path: path.to_owned(),
        format: Format::Npy,
        dimensions: three_dimensions(&shape)?,
        scalar,
        affine: None,
        stated_spacing: None,
        other_spacing: None,
        data: VoxelData {
            path: path.to_owned(),
            opened: OpenedFile::default(),
            encoding: Encoding::Raw,
            offset: DataOffset::Stored(offset),
            order,
            scaling: None,
        },
    })
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
