//! What helps against an error, which each front end calls by its own names.

use super::{BesideRole, RunError};
use crate::inputs::InputError;
use crate::io::ReadError;
use crate::measurement::MeasureError;
use crate::phantoms::PHANTOM_NAMES;
use crate::text::question;
use crate::volume::VolumeError;
use std::io::ErrorKind;
use std::path::Path;

/// What helps against an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cure {
    /// To say what the spacing is.
    Spacing,
    /// To say which grey values are the object.
    Threshold,
    /// The same, or to measure a field as one that is given.
    GivenEmbedding,
    /// To choose among the labels that there are.
    Label,
    /// To say what labels are called.
    Names,
    /// To say how the voxels of a file without a header are stored.
    Raw,
}

impl Cure {
    /// What helps against an error, where a choice of the caller's does.
    pub fn of(error: &RunError) -> Option<Self> {
        match error {
            // The others are read as they are: what is chosen for the inputs would not help.
            RunError::Beside { what: BesideRole::Later, source, .. } => Self::of(source),
            RunError::Input(
                InputError::MeshWithoutSpacing | InputError::Read(ReadError::UnreadMesh { .. }),
            ) => Some(Self::Spacing),
            RunError::NoSuchName { nameless: true, .. } => Some(Self::Names),
            RunError::NoSuchName { .. } | RunError::NoVoxels { .. } | RunError::NoLaterLabel { .. } => {
                Some(Self::Label)
            }
            RunError::Input(InputError::Read(ReadError::UnknownContent(_))) => Some(Self::Raw),
            RunError::Input(InputError::Read(ReadError::Volume(error)))
            | RunError::Measure(MeasureError::Volume(error)) => Self::of_volume(error),
            _ => None,
        }
    }

    fn of_volume(error: &VolumeError) -> Option<Self> {
        match error {
            VolumeError::MissingSpacing
            | VolumeError::InvalidSpacing { .. }
            | VolumeError::UnknownUnit { .. }
            | VolumeError::UnlikelySpacing { .. }
            | VolumeError::UnequalSpacing { .. } => Some(Self::Spacing),
            VolumeError::GreyValues { .. }
            | VolumeError::NothingWithin { .. }
            | VolumeError::FaintForeground { .. } => Some(Self::Threshold),
            VolumeError::Fractional { .. } => Some(Self::GivenEmbedding),
            VolumeError::NoSuchLabel { .. } => Some(Self::Label),
            _ => None,
        }
    }
}

/// What may have been meant by an input that is not there: a file of a like name beside it, or a built-in shape.
pub(super) fn meant_instead(input: &str, error: &RunError) -> Option<String> {
    let RunError::Input(InputError::Read(error)) = error else { return None };
    let is_shape = PHANTOM_NAMES.contains(&input.split('?').next().unwrap_or_default());
    if is_shape && !Path::new(input).exists() {
        return Some(format!("did you mean phantom:{input}?"));
    }
    let ReadError::Io { path, source } = error else { return None };
    if source.kind() != ErrorKind::NotFound || path != Path::new(input) {
        return None;
    }
    if input == "phantom" {
        return Some("a built-in shape is written as phantom:torus".to_owned());
    }
    let near = files_like(path);
    (!near.is_empty()).then(|| question(&near).trim_end().to_owned())
}

/// Likeness (Jaro and Winkler's, 0 to 1) from which a file may have been meant.
const ALIKE: f64 = 0.9;
/// Files that are suggested, and entries of a folder that are looked at.
const SUGGESTED: usize = 2;
const LOOKED_AT: usize = 10_000;

/// Names in the folder of a file that are like its own, the likest first; not those of the same series, which differ in digits.
fn files_like(path: &Path) -> Vec<String> {
    let Some(name) = path.file_name().map(|name| name.to_string_lossy()) else { return Vec::new() };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let without_digits = |name: &str| name.replace(|c: char| c.is_ascii_digit(), "");
    let own = without_digits(&name);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().take(LOOKED_AT);
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut alike: Vec<(f64, String)> = names
        .filter(|other| without_digits(other) != own)
        .map(|other| (strsim::jaro_winkler(&name, &other), other))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .collect();
    alike.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    alike.into_iter().take(SUGGESTED).map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_like_names() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["scan.nii.gz", "scan7.nii", "other.mha"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let like = |name: &str| files_like(&folder.path().join(name));
        assert_eq!(like("scan.nii"), ["scan.nii.gz"]);
        assert_eq!(like("scna.nii.gz"), ["scan.nii.gz"]);
        // Another one of the series is no slip.
        assert!(like("scan8.nii").iter().all(|name| name != "scan7.nii"));
        assert!(like("femur.nrrd").is_empty() && files_like(Path::new("/nowhere/scan.nii")).is_empty());
    }
}
