//! Tables as `measure --format csv` writes them, and any other whose rows name their objects.

use super::TableError;
use super::decimals::Decimals;
use super::sheet::Sheet;
use crate::text::FORMULA;
use csv::StringRecord;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap, HashSet};
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
    /// The column `label`, whole numbers without a point (1 for 1.0), united labels in ascending order (1+2 for 2+1);
    /// empty without it.
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

    /// A cell's number; `None` of an empty cell and of one that says that there is no value (NA, NaN, null, none,
    /// -).
    ///
    /// # Errors
    /// The cell's text, where it is no number, or infinity.
    pub fn number(&self, column: &str) -> Result<Option<f64>, &str> {
        match self.cell(column) {
            text if is_missing(text) => Ok(None),
            text => text.parse::<f64>().ok().filter(|v| v.is_finite()).map(Some).ok_or(text),
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

/// A name without the apostrophe that keeps spreadsheets from taking it for a formula.
fn name_text(text: &str) -> &str {
    text.strip_prefix('\'').filter(|name| name.starts_with(FORMULA)).unwrap_or(text)
}

/// A label as [`whole_number_text`] has it; of united ones each, in ascending order.
fn label_text(text: &str) -> String {
    let parts: Option<Vec<i64>> = text.split('+').map(|part| part.trim().parse().ok()).collect();
    match parts {
        Some(mut labels) if labels.len() > 1 => {
            labels.sort_unstable();
            labels.iter().map(i64::to_string).collect::<Vec<_>>().join("+")
        }
        _ => whole_number_text(text),
    }
}

/// Which columns name the objects.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyColumns {
    /// The one of inputs.
    pub object: String,
    /// The one of labels; `None` for `label`, whatever its case, where there is one.
    pub label: Option<String>,
}

impl Default for KeyColumns {
    fn default() -> Self {
        Self { object: "input".to_owned(), label: None }
    }
}

/// What is in a file, or in the tables of a folder, before it is said which columns name the objects.
///
/// A table is CSV with commas, semicolons (and then decimal commas too) or tabs between its cells, which the
/// header or a first line `sep=;` tells, or a document that this program writes as JSON or JSONL. Lines that
/// begin with `#`, and lines without anything in them, are left out.
#[derive(Debug)]
pub struct TableFiles {
    path: PathBuf,
    sheets: Vec<Sheet>,
}

impl TableFiles {
    /// Reads them.
    ///
    /// # Errors
    /// [`TableError`] of what is no table.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        Ok(Self { path: path.to_owned(), sheets: Sheet::all(path)? })
    }

    /// Whether any of them has a column.
    pub fn has(&self, column: &str) -> bool {
        self.sheets.iter().any(|sheet| sheet.columns.iter().any(|name| name == column))
    }

    /// All of them as one table. Where tables in a folder have no column of inputs, their files' names without
    /// the ending are the inputs.
    ///
    /// Rows of inputs that failed (whose column `error` has words) are left out and counted. Where an object has several
    /// rows that a column `method` tells apart, or what a sweep went over, they become one: the columns of each
    /// get the method's name after an `@`.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn into_table(self, names: &KeyColumns) -> Result<Table, TableError> {
        let from_folder = self.path.is_dir();
        let mut table = Table::empty(self.path);
        for sheet in self.sheets {
            let by_file = from_folder && !sheet.columns.contains(&names.object);
            table.add(sheet, names, by_file)?;
        }
        if table.rows.is_empty() {
            let columns = table.columns.join(", ");
            return Err(TableError::NoRows { path: table.path, columns, failed: table.failed });
        }
        table.with_methods_as_columns()
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
    /// Rows of inputs that failed, which are left out.
    pub failed: usize,
    /// The signs in its numbers, of the files with each separator.
    pub(super) decimals: BTreeMap<u8, Decimals>,
}

impl Table {
    /// Reads a table, or all those in a folder as one, as [`TableFiles`] has it; its column `input` names the
    /// objects.
    ///
    /// # Errors
    /// [`TableError`].
    pub fn read(path: &Path) -> Result<Self, TableError> {
        TableFiles::read(path)?.into_table(&KeyColumns::default())
    }

    fn empty(path: PathBuf) -> Self {
        Self {
            path,
            files: Vec::new(),
            columns: Vec::new(),
            rows: Vec::new(),
            failed: 0,
            decimals: BTreeMap::new(),
        }
    }

    /// The number in a cell of a row of it; `None` of an empty cell.
    ///
    /// # Errors
    /// [`TableError::NotANumber`]; [`TableError::MixedDecimals`] and [`TableError::Thousands`] where the column
    /// is one whose numbers may be meant a thousand times as large.
    pub fn number(&self, row: &Row, column: &str) -> Result<Option<f64>, TableError> {
        for decimals in self.decimals.values() {
            decimals.check(column)?;
        }
        row.number(column).map_err(|text| TableError::NotANumber {
            path: self.path.clone(),
            object: row.key.to_string(),
            column: column.to_owned(),
            text: text.to_owned(),
        })
    }

    /// What is assumed of a column whose numbers may all be meant a thousand times as large.
    pub(super) fn doubt(&self, column: &str) -> Option<String> {
        // With commas between cells points are decimal points.
        let unsure = self.decimals.iter().filter(|(separator, _)| **separator != b',');
        let place = unsure.map(|(_, decimals)| decimals.doubt(column)).find_map(|place| place)?;
        Some(format!(
            "{place}, read with a decimal sign: no number of the table tells whether thousands are meant"
        ))
    }

    /// Takes a sheet's rows.
    fn add(&mut self, sheet: Sheet, names: &KeyColumns, by_file: bool) -> Result<(), TableError> {
        let Sheet { path, columns, records, text } = sheet;
        refuse_repeated(&path, &columns)?;
        let named = names.object.as_str();
        if !by_file && !columns.iter().any(|column| column == named) {
            return Err(TableError::Unnamed { path, wanted: named.to_owned(), known: columns.join(", ") });
        }
        let label = label_column(&path, &columns, names)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let places: Arc<HashMap<String, usize>> = Arc::new(columns.iter().cloned().zip(0..).collect());
        let is_name = |column: &str| [Some(named), label, Some("component")].contains(&Some(column));
        for (number, mut cells) in records.into_iter().enumerate() {
            if is_failure(cell_of(&cells, &places, "error")) {
                self.failed += 1;
                continue;
            }
            if let Some((separator, lines)) = &text {
                let decimals = self.decimals.entry(*separator).or_default();
                for (column, cell) in columns.iter().zip(&cells) {
                    if !is_name(column) && !is_missing(cell.trim()) {
                        decimals.see(&path, lines[number], column, cell.trim());
                    }
                }
                if *separator == b';' {
                    let converted = |(column, cell): (&String, &str)| {
                        if column == named { cell.to_owned() } else { with_point(cell) }
                    };
                    cells = columns.iter().zip(&cells).map(converted).collect();
                }
            }
            let cell = |column: &str| cell_of(&cells, &places, column);
            let key = ObjectKey {
                input: if by_file { stem.clone() } else { name_text(cell(named)).to_owned() },
                label: label_text(label.map_or("", cell)),
                component: whole_number_text(cell("component")),
            };
            self.rows.push(Row::new(key, cells, &places));
        }
        self.files.push(path);
        let new: Vec<String> = columns.into_iter().filter(|column| !self.columns.contains(column)).collect();
        self.columns.extend(new);
        Ok(())
    }

    /// Columns that hold a number in any row, and are not part of an object's name.
    pub(super) fn numeric_columns(&self) -> Vec<&str> {
        self.columns_with(|found| matches!(found, Ok(Some(_))))
    }

    /// Columns that hold anything in any row, be it unreadable, and are not part of an object's name.
    pub(super) fn filled_columns(&self) -> Vec<&str> {
        self.columns_with(|found| !matches!(found, Ok(None)))
    }

    fn columns_with(&self, is_wanted: impl Fn(Result<Option<f64>, &str>) -> bool) -> Vec<&str> {
        let is_one = |column: &&str| {
            !["label", "component"].contains(column)
                && self.rows.iter().any(|row| is_wanted(row.number(column)))
        };
        self.columns.iter().map(String::as_str).filter(is_one).collect()
    }
}

/// The column of labels, where a table has one.
///
/// # Errors
/// [`TableError::NoLabels`] where it lacks the one that was named.
fn label_column<'a>(
    path: &Path,
    columns: &'a [String],
    names: &KeyColumns,
) -> Result<Option<&'a str>, TableError> {
    let Some(wanted) = &names.label else {
        let is_label = |name: &&String| name.eq_ignore_ascii_case("label") && **name != names.object;
        return Ok(columns.iter().find(is_label).map(String::as_str));
    };
    let found = columns.iter().find(|name| *name == wanted).map(String::as_str);
    found.map(Some).ok_or_else(|| TableError::NoLabels {
        path: path.to_owned(),
        wanted: wanted.clone(),
        known: columns.join(", "),
    })
}

/// Refuses a table of which two columns have one name. Columns without a name cannot be named, so they do no harm.
///
/// # Errors
/// [`TableError::RepeatedColumn`].
pub(super) fn refuse_repeated(path: &Path, columns: &[String]) -> Result<(), TableError> {
    let mut seen = HashSet::new();
    match columns.iter().find(|column| !column.is_empty() && !seen.insert(column.as_str())) {
        Some(column) => Err(TableError::RepeatedColumn { path: path.to_owned(), column: column.clone() }),
        None => Ok(()),
    }
}

/// Whether a cell of the column `error` tells of a failure: other programs call a standard error so, which is a number.
fn is_failure(cell: &str) -> bool {
    !is_missing(cell.trim()) && with_point(cell).trim().parse::<f64>().is_err()
}

/// A number with a decimal comma, as files with semicolons have it, with a point; anything else as it is.
fn with_point(cell: &str) -> String {
    let pointed = cell.replacen(',', ".", 1);
    if pointed.trim().parse::<f64>().is_ok() { pointed } else { cell.to_owned() }
}
