//! A page that is written while a run goes on.

use super::{command_line, say};
use anyhow::{Context, Result};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use surfometry::io::ResultOutput;
use surfometry::report::{HashedInput, ObjectReport, Provenance, Report, ReportPart, render};
use surfometry::runs::{Failure, Sink};

/// Takes the sections of a page. What was finished is in `NAME.partial` after the first, second, fourth, eighth
/// object and so on, for a page is rendered as a whole, and whenever [`PageSink::save`] is called.
#[derive(Clone)]
pub(crate) struct PageSink(Arc<Mutex<Page>>);

struct Page {
    path: PathBuf,
    title: String,
    date: Option<String>,
    out: Option<ResultOutput>,
    objects: Vec<ObjectReport>,
    sources: Vec<HashedInput>,
    failures: Vec<Failure>,
}

impl PageSink {
    pub(crate) fn new(path: PathBuf, title: String, date: Option<String>) -> Self {
        let (objects, sources, failures) = (Vec::new(), Vec::new(), Vec::new());
        let page = Page { path, title, date, out: None, objects, sources, failures };
        Self(Arc::new(Mutex::new(page)))
    }

    fn page(&self) -> MutexGuard<'_, Page> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes what there is under the name of an unfinished file.
    pub(crate) fn save(&self) {
        let mut page = self.page();
        if let Err(error) = page.save() {
            say(&error.to_string());
        }
    }

    /// Gives the page its name, unless the run was stopped; how many objects are in it, where there is one.
    pub(crate) fn finish(&self, stopped: bool) -> Result<Option<usize>> {
        let mut page = self.page();
        let name = format!("{}: cannot be written", page.path.display());
        let objects = page.objects.len();
        Ok(page.finish(stopped).with_context(|| name)?.then_some(objects))
    }
}

impl Page {
    fn text(&mut self) -> io::Result<String> {
        let report = Report {
            title: self.title.clone(),
            objects: std::mem::take(&mut self.objects),
            failures: self.failures.clone(),
            provenance: Provenance::new(command_line(), self.sources.clone()).made_at(self.date.clone()),
        };
        let text = render(&report).map_err(io::Error::other);
        self.objects = report.objects;
        text
    }

    /// The file, begun where it is not yet; `None` where there is nothing to show.
    fn begun(&mut self) -> io::Result<Option<ResultOutput>> {
        match self.out.take() {
            None if self.objects.is_empty() => Ok(None),
            None if self.path == Path::new("-") => Ok(Some(ResultOutput::stdout())),
            None => ResultOutput::create(&self.path).map(Some),
            begun => Ok(begun),
        }
    }

    fn save(&mut self) -> io::Result<()> {
        self.save_in_file().map_err(|error| {
            io::Error::new(error.kind(), format!("{}: cannot be written: {error}", self.path.display()))
        })
    }

    fn save_in_file(&mut self) -> io::Result<()> {
        let Some(mut out) = self.begun()? else { return Ok(()) };
        // A pipe takes a page once, at the end.
        let saved = match out.partial() {
            Some(_) => self.text().and_then(|text| out.write_secured(b"", text.as_bytes())),
            None => Ok(()),
        };
        self.out = Some(out);
        saved
    }

    fn finish(&mut self, stopped: bool) -> io::Result<bool> {
        let Some(mut out) = self.begun()? else { return Ok(false) };
        let text = self.text()?;
        // There is nothing left that could be saved.
        self.objects.clear();
        out.write_secured(text.as_bytes(), b"")?;
        out.end(stopped).map(|_| true)
    }
}

impl Sink<ReportPart> for PageSink {
    fn row(&mut self, part: ReportPart) -> io::Result<()> {
        let mut page = self.page();
        match part {
            ReportPart::Object(object) => {
                page.objects.push(*object);
                if page.objects.len().is_power_of_two() { page.save() } else { Ok(()) }
            }
            ReportPart::Source(source) => {
                page.sources.push(source);
                Ok(())
            }
        }
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.page().failures.push(failure);
        Ok(())
    }
}
