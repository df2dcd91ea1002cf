//! Names of labels in JSON: nnU-Net's `dataset.json`, TotalSegmentator's class maps, any object of names and numbers.

use super::{EXPECTED, row};
use crate::volume::LabelTable;
use serde_json::{Map, Value};

/// The table in a document: its object `labels`, or the document itself.
pub(super) fn table(text: &str) -> Result<LabelTable, String> {
    let document: Value = serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
    let labels = match document.get("labels") {
        Some(labels) => labels,
        None => &document,
    };
    let Value::Object(labels) = labels else { return Err(format!("`labels` is no object; {EXPECTED}")) };
    of_object(labels)
}

/// Numbers of names, as nnU-Net's second version has them, or names of numbers, as its first; a name of several numbers is a
/// region's.
fn of_object(labels: &Map<String, Value>) -> Result<LabelTable, String> {
    let (mut rows, mut regions) = (Vec::new(), Vec::new());
    for (key, value) in labels {
        let wrong = || {
            format!("`{key}: {value}` is neither a name and its label nor a label and its name; {EXPECTED}")
        };
        match value {
            Value::String(name) => match (key.trim().parse(), name.trim().parse()) {
                (Ok(label), _) => rows.push(row(label, name, None)),
                (Err(_), Ok(label)) => rows.push(row(label, key, None)),
                _ => return Err(wrong()),
            },
            Value::Array(values) => {
                let several =
                    values.iter().map(Value::as_i64).collect::<Option<Vec<_>>>().ok_or_else(wrong)?;
                match several[..] {
                    [label] => rows.push(row(label, key, None)),
                    _ => regions.push((key.clone(), several)),
                }
            }
            _ => rows.push(row(value.as_i64().ok_or_else(wrong)?, key, None)),
        }
    }
    rows.retain(|(label, _)| *label != 0);
    for (_, labels) in &mut regions {
        labels.retain(|label| *label != 0);
    }
    regions.retain(|(_, labels)| !labels.is_empty());
    Ok(rows.into_iter().collect::<LabelTable>().with_regions(regions))
}
