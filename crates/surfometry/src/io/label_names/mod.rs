//! Tables of the names of labels, as programs that segment write them beside their images.

mod json;
mod lines;

use super::ReadError;
use super::packed::read_start;
use crate::volume::{LabelEntry, LabelTable};
use encoding_rs::{UTF_8, WINDOWS_1252};
use std::collections::BTreeMap;
use std::path::Path;

/// Longer than any real table.
const LONGEST: u64 = 1 << 24;

/// A row of a table.
type Row = (i64, LabelEntry);

/// Reads names, and colours where there are any, of labels: nnU-Net's `dataset.json`, any JSON of names and numbers, a colour
/// table of FreeSurfer or 3D Slicer, label descriptions of ITK-SNAP, CSV or TSV of labels and names. Which it is, is told
/// by the content. Background (0) is left out.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("dataset.json");
/// std::fs::write(&path, r#"{"labels": {"background": 0, "whole": [1, 2], "core": 2}}"#)?;
/// let table = surfometry::io::read_label_names(&path)?;
/// assert_eq!(table.names()[&2], "core");
/// assert_eq!(table.called("whole")[0].labels(), [1, 2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Text is UTF-8; where it is not, Windows-1252, which has Latin-1 in it.
///
/// # Errors
/// [`ReadError`] that names what could not be read, with its line; also of a label with two names.
pub fn read_label_names(path: impl AsRef<Path>) -> Result<LabelTable, ReadError> {
    read_label_names_warning(path, |_| ())
}

/// The same; `warn` is told where the text's encoding is a guess.
///
/// # Errors
/// As of [`read_label_names`].
pub fn read_label_names_warning(
    path: impl AsRef<Path>,
    warn: impl FnOnce(&str),
) -> Result<LabelTable, ReadError> {
    let path = path.as_ref();
    let named = |reason: String| ReadError::LabelNames { path: path.to_owned(), reason };
    let bytes = read_start(path, LONGEST + 1)?;
    if bytes.len() as u64 > LONGEST {
        return Err(named(format!("more than {LONGEST} bytes are no table of names; name the right file")));
    }
    // UTF-8, or UTF-16 by its mark.
    let (text, encoding, is_wrong) = UTF_8.decode(&bytes);
    let is_guess = is_wrong && encoding == UTF_8;
    let text = if is_guess { WINDOWS_1252.decode(&bytes).0 } else { text };
    let table = label_names_of_text(&text).map_err(named)?;
    if is_guess {
        warn(&format!(
            "{}: its text is no UTF-8, and was read as Windows-1252 (Latin-1): where names look wrong, save it in UTF-8",
            path.display()
        ));
    }
    Ok(table)
}

/// The same of a table's text.
///
/// # Errors
/// What could not be read, with its line.
pub fn label_names_of_text(text: &str) -> Result<LabelTable, String> {
    let table = if text.trim_start().starts_with('{') { json::table(text) } else { lines::table(text) };
    match table? {
        table if table.is_empty() => Err(format!("no label has a name in it; {EXPECTED}")),
        table => Ok(table),
    }
}

/// What a table may be.
const EXPECTED: &str = "expected is nnU-Net's dataset.json, JSON as {\"1\": \"liver\"}, CSV or TSV of label and name, FreeSurfer's `1 liver 255 0 0 0` \
                        or ITK-SNAP's `1 255 0 0 1 1 1 \"liver\"`";

/// Rows of which each was found at a place, as a line: background left out, and no label with two names.
pub(super) fn distinct(rows: impl IntoIterator<Item = (String, Row)>) -> Result<Vec<Row>, String> {
    let mut found = BTreeMap::<i64, (String, Row)>::new();
    for (place, (label, entry)) in rows.into_iter().filter(|(_, (label, _))| *label != 0) {
        let name = |entry: &LabelEntry| entry.name.as_deref().unwrap_or_default().trim().to_owned();
        match found.get(&label) {
            Some((first, (_, earlier))) if name(earlier) != name(&entry) => {
                return Err(format!(
                    "label {label} has two names, `{}` ({first}) and `{}` ({place}); take out the wrong one",
                    name(earlier),
                    name(&entry)
                ));
            }
            Some(_) => (),
            None => drop(found.insert(label, (place, (label, entry)))),
        }
    }
    Ok(found.into_values().map(|(_, row)| row).collect())
}

fn row(label: i64, name: &str, colour: Option<[u8; 3]>) -> Row {
    (label, LabelEntry { name: Some(name.to_owned()), colour })
}
