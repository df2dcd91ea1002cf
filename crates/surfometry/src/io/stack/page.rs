//! One page: how its pixels are stored, and what comes of them.

use crate::io::ReadError;
use crate::volume::ScalarType;
use std::path::Path;

/// Size and type of a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Page {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Bits of a pixel: 1, 2, 4, or those of its type.
    pub(super) bits: u8,
    pub(super) scalar: ScalarType,
}

impl Page {
    /// Of the type that so many bits have; `None` where there is none.
    pub(super) fn of(size: [usize; 2], bits: u8, number: Number) -> Option<Self> {
        let scalar = match (bits, number) {
            (1 | 2 | 4 | 8, Number::Unsigned) => ScalarType::U8,
            (16, Number::Unsigned) => ScalarType::U16,
            (32, Number::Unsigned) => ScalarType::U32,
            (64, Number::Unsigned) => ScalarType::U64,
            (8, Number::Signed) => ScalarType::I8,
            (16, Number::Signed) => ScalarType::I16,
            (32, Number::Signed) => ScalarType::I32,
            (64, Number::Signed) => ScalarType::I64,
            (32, Number::Float) => ScalarType::F32,
            (64, Number::Float) => ScalarType::F64,
            _ => return None,
        };
        Some(Self { width: size[0], height: size[1], bits, scalar })
    }

    /// Whether its numbers are whole and have no sign.
    pub(super) fn is_unsigned(&self) -> bool {
        matches!(self.scalar, ScalarType::U8 | ScalarType::U16 | ScalarType::U32 | ScalarType::U64)
    }

    /// Bytes of its voxels.
    pub(super) fn bytes(&self) -> usize {
        self.width * self.height * self.scalar.bytes()
    }

    /// A byte a pixel, where a byte holds several: each row begins a byte, the first pixel is its highest bits.
    pub(super) fn unpacked(&self, stored: Vec<u8>) -> Vec<u8> {
        if self.bits >= 8 {
            return stored;
        }
        let (bits, mask) = (usize::from(self.bits), (1u8 << self.bits) - 1);
        let a_byte = 8 / bits;
        let pixel = |row: &[u8], x: usize| row[x / a_byte] >> (8 - bits * (x % a_byte + 1)) & mask;
        let rows = stored.chunks_exact(self.width.div_ceil(a_byte)).take(self.height);
        rows.flat_map(|row| (0..self.width).map(move |x| pixel(row, x))).collect()
    }

    /// The same as another one.
    ///
    /// # Errors
    /// [`ReadError::Header`], which names the page.
    pub(super) fn expect_same(&self, first: &Self, name: &dyn std::fmt::Display) -> Result<(), ReadError> {
        if self == first {
            return Ok(());
        }
        let told = |page: &Self| format!("{} x {} of {} bits", page.width, page.height, page.bits);
        Err(error(format!(
            "{name} is {}, the first one {}: the slices of a stack are alike; take out what is none of them",
            told(self),
            told(first)
        )))
    }
}

/// How a pixel's bits are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Unsigned,
    Signed,
    Float,
}

pub(super) fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: "TIFF or PNG", reason: reason.into() }
}

/// Of pixels that are colours.
pub(super) fn colours(path: &Path, kind: &str) -> ReadError {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    error(format!(
        "{name} has {kind} pixels, which are no labels: save the label image itself, in grey values of 8 or 16 bits (in Fiji: Image > Type)"
    ))
}
