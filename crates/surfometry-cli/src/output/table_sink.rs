//! Results as tables for people, one an input, as soon as it is done.

use super::width::wrapped;
use super::{one_line, plain};
use std::io::{self, Write};
use surfometry::io::ResultOutput;
use surfometry::runs::{Failure, Sink};

/// How results become text.
pub(crate) trait Presenter<R> {
    /// One input's results, of which there is at least one.
    fn of_input(&mut self, results: &[R]) -> String;

    /// Whether there is an empty line between inputs.
    fn is_separated(&self) -> bool {
        true
    }

    /// What stands below all.
    fn ending(&self) -> String {
        String::new()
    }
}

impl<R, F: FnMut(&[R]) -> String> Presenter<R> for F {
    fn of_input(&mut self, results: &[R]) -> String {
        self(results)
    }
}

/// Writes a table an input.
pub(crate) struct TableSink<R, P> {
    out: ResultOutput,
    presenter: P,
    /// Whether failures are listed: not where stderr has shown them beside.
    list_failures: bool,
    of_input: Vec<R>,
    failures: Vec<Failure>,
    tables: usize,
}

impl<R, P: Presenter<R>> TableSink<R, P> {
    pub(crate) fn new(out: ResultOutput, presenter: P, list_failures: bool) -> Self {
        Self { out, presenter, list_failures, of_input: Vec::new(), failures: Vec::new(), tables: 0 }
    }

    pub(crate) fn finish(mut self) -> io::Result<ResultOutput> {
        self.input_ends()?;
        self.out.write_all(plain(&self.presenter.ending()).as_bytes())?;
        if self.list_failures && !self.failures.is_empty() {
            let lines: String = self.failures.iter().map(failure_text).collect();
            self.out.write_all(format!("\nnot measured:\n{}", plain(&lines)).as_bytes())?;
        }
        Ok(self.out)
    }
}

fn failure_text(Failure { input, error }: &Failure) -> String {
    wrapped(&format!("{}: {error}", one_line(input)), "  ", "    ")
}

impl<R, P: Presenter<R>> Sink<R> for TableSink<R, P> {
    fn row(&mut self, row: R) -> io::Result<()> {
        self.of_input.push(row);
        Ok(())
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.failures.push(failure);
        Ok(())
    }

    fn input_ends(&mut self) -> io::Result<()> {
        if self.of_input.is_empty() {
            return Ok(());
        }
        let text = self.presenter.of_input(&self.of_input);
        let between = if self.tables > 0 && self.presenter.is_separated() { "\n" } else { "" };
        let text = plain(&text);
        self.of_input.clear();
        self.tables += 1;
        self.out.write_all(format!("{between}{text}").as_bytes())?;
        self.out.flush()
    }
}
