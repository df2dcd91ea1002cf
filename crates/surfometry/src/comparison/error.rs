//! Why tables cannot be compared.

use super::Place;
use std::path::PathBuf;
use thiserror::Error;

/// Why tables cannot be compared.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// Not a file that can be read.
    #[error("{path}: cannot be read: {source}; name a table (.csv, .tsv, .json, .jsonl) or a folder of tables", path = path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file of bytes.
    #[error("{path}: not read as CSV: it is no text (a spreadsheet's or an image's file); save the table as CSV in UTF-8", path = path.display())]
    NoText {
        /// The file.
        path: PathBuf,
    },
    /// Nothing in it.
    #[error("{path}: the file is empty; a table has a line with the names of its columns, and one for each object", path = path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Not a table that can be read.
    #[error("{path}: not read as CSV: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: csv::Error,
    },
    /// A row that is longer or shorter than the header.
    #[error("{path}: not read as CSV: line {line} has {cells} cells, but there are {columns} columns; quote cells that hold the separator, `{separator}`", path = path.display())]
    Ragged {
        /// The file.
        path: PathBuf,
        /// The line in it, from 1.
        line: u64,
        /// Cells in the line.
        cells: usize,
        /// Columns of the table.
        columns: usize,
        /// What stands between cells.
        separator: char,
    },
    /// Columns, but no objects.
    #[error("{path}: there are no objects in it, only the columns {columns}{}", failed_words(*failed), path = path.display())]
    NoRows {
        /// The file.
        path: PathBuf,
        /// Its columns.
        columns: String,
        /// Rows of inputs that failed.
        failed: usize,
    },
    /// Columns of one name.
    #[error("{path}: more than one column is called `{column}`, so it cannot be told which is meant; give each a name of its own", path = path.display())]
    RepeatedColumn {
        /// The file.
        path: PathBuf,
        /// The name.
        column: String,
    },
    /// Decimal commas and points.
    #[error(
        "{comma}, but {point}: decimal commas and points are mixed, so numbers may be misread by 1000; write all with one decimal sign and none between thousands"
    )]
    MixedDecimals {
        /// A cell with a comma.
        comma: Box<Place>,
        /// A cell with a point.
        point: Box<Place>,
    },
    /// Signs between thousands.
    #[error("{place}, with a sign between thousands; write numbers without")]
    Thousands {
        /// The cell.
        place: Place,
    },
    /// No column has the labels.
    #[error("{path}: there is no column `{wanted}` of labels; its columns are {known}", path = path.display())]
    NoLabels {
        /// The file.
        path: PathBuf,
        /// The column that was looked for.
        wanted: String,
        /// Those that are.
        known: String,
    },
    /// A document that is none of ours.
    #[error("{path}: not a document of results: {why}", path = path.display())]
    Document {
        /// The file.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// A folder without tables.
    #[error("{path}: a folder without tables: none of its files ends in .csv, .tsv, .json or .jsonl", path = path.display())]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
    },
    /// No column names the objects.
    #[error("{path}: there is no column `{wanted}` that names the objects, as in the tables that `measure` writes as CSV; its columns are {known}", path = path.display())]
    Unnamed {
        /// The file.
        path: PathBuf,
        /// The column that was looked for.
        wanted: String,
        /// Those that are.
        known: String,
    },
    /// An object twice.
    #[error("{path}: {object} is there more than once, so it cannot be told which row is meant", path = path.display())]
    Twice {
        /// The file.
        path: PathBuf,
        /// The object.
        object: String,
    },
    /// A column that is not there.
    #[error("{path}: there is no column `{column}`; {near}columns of numbers are {known}", path = path.display())]
    NoColumn {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// A question whether one of those that are was meant; empty, or a space is behind it.
        near: String,
        /// Those that are.
        known: String,
    },
    /// A cell that is no number.
    #[error("{path}: {object} has `{text}` in column `{column}`, which is no number; write it as 1234.5, without a unit or a sign between thousands, or leave the cell empty", path = path.display())]
    NotANumber {
        /// The file.
        path: PathBuf,
        /// The object.
        object: String,
        /// The column.
        column: String,
        /// The cell.
        text: String,
    },
    /// Nothing in common.
    #[error("no object is in both {method} and {standard}: they are matched by the columns input and label (with and without folders and endings), as `{example}` and `{other}`", method = method.display(), standard = standard.display())]
    NoMatch {
        /// A file.
        method: PathBuf,
        /// The other.
        standard: PathBuf,
        /// The first object of the first.
        example: String,
        /// The first object of the other.
        other: String,
    },
    /// Neither has what could be compared.
    #[error("{method} and {standard} share none of the columns that are compared by default, or only such as have no value in one of them; name one", method = method.display(), standard = standard.display())]
    NoMeasure {
        /// A file.
        method: PathBuf,
        /// The other.
        standard: PathBuf,
    },
    /// A choice of columns that can be read in several ways.
    #[error("`{choice}` may be {readings}; rename a column")]
    Ambiguous {
        /// What was chosen.
        choice: String,
        /// The ways.
        readings: String,
    },
    /// Columns of several methods, none of which is in both.
    #[error("{method} has `{of_method}` and {standard} `{of_standard}` by several methods each, none of them the same: name one of each", method = method.display(), standard = standard.display())]
    OtherVariants {
        /// A file.
        method: PathBuf,
        /// The other.
        standard: PathBuf,
        /// A column of the one, with its method.
        of_method: String,
        /// A column of the other.
        of_standard: String,
    },
}

fn failed_words(failed: usize) -> String {
    if failed == 0 { String::new() } else { format!("; all {failed} rows are of inputs that failed") }
}

impl TableError {
    /// Whether the system would not let the file be read.
    pub fn is_of_file(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
            || matches!(self, Self::Read { source, .. } if source.is_io_error())
    }
}
