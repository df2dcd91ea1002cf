//! Files of rows: CSV of any program, and documents of this one.

use super::TableError;
use crate::runs::flatten;
use csv::StringRecord;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// What is taken for a table in a folder.
const ENDINGS: [&str; 4] = ["csv", "tsv", "json", "jsonl"];

/// A file's columns and rows, as text.
pub(super) struct Sheet {
    pub(super) path: PathBuf,
    pub(super) columns: Vec<String>,
    pub(super) records: Vec<StringRecord>,
}

impl Sheet {
    /// The sheets of a file, or of the tables that lie in a folder, in the order of their names.
    pub(super) fn all(path: &Path) -> Result<Vec<Self>, TableError> {
        if !path.is_dir() {
            return Ok(vec![Self::read(path)?]);
        }
        let unread =
            |source: std::io::Error| TableError::Read { path: path.to_owned(), source: source.into() };
        let is_table = |file: &PathBuf| {
            ending(file).is_some_and(|ending| ENDINGS.contains(&ending.as_str())) && file.is_file()
        };
        let entries = path.read_dir().map_err(unread)?.map(|entry| Ok(entry?.path()));
        let mut files = entries.collect::<std::io::Result<Vec<PathBuf>>>().map_err(unread)?;
        files.retain(is_table);
        files.sort();
        if files.is_empty() {
            return Err(TableError::EmptyFolder { path: path.to_owned() });
        }
        files.iter().map(|file| Self::read(file)).collect()
    }

    fn read(path: &Path) -> Result<Self, TableError> {
        let wrong = |source: csv::Error| TableError::Read { path: path.to_owned(), source };
        let bytes = std::fs::read(path).map_err(|e| wrong(e.into()))?;
        if bytes.contains(&0) {
            let error = std::io::Error::other(
                "it is no text (a spreadsheet's or an image's file); save the table as CSV in UTF-8",
            );
            return Err(wrong(error.into()));
        }
        // Units in headers are often in an encoding of their own; numbers are not.
        let text = String::from_utf8_lossy(&bytes);
        match ending(path).as_deref() {
            Some("json") => Self::of_document(path, &text),
            Some("jsonl") => Self::of_lines(path, &text),
            _ => Self::of_csv(path, &text).map_err(wrong),
        }
    }

    fn of_csv(path: &Path, text: &str) -> Result<Self, csv::Error> {
        let separator = separator_of(text.lines().next().unwrap_or_default());
        let mut reader = csv::ReaderBuilder::new().delimiter(separator).from_reader(text.as_bytes());
        let columns = reader.headers()?.iter().map(|name| name.trim().to_owned()).collect();
        let mut records = reader.into_records().collect::<Result<Vec<_>, _>>()?;
        if separator == b';' {
            for record in &mut records {
                *record = record.iter().map(with_point).collect();
            }
        }
        Ok(Self { path: path.to_owned(), columns, records })
    }

    /// The `results` of a document, or the `cases` of one of `validate`.
    fn of_document(path: &Path, text: &str) -> Result<Self, TableError> {
        let wrong = |why: String| TableError::Document { path: path.to_owned(), why };
        let document: Value = serde_json::from_str(text).map_err(|e| wrong(e.to_string()))?;
        let results = document["results"].as_array().or(document["cases"].as_array());
        let results = results.ok_or_else(|| wrong("it has no `results`".to_owned()))?;
        Ok(Self::of_records(path, results))
    }

    fn of_lines(path: &Path, text: &str) -> Result<Self, TableError> {
        let wrong = |e: serde_json::Error| TableError::Document { path: path.to_owned(), why: e.to_string() };
        let lines = text.lines().filter(|line| !line.trim().is_empty());
        let records = lines.map(serde_json::from_str).collect::<Result<Vec<Value>, _>>().map_err(wrong)?;
        Ok(Self::of_records(path, &records))
    }

    /// Columns are those of the first row that has them: what one row lacks, it has no value for.
    fn of_records(path: &Path, records: &[Value]) -> Self {
        let rows: Vec<Map<String, Value>> = records.iter().map(flatten).collect();
        let mut columns: Vec<String> = Vec::new();
        let mut known = std::collections::HashSet::new();
        for name in rows.iter().flat_map(Map::keys) {
            if known.insert(name.as_str()) {
                columns.push(name.clone());
            }
        }
        let cell = |row: &Map<String, Value>, column: &String| match row.get(column) {
            None | Some(Value::Null) => String::new(),
            Some(Value::String(text)) => text.clone(),
            Some(value) => value.to_string(),
        };
        let records =
            rows.iter().map(|row| columns.iter().map(|column| cell(row, column)).collect()).collect();
        Self { path: path.to_owned(), columns, records }
    }
}

fn ending(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}

/// What stands most often between the names of a header, outside quotes; a comma where nothing does.
fn separator_of(header: &str) -> u8 {
    let plain: Vec<&str> = header.split('"').step_by(2).collect();
    let count = |separator: u8| -> usize {
        plain.iter().map(|part| part.matches(char::from(separator)).count()).sum()
    };
    // Of equals the last wins.
    [b'\t', b';', b','].into_iter().max_by_key(|&separator| count(separator)).unwrap_or(b',')
}

/// A number with a decimal comma, as files with semicolons have it, with a point; anything else as it is.
fn with_point(cell: &str) -> String {
    let pointed = cell.replacen(',', ".", 1);
    if pointed.trim().parse::<f64>().is_ok() { pointed } else { cell.to_owned() }
}
