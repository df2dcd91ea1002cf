//! Results as tables for people, one an input, as soon as it is done.

use super::plain;
use std::io::{self, Write};
use surfometry::io::ResultOutput;
use surfometry::runs::{Failure, Sink};

/// How results become text.
pub(crate) struct TableStyle<R> {
    /// Of one input's results, of which there is at least one.
    pub(crate) of_input: Box<ToText<R>>,
    /// What stands below all tables, if any result wants it.
    pub(crate) legend: Option<Legend<R>>,
}

/// One input's results as text.
type ToText<R> = dyn Fn(&[R]) -> String;

/// A text, and which results want it.
pub(crate) struct Legend<R> {
    pub(crate) text: &'static str,
    pub(crate) wanted: fn(&R) -> bool,
}

/// Writes a table an input.
pub(crate) struct TableSink<R> {
    out: ResultOutput,
    style: TableStyle<R>,
    /// Whether failures are listed: not where stderr has shown them beside.
    list_failures: bool,
    of_input: Vec<R>,
    failures: Vec<Failure>,
    tables: usize,
    explained: bool,
}

impl<R> TableSink<R> {
    pub(crate) fn new(out: ResultOutput, style: TableStyle<R>, list_failures: bool) -> Self {
        Self {
            out,
            style,
            list_failures,
            of_input: Vec::new(),
            failures: Vec::new(),
            tables: 0,
            explained: false,
        }
    }

    pub(crate) fn finish(mut self) -> io::Result<ResultOutput> {
        self.input_ends()?;
        if let Some(Legend { text, .. }) = self.style.legend.as_ref().filter(|_| self.explained) {
            self.out.write_all(format!("\n{text}\n").as_bytes())?;
        }
        if self.list_failures && !self.failures.is_empty() {
            let lines: Vec<String> = self.failures.iter().map(|failure| format!("  {failure}\n")).collect();
            self.out.write_all(format!("\nnot measured:\n{}", plain(&lines.concat())).as_bytes())?;
        }
        Ok(self.out)
    }
}

impl<R> Sink<R> for TableSink<R> {
    fn row(&mut self, row: R) -> io::Result<()> {
        self.explained |= self.style.legend.as_ref().is_some_and(|legend| (legend.wanted)(&row));
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
        let between = if self.tables == 0 { "" } else { "\n" };
        let text = (self.style.of_input)(&self.of_input);
        let text = plain(&text);
        self.of_input.clear();
        self.tables += 1;
        self.out.write_all(format!("{between}{text}").as_bytes())?;
        self.out.flush()
    }
}
