//! How pixels are stored.

use super::data_set::{DataSet, Elements};
use super::error;
use crate::io::ReadError;
use crate::volume::ScalarType;
use dicom_dictionary_std::tags;

/// How the pixels of a file are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PixelLayout {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) frames: usize,
    /// Bits that a pixel takes.
    pub(super) allocated: usize,
    /// Bits of them that count, the lowest.
    stored: u32,
    signed: bool,
}

impl PixelLayout {
    /// Of a file with one number a pixel.
    ///
    /// # Errors
    /// Colours, floats, sizes that are missing or make no sense.
    pub(super) fn of(data_set: &DataSet) -> Result<Self, ReadError> {
        refuse_floats(data_set)?;
        let number = |tag, name: &str| {
            let value = data_set.whole_number(tag).and_then(|value| usize::try_from(value).ok());
            value.ok_or_else(|| {
                error(format!("no {name}; the file holds no image, or is damaged: export it again"))
            })
        };
        let samples = data_set.whole_number(tags::SAMPLES_PER_PIXEL).unwrap_or(1);
        let meaning = data_set.text(tags::PHOTOMETRIC_INTERPRETATION).unwrap_or_default();
        if samples != 1 || meaning == "PALETTE COLOR" {
            return Err(error(format!(
                "{samples} values a pixel, {meaning} (a colour picture): export the original series, not screenshots"
            )));
        }
        let allocated = number(tags::BITS_ALLOCATED, "BitsAllocated (0028,0100)")?;
        let stored = number(tags::BITS_STORED, "BitsStored (0028,0101)")?;
        if !matches!(allocated, 1 | 8 | 16 | 32) || stored == 0 || stored > allocated {
            return Err(error(format!(
                "{stored} of {allocated} bits a pixel are not read; 1, 8, 16 and 32 are"
            )));
        }
        let frames = data_set.whole_number(tags::NUMBER_OF_FRAMES).unwrap_or(1);
        let frames = usize::try_from(frames).ok().filter(|frames| *frames > 0);
        let layout = Self {
            columns: number(tags::COLUMNS, "Columns (0028,0011)")?,
            rows: number(tags::ROWS, "Rows (0028,0010)")?,
            frames: frames.ok_or_else(|| error("NumberOfFrames (0028,0008) is no positive number"))?,
            allocated,
            stored: stored as u32,
            signed: data_set.whole_number(tags::PIXEL_REPRESENTATION) == Some(1),
        };
        if layout.columns == 0 || layout.rows == 0 { Err(error("an image of no pixels")) } else { Ok(layout) }
    }

    /// Whether frames of two files are stored alike.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        Self { frames: other.frames, ..*self } == *other
    }

    /// Type of the numbers.
    pub(super) fn scalar(&self) -> ScalarType {
        match (self.allocated, self.signed) {
            (16, false) => ScalarType::U16,
            (16, true) => ScalarType::I16,
            (32, false) => ScalarType::U32,
            (32, true) => ScalarType::I32,
            (_, false) => ScalarType::U8,
            (_, true) => ScalarType::I8,
        }
    }

    /// Pixels of a frame.
    pub(super) fn pixels(&self) -> usize {
        self.columns * self.rows
    }

    /// Bytes of a frame whose pixels take whole bytes.
    pub(super) fn frame_bytes(&self) -> usize {
        self.pixels() * self.allocated / 8
    }

    /// A frame's bytes, of which the bits that do not count follow the sign.
    pub(super) fn frame(&self, pixels: &[u8], number: usize) -> Result<Vec<u8>, ReadError> {
        let bytes = self.frame_bytes();
        let frame = pixels.get(number * bytes..(number + 1) * bytes);
        let mut frame = frame.map(<[u8]>::to_vec).ok_or_else(|| self.truncated(pixels.len()))?;
        if (self.stored as usize) < self.allocated {
            let width = self.allocated / 8;
            frame.chunks_exact_mut(width).for_each(|pixel| self.drop_spare_bits(pixel));
        }
        Ok(frame)
    }

    fn drop_spare_bits(&self, pixel: &mut [u8]) {
        let mut wide = [0; 4];
        wide[..pixel.len()].copy_from_slice(pixel);
        let spare = 32 - self.stored;
        let raised = u32::from_le_bytes(wide) << spare;
        let value = if self.signed { (raised as i32 >> spare) as u32 } else { raised >> spare };
        pixel.copy_from_slice(&value.to_le_bytes()[..pixel.len()]);
    }

    pub(super) fn truncated(&self, found: usize) -> ReadError {
        ReadError::Truncated { found: found as u64, expected: (self.frame_bytes() * self.frames) as u64 }
    }
}

/// Refuses an image that has floats in the place of pixels, as parametric maps have.
fn refuse_floats(data_set: &DataSet) -> Result<(), ReadError> {
    let elements = [
        (tags::FLOAT_PIXEL_DATA, "FloatPixelData (7FE0,0008)"),
        (tags::DOUBLE_FLOAT_PIXEL_DATA, "DoubleFloatPixelData (7FE0,0009)"),
    ];
    match elements.into_iter().find(|(tag, _)| data_set.elements().get(*tag).is_some()) {
        Some((_, name)) => Err(error(format!(
            "an image of floats ({name}), as parametric maps are, which is not read as labels; save the labels as whole numbers or as a \
             segmentation, or the image as NIfTI"
        ))),
        None => Ok(()),
    }
}
