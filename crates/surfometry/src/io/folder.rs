//! What lies in a folder.

use super::ReadError;
use std::path::{Path, PathBuf};

/// Paths of what lies in a folder, in order of their names. Hidden ones are left out, as macOS leaves them behind.
pub(super) fn visible(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let failed = |e| ReadError::io(folder, e);
    let entries = folder.read_dir().map_err(failed)?;
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(failed)?;
    paths.retain(|path| !name_of(path).starts_with('.'));
    paths.sort();
    Ok(paths)
}

/// The name of a file without its folders.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
