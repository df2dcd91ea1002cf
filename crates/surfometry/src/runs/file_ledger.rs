//! Which files a run may write.

use super::RunError;
use crate::inputs::files_of;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The files of a run: its inputs stay as they are, and no output takes another's place.
#[derive(Debug, Default)]
pub struct FileLedger {
    taken: Mutex<HashMap<PathBuf, Holder>>,
}

#[derive(Debug)]
enum Holder {
    Input,
    Output,
}

impl FileLedger {
    /// A ledger in which only the run's inputs stand, with all files that they rest on; what is no file, as a phantom, is
    /// passed over.
    pub fn new(inputs: &[String]) -> Self {
        let files =
            inputs.iter().flat_map(|input| files_of(input)).filter_map(|file| file.canonicalize().ok());
        Self { taken: Mutex::new(files.map(|file| (file, Holder::Input)).collect()) }
    }

    /// Takes a file for an output.
    ///
    /// # Errors
    /// [`RunError::ReplacesInput`], or [`RunError::NameTaken`] by an earlier output of the run.
    pub fn claim(&self, path: &Path) -> Result<(), RunError> {
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        match taken.entry(location(path)) {
            Entry::Vacant(free) => {
                free.insert(Holder::Output);
                Ok(())
            }
            Entry::Occupied(taken) => Err(match taken.get() {
                Holder::Input => RunError::ReplacesInput { path: path.to_owned() },
                Holder::Output => RunError::NameTaken { path: path.to_owned() },
            }),
        }
    }
}

/// A file's name, which need not exist yet, without links and dots.
fn location(path: &Path) -> PathBuf {
    if let Ok(existing) = path.canonicalize() {
        return existing;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (folder.canonicalize(), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_and_earlier_outputs_are_spared() {
        let folder = tempfile::tempdir().unwrap();
        let (input, output) = (folder.path().join("in.nii"), folder.path().join("out.nii"));
        std::fs::write(&input, b"").unwrap();
        let ledger = FileLedger::new(&[input.display().to_string(), "phantom:ball".to_owned()]);
        let dotted = folder.path().join(".").join("in.nii");
        for _ in 0..2 {
            assert!(matches!(ledger.claim(&dotted), Err(RunError::ReplacesInput { .. })));
        }
        assert!(ledger.claim(&output).is_ok());
        assert!(matches!(ledger.claim(&output), Err(RunError::NameTaken { .. })));
        assert!(ledger.claim(&folder.path().join("other.nii")).is_ok());
        // The voxels of a header.
        let (header, voxels) = (folder.path().join("in.mhd"), folder.path().join("voxels.csv"));
        let text = "NDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = voxels.csv\n";
        std::fs::write(&header, text).unwrap();
        std::fs::write(&voxels, [0; 8]).unwrap();
        let ledger = FileLedger::new(&[header.display().to_string()]);
        assert!(matches!(ledger.claim(&voxels), Err(RunError::ReplacesInput { .. })));
    }
}
