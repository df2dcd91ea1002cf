//! Why not all that was asked of an input could be done.

use super::Failure;
use crate::Stopped;
use crate::inputs::InputError;
use crate::measurement::{MeasureError, StreamError};
use crate::volume::{FieldOfView, LabelGroup, VolumeError};
use std::path::PathBuf;
use std::{fmt, io};
use thiserror::Error;

/// Why not all that was asked of an input could be done. The input's name is added by who knows it.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// The input.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The measurement.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// An object without a surface.
    #[error(
        "nothing is left inside the level set at this sigma and level, so there is no surface; use a smaller sigma, or a scale for curvature, which gives thin objects back"
    )]
    NoSurface,
    /// A picture that could not be drawn.
    #[cfg(feature = "pictures")]
    #[error(transparent)]
    Picture(#[from] crate::pictures::PictureError),
    /// A file that would replace an input.
    #[error("{path}: the output would replace an input; choose another name", path = path.display())]
    ReplacesInput {
        /// The file.
        path: PathBuf,
    },
    /// A file that an earlier output of the same run has become.
    #[error("{path}: another output of this run has that name already; choose names that differ, or use other folders", path = path.display())]
    NameTaken {
        /// The file.
        path: PathBuf,
    },
    /// A file that could not be written.
    #[error("{path}: cannot be written: {source}", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A run's journal.
    #[error(transparent)]
    Journal(#[from] super::JournalError),
    /// A measure that records do not have.
    #[error("{0}: no number of that name is measured; names are those of the columns of CSV")]
    NoMeasure(String),
    /// A fault of this library.
    #[error("a fault of surfometry itself ({0}); please report it with the file")]
    Fault(String),
    /// A file that was another one when it had been read.
    #[error("the file changed while it was read: measure it again when it is finished")]
    Changed,
    /// A blur or thickness of what is not measured.
    #[error(
        "a sigma or thickness is given for label {label}, which is not among the objects: {objects}; {cure}"
    )]
    UnusedScale {
        /// The label, or labels.
        label: LabelGroup,
        /// The objects.
        objects: String,
        /// What may have been meant.
        cure: String,
    },
    /// A name that no label of an input has, or several have.
    #[error("no label is called `{name}`: {told}")]
    NoSuchName {
        /// The name.
        name: String,
        /// What is there instead, and what helps.
        told: String,
        /// Whether the input has no names at all.
        nameless: bool,
    },
    /// A label with a name that does not occur.
    #[error("`{name}` (label {label}) has no voxels; the image has {present}")]
    NoVoxels {
        /// The name.
        name: String,
        /// The label.
        label: i64,
        /// The labels that occur.
        present: String,
    },
    /// Objects of one image that share a label.
    #[error(
        "the objects {first} and {second} share label {label}, whose voxels can have the value of only one of them in an image: name each label once, or write an image for each object"
    )]
    SharedLabel {
        /// The label.
        label: i64,
        /// An object that has it.
        first: LabelGroup,
        /// The other.
        second: LabelGroup,
    },
    /// An image that is read beside the inputs.
    #[error("{what} {}", Failure::new(file, source))]
    Beside {
        /// What it is for.
        what: BesideRole,
        /// Its name.
        file: String,
        /// Why.
        source: Box<RunError>,
    },
    /// An image that is read beside the inputs and lies elsewhere.
    #[error(
        "it knows nothing of the object, which lies at {here}: it reaches over {there}; bring both to the same world coordinates, as a \
         registration does"
    )]
    Apart {
        /// Where the object lies.
        here: String,
        /// Where the image does.
        there: String,
    },
    /// A later image without the label of an object.
    #[error(
        "no label {missing} in it; it holds {present}: surfaces are compared label by label, so give an object the same label in both images, or \
         choose among the labels that both have"
    )]
    NoLaterLabel {
        /// What was looked for.
        missing: i64,
        /// What is there, shortened.
        present: String,
    },
    /// What cannot be done with the input.
    #[error("{0}")]
    Unfit(&'static str),
}

/// What an image is for that is read beside the inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BesideRole {
    /// Its labels are regions of the objects.
    Regions,
    /// Its values are put on surfaces.
    Sample,
    /// Its surfaces are those with which others are compared.
    Later,
}

impl fmt::Display for BesideRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Regions => "regions",
            Self::Sample => "sample",
            Self::Later => "the later image",
        })
    }
}

impl RunError {
    /// Of an object that lies here, and an image that lies there.
    pub(super) fn apart(here: FieldOfView, there: FieldOfView) -> Self {
        Self::Apart { here: here.to_string(), there: there.to_string() }
    }

    /// Whether it is no fault of the input: the run was told to stop.
    pub fn is_stop(&self) -> bool {
        matches!(self, Self::Input(InputError::Stopped(_)))
    }
}

impl From<Stopped> for RunError {
    fn from(stopped: Stopped) -> Self {
        Self::Input(stopped.into())
    }
}

impl From<StreamError<InputError>> for RunError {
    fn from(error: StreamError<InputError>) -> Self {
        match error {
            StreamError::Read(error) => error.into(),
            StreamError::Measure(error) => error.into(),
        }
    }
}

impl From<VolumeError> for RunError {
    fn from(error: VolumeError) -> Self {
        Self::Input(error.into())
    }
}
