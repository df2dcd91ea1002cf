//! Results as documents, written while they come.

use super::flatten::each_field;
use super::{Failure, MadeBy, Outcome, Settings, Sink};
use crate::io::ResultOutput;
use crate::text::{FORMULA, plain};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::{self, IsTerminal, Write};
use std::marker::PhantomData;
use std::path::Path;

/// The form of a document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DocumentForm {
    /// One document.
    Json,
    /// A line of JSON a result.
    JsonLines,
    /// A table.
    Csv,
}

impl DocumentForm {
    /// The one that the ending of a file's name says.
    pub fn of_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_ascii_lowercase().to_str()? {
            "json" => Some(Self::Json),
            "jsonl" => Some(Self::JsonLines),
            "csv" => Some(Self::Csv),
            _ => None,
        }
    }

    /// Runs something that hands its results to a sink, and writes these in this form; the output is to be ended.
    ///
    /// # Errors
    /// Whatever keeps them from being written.
    pub fn write<R: Row>(
        self,
        out: ResultOutput,
        settings: &Settings,
        run: impl FnOnce(&mut dyn Sink<R>) -> io::Result<Outcome>,
    ) -> io::Result<(Outcome, ResultOutput)> {
        match self {
            Self::Json => {
                let mut sink = JsonSink::new(out, settings)?;
                Ok((run(&mut sink)?, sink.finish()?))
            }
            Self::JsonLines => {
                let mut sink = JsonLinesSink::new(out);
                Ok((run(&mut sink)?, sink.finish()))
            }
            Self::Csv => {
                let mut sink = CsvSink::new(out)?;
                Ok((run(&mut sink)?, sink.finish()?))
            }
        }
    }
}

/// A result that documents and tables hold.
pub trait Row: Serialize + Send {
    /// Name and version of the document.
    const SCHEMA: &'static str;

    /// The columns of a table, the same for every row.
    fn columns() -> Vec<String>;
}

/// The document as a whole: what made it, settings, results, failures. Wherever the run ends, what was written to a
/// file so far is a whole document.
pub struct JsonSink<R> {
    out: ResultOutput,
    rows: usize,
    failures: Vec<Failure>,
    of: PhantomData<fn(R)>,
}

impl<R: Row> JsonSink<R> {
    /// Begins a document of results that were had with some settings.
    ///
    /// # Errors
    /// Whatever keeps it from being written.
    pub fn new(out: ResultOutput, settings: &Settings) -> io::Result<Self> {
        let mut sink = Self { out, rows: 0, failures: Vec::new(), of: PhantomData };
        let MadeBy { version, commit, machine } = MadeBy::this();
        let head = [
            ("schema", json!(R::SCHEMA)),
            ("version", json!(version)),
            ("commit", json!(commit)),
            ("machine", json!(machine)),
        ];
        let fields = head.map(|(name, value)| format!("  \"{name}\": {value},\n")).concat();
        let settings = indented(settings, "  ")?;
        sink.write(&format!("{{\n{fields}  \"settings\": {settings},\n  \"results\": ["))?;
        Ok(sink)
    }

    /// Ends the document.
    ///
    /// # Errors
    /// Whatever keeps it from being written.
    pub fn finish(mut self) -> io::Result<ResultOutput> {
        let end = self.end()?;
        self.out.write_all(end.as_bytes())?;
        Ok(self.out)
    }

    fn end(&self) -> io::Result<String> {
        let close = if self.rows == 0 { "]" } else { "\n  ]" };
        Ok(format!("{close},\n  \"failures\": {}\n}}\n", indented(&self.failures, "  ")?))
    }

    fn write(&mut self, text: &str) -> io::Result<()> {
        let end = self.end()?;
        self.out.write_secured(text.as_bytes(), end.as_bytes())
    }
}

impl<R: Row> Sink<R> for JsonSink<R> {
    fn row(&mut self, row: R) -> io::Result<()> {
        let comma = if self.rows == 0 { "" } else { "," };
        self.rows += 1;
        self.write(&format!("{comma}\n    {}", indented(&row, "    ")?))
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.failures.push(failure);
        self.write("")
    }
}

/// A value as it stands in a document that is indented by two spaces a level.
fn indented(value: &impl Serialize, by: &str) -> io::Result<String> {
    Ok(serde_json::to_string_pretty(value)?.replace('\n', &format!("\n{by}")))
}

/// A result or a failure a line.
pub struct JsonLinesSink<R> {
    out: ResultOutput,
    of: PhantomData<fn(R)>,
}

impl<R: Row> JsonLinesSink<R> {
    /// Of an output.
    pub fn new(out: ResultOutput) -> Self {
        Self { out, of: PhantomData }
    }

    /// The output, to which all was written.
    pub fn finish(self) -> ResultOutput {
        self.out
    }

    fn line(&mut self, value: &impl Serialize) -> io::Result<()> {
        self.out.write_all((serde_json::to_string(value)? + "\n").as_bytes())?;
        self.out.flush()
    }
}

impl<R: Row> Sink<R> for JsonLinesSink<R> {
    fn row(&mut self, row: R) -> io::Result<()> {
        self.line(&row)
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.line(&failure)
    }
}

/// A table with a header: nested fields flattened, failed inputs as rows with an `error`.
pub struct CsvSink<R> {
    out: csv::Writer<ResultOutput>,
    /// Whether people see it, to whose terminal names say nothing.
    is_shown: bool,
    /// Where each column is.
    columns: HashMap<String, usize>,
    of: PhantomData<fn(R)>,
}

impl<R: Row> CsvSink<R> {
    /// Begins a table.
    ///
    /// # Errors
    /// Whatever keeps it from being written.
    pub fn new(out: ResultOutput) -> io::Result<Self> {
        let is_shown = matches!(out, ResultOutput::Stream(_)) && io::stdout().is_terminal();
        let mut out = csv::Writer::from_writer(out);
        out.write_record(header::<R>())?;
        out.flush()?;
        Ok(Self { out, is_shown, columns: places::<R>(), of: PhantomData })
    }

    /// The output, all written.
    ///
    /// # Errors
    /// Whatever keeps it from being written.
    pub fn finish(self) -> io::Result<ResultOutput> {
        self.out.into_inner().map_err(csv::IntoInnerError::into_error)
    }

    fn write(&mut self, record: Value) -> io::Result<()> {
        let cells = cells(&self.columns, record);
        if self.is_shown {
            self.out.write_record(cells.iter().map(|cell| plain(cell).into_owned()))?;
        } else {
            self.out.write_record(cells)?;
        }
        self.out.flush()
    }
}

impl<R: Row> Sink<R> for CsvSink<R> {
    fn row(&mut self, row: R) -> io::Result<()> {
        self.write(serde_json::to_value(row)?)
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.write(serde_json::to_value(failure)?)
    }
}

fn header<R: Row>() -> Vec<String> {
    let mut columns = R::columns();
    columns.push("error".to_owned());
    columns
}

/// Where each column is.
fn places<R: Row>() -> HashMap<String, usize> {
    header::<R>().into_iter().enumerate().map(|(place, name)| (name, place)).collect()
}

/// A row's cells.
fn cells(columns: &HashMap<String, usize>, record: Value) -> Vec<String> {
    let mut cells = vec![String::new(); columns.len()];
    each_field(&mut String::new(), record, &mut |name, value| {
        if let Some(&place) = columns.get(name) {
            cells[place] = cell(value);
        }
    });
    cells
}

/// The lines of a table of records: its header, then one each.
#[cfg(feature = "report")]
pub(crate) fn csv_lines<R: Row>(records: Vec<Value>) -> io::Result<Vec<String>> {
    let columns = places::<R>();
    let line = |cells: Vec<String>| {
        let mut out = csv::Writer::from_writer(Vec::new());
        out.write_record(cells)?;
        let bytes = out.into_inner().map_err(csv::IntoInnerError::into_error)?;
        String::from_utf8(bytes).map_err(io::Error::other)
    };
    let rows = records.into_iter().map(|record| cells(&columns, record));
    std::iter::once(header::<R>()).chain(rows).map(line).collect()
}

fn cell(value: Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text_cell(text),
        other => other.to_string(),
    }
}

/// A text that a spreadsheet takes for no formula: an apostrophe stands in front of one that would be.
pub(super) fn text_cell(text: String) -> String {
    let formula = text.starts_with(FORMULA) && text.parse::<f64>().is_err();
    if formula { format!("'{text}") } else { text }
}
