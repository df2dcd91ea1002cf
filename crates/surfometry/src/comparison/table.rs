//! Tables as `measure --format csv` writes them, and any other with a column `input`.

use csv::StringRecord;
use serde::Serialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Which object a row is of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct ObjectKey {
    /// The column `input`.
    pub input: String,
    /// The column `label`; empty without it.
    pub label: String,
    /// The column `component`; empty without it.
    pub component: String,
}

impl std::fmt::Display for ObjectKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.input)?;
        if !self.label.is_empty() {
            write!(f, " label {}", self.label)?;
        }
        if self.component.is_empty() { Ok(()) } else { write!(f, " #{}", self.component) }
    }
}

/// An object's cells, by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The object.
    pub key: ObjectKey,
    cells: StringRecord,
    /// Where each column's cell is, the same for all rows.
    places: Arc<HashMap<String, usize>>,
}

impl Row {
    /// A cell's number; `None` of an empty cell.
    ///
    /// # Errors
    /// The cell's text, where it is no number.
    pub fn number(&self, column: &str) -> Result<Option<f64>, &str> {
        let cell = self.places.get(column).and_then(|&place| self.cells.get(place));
        match cell.unwrap_or_default().trim() {
            "" => Ok(None),
            text => text.parse::<f64>().map(|v| Some(v).filter(|v| v.is_finite())).map_err(|_| text),
        }
    }
}

/// A table of objects.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Where it was read from.
    pub path: PathBuf,
    /// Names of its columns.
    pub columns: Vec<String>,
    /// Its rows.
    pub rows: Vec<Row>,
}

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
    /// No column names the objects.
    #[error("{path}: there is no column `input` that names the objects, as in the tables that `measure` writes as CSV", path = path.display())]
    Unnamed {
        /// The file.
        path: PathBuf,
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
    #[error("no object is in both {method} and {standard}: they are matched by the columns input and label (with and without folders), as `{example}`", method = method.display(), standard = standard.display())]
    NoMatch {
        /// A file.
        method: PathBuf,
        /// The other.
        standard: PathBuf,
        /// The first object of the first.
        example: String,
    },
    /// Neither has what could be compared.
    #[error("{method} and {standard} share none of the columns that are compared by default; name one", method = method.display(), standard = standard.display())]
    NoMeasure {
        /// A file.
        method: PathBuf,
        /// The other.
        standard: PathBuf,
    },
}

impl Table {
    /// The number in a cell of a row of it; `None` of an empty cell.
    ///
    /// # Errors
    /// [`TableError::NotANumber`].
    pub fn number(&self, row: &Row, column: &str) -> Result<Option<f64>, TableError> {
        row.number(column).map_err(|text| TableError::NotANumber {
            path: self.path.clone(),
            object: row.key.to_string(),
            column: column.to_owned(),
            text: text.to_owned(),
        })
    }

    /// Reads a table; rows of inputs that failed (whose column `error` is not empty) are left out.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let wrong = |source| TableError::Read { path: path.to_owned(), source };
        let mut reader = csv::Reader::from_path(path).map_err(wrong)?;
        let columns: Vec<String> = reader.headers().map_err(wrong)?.iter().map(str::to_owned).collect();
        if !columns.iter().any(|column| column == "input") {
            return Err(TableError::Unnamed { path: path.to_owned() });
        }
        let places: Arc<HashMap<String, usize>> = Arc::new(columns.iter().cloned().zip(0..).collect());
        let mut rows = Vec::new();
        for record in reader.into_records() {
            let cells = record.map_err(wrong)?;
            let cell =
                |column: &str| places.get(column).and_then(|&place| cells.get(place)).unwrap_or_default();
            if !cell("error").is_empty() {
                continue;
            }
            let [input, label, component] = ["input", "label", "component"].map(|name| cell(name).to_owned());
            rows.push(Row { key: ObjectKey { input, label, component }, cells, places: Arc::clone(&places) });
        }
        Ok(Self { path: path.to_owned(), columns, rows })
    }

    /// Columns that hold a number in any row, and are not part of an object's name.
    pub(super) fn numeric_columns(&self) -> Vec<&str> {
        let number = |column: &&str| {
            !["label", "component"].contains(column)
                && self.rows.iter().any(|row| matches!(row.number(column), Ok(Some(_))))
        };
        self.columns.iter().map(String::as_str).filter(number).collect()
    }
}
