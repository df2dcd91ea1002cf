//! Voxels that are written as text.

use super::ReadError;
use super::packed::PackedStretch;
use crate::volume::ScalarType;

/// How many bytes of text are looked at together.
const AT_ONCE: usize = 1 << 16;

/// Numbers between white space, as many as there are voxels.
pub(super) struct TextNumbers {
    stored: PackedStretch,
    scalar: ScalarType,
    /// Whether bytes are written as shares of 255.
    shares: bool,
    left: u64,
    /// The beginning of a number whose end was not read yet.
    begun: Vec<u8>,
}

impl TextNumbers {
    pub(super) fn new(stored: PackedStretch, scalar: ScalarType, voxels: u64) -> Self {
        Self { stored, scalar, shares: false, left: voxels, begun: Vec::new() }
    }

    /// Bytes that are written as shares of 255, as VTK does with colours.
    pub(super) fn shares(stored: PackedStretch, voxels: u64) -> Self {
        Self { shares: true, ..Self::new(stored, ScalarType::U8, voxels) }
    }

    /// The next voxels, little-endian; `None` where there are no more of them, or no more text.
    pub(super) fn next(&mut self) -> Result<Option<Vec<u8>>, ReadError> {
        let mut voxels = Vec::new();
        while voxels.is_empty() && self.left > 0 {
            let text = self.stored.some(AT_ONCE)?;
            let ended = text.is_empty();
            self.begun.extend(text);
            // What white space does not end yet may go on.
            let end = match self.begun.iter().rposition(u8::is_ascii_whitespace) {
                _ if ended => self.begun.len(),
                Some(last) => last,
                None if self.begun.len() > AT_ONCE => return Err(self.not_a_number(&self.begun)),
                None => continue,
            };
            let rest = self.begun.split_off(end);
            let whole = std::mem::replace(&mut self.begun, rest);
            let words = whole.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            for word in words.take(self.left as usize) {
                let pushed = if self.shares {
                    push_share(&mut voxels, word)
                } else {
                    push(&mut voxels, self.scalar, word)
                };
                if !pushed {
                    return Err(self.not_a_number(word));
                }
                self.left -= 1;
            }
            if ended {
                break;
            }
        }
        if voxels.is_empty() {
            self.stored.drain()?;
        }
        Ok((!voxels.is_empty()).then_some(voxels))
    }

    fn not_a_number(&self, word: &[u8]) -> ReadError {
        let word = String::from_utf8_lossy(&word[..word.len().min(20)]).into_owned();
        ReadError::damaged(
            self.stored.path(),
            &format!("`{}` is no {} number", word.escape_default(), self.scalar.name()),
        )
    }
}

fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Puts a byte behind others that is written as a share of 255; false where the word is none.
fn push_share(voxels: &mut Vec<u8>, word: &[u8]) -> bool {
    let share = number::<f64>(word).filter(|share| (0.0..=1.0).contains(share));
    share.map(|share| voxels.push((share * 255.0).round() as u8)).is_some()
}

/// Puts a number behind others; false where the word is none of the type.
fn push(voxels: &mut Vec<u8>, scalar: ScalarType, word: &[u8]) -> bool {
    let bytes = match scalar {
        ScalarType::U8 => number::<u8>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::I8 => number::<i8>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::U16 => number::<u16>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::I16 => number::<i16>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::U32 => number::<u32>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::I32 => number::<i32>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::U64 => number::<u64>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::I64 => number::<i64>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::F32 => number::<f32>(word).map(|v| v.to_le_bytes().to_vec()),
        ScalarType::F64 => number::<f64>(word).map(|v| v.to_le_bytes().to_vec()),
    };
    bytes.map(|bytes| voxels.extend(bytes)).is_some()
}
