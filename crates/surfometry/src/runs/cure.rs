//! What helps against an error, which each front end calls by its own names.

use super::{BesideRole, RunError};
use crate::inputs::InputError;
use crate::io::ReadError;
use crate::measurement::MeasureError;
use crate::volume::VolumeError;

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
            RunError::Input(InputError::MeshWithoutSpacing) => Some(Self::Spacing),
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
