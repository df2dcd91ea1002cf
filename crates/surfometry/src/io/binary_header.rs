//! Numbers at known places of a binary header.

use super::ReadError;
use super::header::ByteOrder;

/// The first bytes of a file, whose numbers are all of one byte order.
pub(super) struct BinaryHeader {
    format: &'static str,
    bytes: Vec<u8>,
    order: ByteOrder,
}

impl BinaryHeader {
    /// Of at least `needed` bytes.
    ///
    /// # Errors
    /// [`ReadError::Header`] where there are fewer.
    pub(super) fn new(
        format: &'static str,
        bytes: Vec<u8>,
        order: ByteOrder,
        needed: usize,
    ) -> Result<Self, ReadError> {
        if bytes.len() >= needed {
            return Ok(Self { format, bytes, order });
        }
        let reason = format!(
            "the file ends after {} bytes, its header alone has {needed}; copy or export it again",
            bytes.len()
        );
        Err(ReadError::Header { format, reason })
    }

    /// N bytes at a place; zeros behind the end, which [`Self::new`] has ruled out for what is needed.
    pub(super) fn bytes<const N: usize>(&self, at: usize) -> [u8; N] {
        self.bytes.get(at..at + N).and_then(|bytes| bytes.try_into().ok()).unwrap_or([0; N])
    }

    fn number<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = self.bytes(at);
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    pub(super) fn i16(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.number(at))
    }

    pub(super) fn i32(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.number(at))
    }

    pub(super) fn i64(&self, at: usize) -> i64 {
        i64::from_le_bytes(self.number(at))
    }

    pub(super) fn f32(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.number(at))
    }

    /// Voxels along an axis out of what is stored.
    ///
    /// # Errors
    /// [`ReadError::Header`] for a negative number.
    pub(super) fn size(&self, field: &str, stored: i64) -> Result<usize, ReadError> {
        usize::try_from(stored).map_err(|_| {
            let reason =
                format!("{field} is {stored}, not a number of voxels; copy or export the file again");
            ReadError::Header { format: self.format, reason }
        })
    }
}
