//! Image and mesh files: one file a format. An image format only reads its header; decoding and slabs are
//! common to all.
//!
//! ```
//! use surfometry::{io, phantoms::Phantom};
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("ball.nii.gz");
//! let image = Phantom::from_spec("ball?radius=6&spacing=1,1,2")?.labels()?;
//! io::write_labels(&path, &image)?;
//! let read = io::read_labels(&path)?;
//! assert_eq!(read.mask(1).voxels(), image.mask(1).voxels());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod aim;
mod aim_voxels;
mod assembled;
mod base64_text;
mod binary_header;
mod claims;
mod combinations;
#[cfg(feature = "dicom")]
mod dicom;
mod digest;
mod encoding;
mod error;
mod file_series;
mod folder;
mod foreign;
mod format;
mod growing_file;
mod header;
mod isq;
mod label_names;
mod mask_folder;
mod members;
mod mesh;
mod metaimage;
mod mgh;
mod nifti;
mod nifti_labels;
mod nifti_writer;
mod npy;
mod nrrd;
mod overlay;
mod packed;
mod raw;
mod segmentation;
mod stack;
mod stem;
mod text_header;
mod text_numbers;
mod timed_file;
mod unread;
mod voxel_stream;
mod vtk;
mod whole_file;
#[cfg(feature = "zarr")]
mod zarr;

pub use digest::HashedFile;
pub(crate) use digest::sha256_text;
pub use error::ReadError;
pub use format::Format;
pub(crate) use format::PACKED;
pub use growing_file::{GrowingFile, ResultOutput, unfinished};
pub use header::ImageHeader;
use header::Voxels;
pub use label_names::{label_names_of_text, read_label_names, read_label_names_warning};
pub use mesh::{MeshDocument, MeshFormat, is_mesh, mesh_paths, read_mesh, write_mesh};
pub(crate) use mesh::{MeshFile, read_mesh_file};
pub use nifti_writer::{write_labels, write_voxel_map};
pub(crate) use packed::{read_handed_on, read_text};
pub(crate) use raw::read_header as read_raw_header;
pub use raw::{RawLayout, RawLayoutError};
pub(crate) use stem::known_stem;
pub use voxel_stream::VoxelStream;
pub use whole_file::{try_writing, write_whole};

use crate::volume::{FieldImage, LabelImage};
use std::path::Path;

/// What the caller knows better than the file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReadOptions {
    /// Spacing in mm, fastest axis first: replaces the file's, or supplies what it lacks.
    pub spacing: Option<[f64; 3]>,
}

/// Reads a label image of any supported format.
///
/// # Errors
/// [`ReadError`], which names the file, what is wrong and what to do.
pub fn read_labels(path: impl AsRef<Path>) -> Result<LabelImage, ReadError> {
    read_labels_with(path, ReadOptions::default())
}

/// Reads a label image with options.
///
/// # Errors
/// As [`read_labels`].
pub fn read_labels_with(path: impl AsRef<Path>, options: ReadOptions) -> Result<LabelImage, ReadError> {
    LabelImage::from_slabs(&mut VoxelStream::open(path.as_ref(), options)?)
}

/// Reads a scalar field, for instance an embedding made elsewhere.
///
/// # Errors
/// As [`read_labels`].
pub fn read_field(path: impl AsRef<Path>, options: ReadOptions) -> Result<FieldImage, ReadError> {
    FieldImage::from_slabs(&mut VoxelStream::open(path.as_ref(), options)?)
}

/// Reads only the header.
///
/// # Errors
/// As [`read_labels`].
pub fn read_header(path: impl AsRef<Path>) -> Result<ImageHeader, ReadError> {
    let path = path.as_ref();
    let format = Format::detect(path)?;
    let header = match format {
        Format::Nifti => nifti::read_header(path),
        Format::MetaImage => metaimage::read_header(path),
        Format::Nrrd => nrrd::read_header(path),
        // Such a file is never found out: the caller says so.
        Format::Raw => Err(ReadError::UnknownFormat("no header".into())),
        Format::Npy => npy::read_header(path),
        Format::Mgh => mgh::read_header(path),
        Format::Aim => aim::read_header(path),
        Format::Isq => isq::read_header(path),
        #[cfg(feature = "dicom")]
        Format::Dicom => return dicom::read_header(path),
        Format::MaskFolder => return mask_folder::read_header(path),
        Format::Tiff => stack::read_tiff(path),
        Format::LegacyVtk => vtk::read_legacy(path),
        Format::Vti => vtk::read_image_data(path),
        Format::Slices => stack::read_folder(path),
        #[cfg(feature = "zarr")]
        Format::Zarr => zarr::read_header(path),
    };
    // Who cannot read it may say what it is instead.
    header.map_err(|error| match foreign::content(path) {
        Some(content) if !format.is_called(content) => {
            ReadError::Foreign { content, expected: format.name() }
        }
        _ => error,
    })
}
