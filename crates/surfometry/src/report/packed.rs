//! Numbers for the viewer: quantised, as differences, deflated, in base64. `viewer/packed.js` reads them.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use std::io::{self, Write};

/// Numbers of one object, one array after the other.
#[derive(Debug, Default)]
pub(super) struct Packer {
    bytes: Vec<u8>,
}

/// Whole numbers of a packer: bytes as they are; or the difference of each to the one before (in zigzag: 0, -1, 1, -2, ..),
/// all lowest bytes first, then the next higher ones.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Packed {
    offset: usize,
    count: usize,
    /// Of a number.
    bytes: usize,
}

/// Numbers low + step * whole number; [`MISSING`] stands for none.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Quantised {
    low: f64,
    step: f64,
    values: Packed,
}

/// The whole number of what has no value.
const MISSING: u32 = u16::MAX as u32;

impl Packer {
    fn differences(&mut self, bytes: usize, numbers: impl Iterator<Item = u32>) -> Packed {
        let mut last = 0u32;
        let zigzag = |number: u32| {
            let difference = number.wrapping_sub(last) as i32;
            last = number;
            ((difference << 1) ^ (difference >> 31)) as u32
        };
        let coded: Vec<u32> = numbers.map(zigzag).collect();
        let packed = Packed { offset: self.bytes.len(), count: coded.len(), bytes };
        for byte in 0..bytes {
            self.bytes.extend(coded.iter().map(|number| (number >> (8 * byte)) as u8));
        }
        packed
    }

    /// Numbers below 2^31.
    pub(super) fn integers(&mut self, numbers: impl Iterator<Item = u32>) -> Packed {
        self.differences(4, numbers)
    }

    /// Bytes as they are.
    pub(super) fn bytes(&mut self, numbers: &[u8]) -> Packed {
        let packed = Packed { offset: self.bytes.len(), count: numbers.len(), bytes: 1 };
        self.bytes.extend_from_slice(numbers);
        packed
    }

    /// Numbers to the nearest multiple of a step, or of a larger one where they spread too far for it; those that are
    /// not finite are missing.
    pub(super) fn quantised(&mut self, values: &[f64], step: f64) -> Quantised {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let low = finite().reduce(f64::min).unwrap_or_default();
        let high = finite().reduce(f64::max).unwrap_or_default();
        let step = step.max((high - low) / f64::from(MISSING - 1));
        let step = if step > 0.0 { step } else { 1.0 };
        let whole = |value: &f64| {
            if value.is_finite() { libm::round((value - low) / step) as u32 } else { MISSING }
        };
        let numbers: Vec<u32> = values.iter().map(whole).collect();
        Quantised { low, step, values: self.differences(3, numbers.into_iter()) }
    }

    /// A head that says where all is, and the numbers: the head's length in four bytes, it as JSON, the numbers.
    pub(super) fn finish(self, head: &impl Serialize) -> io::Result<String> {
        let head = serde_json::to_vec(head)?;
        let mut out = ZlibEncoder::new(Vec::new(), Compression::new(7));
        let all = [&(head.len() as u32).to_le_bytes()[..], &head, &self.bytes];
        all.into_iter().try_for_each(|part| out.write_all(part))?;
        Ok(BASE64_STANDARD.encode(out.finish()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    /// What the viewer does, in its few steps.
    fn unpacked(bytes: &[u8], packed: Packed) -> Vec<u32> {
        let mut last = 0u32;
        let place = |i: usize, byte: usize| packed.offset + byte * packed.count + i;
        let coded =
            |i: usize| (0..packed.bytes).map(|b| u32::from(bytes[place(i, b)]) << (8 * b)).sum::<u32>();
        (0..packed.count)
            .map(|i| {
                last = last.wrapping_add((coded(i) >> 1) ^ (coded(i) & 1).wrapping_neg());
                last
            })
            .collect()
    }

    #[test]
    fn numbers_come_back_to_half_a_step() {
        let mut packer = Packer::default();
        let values = [0.25, -3.0, f64::NAN, 1e3, 0.255];
        let quantised = packer.quantised(&values, 0.02);
        let indices = packer.integers([0, 70_000, 3].into_iter());
        let text = packer.finish(&"head").unwrap();
        let mut all = Vec::new();
        ZlibDecoder::new(&BASE64_STANDARD.decode(text).unwrap()[..]).read_to_end(&mut all).unwrap();
        assert_eq!(&all[..10], b"\x06\0\0\0\"head\"");
        let bytes = &all[10..];
        assert_eq!(unpacked(bytes, indices), [0, 70_000, 3]);
        let whole = unpacked(bytes, quantised.values);
        assert_eq!(whole[2], MISSING);
        for (value, whole) in values.iter().zip(whole).filter(|(value, _)| value.is_finite()) {
            let back = quantised.low + quantised.step * f64::from(whole);
            assert!((back - value).abs() <= 0.0101, "{value} {back}");
        }
    }

    #[test]
    fn one_value_and_none_are_no_trouble() {
        let mut packer = Packer::default();
        let one = packer.quantised(&[7.0], 0.0);
        assert_eq!((one.low, one.step), (7.0, 1.0));
        assert_eq!(packer.quantised(&[], 0.1).values.count, 0);
        assert_eq!(packer.quantised(&[f64::INFINITY], 0.1).low, 0.0);
    }
}
