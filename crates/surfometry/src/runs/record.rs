//! What is written of an object.

use super::columns::{RECORD, columns};
use super::cure::meant_instead;
use super::{Row, RunError};
use crate::inputs::PreparedObject;
use crate::measurement::{Interface, Measured, RegionPart};
use crate::phantoms::Truth;
use crate::volume::{LabelGroup, LabelTable};
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const SCHEMA: &str = "surfometry.measure/2";

/// One object's results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The input as named.
    pub input: String,
    /// Label, or labels that were united; `None` for a field, which has none.
    pub label: Option<LabelGroup>,
    /// The label's name, where the input holds one.
    pub name: Option<String>,
    /// Which of the label's pieces, the largest being 1; `None` where all are one object.
    pub component: Option<u64>,
    /// The results.
    #[serde(flatten)]
    pub measured: Measured,
    /// Exact integrals, for phantoms; `None` of anything else.
    #[serde(default)]
    pub truth: Option<Truth>,
    /// What was done to its voxels before; `None` where nothing was.
    #[serde(default)]
    pub preparation: Option<PreparedObject>,
    /// Its parts by regions, which add up to it; `None` where there are no regions.
    #[serde(default)]
    pub regions: Option<Vec<RegionPart>>,
    /// Its contacts with other labels and background; `None` where they were not asked for.
    #[serde(default)]
    pub interfaces: Option<Vec<Interface>>,
    /// Blur of the corrected embedding in which the surface is mapped, mm, where it is mapped in one of its
    /// own.
    #[serde(default)]
    pub curvature_sigma_mm: Option<f64>,
    /// SHA-256 of the input's file; of several (header and data, the files of a folder) that of their digests, a line
    /// each; `None` of what lies in no file.
    #[serde(default)]
    pub input_sha256: Option<String>,
    /// Time to read and decode the input, s.
    pub read_seconds: Option<f64>,
    /// Time from the decoded labels to all integrals, s.
    pub seconds: f64,
}

impl Record {
    /// Of a label's object that was not known as a whole, before anything is said of its file.
    pub(super) fn of_label(input: &str, names: &LabelTable, label: LabelGroup, measured: Measured) -> Self {
        Self {
            input: input.to_owned(),
            name: names.name_of(&label),
            label: Some(label),
            component: None,
            truth: None,
            preparation: None,
            regions: None,
            interfaces: None,
            curvature_sigma_mm: None,
            input_sha256: None,
            read_seconds: None,
            seconds: measured.timings.integrals,
            measured,
        }
    }
}

impl Row for Record {
    const SCHEMA: &'static str = SCHEMA;

    fn columns() -> Vec<String> {
        columns(&RECORD)
    }
}

/// An input that could not be measured, or not as was asked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// The input as named.
    pub input: String,
    /// Cause and cure.
    pub error: String,
}

impl Failure {
    /// The failure of an input. A message that begins with the input's name does not get it twice.
    pub fn new(input: &str, error: &impl std::fmt::Display) -> Self {
        let error = error.to_string();
        let error = error.strip_prefix(&format!("{input}: ")).map(str::to_owned).unwrap_or(error);
        Self { input: input.to_owned(), error }
    }

    /// The same of a run's error, with the front end's words for what helps.
    pub(super) fn of(input: &str, error: &RunError, cure: fn(&RunError) -> Option<&'static str>) -> Self {
        match (cure(error), meant_instead(input, error)) {
            (Some(cure), _) => Self::new(input, &format!("{error} ({cure})")),
            (None, Some(meant)) => Self::new(input, &format!("{error}; {meant}")),
            (None, None) => Self::new(input, error),
        }
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.input, self.error)
    }
}
