//! FreeSurfer images: .mgh, and .mgz, which is the same with gzip around it. Big-endian always.
//!
//! # References
//! <https://surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat>. World coordinates are RAS; the header has
//! those of the image's middle, index n / 2 along each axis.

use super::binary_header::BinaryHeader;
use super::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use super::packed::Packed;
use super::{Format, ReadError};
use crate::volume::{Affine, ScalarType};
use std::path::Path;

/// Where the voxels begin.
const DATA: usize = 284;
/// Bytes of the header that say anything.
const HEADER: usize = 90;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::Mgh.name(), reason: reason.into() }
}

/// Reads the header of a .mgh or .mgz file.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let file = Packed::open(path)?;
    let start = file.start(DATA as u64)?.0;
    let fields = BinaryHeader::new(Format::Mgh.name(), start, ByteOrder::Big, HEADER)?;
    let version = fields.i32(0);
    if version != 1 {
        return Err(error(format!("version {version}, where 1 is known; is this a FreeSurfer image?")));
    }
    let sizes: Vec<usize> = [("width", 4), ("height", 8), ("depth", 12), ("nframes", 16)]
        .into_iter()
        .map(|(name, at)| fields.size(name, i64::from(fields.i32(at))))
        .collect::<Result<_, _>>()?;
    let dimensions = three_dimensions(&sizes)?;
    let data = Voxels::Stored(file.data(DATA as u64, Encoding::Raw, ByteOrder::Big)?);
    let spacing = [30, 34, 38].map(|at| f64::from(fields.f32(at)));
    // Without it the numbers that follow mean nothing: FreeSurfer takes 1 mm, which nobody measured.
    let known = fields.i16(28) == 1;
    Ok(ImageHeader {
        affine: known.then(|| affine(&fields, dimensions, spacing)),
        stated_spacing: known.then_some(spacing),
        ..ImageHeader::new(path, Format::Mgh, dimensions, scalar(fields.i32(20))?, data)
    })
}

fn scalar(code: i32) -> Result<ScalarType, ReadError> {
    Ok(match code {
        0 => ScalarType::U8,
        1 => ScalarType::I32,
        3 => ScalarType::F32,
        4 => ScalarType::I16,
        10 => ScalarType::U16,
        other => return Err(ReadError::VoxelType(format!("FreeSurfer {other}"))),
    })
}

fn affine(fields: &BinaryHeader, dimensions: [usize; 3], spacing: [f64; 3]) -> Affine {
    let vector = |at: usize| [0, 4, 8].map(|further| f64::from(fields.f32(at + further)));
    let directions = [42, 54, 66].map(vector);
    let centred = Affine::from_directions(directions, spacing, vector(78));
    // The middle is that of half of the voxels, not of half of the intervals.
    Affine { origin: centred.apply(dimensions.map(|n| -(n as f64) / 2.0)), ..centred }
}
