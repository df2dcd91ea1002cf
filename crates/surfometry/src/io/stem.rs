//! Names of files without their endings.

use super::format::{PACKED, without_version};
use super::{Format, MeshFormat};

/// Endings of files that are read or written, beside those of images and meshes.
const OTHERS: [&str; 11] =
    [".raw", ".surf.gii", ".off", ".vtk", ".tsv", ".json", ".jsonl", ".png", ".svg", ".html", ".htm"];

/// A name without the ending of a file that is read or written, and `.gz` around it. Nothing else is cut off: what
/// follows a point may tell objects apart, as `S01.left` and `S01.right`.
pub(crate) fn known_stem(name: &str) -> &str {
    let images = Format::ENDINGS.iter().flat_map(|(_, endings)| endings.iter());
    // `.surf.gii` before `.gii`.
    let endings = OTHERS.iter().chain(images).chain(&MeshFormat::EXTENSIONS);
    let unversioned = without_version(name);
    let packed = PACKED.iter().find_map(|ending| before(unversioned, ending)).unwrap_or(unversioned);
    endings.copied().find_map(|ending| before(packed, ending)).unwrap_or(name)
}

/// What is in front of an ending, in upper or lower case; `None` where nothing is, or the name ends otherwise.
fn before<'a>(name: &'a str, ending: &str) -> Option<&'a str> {
    let (stem, end) = name.split_at_checked(name.len().checked_sub(ending.len())?)?;
    (end.eq_ignore_ascii_case(ending) && !stem.is_empty()).then_some(stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_endings_of_files_are_cut_off() {
        for name in ["S01.left", "p1.5mm", "sub-1.5mm.v2", "scan_2024.01.05", "a.gz", ".nii", "a.", "é.xyz"]
        {
            assert_eq!(known_stem(name), name);
        }
        for ending in [
            ".nii",
            ".NII.GZ",
            ".img.gz",
            ".nrrd",
            ".csv.gz",
            ".surf.gii",
            ".gii",
            ".ply",
            ".raw",
            ".tif",
            ".AIM;1",
        ] {
            assert_eq!(known_stem(&format!("p1.5mm{ending}")), "p1.5mm");
        }
    }
}
