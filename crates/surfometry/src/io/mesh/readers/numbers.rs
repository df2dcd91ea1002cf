//! Numbers out of bytes.

use super::super::super::header::ByteOrder;
use super::Outcome;
use crate::volume::ScalarType;

/// The number that the first bytes stand for; there must be enough of them.
#[expect(clippy::cast_lossless, reason = "one macro for all types, of which some are too wide")]
pub(super) fn number(scalar: ScalarType, order: ByteOrder, bytes: &[u8]) -> f64 {
    macro_rules! of {
        ($type:ty) => {{
            let bytes = *bytes.first_chunk().expect("as many bytes as the type has");
            match order {
                ByteOrder::Little => <$type>::from_le_bytes(bytes) as f64,
                ByteOrder::Big => <$type>::from_be_bytes(bytes) as f64,
            }
        }};
    }
    match scalar {
        ScalarType::U8 => of!(u8),
        ScalarType::I8 => of!(i8),
        ScalarType::U16 => of!(u16),
        ScalarType::I16 => of!(i16),
        ScalarType::U32 => of!(u32),
        ScalarType::I32 => of!(i32),
        ScalarType::U64 => of!(u64),
        ScalarType::I64 => of!(i64),
        ScalarType::F32 => of!(f32),
        ScalarType::F64 => of!(f64),
    }
}

/// All numbers of an array.
pub(super) fn numbers(scalar: ScalarType, order: ByteOrder, bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(scalar.bytes()).map(|bytes| number(scalar, order, bytes)).collect()
}

/// Numbers in threes.
pub(super) fn places(numbers: &[f64]) -> Outcome<&[[f64; 3]]> {
    match numbers.as_chunks() {
        (places, []) => Ok(places),
        _ => Err(format!("{} numbers are no points of three coordinates each", numbers.len())),
    }
}
