//! Why a file could not be read.

use crate::volume::VolumeError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why a file could not be read; every message says what to do. The file's name is added by who knows it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// The file, which for a detached header may be its data file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Not a file, where one is named.
    #[error("{path}: {kind}, not a file; name the file that holds the data", path = path.display())]
    NotAFile {
        /// What is named.
        path: PathBuf,
        /// What it is.
        kind: &'static str,
    },
    /// No supported format.
    #[error("{0}")]
    UnknownFormat(String),
    /// No supported format, nor another one that its content would tell: voxels alone, perhaps.
    #[error("{0}; where it holds voxels alone, say how they are stored")]
    UnknownContent(String),
    /// The header makes no sense.
    #[error("damaged or unsupported {format} header: {reason}")]
    Header {
        /// Format.
        format: &'static str,
        /// What is wrong and what to do.
        reason: String,
    },
    /// A mesh's file makes no sense, or holds its surface in a form that is not read.
    #[error("damaged or unsupported {format} mesh: {reason}; export the mesh again")]
    Mesh {
        /// Format, by the file's name.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// A mesh in a format that is not read.
    #[error(
        "{kind}, which is not read: convert it to one of {read}, and say how far apart its voxels shall be, in mm",
        read = super::mesh::readable()
    )]
    UnreadMesh {
        /// What it is.
        kind: &'static str,
    },
    /// Several volumes or channels in one file.
    #[error(
        "{count} volumes or channels in one file ({dimensions:?}): surfometry measures one 3-D image at a time; save each as a file of its own"
    )]
    SeveralVolumes {
        /// Dimensions as stored.
        dimensions: Vec<usize>,
        /// How many.
        count: usize,
    },
    /// A first axis of one sample in front of three of space, which takes the first of their spacings.
    #[error(
        "the axes are {dimensions:?}: the first one, of a single sample, is a channel and not x, so the spacings that the header names belong to \
         other axes; save the image as {three:?} voxels with their spacing",
        three = &dimensions[1..]
    )]
    ChannelFirst {
        /// Dimensions as stored.
        dimensions: Vec<usize>,
    },
    /// The content is of another kind than the name says.
    #[error("this is {content}, not {expected}, whatever its name; export or fetch the image itself")]
    Foreign {
        /// What it is.
        content: &'static str,
        /// What the name says.
        expected: &'static str,
    },
    /// A table of names that cannot be read.
    #[error("{path}: {reason}", path = path.display())]
    LabelNames {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what is expected.
        reason: String,
    },
    /// Compressed voxels in a file that is compressed as a whole.
    #[error(
        "the voxels are compressed, and the file around them again: unpack the file first, with `gunzip` or `bunzip2`"
    )]
    PackedTwice,
    /// A compressed file that is compressed again.
    #[error("{path}: {inner} within {outer}: the file is compressed twice; unpack it once, with `gunzip` or `bunzip2`", path = path.display())]
    PackedAgain {
        /// The file.
        path: PathBuf,
        /// How it is compressed.
        outer: &'static str,
        /// How what comes out is.
        inner: &'static str,
    },
    /// The voxel type has no single number a voxel.
    #[error(
        "voxels of type {0}: surfometry reads integers of 8 to 64 bits and floats of 32 or 64; convert the image"
    )]
    VoxelType(String),
    /// The data end before the header says.
    #[error(
        "the voxel data end after {found} of {expected} bytes: the file is truncated or its header claims too much; copy or export it again"
    )]
    Truncated {
        /// Bytes found.
        found: u64,
        /// Bytes that the header promises.
        expected: u64,
    },
    /// The compressed data are damaged.
    #[error(
        "the compressed voxel data are damaged ({source}) after {found} of {expected} bytes; copy or export the file again"
    )]
    Decompression {
        /// Bytes decoded.
        found: u64,
        /// Bytes that the header promises.
        expected: u64,
        /// What the decoder said.
        source: io::Error,
    },
    /// What holds voxels cannot be decoded.
    #[error("{path}: the voxel data are damaged: {reason}; copy or export the file again", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Compressed data that go on and on.
    #[error(
        "more than {surplus} bytes follow the {expected} of the voxels in the compressed data: the header does not describe them; export the file again"
    )]
    Endless {
        /// Bytes that the header promises.
        expected: u64,
        /// Bytes decoded behind them, without an end.
        surplus: u64,
    },
    /// More voxels than the bytes that are stored can hold.
    #[error(
        "the header claims {} x {} x {} voxels, and {stored} bytes are stored: these cannot be so many, or would take hours to read; correct the \
         dimensions, or copy or export the image again",
        dimensions[0], dimensions[1], dimensions[2]
    )]
    Claim {
        /// What the header claims.
        dimensions: [usize; 3],
        /// Bytes of what holds the voxels.
        stored: u64,
    },
    /// A segmentation in which nothing is segmented.
    #[error(
        "a segmentation without segments, for which 3D Slicer saves one voxel: save it again when it has some"
    )]
    NoSegments,
    /// A label that no segment of the file has.
    #[error(
        "label {label} in layer {layer} is none of the segments that the header names: save the segmentation again"
    )]
    NoSegment {
        /// The label.
        label: i64,
        /// The layer, from 0 on.
        layer: usize,
    },
    /// Several labels in what should be a mask.
    #[error(
        "labels {} and {} in one of the files of a folder, which is read as masks, one a file: name the images themselves, as 'FOLDER/*.nii.gz'",
        labels[0], labels[1]
    )]
    SeveralLabels {
        /// Two of them.
        labels: [i64; 2],
    },
    /// A value that is neither a label nor background in what is laid over others.
    #[error(
        "a value {value}, which is no label: segments that may overlap want whole numbers; threshold it first"
    )]
    NoMask {
        /// The value.
        value: f64,
    },
    /// Masks that do not lie on each other.
    #[error(
        "{other}: another lattice (dimensions, spacing, orientation or origin) than {first}; a folder is read as masks of one image: name the images themselves, as 'FOLDER/*.nii.gz'",
        first = first.display(), other = other.display()
    )]
    OtherLattice {
        /// The first file.
        first: PathBuf,
        /// The one that differs.
        other: PathBuf,
    },
    /// One of several files.
    #[error("{path}: {source}", path = path.display())]
    InLayer {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<ReadError>,
    },
    /// The image itself.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

impl ReadError {
    /// Of what is named and is no file.
    pub(crate) fn not_a_file(path: &std::path::Path, found: &std::fs::Metadata) -> Self {
        let kind = if found.is_dir() { "a folder" } else { "a device or pipe" };
        Self::NotAFile { path: path.to_owned(), kind }
    }

    pub(crate) fn io(path: &std::path::Path, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    /// Of voxels, after so many of their bytes: what a reader of assembled ones reported is kept in the error whole, any
    /// other is of damaged data.
    pub(crate) fn of_read(source: io::Error, found: u64, expected: u64) -> Self {
        source.downcast().unwrap_or_else(|source| Self::Decompression { found, expected, source })
    }

    /// Of one of several files.
    pub(crate) fn in_file(path: &std::path::Path, source: Self) -> Self {
        Self::InLayer { path: path.to_owned(), source: Box::new(source) }
    }

    pub(crate) fn damaged(path: &std::path::Path, reason: &impl std::fmt::Display) -> Self {
        Self::Damaged { path: path.to_owned(), reason: reason.to_string() }
    }
}

/// For readers of bytes, whose errors are those of files; who reads takes it out again.
impl From<ReadError> for io::Error {
    fn from(error: ReadError) -> Self {
        Self::other(error)
    }
}
