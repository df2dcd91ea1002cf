//! The document that a run writes.

use super::{MAP_SCHEMA, SurfaceRecord};
use crate::measurement::Measured;
use crate::phantoms::Truth;
use crate::volume::LabelGroup;
use serde::Serialize;

/// Name and version of the format.
pub const SCHEMA: &str = "surfometry.measure/2";

/// Results and failures of a run: docs/contract.md.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Output<R = Record> {
    /// [`SCHEMA`], or [`MAP_SCHEMA`].
    pub schema: &'static str,
    /// Version of surfometry.
    pub version: &'static str,
    /// One record an object.
    pub results: Vec<R>,
    /// Inputs that could not be measured.
    pub failures: Vec<Failure>,
}

impl Output {
    /// A document.
    pub fn new(results: Vec<Record>, failures: Vec<Failure>) -> Self {
        Self { schema: SCHEMA, version: env!("CARGO_PKG_VERSION"), results, failures }
    }
}

impl Output<SurfaceRecord> {
    /// A document of surfaces.
    pub fn of_surfaces(results: Vec<SurfaceRecord>, failures: Vec<Failure>) -> Self {
        Self { schema: MAP_SCHEMA, version: env!("CARGO_PKG_VERSION"), results, failures }
    }
}

/// One object's results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// The input as named.
    pub input: String,
    /// Label, or labels that were united; `None` for a field, which has none.
    pub label: Option<LabelGroup>,
    /// The label's name, where a file holds one.
    pub name: Option<String>,
    /// Which of the label's pieces, the largest being 1; `None` where all are one object.
    pub component: Option<u64>,
    /// The results.
    #[serde(flatten)]
    pub measured: Measured,
    /// Exact integrals, for phantoms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth>,
    /// Time to read and decode the input, s.
    pub read_seconds: Option<f64>,
    /// Time from the decoded labels to all integrals, s.
    pub seconds: f64,
}

/// An input that could not be measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
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
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.input, self.error)
    }
}
