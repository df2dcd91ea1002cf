//! How long a file takes, apart from what is made of its bytes.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A file that adds up how long reading it takes.
pub(super) struct Timed {
    file: File,
    nanoseconds: Arc<AtomicU64>,
}

impl Timed {
    /// Adds to `nanoseconds` whatever reading takes from now on.
    pub(super) fn new(file: File, nanoseconds: &Arc<AtomicU64>) -> Self {
        Self { file, nanoseconds: Arc::clone(nanoseconds) }
    }
}

impl Read for Timed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let start = Instant::now();
        let outcome = self.file.read(buffer);
        self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        outcome
    }
}

impl Seek for Timed {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.file.seek(position)
    }
}
