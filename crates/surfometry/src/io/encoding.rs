//! Decoders of voxel data.

use super::ReadError;
use super::header::{DataOffset, Encoding, VoxelData};
use super::members::Members;
use super::timed_file::Timed;
use bzip2::bufread::BzDecoder;
use flate2::bufread::{GzDecoder, ZlibDecoder};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// Reads ahead in pieces that keep system calls few.
const BUFFER: usize = 1 << 18;

/// Opens voxel data, positioned at the first voxel. `bytes` is how many the header promises: raw data are
/// checked against the file's size before anything is read. `spent` adds up the nanoseconds that the file
/// itself takes.
pub(crate) fn open(
    data: &VoxelData,
    bytes: u64,
    spent: &Arc<AtomicU64>,
) -> Result<Box<dyn Read + Send>, ReadError> {
    let io_error = |e| ReadError::io(&data.path, e);
    let (mut file, size) = data.file()?;
    let (start, skip) = match data.offset {
        DataOffset::Stored(start) => (start, 0),
        DataOffset::Decoded(skip) => (0, skip),
        DataOffset::FromEnd => (size.saturating_sub(bytes), 0),
    };
    let available = size.saturating_sub(start).saturating_sub(skip);
    if data.encoding == Encoding::Raw && available < bytes {
        return Err(ReadError::Truncated { found: available, expected: bytes });
    }
    file.seek(SeekFrom::Start(start)).map_err(io_error)?;
    let stored = BufReader::with_capacity(BUFFER, Timed::new(file, spent));
    let mut decoded = decoder(data.encoding, stored);
    io::copy(&mut decoded.by_ref().take(skip), &mut io::sink())
        .map_err(|source| ReadError::Decompression { found: 0, expected: bytes, source })?;
    Ok(decoded)
}

/// What stored bytes are decoded to.
pub(crate) fn decoder(encoding: Encoding, stored: BufReader<Timed>) -> Box<dyn Read + Send> {
    match encoding {
        Encoding::Raw => Box::new(stored),
        Encoding::Gzip => Box::new(Members::<GzDecoder<_>>::new(stored)),
        Encoding::Zlib => Box::new(ZlibDecoder::new(stored)),
        Encoding::Bzip2 => Box::new(Members::<BzDecoder<_>>::new(stored)),
    }
}
