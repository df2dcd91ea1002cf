//! Pixels of one bit, as programs pack them.

use super::error;
use crate::io::ReadError;

/// Where the bits of each frame begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct BitLayout {
    pixels: usize,
    /// Bits from one frame to the next.
    stride: usize,
}

impl BitLayout {
    /// By how many bytes there are: frames run on without a gap, as the standard has it, or each begins a byte or, of
    /// MeVisLab's of old, two.
    ///
    /// # Errors
    /// A length that fits none of these.
    pub(super) fn of(pixels: usize, frames: usize, bytes: usize) -> Result<Self, ReadError> {
        let strides = [pixels, pixels.next_multiple_of(8), pixels.next_multiple_of(16)];
        let needed = |stride: usize| (stride * frames).div_ceil(8);
        // Elements have even lengths.
        let fits = |stride: &usize| bytes == needed(*stride) || bytes == needed(*stride).next_multiple_of(2);
        match strides.into_iter().find(fits) {
            Some(stride) => Ok(Self { pixels, stride }),
            None => Err(error(format!(
                "{bytes} bytes of pixels, where {frames} frames of {pixels} bits take {}, or {} with each frame in whole bytes: the file is \
                 truncated or packed otherwise; export it again",
                needed(strides[0]),
                needed(strides[1])
            ))),
        }
    }

    /// A frame's pixels, 0 or 1; the lowest bit of a byte is the first.
    pub(super) fn frame(&self, bytes: &[u8], number: usize) -> Vec<u8> {
        let first = number * self.stride;
        (first..first + self.pixels)
            .map(|bit| bytes.get(bit / 8).map_or(0, |byte| byte >> (bit % 8) & 1))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three frames of 15 pixels of which pixel n of frame f is set where (n + f) % 3 is 0, packed with a stride.
    fn packed(stride: usize) -> Vec<u8> {
        let mut bytes = vec![0u8; (stride * 3).div_ceil(8).next_multiple_of(2)];
        for frame in 0..3 {
            for pixel in (0..15).filter(|pixel| (pixel + frame) % 3 == 0) {
                let bit = frame * stride + pixel;
                bytes[bit / 8] |= 1 << (bit % 8);
            }
        }
        bytes
    }

    #[test]
    fn layouts_are_told_by_length() {
        for stride in [15, 16] {
            let bytes = packed(stride);
            let layout = BitLayout::of(15, 3, bytes.len());
            if stride == 15 {
                // 45 bits and 48 take six bytes: as the standard has it.
                assert_eq!(layout.unwrap(), BitLayout { pixels: 15, stride: 15 });
            }
        }
        assert_eq!(BitLayout::of(20, 5, 13).unwrap().stride, 20);
        assert_eq!(BitLayout::of(20, 5, 14).unwrap().stride, 20);
        assert_eq!(BitLayout::of(20, 5, 15).unwrap().stride, 24);
        assert_eq!(BitLayout::of(20, 5, 16).unwrap().stride, 24);
        assert_eq!(BitLayout::of(20, 5, 20).unwrap().stride, 32);
        for bytes in [0, 12, 17, 19, 21] {
            assert!(BitLayout::of(20, 5, bytes).is_err(), "{bytes}");
        }
        let layout = BitLayout::of(15, 3, 6).unwrap();
        let expected: Vec<u8> = (0..15).map(|pixel| u8::from((pixel + 2) % 3 == 0)).collect();
        assert_eq!(layout.frame(&packed(15), 2), expected);
    }
}
