//! Voxels that are not one stretch of bytes: tiles, pages, a file a slice, packed bits. Their format puts them
//! together, piece by piece.

use super::ReadError;
use crate::volume::Segments;
use std::io::{self, Cursor, Read};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// Voxels that a format puts together itself.
pub(crate) trait AssembleVoxels: std::fmt::Debug + Send + Sync {
    /// The files that hold them.
    fn files(&self) -> Vec<PathBuf>;

    /// Bytes of what holds the voxels.
    fn stored_bytes(&self) -> u64 {
        self.files().iter().filter_map(|file| file.metadata().ok()).map(|file| file.len()).sum()
    }

    /// value = slope * stored + intercept.
    fn scaling(&self) -> Option<(f64, f64)> {
        None
    }

    /// Which segments the values stand for, as far as they were read, where segments may overlap.
    fn segments(&self) -> Option<Segments> {
        None
    }

    /// The bytes of the voxels, little-endian, x fastest, then y, then z; each call begins again. What fails on
    /// the way is a [`ReadError`] in an [`std::io::Error`] (`From`). `spent` adds up the nanoseconds that the
    /// files themselves take, where this is known.
    fn open(&self, spent: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError>;
}

/// Such voxels, shared.
#[derive(Debug, Clone)]
pub(crate) struct Assembled(pub(crate) Arc<dyn AssembleVoxels>);

/// The same voxels, not voxels that are the same.
impl PartialEq for Assembled {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Pieces one after the other, each made when it is wanted: slices, as a rule. `None` ends them.
pub(crate) struct Pieces<F> {
    next: F,
    piece: Cursor<Vec<u8>>,
}

impl<F: FnMut() -> Result<Option<Vec<u8>>, ReadError>> Pieces<F> {
    pub(crate) fn new(next: F) -> Self {
        Self { next, piece: Cursor::default() }
    }
}

impl<F: FnMut() -> Result<Option<Vec<u8>>, ReadError>> Read for Pieces<F> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let read = self.piece.read(buffer)?;
            if read > 0 || buffer.is_empty() {
                return Ok(read);
            }
            match (self.next)()? {
                Some(piece) => self.piece = Cursor::new(piece),
                None => return Ok(0),
            }
        }
    }
}
