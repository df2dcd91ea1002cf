//! Errors of the library as exceptions of the Python layer.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::io;
use surfometry::inputs::InputError;
use surfometry::io::ReadError;
use surfometry::measurement::MeasureError;
use surfometry::runs::{Cure, Failure, JournalError, RunError};
use surfometry::volume::VolumeError;

/// An exception of `surfometry._errors`, with its attributes.
pub(crate) fn raise(py: Python, class: &str, message: &str, attributes: &[(&str, Option<&str>)]) -> PyErr {
    let made = || {
        let kwargs = PyDict::new(py);
        for (name, value) in attributes {
            kwargs.set_item(name, value)?;
        }
        py.import("surfometry._errors")?.getattr(class)?.call((message,), Some(&kwargs))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// Says something that is no error.
pub(crate) fn warn(py: Python, message: &str) -> PyResult<()> {
    let class = py.import("surfometry._errors")?.getattr("SurfometryWarning")?;
    py.import("warnings")?.call_method1("warn", (message, class)).map(drop)
}

/// Why not all that was asked of an input could be done.
pub(crate) fn of_run(py: Python, input: Option<&Name>, error: &RunError) -> PyErr {
    let hint = hint(input, error);
    let cured = hint.map_or_else(|| error.to_string(), |hint| format!("{error} ({hint})"));
    let message = input.map_or_else(|| cured.clone(), |of| Failure::new(of.name, &cured).to_string());
    let path = input.filter(|of| !of.is_in_memory).map(|of| of.name);
    let attributes = [("path", path), ("field", field(error)), ("hint", hint)];
    match os_error(error) {
        Some((path, source)) => {
            let raised = raise(py, "FileError", &message, &[("path", Some(&path)), ("hint", hint)]);
            let number = source.and_then(io::Error::raw_os_error);
            number.map_or(Ok(()), |number| raised.value(py).setattr("errno", number)).err().unwrap_or(raised)
        }
        None if matches!(error, RunError::Measure(e) if !matches!(e, MeasureError::Volume(_))) => {
            raise(py, "ParameterError", &message, &attributes)
        }
        None => raise(py, "InputError", &message, &attributes),
    }
}

/// What an input is called.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Name<'a> {
    pub(crate) name: &'a str,
    pub(crate) is_in_memory: bool,
}

/// The file that could not be read or written, and what the system said.
fn os_error(error: &RunError) -> Option<(String, Option<&io::Error>)> {
    match error {
        RunError::Beside { source, .. } => os_error(source),
        RunError::Input(InputError::Read(ReadError::Io { path, source }))
        | RunError::Journal(JournalError::Io { path, source })
        | RunError::Write { path, source } => Some((path.display().to_string(), Some(source))),
        RunError::Input(InputError::Read(ReadError::NotAFile { path, .. })) => {
            Some((path.display().to_string(), None))
        }
        _ => None,
    }
}

/// What helps, whatever the input.
pub(crate) fn cure(error: &RunError) -> Option<&'static str> {
    hint(None, error)
}

/// What helps, in the names of the Python layer.
fn hint(input: Option<&Name>, error: &RunError) -> Option<&'static str> {
    let in_memory = input.is_some_and(|of| of.is_in_memory);
    match Cure::of(error) {
        Some(Cure::Spacing) => Some("spacing=, in mm, in the order of the array's axes"),
        Some(Cure::GivenEmbedding) => Some("threshold=(low, high), or embedding=\"given\""),
        Some(Cure::Threshold) => Some("threshold=(low, high)"),
        Some(Cure::Label) => Some("label="),
        Some(Cure::Names) => Some("names="),
        _ if in_memory && names_a_voxel(error) => {
            Some("voxels are named x first, which is the last axis of a plain array")
        }
        _ => None,
    }
}

fn names_a_voxel(error: &RunError) -> bool {
    let (RunError::Input(InputError::Read(ReadError::Volume(error)))
    | RunError::Measure(MeasureError::Volume(error))) = error
    else {
        return false;
    };
    matches!(
        error,
        VolumeError::NotFinite { .. }
            | VolumeError::NotAProbability { .. }
            | VolumeError::HugeValue { .. }
            | VolumeError::LabelOutOfRange { .. }
    )
}

/// The argument that is at fault.
fn field(error: &RunError) -> Option<&'static str> {
    match error {
        RunError::Measure(MeasureError::OutOfRange { name, .. } | MeasureError::TooWide { name, .. }) => {
            Some(name)
        }
        RunError::NoMeasure(_) => Some("measures"),
        _ => match Cure::of(error)? {
            Cure::Spacing => Some("spacing"),
            Cure::GivenEmbedding => Some("embedding"),
            Cure::Label => Some("label"),
            Cure::Threshold => Some("threshold"),
            Cure::Names => Some("names"),
            _ => None,
        },
    }
}
