//! One HTML file that shows what was measured: a table of all objects, and of each its numbers, surface,
//! distributions, slices, topology, flags and method, with provenance.
//!
//! Everything that is shown stands in one serialisable [`Report`]; `report.html` is its only template, `viewer/` its
//! program, plain JavaScript with WebGL 2. The file asks for nothing, and its policy lets the browser run nothing but this
//! program. What is shown of an object is packed (`packed.rs`): quantised, and of large surfaces fewer triangles. That
//! is for display alone; numbers are those of the whole surface.
//!
//! ```
//! use surfometry::report::{Provenance, Report, ReportPart, ReportTask, render};
//! use surfometry::{Control, runs::{Batch, Collected, Plan}};
//! let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
//! let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
//! let mut parts = Collected::default();
//! batch.run(&ReportTask::new(Plan::default()), &mut parts)?;
//! let objects = parts.results.into_iter().filter_map(|part| match part {
//!     ReportPart::Object(object) => Some(*object),
//!     ReportPart::Source(_) => None,
//! });
//! let page = render(&Report {
//!     title: "a ball".to_owned(),
//!     objects: objects.collect(),
//!     failures: parts.failures,
//!     provenance: Provenance::new("an example".to_owned(), Vec::new()),
//! })?;
//! assert!(page.contains("a ball"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod comparison_page;
mod display_mesh;
mod nearest;
mod object_report;
mod packed;
mod page_data;
mod page_share;
mod provenance;
mod scene;
mod slices;
mod sweep;
mod task;
mod template;
mod viewer;

pub use crate::io::HashedFile;
pub use comparison_page::{ComparisonPage, comparison_chart};
pub use object_report::ObjectReport;
pub use provenance::{HashedInput, Provenance};
pub use sweep::{BlurSweep, Plateau, SweepLine, SweepPanel};
pub use task::{ReportPart, ReportTask};
pub use template::{render, render_comparison};

use crate::runs::Failure;
use serde::Serialize;

/// What a report shows.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Heading.
    pub title: String,
    /// In the order of the inputs.
    pub objects: Vec<ObjectReport>,
    /// Inputs that could not be measured.
    pub failures: Vec<Failure>,
    /// How, from what and by what it was made.
    pub provenance: Provenance,
}
