//! Many files to one table, by a run that goes on where it was killed.

use crate::errors::{cure, of_run};
use crate::input::Held;
use crate::options::{Options, plan};
use crate::session::{Heard, Session};
use pyo3::prelude::*;
use serde_json::json;
use std::io;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use surfometry::io::ResultOutput;
use surfometry::measurement::CurvatureScale;
use surfometry::runs::{
    Batch, DocumentForm, Failure, Journal, JournalError, MeasureTask, Plan, Record, RunError, RunHead,
    Settings, Shard, Sink, journal_line,
};
use surfometry::{Control, Event};

/// A cohort: its files, how they are measured, and where the table goes.
#[derive(FromPyObject)]
pub(crate) struct Cohort {
    inputs: Vec<String>,
    out: PathBuf,
    options: Options,
    resume: bool,
}

impl Cohort {
    fn journal(&self, plan: &Plan) -> Result<Journal, JournalError> {
        let head = RunHead::new(plan, Shard::ALL, &self.inputs)?;
        let path = Journal::beside(&self.out);
        if self.resume { Journal::resume(&path, head) } else { Journal::begin(&path, head) }
    }

    fn held(&self) -> Held<'static> {
        Held::Name(self.out.display().to_string())
    }
}

/// Measures what the journal does not have, and writes the table; how many rows it has, and what failed, as JSON.
/// Where `retry` is off, what failed before has failed.
#[pyfunction]
pub(crate) fn cohort(py: Python, cohort: Cohort, session: Session, retry: bool) -> PyResult<String> {
    let plan = plan(py, &cohort.options, CurvatureScale::AsMeasured)?;
    let of = cohort.inputs.len();
    let hear = move |event: &Event, heard: &mut Heard| {
        if let Event::Finished { .. } = event {
            *heard = Heard::of_many("inputs", heard, of);
        }
    };
    session.run_heard(py, &cohort.held(), hear, move |control, _| {
        let journal = cohort.journal(&plan)?;
        let journal = if retry { journal } else { journal.keeping_failures() };
        let told = tabulated(&cohort, journal, plan, control)
            .map_err(|source| RunError::Write { path: cohort.out.clone(), source })?;
        control.check()?;
        Ok(told)
    })
}

fn tabulated(cohort: &Cohort, journal: Journal, plan: Plan, control: &Control) -> io::Result<String> {
    let batch = Batch { inputs: &cohort.inputs, open: plan.open.clone(), control, cure };
    let settings = Settings::of(&plan);
    let task = MeasureTask { plan, ..MeasureTask::default() };
    let form = DocumentForm::of_path(&cohort.out).unwrap_or(DocumentForm::Csv);
    let mut failures = Vec::new();
    let (outcome, out) = form.write(ResultOutput::create(&cohort.out)?, &settings, |sink| {
        journal.run(&batch, task, Some(&mut Noted { sink, failures: &mut failures }))
    })?;
    out.end(outcome.stopped)?;
    Ok(json!({ "rows": outcome.rows, "failures": failures }).to_string())
}

/// Hands everything on, and keeps what failed.
struct Noted<'a> {
    sink: &'a mut dyn Sink<Record>,
    failures: &'a mut Vec<Failure>,
}

impl Sink<Record> for Noted<'_> {
    fn row(&mut self, row: Record) -> io::Result<()> {
        self.sink.row(row)
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.failures.push(failure.clone());
        self.sink.failure(failure)
    }

    fn input_ends(&mut self) -> io::Result<()> {
        self.sink.input_ends()
    }
}

/// The line of a journal that says what came of one file, for [`CohortJournal::add`].
#[pyfunction]
pub(crate) fn measured_line(
    py: Python,
    input: String,
    options: Options,
    session: Session,
) -> PyResult<String> {
    let plan = plan(py, &options, CurvatureScale::AsMeasured)?;
    session.run(py, &Held::Name(input.clone()), move |control, _| {
        let open = plan.open.clone();
        journal_line(&input, &open, &MeasureTask { plan, ..MeasureTask::default() }, control, cure)
    })
}

/// A cohort's journal, to which lines of workers are added.
#[pyclass(frozen)]
pub(crate) struct CohortJournal {
    journal: Mutex<Option<Journal>>,
    pending: Vec<String>,
}

#[pymethods]
impl CohortJournal {
    #[new]
    fn new(py: Python, cohort: Cohort) -> PyResult<Self> {
        let plan = plan(py, &cohort.options, CurvatureScale::AsMeasured)?;
        let begun = py.detach(|| {
            let journal = cohort.journal(&plan)?;
            let pending = journal.pending(&plan.open);
            Ok((journal, pending))
        });
        let (journal, pending) = begun.map_err(|error| of_journal(py, error))?;
        Ok(Self { journal: Mutex::new(Some(journal)), pending })
    }

    /// The files that are to be measured.
    fn pending(&self) -> Vec<String> {
        self.pending.clone()
    }

    /// Adds what came of a file.
    fn add(&self, py: Python, line: &str) -> PyResult<()> {
        self.with(py, |journal| journal.add_line(line))
    }

    /// Adds that a file could not be measured.
    fn add_failure(&self, py: Python, input: &str, error: &str) -> PyResult<()> {
        self.with(py, |journal| journal.add_failure(Failure::new(input, &error)))
    }

    /// Ends it.
    fn end(&self) -> PyResult<()> {
        let journal = self.journal.lock().unwrap_or_else(PoisonError::into_inner).take();
        Ok(journal.map_or(Ok(()), |journal| journal.end(false))?)
    }
}

impl CohortJournal {
    fn with(&self, py: Python, act: impl FnOnce(&Journal) -> Result<(), JournalError>) -> PyResult<()> {
        let journal = self.journal.lock().unwrap_or_else(PoisonError::into_inner);
        let done = journal.as_ref().map_or(Ok(()), act);
        done.map_err(|error| of_journal(py, error))
    }
}

fn of_journal(py: Python, error: JournalError) -> PyErr {
    of_run(py, None, &error.into())
}
