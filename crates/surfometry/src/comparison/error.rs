//! Why tables cannot be compared.

use std::path::PathBuf;
use thiserror::Error;

/// Why tables cannot be compared.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// Not a table that can be read.
    #[error("{path}: not read as CSV: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: csv::Error,
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
    #[error("{path}: there is no column `{column}`; columns of numbers are {known}", path = path.display())]
    NoColumn {
        /// The file.
        path: PathBuf,
        /// The column.
        column: String,
        /// Those that are.
        known: String,
    },
    /// A cell that is no number.
    #[error("{path}: {object} has `{text}` in column `{column}`, which is no number", path = path.display())]
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
    #[error("{method} and {standard} share none of the columns that are compared by default; name one", method = method.display(), standard = standard.display())]
    NoMeasure {
        /// A file.
        method: PathBuf,
        /// The other.
        standard: PathBuf,
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

impl TableError {
    /// Whether the system would not let the file be read.
    pub fn is_of_file(&self) -> bool {
        matches!(self, Self::Read { source, .. } if source.is_io_error())
    }
}
