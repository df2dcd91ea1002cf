//! Where a report comes from.

use crate::io::{HashedFile, ReadError};
use serde::Serialize;
use std::path::PathBuf;
use std::time::{Duration, UNIX_EPOCH};

/// How, from what and by what a report was made.
#[derive(Debug, Clone, Serialize)]
pub struct Provenance {
    /// Version of surfometry.
    pub version: &'static str,
    /// The command as typed.
    pub command: String,
    /// When, as the maker says; `None` where nobody does, so that the same input makes the same page.
    pub created: Option<String>,
    /// The inputs.
    pub sources: Vec<HashedInput>,
}

impl Provenance {
    /// Of a command: of no time, or of that in the environment's `SOURCE_DATE_EPOCH`, seconds since 1970, by which
    /// builds that can be repeated say when they were made.
    pub fn new(command: String, sources: Vec<HashedInput>) -> Self {
        let epoch = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|seconds| seconds.parse().ok());
        let time = epoch.and_then(|seconds| UNIX_EPOCH.checked_add(Duration::from_secs(seconds)));
        let created = time.map(|time| humantime::format_rfc3339_seconds(time).to_string());
        Self { version: env!("CARGO_PKG_VERSION"), command, created, sources }
    }

    /// The same with a date, or whatever says when.
    #[must_use]
    pub fn made_at(self, date: Option<String>) -> Self {
        Self { created: date.or(self.created), ..self }
    }
}

/// An input, so that it can be recognised.
#[derive(Debug, Clone, Serialize)]
pub struct HashedInput {
    /// As named.
    pub input: String,
    /// Its files: header and data, where they are apart; none for a phantom, whose name says all.
    pub files: Vec<HashedFile>,
}

impl HashedInput {
    /// Reads an input's files once.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn of(input: &str, files: &[PathBuf]) -> Result<Self, ReadError> {
        let files = files.iter().map(|path| HashedFile::of(path)).collect::<Result<_, _>>()?;
        Ok(Self { input: input.to_owned(), files })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::{OpenOptions, open};

    #[test]
    fn the_hash_is_sha_256() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, b"abc").unwrap();
        let hashed = HashedFile::of(&path).unwrap();
        // FIPS 180-4, the one-block example.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!((hashed.sha256.as_str(), hashed.bytes, hashed.name.as_str()), (expected, 3, "abc"));
        assert!(HashedInput::of("phantom:ball", &[]).unwrap().files.is_empty());
        assert!(HashedInput::of("a", &[PathBuf::from("/no/such/file.nii")]).is_err());
    }

    /// Voxels that lie apart from their header are part of what was measured.
    #[test]
    fn detached_data_are_hashed_too() {
        let folder = tempfile::tempdir().unwrap();
        let header = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\n\
                      ElementDataFile = b.raw\n";
        std::fs::write(folder.path().join("a.mhd"), header).unwrap();
        std::fs::write(folder.path().join("b.raw"), [1u8; 8]).unwrap();
        let name = folder.path().join("a.mhd").to_str().unwrap().to_owned();
        let files = open(&name, &OpenOptions::default()).unwrap().files();
        let source = HashedInput::of(&name, &files).unwrap();
        let names: Vec<&str> = source.files.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["a.mhd", "b.raw"]);
        assert_eq!(source.files[1].bytes, 8);
    }
}
