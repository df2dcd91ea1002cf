//! What all targets do with a case: a file by that ending, in memory where there is such a place, and words where it is refused.

#![allow(dead_code, reason = "no target needs all of it")]

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The ending that this target's files have: its program is called so.
pub const ENDING: &str = env!("CARGO_BIN_NAME");

/// Where this process puts its case.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let memory = Path::new("/dev/shm");
        let place = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
        let folder = place.join(format!("surfometry-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for the case");
        folder
    })
}

/// The case as a file.
pub fn file(bytes: &[u8]) -> PathBuf {
    let path = folder().join(format!("case.{}", ENDING.replace('_', ".")));
    std::fs::write(&path, bytes).expect("a file for the case");
    path
}

/// Whatever was refused says why.
pub fn refused<T, E: std::fmt::Display>(outcome: Result<T, E>) -> Option<T> {
    match outcome {
        Ok(value) => Some(value),
        Err(error) => {
            let words = error.to_string();
            assert!(words.trim().len() >= 12, "it says only `{words}`");
            None
        }
    }
}

/// All voxels of an image, read as whoever measures it does.
pub fn voxels(path: &Path) {
    use surfometry::inputs::{OpenOptions, open};
    use surfometry::volume::LabelImage;
    // Supplies what NumPy's, TIFF's and others' files lack, and replaces what is there.
    let options = OpenOptions { spacing: Some([1.0, 1.5, 0.8]), ..OpenOptions::default() };
    let name = path.to_string_lossy();
    for options in [options, OpenOptions::default()] {
        let Some(source) = refused(open(&name, &options)) else { continue };
        source.flags();
        source.label_table();
        if let Some(mut slabs) = refused(source.slabs()) {
            refused(LabelImage::from_slabs(&mut slabs));
        }
    }
}
