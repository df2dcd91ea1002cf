//! One HTML file that shows what was measured: numbers, a surface to turn, distributions, slices, method,
//! provenance.
//!
//! Everything that is shown stands in one serialisable [`Report`]; `report.html` is its only template. The
//! file needs no network: plotly.js is inside.
//!
//! ```
//! use surfometry::report::{Provenance, Report, ReportPart, ReportTask, render};
//! use surfometry::{Control, runs::{Batch, Collected, Plan}};
//! let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
//! let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
//! let mut parts = Collected::default();
//! batch.run(&ReportTask::new(Plan::default()), &mut parts)?;
//! let objects = parts.results.into_iter().filter_map(|part| match part {
//!     ReportPart::Object(section) => Some(*section),
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
mod figures;
mod provenance;
mod scene;
mod task;
mod template;

pub use crate::io::HashedFile;
pub use comparison_page::{ComparisonPage, comparison_chart};
pub use figures::ObjectReport;
pub use provenance::{HashedInput, Provenance};
pub use scene::{MOST_TRIANGLES, Scene};
pub use task::{ReportPart, ReportTask};
pub use template::{render, render_comparison};

use crate::runs::Failure;
use serde::Serialize;

/// What a report shows.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Heading.
    pub title: String,
    /// One section each.
    pub objects: Vec<ObjectReport>,
    /// Inputs that could not be measured.
    pub failures: Vec<Failure>,
    /// How, from what and by what it was made.
    pub provenance: Provenance,
}
