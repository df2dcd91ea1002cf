//! DICOM: images of one or several frames a file, and segmentations.
//!
//! # References
//! DICOM PS3.3 C.7.6.2 (where an image lies), C.7.6.16 (frames), C.8.20 (segmentations), PS3.5 8 (pixel data).

mod bits;
mod code_extensions;
mod colour;
mod data_set;
mod frame;
mod lattice;
mod lengths;
mod pixels;
mod segmentation;
mod series;

pub(super) use data_set::is_dicom;
pub(super) use series::files;

use super::{ImageHeader, ReadError};
use data_set::DataSet;
use std::path::Path;

fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: "DICOM", reason: reason.into() }
}

/// Reads the headers of a series: a folder's only one, or that of a file with all files beside it that belong to it. A
/// segmentation is a file by itself.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    if path.is_dir() {
        return series::of_folder(path);
    }
    let data_set = DataSet::header(path)?;
    if data_set.is_segmentation() {
        segmentation::read_header(path)
    } else {
        series::of_file(path, &data_set)
    }
}
