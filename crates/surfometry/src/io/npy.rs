//! NumPy arrays. They hold no spacing: the caller gives it.
//!
//! # References
//! <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>: behind magic, version and length a
//! dictionary as Python writes it.

use super::header::{ByteOrder, Encoding, ImageHeader, Voxels, three_dimensions};
use super::packed::Packed;
use super::{Format, ReadError};
use crate::volume::ScalarType;
use py_literal::Value;
use std::path::Path;

const MAGIC: &[u8] = b"\x93NUMPY";
/// Longer than the header of any array of numbers, and deeper: bounds what its parser makes of a file that is none.
const LONGEST: usize = 1 << 16;
const DEEPEST: usize = 8;

fn error(reason: impl std::fmt::Display) -> ReadError {
    let reason = format!("{reason}; save the array again with numpy.save");
    ReadError::Header { format: "NumPy", reason }
}

/// Reads the header of a .npy file: in C order the last axis is x, in Fortran order the first.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let file = Packed::open(path)?;
    let start = file.start((LONGEST + 12) as u64)?.0;
    let (fields, end) = fields(&start)?;
    let of = |key: &str| {
        let is_it = |(name, _): &&(Value, Value)| name.as_string().is_some_and(|name| name == key);
        let found = fields.iter().find(is_it).map(|(_, value)| value);
        found.ok_or_else(|| error(format_args!("no '{key}' in its header")))
    };
    let mut shape = shape(of("shape")?)?;
    match of("fortran_order")? {
        Value::Boolean(true) => (),
        Value::Boolean(false) => shape.reverse(),
        other => {
            return Err(error(format_args!(
                "'fortran_order': {}, where True or False is expected",
                shown(other)
            )));
        }
    }
    // Axes of one element, as of a batch or channel, are dropped on either side of three.
    let single = shape.iter().take_while(|n| **n == 1).count();
    let shape = &shape[single.min(shape.len().saturating_sub(3))..];
    let (scalar, order) = voxel_type(of("descr")?)?;
    let dimensions = three_dimensions(shape)?;
    let data = Voxels::Stored(file.data(end as u64, Encoding::Raw, order)?);
    Ok(ImageHeader::new(path, Format::Npy, dimensions, scalar, data))
}

/// The header's dictionary, and where it ends.
fn fields(start: &[u8]) -> Result<(Vec<(Value, Value)>, usize), ReadError> {
    let cut = || error("the file ends within its header, or has a longer one than arrays of numbers");
    let rest = start
        .strip_prefix(MAGIC)
        .ok_or_else(|| error("no NumPy array: it does not begin with \\x93NUMPY"))?;
    let (length, at) = match *rest {
        [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 10),
        [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([a, b, c, d]) as usize, 12),
        [version, ..] if version == 0 || version > 3 => {
            return Err(error(format_args!("version {version} of the format, where 1 to 3 are known")));
        }
        _ => return Err(cut()),
    };
    let end = at + length;
    let text = start.get(at..end).filter(|_| length <= LONGEST).ok_or_else(cut)?;
    let text = std::str::from_utf8(text).map_err(|_| error("a header that is no UTF-8"))?.trim_end();
    if nesting(text) > DEEPEST {
        return Err(error(format_args!("a header of brackets in brackets, more than {DEEPEST} deep")));
    }
    match text.parse::<Value>() {
        Ok(Value::Dict(fields)) => Ok((fields, end)),
        Ok(other) => Err(error(format_args!("a header that is no dictionary: {}", shown(&other)))),
        Err(e) => Err(error(e)),
    }
}

/// The start of a value as Python writes it.
fn shown(value: &Value) -> String {
    value.format_ascii().unwrap_or_default().chars().take(60).collect()
}

/// How many brackets are open at once, at most.
fn nesting(text: &str) -> usize {
    let depths = text.bytes().scan(0usize, |depth, byte| {
        match byte {
            b'(' | b'[' | b'{' => *depth += 1,
            b')' | b']' | b'}' => *depth = depth.saturating_sub(1),
            _ => (),
        }
        Some(*depth)
    });
    depths.max().unwrap_or(0)
}

fn shape(value: &Value) -> Result<Vec<usize>, ReadError> {
    let wrong = || error(format_args!("'shape': {}, where sizes of axes are expected", shown(value)));
    let sizes = value.as_tuple().or(value.as_list()).ok_or_else(wrong)?;
    let size = |size: &Value| size.as_integer()?.to_string().parse().ok();
    sizes.iter().map(size).collect::<Option<_>>().ok_or_else(wrong)
}

/// By its letter and bytes, behind a byte order.
fn voxel_type(descr: &Value) -> Result<(ScalarType, ByteOrder), ReadError> {
    let unsupported = || ReadError::VoxelType(format!("NumPy {}", shown(descr)));
    let name = descr.as_string().ok_or_else(unsupported)?;
    let scalar = match name.trim_start_matches(['<', '>', '|', '=']) {
        "u1" | "b1" => ScalarType::U8,
        "i1" => ScalarType::I8,
        "u2" => ScalarType::U16,
        "i2" => ScalarType::I16,
        "u4" => ScalarType::U32,
        "i4" => ScalarType::I32,
        "u8" => ScalarType::U64,
        "i8" => ScalarType::I64,
        "f4" => ScalarType::F32,
        "f8" => ScalarType::F64,
        _ => return Err(unsupported()),
    };
    Ok((scalar, if name.starts_with('>') { ByteOrder::Big } else { ByteOrder::Little }))
}
