//! What tells an input's content apart from any other.

use crate::inputs::Source;
use crate::io::{HashedFile, sha256_text};
use sha2::{Digest, Sha256};
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};

/// `None` of files of which one cannot be read any more.
type Hashed = Option<Vec<HashedFile>>;

/// SHA-256 of an input's files, worked out once, beside whatever else is done with it.
#[derive(Debug)]
pub(crate) struct Fingerprint {
    files: Vec<PathBuf>,
    hashing: Mutex<Option<JoinHandle<Hashed>>>,
    known: OnceLock<Hashed>,
}

impl Fingerprint {
    /// Of an input; nothing is read yet.
    pub(super) fn of(source: &dyn Source) -> Self {
        Self { files: source.files(), hashing: Mutex::default(), known: OnceLock::new() }
    }

    /// Of what lies in no file.
    pub(super) fn none() -> Self {
        Self { files: Vec::new(), hashing: Mutex::default(), known: OnceLock::new() }
    }

    /// Begins, for who will ask for it.
    pub(super) fn begin(&self) {
        let mut hashing = self.hashing.lock().unwrap_or_else(PoisonError::into_inner);
        if hashing.is_none() && self.known.get().is_none() && !self.files.is_empty() {
            let files = self.files.clone();
            *hashing = Some(thread::spawn(move || hashed(&files)));
        }
    }

    /// The files one by one, where all can be read still; waits for them.
    pub(super) fn files(&self) -> Option<&[HashedFile]> {
        let wait = || {
            let begun = self.hashing.lock().unwrap_or_else(PoisonError::into_inner).take();
            begun.and_then(|hashing| hashing.join().ok()).unwrap_or_else(|| hashed(&self.files))
        };
        self.known.get_or_init(wait).as_deref()
    }

    /// In digits, of several files that of their digests, a line each in their order; none of what lies in no file, or in
    /// one that cannot be read any more.
    pub(super) fn text(&self) -> Option<String> {
        match self.files()? {
            [] => None,
            [file] => Some(file.sha256.clone()),
            several => {
                let mut all = Sha256::new();
                for file in several {
                    all.update(format!("{}\n", file.sha256));
                }
                Some(sha256_text(all))
            }
        }
    }
}

fn hashed(files: &[PathBuf]) -> Hashed {
    files.iter().map(|file| HashedFile::of(file).ok()).collect()
}
