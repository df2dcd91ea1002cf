//! Compressed streams one after another, as gzip and bzip2 files may hold them.

use super::timed_file::Timed;
use bzip2::bufread::BzDecoder;
use flate2::bufread::GzDecoder;
use std::io::{self, BufRead, BufReader, Read};

type Stored = BufReader<Timed>;

/// A decoder of one stream, which compares its checksums at the end and leaves what follows unread.
pub(super) trait Member: Read + Sized {
    /// How every stream begins.
    const MAGIC: &'static [u8];

    /// Begins at the next stored byte.
    fn begin(stored: Stored) -> Self;

    /// What follows the stream.
    fn into_stored(self) -> Stored;
}

impl Member for GzDecoder<Stored> {
    const MAGIC: &'static [u8] = &[0x1f, 0x8b];

    fn begin(stored: Stored) -> Self {
        Self::new(stored)
    }

    fn into_stored(self) -> Stored {
        self.into_inner()
    }
}

impl Member for BzDecoder<Stored> {
    const MAGIC: &'static [u8] = b"BZh";

    fn begin(stored: Stored) -> Self {
        Self::new(stored)
    }

    fn into_stored(self) -> Stored {
        self.into_inner()
    }
}

/// All streams of a file as one. What follows a whole stream and does not begin as another does is padding,
/// as it is to the tools of both formats; the crates' own decoders of several streams take it for damage.
pub(super) struct Members<D> {
    /// `None` behind the last one.
    current: Option<D>,
}

impl<D: Member> Members<D> {
    pub(super) fn new(stored: Stored) -> Self {
        Self { current: Some(D::begin(stored)) }
    }
}

impl<D: Member> Read for Members<D> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while let Some(member) = &mut self.current {
            let read = member.read(buffer)?;
            if read > 0 || buffer.is_empty() {
                return Ok(read);
            }
            self.current = self.current.take().map(D::into_stored).map_or(Ok(None), next_member)?;
        }
        Ok(0)
    }
}

fn next_member<D: Member>(mut stored: Stored) -> io::Result<Option<D>> {
    skip_zeros(&mut stored)?;
    let mut start = Vec::with_capacity(D::MAGIC.len());
    stored.by_ref().take(D::MAGIC.len() as u64).read_to_end(&mut start)?;
    stored.seek_relative(-(start.len() as i64))?;
    Ok((start == D::MAGIC).then(|| D::begin(stored)))
}

fn skip_zeros(stored: &mut Stored) -> io::Result<()> {
    loop {
        let buffered = stored.fill_buf()?;
        let zeros = buffered.iter().take_while(|byte| **byte == 0).count();
        let done = zeros < buffered.len() || buffered.is_empty();
        stored.consume(zeros);
        if done {
            return Ok(());
        }
    }
}
