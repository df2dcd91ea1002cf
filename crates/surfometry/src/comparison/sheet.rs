//! Files of rows: text of any program, and documents of this one.

use super::TableError;
use super::delimited::Delimited;
use crate::io::read_handed_on;
use crate::runs::flatten;
use csv::StringRecord;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// What is taken for a table in a folder.
const ENDINGS: [&str; 4] = ["csv", "tsv", "json", "jsonl"];

/// A file's columns and rows, as text.
#[derive(Debug)]
pub(super) struct Sheet {
    pub(super) path: PathBuf,
    pub(super) columns: Vec<String>,
    pub(super) records: Vec<StringRecord>,
    /// Of text: what stands between cells, and the line of each row. A document's numbers are never in doubt.
    pub(super) text: Option<(u8, Vec<u64>)>,
}

impl Sheet {
    /// The sheets of a file, or of the tables that lie in a folder, in the order of their names.
    pub(super) fn all(path: &Path) -> Result<Vec<Self>, TableError> {
        if !path.is_dir() {
            return Ok(vec![Self::read(path)?]);
        }
        let unread = |source: std::io::Error| TableError::Unreadable { path: path.to_owned(), source };
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
        let unread = |source: std::io::Error| TableError::Unreadable { path: path.to_owned(), source };
        let bytes = read_handed_on(path).map_err(unread)?;
        if bytes.contains(&0) {
            return Err(TableError::NoText { path: path.to_owned() });
        }
        // Units in headers are often in an encoding of their own; numbers are not.
        let text = String::from_utf8_lossy(&bytes);
        match ending(path).as_deref() {
            Some("json") => Self::of_document(path, &text),
            Some("jsonl") => Self::of_lines(path, &text),
            _ => Self::of_text(path, &text),
        }
    }

    fn of_text(path: &Path, text: &str) -> Result<Self, TableError> {
        let Delimited { separator, columns, records, lines } = Delimited::read(path, text)?;
        Ok(Self { path: path.to_owned(), columns, records, text: Some((separator, lines)) })
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
        let wrong = |line: usize, error: &serde_json::Error| {
            // Of a line by itself it tells that it is the first.
            let told = error.to_string();
            let what = told.rsplit_once(" at line ").map_or(told.as_str(), |(what, _)| what);
            let why = format!("line {line}, column {}: {what}", error.column());
            TableError::Document { path: path.to_owned(), why }
        };
        let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
        let records = lines.map(|(number, line)| serde_json::from_str(line).map_err(|e| wrong(number, &e)));
        let records = records.collect::<Result<Vec<Value>, _>>()?;
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
        Self { path: path.to_owned(), columns, records, text: None }
    }
}

fn ending(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}
