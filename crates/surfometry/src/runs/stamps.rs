//! What tells, without a look at their bytes, whether an input's files are those that they were.

use crate::inputs::Source;
use crate::io::sha256_text;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// More files than this have one stamp in common: the chunks of a Zarr may be a million.
const MOST_STAMPS: usize = 256;

/// Names, sizes and times of an input's files, which tell whether two readings were of the same.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct FileStamps(Vec<Option<Stamp>>);

impl FileStamps {
    pub(super) fn of(source: &dyn Source) -> Self {
        Self::of_files(&source.files())
    }

    pub(super) fn of_files(files: &[PathBuf]) -> Self {
        let folder = common_folder(files);
        let stamps = files.iter().map(|file| Stamp::of(file, folder));
        if files.len() > MOST_STAMPS {
            Self(vec![Some(Stamp::of_all(stamps))])
        } else {
            Self(stamps.collect())
        }
    }
}

/// A file as its folder has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Stamp {
    bytes: u64,
    modified: Option<Moment>,
    /// Within the folder that all files are in, of which labels may be called, or chunks have their places. Journals of old
    /// have none, so that what they tell is measured again.
    #[serde(default)]
    name: String,
}

impl Stamp {
    /// `None` where there is no such file any more.
    fn of(file: &Path, folder: &Path) -> Option<Self> {
        let found = file.metadata().ok()?;
        let name = file.strip_prefix(folder).unwrap_or(file).to_string_lossy().into_owned();
        Some(Self { bytes: found.len(), modified: found.modified().ok().map(Moment::of), name })
    }

    /// One of many files: their sum, and what tells them from any others in the place of the name.
    fn of_all(stamps: impl Iterator<Item = Option<Self>>) -> Self {
        let (mut hash, mut bytes) = (Sha256::new(), 0_u64);
        for stamp in stamps {
            hash.update(format!("{stamp:?}\n"));
            bytes = bytes.saturating_add(stamp.map_or(0, |stamp| stamp.bytes));
        }
        Self { bytes, modified: None, name: sha256_text(hash) }
    }
}

/// The innermost folder that all files are in.
fn common_folder(files: &[PathBuf]) -> &Path {
    let folders = files.iter().filter_map(|file| file.parent());
    let common = folders.reduce(|common, folder| {
        common.ancestors().find(|outer| folder.starts_with(outer)).unwrap_or(Path::new(""))
    });
    common.unwrap_or(Path::new(""))
}

/// A time of a file, which may lie before 1970.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Moment {
    secs_since_epoch: i64,
    nanos_since_epoch: u32,
}

impl Moment {
    fn of(time: SystemTime) -> Self {
        let (sign, apart) = match time.duration_since(SystemTime::UNIX_EPOCH) {
            Ok(since) => (1, since),
            Err(before) => (-1, before.duration()),
        };
        Self { secs_since_epoch: sign * apart.as_secs() as i64, nanos_since_epoch: apart.subsec_nanos() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// Whatever their number, and wherever the folder is.
    #[test]
    fn names_sizes_and_times_of_all_files_count() {
        for count in [2, MOST_STAMPS + 1] {
            let folder = tempfile::tempdir().unwrap();
            let file = |number: usize| folder.path().join(format!("c/{}/{}", number / 100, number % 100));
            let files: Vec<PathBuf> = (0..count).map(file).collect();
            for file in &files {
                fs::create_dir_all(file.parent().unwrap()).unwrap();
                fs::write(file, "chunk").unwrap();
            }
            let first = FileStamps::of_files(&files);
            assert_eq!(first, FileStamps::of_files(&files));
            assert!(first.0.len() <= MOST_STAMPS);
            let text = serde_json::to_string(&first).unwrap();
            assert_eq!(serde_json::from_str::<FileStamps>(&text).unwrap(), first);
            let renamed = files[1].with_file_name("1000");
            fs::rename(&files[1], &renamed).unwrap();
            let named = [&files[..1], std::slice::from_ref(&renamed), &files[2..]].concat();
            assert_ne!(first, FileStamps::of_files(&named));
            fs::rename(&renamed, &files[1]).unwrap();
            assert_eq!(first, FileStamps::of_files(&files));
            fs::write(&files[1], "chunks").unwrap();
            assert_ne!(first, FileStamps::of_files(&files));
            fs::remove_file(&files[1]).unwrap();
            assert_ne!(first, FileStamps::of_files(&files));
        }
    }

    /// Journals of versions that did not know names are read, and match no file.
    #[test]
    fn stamps_without_names_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.nii");
        fs::write(&file, "abc").unwrap();
        let now = FileStamps::of_files(&[file]);
        let Some(Some(Stamp { bytes, modified: Some(time), .. })) = now.0.first() else { panic!("{now:?}") };
        let time = serde_json::to_string(time).unwrap();
        let earlier: FileStamps = serde_json::from_str(&format!("[[{bytes},{time}],null]")).unwrap();
        assert_eq!(earlier.0.len(), 2);
        assert_ne!(earlier.0[0], now.0[0]);
    }
}
