//! What a file is that is not what its name says.

use super::packed::read_start;
use std::path::Path;

/// A mesh of FreeSurfer's own.
pub(super) const FREESURFER_SURFACE: &str = "a surface of FreeSurfer (`mris_convert IN OUT.gii` converts it)";

/// How kinds of files begin, and their names for people.
const MAGIC: [(&[u8], &str); 25] = [
    (b"PK\x03\x04", "a ZIP archive"),
    (
        b"version https://git-lfs",
        "a Git LFS pointer, which stands for a file that was not fetched (`git lfs pull`)",
    ),
    (
        b"/annex/objects/",
        "a git-annex pointer, which stands for a file that was not fetched (`git annex get`)",
    ),
    (b"<!DOCTYPE html", "an HTML page, as a server sends in place of a file"),
    (b"<!doctype html", "an HTML page, as a server sends in place of a file"),
    (b"<html", "an HTML page, as a server sends in place of a file"),
    (b"<HTML", "an HTML page, as a server sends in place of a file"),
    (b"\x89HDF\r\n\x1a\n", "HDF5"),
    (b"MATLAB 5.0 MAT-file", "a MATLAB file"),
    (b"%PDF", "a PDF document"),
    (b"\x89PNG\r\n\x1a\n", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive"),
    (b"Rar!", "a RAR archive"),
    (b"\xfd7zXZ\0", "compressed with xz (`unxz` unpacks it)"),
    (b"\x28\xb5\x2f\xfd", "compressed with Zstandard (`unzstd` unpacks it)"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"\xff\xff\xfecreated by ", FREESURFER_SURFACE),
    (b"NRRD000", "NRRD"),
    (b"\x93NUMPY", "NumPy"),
    (b"# vtk DataFile", "legacy VTK"),
    (b"ObjectType", "MetaImage"),
    (b"AIMDATA_V030", "Scanco AIM"),
    (b"CTDATA-HEADER_V1", "Scanco ISQ"),
];

/// Kinds that are told by what stands further on: at which byte.
const INNER_MAGIC: [(usize, &[u8], &str); 4] = [
    (128, b"DICM", "DICOM"),
    (257, b"ustar", "a tar archive"),
    (344, b"n+1\0", "NIfTI"),
    (344, b"ni1\0", "NIfTI"),
];

/// The kind of a file by its content, unpacked; `None` where that tells nothing.
pub(super) fn content(path: &Path) -> Option<&'static str> {
    let start = read_start(path, 512).ok()?;
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&start).trim_ascii_start();
    let first = MAGIC.iter().find(|(magic, _)| start.starts_with(magic) || text.starts_with(magic));
    let inner =
        || INNER_MAGIC.iter().find(|(at, magic, _)| start.get(*at..).is_some_and(|s| s.starts_with(magic)));
    first.map(|(_, name)| *name).or_else(|| inner().map(|(_, _, name)| *name))
}
