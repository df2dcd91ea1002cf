//! Text with a line for each row: its separator, its header, and what other lines there are.

use super::TableError;
use csv::StringRecord;
use std::path::Path;

/// A text's columns and rows.
pub(super) struct Delimited {
    pub(super) separator: u8,
    pub(super) columns: Vec<String>,
    pub(super) records: Vec<StringRecord>,
    /// The line of each row, from 1.
    pub(super) lines: Vec<u64>,
}

impl Delimited {
    /// Reads the text of a file of that name.
    ///
    /// # Errors
    /// [`TableError::Empty`], [`TableError::Ragged`], [`TableError::Read`].
    pub(super) fn read(path: &Path, text: &str) -> Result<Self, TableError> {
        let wrong = |source: csv::Error| TableError::Read { path: path.to_owned(), source };
        let text = text.trim_start_matches('\u{feff}');
        let Some(Header { start, before, separator }) = Header::find(text) else {
            return Err(TableError::Empty { path: path.to_owned() });
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator)
            .flexible(true)
            .from_reader(&text.as_bytes()[start..]);
        let columns: Vec<String> =
            reader.headers().map_err(wrong)?.iter().map(|name| name.trim().to_owned()).collect();
        let (mut records, mut lines) = (Vec::new(), Vec::new());
        for record in reader.into_records() {
            let record = record.map_err(wrong)?;
            let line = before + record.position().map_or(0, csv::Position::line);
            if record.iter().all(|cell| cell.trim().is_empty()) || is_remark(&record, columns.len()) {
                continue;
            }
            if record.len() != columns.len() {
                return Err(TableError::Ragged {
                    path: path.to_owned(),
                    line,
                    cells: record.len(),
                    columns: columns.len(),
                    separator: char::from(separator),
                });
            }
            records.push(record);
            lines.push(line);
        }
        Ok(Self { separator, columns, records, lines })
    }
}

/// Where a text's header is.
struct Header {
    start: usize,
    /// Lines above it.
    before: u64,
    separator: u8,
}

impl Header {
    /// The first line that holds anything but a remark, or a spreadsheet's `sep=;`.
    fn find(text: &str) -> Option<Self> {
        let (mut start, mut told) = (0, None);
        for (before, line) in (0..).zip(text.split_inclusive('\n')) {
            let content = line.trim_end_matches(['\r', '\n']);
            match separator_told(content) {
                Some(separator) => told = Some(separator),
                None if content.trim().is_empty() || heads_a_remark(content) => (),
                None => {
                    let separator = told.unwrap_or_else(|| separator_of(content));
                    return Some(Self { start, before, separator });
                }
            }
            start += line.len();
        }
        None
    }
}

/// What `sep=;` says, as spreadsheets write it and as they write it back, in quotes or with empty cells after it.
fn separator_told(line: &str) -> Option<u8> {
    let bytes = line.trim_matches('"').as_bytes();
    let (name, rest) = bytes.split_at_checked(4)?;
    let (&first, more) = rest.split_first()?;
    let is_told = name.eq_ignore_ascii_case(b"sep=") && first.is_ascii() && more.iter().all(|c| *c == first);
    is_told.then_some(first)
}

/// Whether a line above the header is a remark: not where its first cell is `#`, a column of numbers.
fn heads_a_remark(line: &str) -> bool {
    let numbers =
        line.split_once(char::from(separator_of(line))).is_some_and(|(first, _)| first.trim() == "#");
    line.starts_with('#') && !numbers
}

/// Whether a line is a remark: not where it has the cells of a row and its object is called `#1`.
fn is_remark(record: &StringRecord, columns: usize) -> bool {
    let first = record.get(0).unwrap_or_default();
    first.strip_prefix('#').is_some_and(|rest| record.len() != columns || rest.starts_with([' ', '#', '\t']))
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
