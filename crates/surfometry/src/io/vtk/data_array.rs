//! The voxels of XML image data: text, or bytes with their number in front, as they are, in base64, or deflated in
//! blocks.

use super::image_data::error;
use crate::io::ReadError;
use crate::io::assembled::{AssembleVoxels, Pieces};
use crate::io::base64_text::Base64Text;
use crate::io::header::ByteOrder;
use crate::io::packed::PackedStretch;
use crate::io::text_numbers::TextNumbers;
use crate::volume::ScalarType;
use flate2::read::ZlibDecoder;
use std::io::Read;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// Bytes that are taken at once of those that are not compressed.
const AT_ONCE: u64 = 1 << 20;
/// More than any writer's blocks, which are unpacked one by one, and more of them than any image has.
const LARGEST_BLOCK: u64 = 1 << 28;
const MOST_BLOCKS: u64 = 1 << 24;

/// How voxels are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    Base64,
    Raw,
}

/// Where and how.
#[derive(Debug)]
pub(super) struct DataArray {
    pub(super) path: PathBuf,
    pub(super) at: u64,
    pub(super) size: u64,
    pub(super) form: Form,
    pub(super) compressed: bool,
    /// Whether numbers in front of the bytes have 64 bits.
    pub(super) wide: bool,
    pub(super) order: ByteOrder,
    pub(super) scalar: ScalarType,
    pub(super) voxels: u64,
}

type Bytes = Box<dyn Read + Send>;

impl DataArray {
    fn bytes(&self) -> u64 {
        self.voxels.saturating_mul(self.scalar.bytes() as u64)
    }

    /// A number in front of the bytes.
    fn number(&self, stored: &mut Bytes) -> Result<u64, ReadError> {
        let mut bytes = [0; 8];
        let width = if self.wide { 8 } else { 4 };
        stored.read_exact(&mut bytes[..width]).map_err(|e| ReadError::damaged(&self.path, &e))?;
        if self.order == ByteOrder::Big {
            bytes[..width].reverse();
        }
        Ok(u64::from_le_bytes(bytes))
    }

    /// The sizes of the blocks: unpacked and packed.
    fn blocks(&self, stored: &mut Bytes) -> Result<Vec<(u64, u64)>, ReadError> {
        let [count, size, last] = [self.number(stored)?, self.number(stored)?, self.number(stored)?];
        let whole = if last == 0 { count } else { count.saturating_sub(1) };
        if count > self.bytes().min(MOST_BLOCKS)
            || whole.checked_mul(size).and_then(|bytes| bytes.checked_add(last)) != Some(self.bytes())
        {
            return Err(error(format!(
                "{count} blocks of {size} bytes and {last} in the last, where the voxels take {}; copy or export the image again",
                self.bytes()
            )));
        }
        if size.max(last) > LARGEST_BLOCK || size % self.scalar.bytes() as u64 != 0 {
            return Err(error(format!(
                "blocks of {size} bytes; save the image with zlib's usual ones, or without"
            )));
        }
        let mut blocks = Vec::new();
        for block in 0..count {
            blocks.push((if block < whole { size } else { last }, self.number(stored)?));
        }
        Ok(blocks)
    }

    /// A block's voxels.
    fn block(&self, stored: &mut Bytes, (size, packed): (u64, u64)) -> Result<Vec<u8>, ReadError> {
        let damaged = |reason: &dyn std::fmt::Display| ReadError::damaged(&self.path, &reason.to_string());
        let mut voxels = Vec::new();
        let mut stored = stored.take(packed);
        ZlibDecoder::new(&mut stored).take(size + 1).read_to_end(&mut voxels).map_err(|e| damaged(&e))?;
        std::io::copy(&mut stored, &mut std::io::sink()).map_err(|e| damaged(&e))?;
        if voxels.len() as u64 == size {
            Ok(voxels)
        } else {
            Err(damaged(&format!("a block of {} bytes, not {size}", voxels.len())))
        }
    }

    fn in_order(&self, voxels: Vec<u8>) -> Vec<u8> {
        self.order.to_little(voxels, self.scalar.bytes())
    }

    /// The bytes behind the encoding.
    fn stored(&self) -> Result<Bytes, ReadError> {
        let stored = PackedStretch::open(&self.path, self.at, self.size)?.into_reader();
        if self.form == Form::Raw { Ok(Box::new(stored)) } else { Ok(Box::new(Base64Text::new(stored))) }
    }

    fn binary(self: &Arc<Self>) -> Result<Bytes, ReadError> {
        let (mut stored, of) = (self.stored()?, Arc::clone(self));
        if self.compressed {
            let mut blocks = self.blocks(&mut stored)?.into_iter();
            return Ok(Box::new(Pieces::new(move || {
                let block = blocks.next().map(|block| of.block(&mut stored, block)).transpose()?;
                Ok(block.map(|voxels| of.in_order(voxels)))
            })));
        }
        let size = self.number(&mut stored)?;
        if size != self.bytes() {
            return Err(error(format!(
                "{size} bytes of voxels, where Extent and type need {}; export the image again",
                self.bytes()
            )));
        }
        let mut stored = stored.take(size);
        Ok(Box::new(Pieces::new(move || {
            let mut voxels = Vec::new();
            let read = stored.by_ref().take(AT_ONCE).read_to_end(&mut voxels);
            read.map_err(|e| ReadError::damaged(&of.path, &e))?;
            Ok((!voxels.is_empty()).then(|| of.in_order(voxels)))
        })))
    }
}

/// What a header shares with each reading of its voxels.
#[derive(Debug)]
pub(super) struct SharedArray(pub(super) Arc<DataArray>);

impl AssembleVoxels for SharedArray {
    fn files(&self) -> Vec<PathBuf> {
        vec![self.0.path.clone()]
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        if self.0.form == Form::Text {
            let stored = PackedStretch::open(&self.0.path, self.0.at, self.0.size)?;
            let mut numbers = TextNumbers::new(stored, self.0.scalar, self.0.voxels);
            return Ok(Box::new(Pieces::new(move || numbers.next())));
        }
        self.0.binary()
    }
}
