//! Objects to records.

use crate::input::{Prepared, Request};
use crate::options::{chosen, plan, wrong};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value, json};
use surfometry::Control;
use surfometry::inputs::OpenOptions;
use surfometry::measurement::CurvatureScale;
use surfometry::reference_methods::{METHODS, ReferenceMethod};
use surfometry::runs::{
    Collected, ExplainTopology, FileLedger, InfoTask, Item, MeasureTask, Opened, Plan, Record, ReferenceTask,
    RunError, Sink, SweepTask, Task, table_columns,
};
use surfometry::volume::VolumeError;

/// Runs a task on one input; what comes of it.
pub(crate) fn collected<T: Task<Row: 'static> + Send + 'static>(
    py: Python,
    Request { image, session, .. }: Request,
    open: OpenOptions,
    task: T,
) -> PyResult<Collected<T::Row>> {
    session.run(py, &image.held()?, move |control, prepared| of_task(&task, prepared, &open, control))
}

/// What comes of a task on an input.
pub(crate) fn of_task<T: Task>(
    task: &T,
    prepared: Prepared,
    open: &OpenOptions,
    control: &Control,
) -> Result<Collected<T::Row>, RunError> {
    let (name, source) = prepared.opened(open)?;
    let input = Opened::new(&name, None, source, control);
    let mut found = Collected::default();
    task.run(&input, &mut |item| {
        // Keeping what comes cannot fail.
        let _ = match item {
            Item::Row(row) => found.row(row),
            Item::Failure(failure) => found.failure(failure),
        };
    })?;
    // What a stopped run hands out is not all there is.
    control.check()?;
    Ok(found)
}

pub(crate) fn text(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

fn records_of(py: Python, request: Request) -> PyResult<Vec<Record>> {
    let plan = plan(py, &request.options, CurvatureScale::AsMeasured)?;
    let task = MeasureTask { plan, ..MeasureTask::default() };
    Ok(collected(py, request, task.plan.open.clone(), task)?.results)
}

/// Records of all objects, as JSON.
#[pyfunction]
pub(crate) fn measure(py: Python, request: Request) -> PyResult<String> {
    text(&records_of(py, request)?)
}

/// The same as columns of a table, and the flags of each row in full, as JSON.
#[pyfunction]
pub(crate) fn measure_columns(py: Python, request: Request) -> PyResult<String> {
    columns(records_of(py, request)?)
}

/// The same of records, as JSON.
#[pyfunction]
pub(crate) fn columns_of(records: &str) -> PyResult<String> {
    columns(serde_json::from_str(records).map_err(|error| PyRuntimeError::new_err(error.to_string()))?)
}

fn columns(records: Vec<Record>) -> PyResult<String> {
    let flags: Vec<_> = records.iter().map(|record| json!(record.measured.flags)).collect();
    let named: Map<String, Value> = table_columns(records)
        .map_err(|error| PyRuntimeError::new_err(error.to_string()))?
        .into_iter()
        .map(|(name, values)| (name, Value::Array(values)))
        .collect();
    text(&json!({ "columns": named, "flags": flags }))
}

/// Records over values of a parameter, and what could not be measured, as JSON.
#[pyfunction]
pub(crate) fn sweep(py: Python, request: Request, over: &str, values: Vec<f64>) -> PyResult<String> {
    let over = chosen(py, "over", over)?;
    let plan = plan(py, &request.options, CurvatureScale::AsMeasured)?;
    let task = SweepTask {
        plan: Plan { explain_topology: ExplainTopology::Never, recover: false, ..plan },
        over,
        values,
        chart: None,
        surfaces: None,
        ledger: FileLedger::new(&[]),
    };
    task.check().map_err(|error| crate::errors::of_run(py, None, &error))?;
    let found = collected(py, request, task.plan.open.clone(), task)?;
    text(&json!({ "results": found.results, "failures": found.failures }))
}

/// Records by classical methods, as JSON.
#[pyfunction]
pub(crate) fn reference(py: Python, request: Request, methods: Vec<String>) -> PyResult<String> {
    if let Some(unknown) = methods.iter().find(|name| METHODS.iter().all(|method| method.name() != **name)) {
        let known: Vec<&str> = METHODS.iter().map(|method| method.name()).collect();
        return Err(wrong(py, "methods", unknown, &format!("take some of {}", known.join(", "))));
    }
    let is_asked =
        |method: &&&dyn ReferenceMethod| methods.is_empty() || methods.iter().any(|m| m == method.name());
    let methods = METHODS.iter().filter(is_asked).copied().collect();
    let task = ReferenceTask { plan: plan(py, &request.options, CurvatureScale::AsMeasured)?, methods };
    text(&collected(py, request, task.plan.open.clone(), task)?.results)
}

/// What an input holds, as JSON.
#[pyfunction]
pub(crate) fn describe(py: Python, request: Request) -> PyResult<String> {
    let plan = plan(py, &request.options, CurvatureScale::AsMeasured)?;
    let found = collected(py, request, plan.open.clone(), InfoTask)?;
    text(&found.results.first())
}

/// That an image holds no object, where one is needed.
pub(crate) fn no_object() -> RunError {
    RunError::from(VolumeError::NoForeground)
}
