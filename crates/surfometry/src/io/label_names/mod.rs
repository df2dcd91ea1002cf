//! Tables of the names of labels, as programs that segment write them beside their images.

mod json;
mod lines;

use super::ReadError;
use super::packed::read_start;
use crate::volume::{LabelEntry, LabelTable};
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
/// # Errors
/// [`ReadError`] that names what could not be read, with its line.
pub fn read_label_names(path: impl AsRef<Path>) -> Result<LabelTable, ReadError> {
    let path = path.as_ref();
    let named = |reason: String| ReadError::LabelNames { path: path.to_owned(), reason };
    let bytes = read_start(path, LONGEST + 1)?;
    if bytes.len() as u64 > LONGEST {
        return Err(named(format!("more than {LONGEST} bytes are no table of names; name the right file")));
    }
    let text = String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes)).into_owned();
    label_names_of_text(&text).map_err(named)
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

fn row(label: i64, name: &str, colour: Option<[u8; 3]>) -> Row {
    (label, LabelEntry { name: Some(name.to_owned()), colour })
}
