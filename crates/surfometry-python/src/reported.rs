//! A page.

use crate::input::Request;
use crate::measured::no_object;
use crate::options::{choices, curvature, plan};
use pyo3::prelude::*;
use std::io;
use std::path::PathBuf;
use surfometry::inputs::input_title;
use surfometry::io::write_whole;
use surfometry::report::{Provenance, Report, ReportPart, ReportTask, render};
use surfometry::runs::{Item, Opened, RunError};

/// Writes a page of one input; whether all of it could be shown.
#[expect(clippy::too_many_arguments, reason = "what a page says of itself")]
#[pyfunction]
pub(crate) fn report(
    py: Python,
    request: Request,
    curvature_sigma: Option<&str>,
    path: PathBuf,
    title: Option<String>,
    date: Option<String>,
    command: String,
) -> PyResult<()> {
    let Request { image, options, session } = request;
    let is_free = curvature_sigma.is_none() && !choices(py, &options)?.names_a_field();
    let plan = plan(py, &options, curvature(py, curvature_sigma)?)?;
    session.run(py, &image.held()?, move |control, prepared| {
        let (name, source) = prepared.opened(&plan.open)?;
        let input = Opened::new(&name, None, source, control);
        let title = title.unwrap_or_else(|| input_title(&name));
        let task = ReportTask::new(plan).of_free_choice(is_free);
        let (mut objects, mut sources, mut failures) = (Vec::new(), Vec::new(), Vec::new());
        surfometry::runs::Task::run(&task, &input, &mut |item| match item {
            Item::Row(ReportPart::Object(object)) => objects.push(*object),
            Item::Row(ReportPart::Source(source)) => sources.push(source),
            Item::Failure(failure) => failures.push(failure),
        })?;
        if objects.is_empty() {
            return Err(no_object());
        }
        let provenance = Provenance::new(command, sources).made_at(date);
        let report = Report { title, objects, failures, provenance };
        let written = render(&report)
            .map_err(io::Error::other)
            .and_then(|text| write_whole(&path, |out| out.write_all(text.as_bytes())));
        written.map_err(|source| RunError::Write { path: path.clone(), source })
    })
}
