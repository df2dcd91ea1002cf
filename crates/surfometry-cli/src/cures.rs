//! What the command line calls the cures of errors.

use surfometry::inputs::InputError;
use surfometry::io::ReadError;
use surfometry::measurement::MeasureError;
use surfometry::runs::RunError;
use surfometry::volume::VolumeError;

/// The option that helps, where one does.
pub(crate) fn cure(error: &RunError) -> Option<&'static str> {
    match error {
        RunError::Input(InputError::MeshWithoutSpacing) => Some("--spacing X,Y,Z"),
        RunError::Input(InputError::Read(ReadError::Volume(error)))
        | RunError::Measure(MeasureError::Volume(error)) => of_volume(error),
        _ => None,
    }
}

fn of_volume(error: &VolumeError) -> Option<&'static str> {
    match error {
        VolumeError::MissingSpacing | VolumeError::InvalidSpacing { .. } => Some("--spacing X,Y,Z"),
        VolumeError::Fractional { .. } => Some("--embedding given"),
        VolumeError::NoSuchLabel { .. } => Some("--label"),
        _ => None,
    }
}
