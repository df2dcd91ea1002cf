//! Scanco AIM: images of IPL, versions 010 to 030, as numbers, packed bits or run lengths.
//!
//! # References
//! The layout is that of AimIO (MIT), <https://github.com/Numerics88/AimIO>. There are no directions: the axes are
//! taken for those of the world, and `pos` for the place of the first voxel, in voxels. Values are as they are
//! stored, without the calibration of the processing log.

use super::aim_voxels::{AimVoxels, Coding};
use super::assembled::Assembled;
use super::binary_header::BinaryHeader;
use super::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use super::packed::Packed;
use super::{Format, ReadError};
use crate::volume::{Affine, ScalarType};
use std::path::Path;
use std::sync::Arc;

const MAGIC_030: &[u8] = b"AIMDATA_V030";
/// More than any header has.
const LONGEST: u64 = 512;
const NM_PER_MM: f64 = 1e6;
/// Voxels of a border that is not stored; IPL's are a few.
const MOST_BORDER: usize = 255;

pub(super) fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::Aim.name(), reason: reason.into() }
}

/// Reads the header of an .aim file.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let file = Packed::open(path)?;
    let start = file.start(LONGEST)?.0;
    let blocks = Blocks::of(start)?;
    let image = blocks.image()?;
    let dimensions = three_dimensions(&image.dimensions)?;
    let voxels = dimensions.iter().try_fold(1u64, |product, &n| product.checked_mul(n as u64));
    let voxels = voxels.ok_or_else(|| error("dim is too large; copy or export the file again"))?;
    let (scalar, coding) = storage(image.storage)?;
    let size = blocks.data_size;
    let data = match coding {
        None => {
            if voxels.checked_mul(scalar.bytes() as u64) != Some(size) {
                return Err(error(format!(
                    "{size} bytes of voxels, where dim {dimensions:?} of type {} needs another number; copy or export the file again",
                    scalar.name()
                )));
            }
            Voxels::Stored(file.data(blocks.data, Encoding::Raw, ByteOrder::Little)?)
        }
        Some(coding) => {
            let border = image.border(dimensions)?;
            let (path, at, wide) = (path.to_owned(), blocks.data, blocks.wide);
            let voxels = AimVoxels { path, at, size, coding, dimensions, border, wide };
            voxels.check()?;
            Voxels::Assembled(Assembled(Arc::new(voxels)))
        }
    };
    let origin = std::array::from_fn(|a| image.position[a] as f64 * image.spacing[a]);
    let affine = Affine { origin, ..Affine::diagonal(image.spacing) };
    Ok(ImageHeader {
        affine: Some(affine),
        stated_spacing: Some(image.spacing),
        ..ImageHeader::new(path, Format::Aim, dimensions, scalar, data)
    })
}

/// Where the parts of a file are: a list of sizes, then the image's header, the processing log, the voxels.
struct Blocks {
    header: BinaryHeader,
    /// Whether sizes have 64 bits, as since version 030.
    wide: bool,
    image: usize,
    image_size: u64,
    data: u64,
    data_size: u64,
}

impl Blocks {
    fn of(start: Vec<u8>) -> Result<Self, ReadError> {
        let wide = start.starts_with(MAGIC_030);
        let (first, width) = if wide { (16, 8) } else { (0, 4) };
        let header = BinaryHeader::new(Format::Aim.name(), start, ByteOrder::Little, 112)?;
        let stored = |entry: usize| {
            let at = first + entry * width;
            let size = if wide { header.i64(at) } else { i64::from(header.i32(at)) };
            u64::try_from(size)
                .map_err(|_| error(format!("a part of {size} bytes; copy or export the file again")))
        };
        let list = stored(0)?;
        // Its own size, then at least those of header, log and voxels.
        if !(4 * width as u64..=8 * width as u64).contains(&list) {
            return Err(error("no list of sizes in front; is this a Scanco AIM file?"));
        }
        let image = first as u64 + list;
        let (image_size, log, data_size) = (stored(1)?, stored(2)?, stored(3)?);
        let data = image.checked_add(image_size).and_then(|end| end.checked_add(log));
        let data = data.ok_or_else(|| error("parts of impossible sizes; copy or export the file again"))?;
        Ok(Self { header, wide, image: image as usize, image_size, data, data_size })
    }

    /// The image's header, whose size tells its version.
    fn image(&self) -> Result<ImageFields, ReadError> {
        let (header, at) = (&self.header, self.image);
        let narrow = |from: usize| [0, 4, 8].map(|further| i64::from(header.i32(at + from + further)));
        let long = |from: usize| [0, 8, 16].map(|further| header.i64(at + from + further));
        let vax = |from: usize| f64::from(vax_float(header.bytes(at + from)));
        let kind = |from: usize| header.i32(at + from);
        let of = |storage, position, dimensions: [i64; 3], border, spacing| {
            let sizes = dimensions.iter().map(|&n| header.size("dim", n)).collect::<Result<_, _>>()?;
            Ok(ImageFields { storage, position, dimensions: sizes, border, spacing })
        };
        match (self.wide, self.image_size) {
            (true, 224) => {
                let spacing = long(184).map(|nm| nm as f64 / NM_PER_MM);
                of(kind(12), long(16), long(40), long(64), spacing)
            }
            (false, 140) => {
                let spacing = [108, 112, 116].map(vax);
                of(kind(20), narrow(24), narrow(36), narrow(48), spacing)
            }
            // Versions 010 and 011 have one spacing for all axes.
            (false, 92 | 96) => of(kind(16), narrow(56), narrow(20), narrow(32), [vax(68); 3]),
            (_, size) => Err(error(format!(
                "an image header of {size} bytes, where versions 010 to 030 have 92, 96, 140 or 224; export the image again"
            ))),
        }
    }
}

/// What the image's header says, of any version.
struct ImageFields {
    storage: i32,
    position: [i64; 3],
    dimensions: Vec<usize>,
    border: [i64; 3],
    spacing: [f64; 3],
}

impl ImageFields {
    /// Voxels of background on either side that run lengths leave out.
    fn border(&self, dimensions: [usize; 3]) -> Result<[usize; 3], ReadError> {
        let fits = |a: usize| {
            let border = usize::try_from(self.border[a]).ok()?;
            (border <= MOST_BORDER && 2 * border < dimensions[a]).then_some(border)
        };
        match [fits(0), fits(1), fits(2)] {
            [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
            _ => Err(error(format!(
                "off {:?} leaves nothing of dim {dimensions:?}; copy or export the file again",
                self.border
            ))),
        }
    }
}

/// The type of the voxels, and how they are put together, where they are not stored one by one.
fn storage(code: i32) -> Result<(ScalarType, Option<Coding>), ReadError> {
    Ok(match code {
        0x0001_0001 => (ScalarType::I8, None),
        0x0002_0002 => (ScalarType::I16, None),
        0x0004_0004 | 0x001a_0004 => (ScalarType::F32, Some(Coding::VaxFloats)),
        0x0006_0001 => (ScalarType::I8, Some(Coding::PackedBits)),
        0x0015_0001 => (ScalarType::I8, Some(Coding::TwoValuedRuns)),
        0x0008_0002 => (ScalarType::I8, Some(Coding::ValuedRuns)),
        other => return Err(ReadError::VoxelType(format!("Scanco AIM {other:#x}"))),
    })
}

/// The F-float of a VAX: halves swapped, and an exponent that is larger by two.
pub(super) fn vax_float([a, b, c, d]: [u8; 4]) -> f32 {
    f32::from_le_bytes([c, d, a, b]) / 4.0
}
