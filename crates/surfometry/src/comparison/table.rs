//! Tables as `measure --format csv` writes them, and any other whose rows name their objects.

use super::TableError;
use super::sheet::Sheet;
use csv::StringRecord;
use serde::Serialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The column of a row's warnings.
pub(super) const FLAGS: &str = "flags";
/// What stands in a cell without a value, whatever its case.
const MISSING: [&str; 7] = ["", "na", "n/a", "nan", "null", "none", "-"];

/// Which object a row is of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct ObjectKey {
    /// The column `input`.
    pub input: String,
    /// The column `label`, whole numbers without a point (1 for 1.0); empty without it.
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
    pub(super) fn new(key: ObjectKey, cells: StringRecord, places: &Arc<HashMap<String, usize>>) -> Self {
        Self { key, cells, places: Arc::clone(places) }
    }

    /// A cell's text without spaces around it; empty where there is none.
    pub(super) fn cell(&self, column: &str) -> &str {
        cell_of(&self.cells, &self.places, column)
    }

    /// A cell's number; `None` of an empty cell, of one that says that there is no value (NA, NaN, null, none,
    /// -), and of infinity.
    ///
    /// # Errors
    /// The cell's text, where it is no number.
    pub fn number(&self, column: &str) -> Result<Option<f64>, &str> {
        match self.cell(column) {
            text if is_missing(text) => Ok(None),
            text => text.parse::<f64>().map(|v| Some(v).filter(|v| v.is_finite())).map_err(|_| text),
        }
    }

    /// The codes of its warnings.
    pub fn flags(&self) -> impl Iterator<Item = &str> {
        self.cell(FLAGS).split(';').map(str::trim).filter(|code| !is_missing(code))
    }
}

fn cell_of<'a>(cells: &'a StringRecord, places: &HashMap<String, usize>, column: &str) -> &'a str {
    places.get(column).and_then(|&place| cells.get(place)).unwrap_or_default().trim()
}

fn is_missing(text: &str) -> bool {
    MISSING.contains(&text.to_ascii_lowercase().as_str())
}

/// A whole number as digits alone, as 1 for 1.0; nothing for what says that there is no value; other text as it is.
pub(super) fn whole_number_text(text: &str) -> String {
    // Beyond 2^53 a number with a point does not say which it is.
    let whole = |value: &f64| value.fract() == 0.0 && value.abs() < 9_007_199_254_740_992.0;
    match text.parse::<f64>().ok().filter(whole) {
        Some(value) => format!("{}", value as i64),
        None if is_missing(text) => String::new(),
        None => text.to_owned(),
    }
}

/// A table of objects.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Where it was read from: a file, or a folder of tables.
    pub path: PathBuf,
    /// The files that it was read from.
    pub files: Vec<PathBuf>,
    /// Names of its columns.
    pub columns: Vec<String>,
    /// Its rows.
    pub rows: Vec<Row>,
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

    /// Reads a table whose column `input` names the objects; see [`read_named`](Self::read_named).
    ///
    /// # Errors
    /// [`TableError`].
    pub fn read(path: &Path) -> Result<Self, TableError> {
        Self::read_named(path, "input")
    }

    /// Reads a table, or all those in a folder as one; the column `named` names the objects, or, where tables in a
    /// folder have none, their files' names without the ending.
    ///
    /// A table is CSV with commas, semicolons (and then decimal commas too) or tabs between its cells, or a
    /// document that this program writes as JSON or JSONL. Rows of inputs that failed (whose column `error`
    /// is not empty) are left out. Where an object has several rows that a column `method` tells apart, or
    /// what a sweep went over, they become one: the columns of each get the method's name after an `@`.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn read_named(path: &Path, named: &str) -> Result<Self, TableError> {
        let from_folder = path.is_dir();
        let mut table =
            Self { path: path.to_owned(), files: Vec::new(), columns: Vec::new(), rows: Vec::new() };
        for sheet in Sheet::all(path)? {
            let by_file = from_folder && !sheet.columns.iter().any(|column| column == named);
            table.add(sheet, named, by_file)?;
        }
        Ok(table.with_methods_as_columns())
    }

    fn add(&mut self, sheet: Sheet, named: &str, by_file: bool) -> Result<(), TableError> {
        let Sheet { path, columns, records } = sheet;
        if !by_file && !columns.iter().any(|column| column == named) {
            return Err(TableError::Unnamed { path, wanted: named.to_owned(), known: columns.join(", ") });
        }
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.files.push(path);
        let label = columns.iter().find(|name| name.eq_ignore_ascii_case("label") && *name != named);
        let places: Arc<HashMap<String, usize>> = Arc::new(columns.iter().cloned().zip(0..).collect());
        for cells in records {
            let cell = |column: &str| cell_of(&cells, &places, column);
            if !is_missing(cell("error")) {
                continue;
            }
            let key = ObjectKey {
                input: if by_file { stem.clone() } else { cell(named).to_owned() },
                label: whole_number_text(label.map_or("", |label| cell(label))),
                component: whole_number_text(cell("component")),
            };
            self.rows.push(Row::new(key, cells, &places));
        }
        let new: Vec<String> = columns.into_iter().filter(|column| !self.columns.contains(column)).collect();
        self.columns.extend(new);
        Ok(())
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
