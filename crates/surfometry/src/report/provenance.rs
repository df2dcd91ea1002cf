//! Where a report comes from.

use crate::phantoms::Phantom;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io;
use std::time::SystemTime;

/// How, from what and by what a report was made.
#[derive(Debug, Clone, Serialize)]
pub struct Provenance {
    /// Version of surfometry.
    pub version: &'static str,
    /// The command as typed.
    pub command: String,
    /// When, UTC (RFC 3339).
    pub created: String,
    /// The inputs.
    pub sources: Vec<Source>,
}

impl Provenance {
    /// Of a command that starts now.
    pub fn new(command: String, sources: Vec<Source>) -> Self {
        let created = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        Self { version: env!("CARGO_PKG_VERSION"), command, created, sources }
    }
}

/// An input, so that it can be recognised.
#[derive(Debug, Clone, Serialize)]
pub struct Source {
    /// As named.
    pub input: String,
    /// SHA-256 of the file's bytes (of a detached header, of the header); `None` for a phantom, whose name says all.
    pub sha256: Option<String>,
    /// Length of the file, bytes.
    pub bytes: Option<u64>,
}

impl Source {
    /// Reads the file once.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn of(input: &str) -> io::Result<Self> {
        if Phantom::is_spec(input) {
            return Ok(Self { input: input.to_owned(), sha256: None, bytes: None });
        }
        let mut hash = Sha256::new();
        let bytes = io::copy(&mut File::open(input)?, &mut HashWriter(&mut hash))?;
        let digits: Vec<String> = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { input: input.to_owned(), sha256: Some(digits.concat()), bytes: Some(bytes) })
    }
}

struct HashWriter<'a>(&'a mut Sha256);

impl io::Write for HashWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_sha_256() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, b"abc").unwrap();
        let source = Source::of(path.to_str().unwrap()).unwrap();
        // FIPS 180-4, the one-block example.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!((source.sha256.as_deref(), source.bytes), (Some(expected), Some(3)));
        assert!(Source::of("phantom:ball").unwrap().sha256.is_none());
        assert!(Source::of("/no/such/file").is_err());
    }
}
