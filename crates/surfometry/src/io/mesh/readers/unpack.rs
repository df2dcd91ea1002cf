//! The bytes of a mesh's file, unpacked.

use super::super::super::ReadError;
use super::super::super::header::open_file;
use super::super::super::members::{Member, Members};
use super::super::super::timed_file::Timed;
use bzip2::bufread::BzDecoder;
use flate2::bufread::GzDecoder;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::sync::Arc;

/// Bytes that so many packed ones may become: no mesh is packed better, and whoever packed zeros to fill the memory does
/// not.
pub(super) fn most_unpacked(packed: usize) -> usize {
    (64 << 20) + packed.saturating_mul(100)
}

/// All bytes of a file, which may be packed by gzip or bzip2, whatever its name says.
pub(super) fn contents(path: &Path, format: &'static str) -> Result<Vec<u8>, ReadError> {
    let opened = Opened::new(path)?;
    let refused = |reason| ReadError::Mesh { format, reason };
    let most = opened.size.map_or(u64::MAX, |size| most_unpacked(size) as u64);
    let packed = opened.size.is_some();
    let mut bytes = Vec::new();
    opened.bytes.take(most).read_to_end(&mut bytes).map_err(|error| {
        if packed {
            refused(format!("the compressed data are damaged ({error})"))
        } else {
            ReadError::io(path, error)
        }
    })?;
    if bytes.len() as u64 == most {
        return Err(refused(format!("more than {most} bytes are packed in the file: unpack it first")));
    }
    Ok(bytes)
}

/// The first bytes of a file that [`contents`] would read, as many as there are.
pub(super) fn beginning(path: &Path, limit: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    // What was read before an error is its beginning still.
    let _ = Opened::new(path).map(|opened| opened.bytes.take(limit).read_to_end(&mut bytes));
    bytes
}

struct Opened {
    bytes: Box<dyn Read>,
    /// Of a packed file.
    size: Option<usize>,
}

impl Opened {
    fn new(path: &Path) -> Result<Self, ReadError> {
        let (file, size) = open_file(path)?;
        let mut stored = BufReader::new(Timed::new(file, &Arc::default()));
        let start = stored.fill_buf().map_err(|error| ReadError::io(path, error))?;
        let (gzip, bzip2) = (GzDecoder::<_>::MAGIC, BzDecoder::<_>::MAGIC);
        let size = (start.starts_with(gzip) || start.starts_with(bzip2)).then_some(size as usize);
        let bytes: Box<dyn Read> = if start.starts_with(gzip) {
            Box::new(Members::<GzDecoder<_>>::new(stored))
        } else if start.starts_with(bzip2) {
            Box::new(Members::<BzDecoder<_>>::new(stored))
        } else {
            Box::new(stored)
        };
        Ok(Self { bytes, size })
    }
}
