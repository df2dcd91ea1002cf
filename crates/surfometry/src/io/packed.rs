//! Files that hold a header, compressed as a whole or not: gzip or bzip2 around any format.

use super::header::{ByteOrder, DataOffset, Encoding, OpenedFile, VoxelData};
use super::members::Member;
use super::timed_file::Timed;
use super::{ReadError, encoding};
use bzip2::bufread::BzDecoder;
use flate2::bufread::GzDecoder;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// So far the end of a compressed file is looked for behind its voxels.
const MOST_BEHIND: u64 = 1 << 28;
/// Bytes that tell how a file is compressed.
const MAGIC: u64 = 10;
/// How the first block of a bzip2 stream begins, behind its magic and a digit for its blocks' size.
const BZIP2_BLOCK: &[u8] = &[0x31, 0x41, 0x59, 0x26, 0x53, 0x59];

/// An open file, and how it is compressed as a whole.
#[derive(Debug)]
pub(crate) struct Packed {
    path: PathBuf,
    file: File,
    encoding: Encoding,
}

impl Packed {
    /// Opens a file and looks at its first bytes.
    pub(crate) fn open(path: &Path) -> Result<Self, ReadError> {
        let (mut file, _) = open_file(path)?;
        let mut magic = Vec::new();
        let read = (&file).take(MAGIC).read_to_end(&mut magic).and_then(|_| file.rewind());
        read.map_err(|e| ReadError::io(path, e))?;
        let packed = Self { path: path.to_owned(), file, encoding: encoding_of(&magic) };
        packed.refuse_twice()?;
        Ok(packed)
    }

    /// Whoever compressed a file twice hardly knows: what comes out is no image, which would be called damaged.
    fn refuse_twice(&self) -> Result<(), ReadError> {
        if !self.is_packed() {
            return Ok(());
        }
        match encoding_of(&self.start(MAGIC)?.0) {
            Encoding::Raw => Ok(()),
            inner => {
                let (outer, inner) = (name_of(self.encoding), name_of(inner));
                Err(ReadError::PackedAgain { path: self.path.clone(), outer, inner })
            }
        }
    }

    /// Whether the whole file is compressed.
    pub(crate) fn is_packed(&self) -> bool {
        self.encoding != Encoding::Raw
    }

    /// Bytes of the file as it is.
    pub(crate) fn stored_bytes(&self) -> Result<u64, ReadError> {
        Ok(self.file.metadata().map_err(|e| ReadError::io(&self.path, e))?.len())
    }

    /// The first bytes, unpacked, at most `limit`; of a stream that is damaged, those before the damage, and the error.
    pub(crate) fn start(&self, limit: u64) -> Result<(Vec<u8>, Option<io::Error>), ReadError> {
        let mut bytes = Vec::new();
        let outcome = self.decoder(self.rewound()?).take(limit).read_to_end(&mut bytes);
        match outcome {
            Err(error) if !self.is_packed() => Err(ReadError::io(&self.path, error)),
            outcome => Ok((bytes, outcome.err())),
        }
    }

    /// The whole file, unpacked, from its beginning.
    pub(crate) fn into_reader(self) -> Result<Box<dyn Read + Send>, ReadError> {
        Ok(self.decoder(self.rewound()?))
    }

    /// A handle of the file, at its beginning; both have one place in it.
    fn rewound(&self) -> Result<File, ReadError> {
        let mut file = self.file.try_clone().map_err(|e| ReadError::io(&self.path, e))?;
        file.rewind().map_err(|e| ReadError::io(&self.path, e))?;
        Ok(file)
    }

    fn decoder(&self, file: File) -> Box<dyn Read + Send> {
        let stored = BufReader::new(Timed::new(file, &Arc::default()));
        encoding::decoder(self.encoding, stored)
    }

    /// The voxels behind a header in the same file, from byte `at` of the unpacked file on; `inner` is how they are
    /// compressed themselves.
    pub(crate) fn data(self, at: u64, inner: Encoding, order: ByteOrder) -> Result<VoxelData, ReadError> {
        let (encoding, offset) = match (self.encoding, inner) {
            (Encoding::Raw, inner) => (inner, DataOffset::Stored(at)),
            (outer, Encoding::Raw) => (outer, DataOffset::Decoded(at)),
            _ => return Err(ReadError::PackedTwice),
        };
        let opened = OpenedFile::keep(self.file);
        Ok(VoxelData { path: self.path, opened, encoding, offset, order, scaling: None })
    }
}

fn encoding_of(magic: &[u8]) -> Encoding {
    if magic.starts_with(GzDecoder::<_>::MAGIC) {
        Encoding::Gzip
    } else if magic.starts_with(BzDecoder::<_>::MAGIC) && magic.get(4..) == Some(BZIP2_BLOCK) {
        Encoding::Bzip2
    } else {
        Encoding::Raw
    }
}

fn name_of(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Raw => "raw",
        Encoding::Gzip => "gzip",
        Encoding::Zlib => "zlib",
        Encoding::Bzip2 => "bzip2",
    }
}

/// Opens a file, and says how many bytes it has. A pipe, a device or a folder is refused before it is
/// touched: opening a pipe waits for who writes to it.
pub(crate) fn open_file(path: &Path) -> Result<(File, u64), ReadError> {
    let failed = |e| ReadError::io(path, e);
    let metadata = path.metadata().map_err(failed)?;
    if !metadata.is_file() {
        return Err(ReadError::not_a_file(path, &metadata));
    }
    Ok((File::open(path).map_err(failed)?, metadata.len()))
}

/// Bytes of what is handed on at most.
const MOST_HANDED_ON: u64 = 1 << 28;

/// The bytes of a file, or of what a shell hands on in its place: standard input, or `<(..)`, which is a pipe that somebody
/// writes to. Any other pipe or device is refused: nobody may ever write to it, and it may never end.
pub(crate) fn read_handed_on(path: &Path) -> io::Result<Vec<u8>> {
    let handed_on = ["/dev/stdin", "/dev/fd", "/proc/self/fd"].iter().any(|place| path.starts_with(place));
    let (is_file, mut bytes) = (path.metadata()?.is_file(), Vec::new());
    let refused = |reason| Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    if !is_file && !handed_on {
        return refused(
            "it is a folder, a pipe or a device, and no file: write what comes out of it to one first",
        );
    }
    File::open(path)?.take(if is_file { u64::MAX } else { MOST_HANDED_ON }).read_to_end(&mut bytes)?;
    if !is_file && bytes.len() as u64 == MOST_HANDED_ON {
        return refused("it goes on and on: write it to a file first");
    }
    Ok(bytes)
}

/// The text of a small file; `Err` inside where it is none. Pipes and devices are refused.
pub(crate) fn read_text(path: &Path) -> Result<Result<String, std::string::FromUtf8Error>, ReadError> {
    let (mut file, _) = open_file(path)?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|e| ReadError::io(path, e))?;
    Ok(String::from_utf8(bytes))
}

/// Reads the start of a file, unpacked, at most `limit` bytes.
pub(crate) fn read_start(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    Ok(Packed::open(path)?.start(limit)?.0)
}

/// Some bytes of a file, counted as it is unpacked.
pub(crate) struct PackedStretch {
    path: PathBuf,
    bytes: io::Take<BufReader<Box<dyn Read + Send>>>,
}

impl PackedStretch {
    /// The bytes from `at` on, `size` of them.
    pub(crate) fn open(path: &Path, at: u64, size: u64) -> Result<Self, ReadError> {
        let whole = BufReader::new(Packed::open(path)?.into_reader()?).take(at);
        let mut stretch = Self { path: path.to_owned(), bytes: whole };
        stretch.skip(at)?;
        stretch.bytes.set_limit(size);
        Ok(stretch)
    }

    /// Leaves bytes out.
    pub(crate) fn skip(&mut self, bytes: u64) -> Result<(), ReadError> {
        let skipped = io::copy(&mut self.bytes.by_ref().take(bytes), &mut io::sink());
        skipped.map(drop).map_err(|e| ReadError::damaged(&self.path, &e))
    }

    /// The next bytes; `None` where there are fewer. Memory grows as they arrive.
    pub(crate) fn bytes(&mut self, count: usize) -> Result<Option<Vec<u8>>, ReadError> {
        let bytes = self.some(count)?;
        Ok((bytes.len() == count).then_some(bytes))
    }

    /// The next few bytes; `None` where there are fewer.
    pub(crate) fn array<const N: usize>(&mut self) -> Result<Option<[u8; N]>, ReadError> {
        let mut array = [0; N];
        match self.bytes.read_exact(&mut array) {
            Ok(()) => Ok(Some(array)),
            Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
            Err(e) => Err(ReadError::damaged(&self.path, &e)),
        }
    }

    /// Some of the next bytes, at most so many; none at the end.
    pub(crate) fn some(&mut self, most: usize) -> Result<Vec<u8>, ReadError> {
        let mut bytes = Vec::new();
        let read = self.bytes.by_ref().take(most as u64).read_to_end(&mut bytes);
        read.map(|_| bytes).map_err(|e| ReadError::damaged(&self.path, &e))
    }

    /// The bytes that are left.
    pub(crate) fn into_reader(self) -> impl Read + Send {
        self.bytes
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Behind the last voxel: nothing may be left of the stretch.
    pub(crate) fn end(&mut self) -> Result<(), ReadError> {
        if self.array::<1>()?.is_some() {
            return Err(ReadError::damaged(&self.path, &"more of them than the header's voxels take"));
        }
        self.drain()
    }

    /// Reads the file to its end, where decoders compare their checksums.
    pub(crate) fn drain(&mut self) -> Result<(), ReadError> {
        self.bytes.set_limit(MOST_BEHIND);
        self.skip(MOST_BEHIND)
    }
}
