//! Buffers of numbers, least significant byte first, as every binary format here stores them.

use std::io::{self, Write};

/// Values in single precision.
pub(super) fn write_f32(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|&v| out.write_all(&(v as f32).to_le_bytes()))
}

/// Values in double precision.
pub(super) fn write_f64(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

/// Vertex numbers in 32 bits; the document's check keeps them below 2^31, so that they are the same signed.
pub(super) fn write_indices(out: &mut dyn Write, triangles: &[[u32; 3]]) -> io::Result<()> {
    triangles.as_flattened().iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}
