//! What tells an input's content apart from any other.

use crate::inputs::Source;
use crate::io::{hash_of_file, sha256_text};
use sha2::{Digest, Sha256};
use std::io;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};
use std::thread::{self, JoinHandle};

/// SHA-256 of an input's file, worked out beside whatever else is done with it. Of several files, that of their
/// digests, a line each in their order; none of what lies in no file, or in one that cannot be read any more.
#[derive(Debug)]
pub(super) struct Fingerprint {
    hashing: Mutex<Option<JoinHandle<Option<String>>>>,
    known: OnceLock<Option<String>>,
}

impl Fingerprint {
    /// Begins.
    pub(super) fn begin(source: &dyn Source) -> Self {
        let files = source.files();
        let hashing = (!files.is_empty()).then(|| thread::spawn(move || of_files(&files).ok()));
        Self { hashing: hashing.into(), known: OnceLock::new() }
    }

    /// Of what lies in no file.
    pub(super) fn none() -> Self {
        Self { hashing: None.into(), known: OnceLock::new() }
    }

    /// In digits; waits for it.
    pub(super) fn text(&self) -> Option<String> {
        let wait = || {
            let hashing = self.hashing.lock().ok().and_then(|mut hashing| hashing.take());
            hashing.and_then(|hashing| hashing.join().ok().flatten())
        };
        self.known.get_or_init(wait).clone()
    }
}

fn of_files(files: &[PathBuf]) -> io::Result<String> {
    if let [file] = files {
        return hash_of_file(file).map(|(digest, _)| digest);
    }
    let mut all = Sha256::new();
    for file in files {
        all.update(hash_of_file(file)?.0 + "\n");
    }
    Ok(sha256_text(all))
}
