//! Names of labels in JSON: nnU-Net's `dataset.json`, TotalSegmentator's class maps, any object of names and numbers.

use super::{EXPECTED, distinct, row};
use crate::volume::LabelTable;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::Value;

/// The table in a document: its object `labels`, or the document itself.
pub(super) fn table(text: &str) -> Result<LabelTable, String> {
    let document: Value = serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
    let labels = match document.get("labels") {
        Some(labels) => labels,
        None => &document,
    };
    if !labels.is_object() {
        return Err(format!("`labels` is no object; {EXPECTED}"));
    }
    let wrong = |error: serde_json::Error| format!("no table: {error}; {EXPECTED}");
    let Pairs(labels) = match document.get("labels") {
        Some(_) => serde_json::from_str::<OfLabels>(text).map_err(wrong)?.labels,
        None => serde_json::from_str(text).map_err(wrong)?,
    };
    of_pairs(&labels)
}

#[derive(serde::Deserialize)]
struct OfLabels {
    labels: Pairs,
}

/// All pairs of an object, also those of one key.
struct Pairs(Vec<(String, Value)>);

impl<'de> Deserialize<'de> for Pairs {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Pairs;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("an object of names and labels")
            }

            fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Pairs, M::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(Pairs(pairs))
            }
        }
        deserializer.deserialize_map(Reader)
    }
}

/// Numbers of names, as nnU-Net's second version has them, or names of numbers, as its first; a name of several numbers is a
/// region's.
fn of_pairs(labels: &[(String, Value)]) -> Result<LabelTable, String> {
    let (mut rows, mut regions) = (Vec::new(), Vec::new());
    for (key, value) in labels {
        let wrong = || {
            format!("`{key}: {value}` is neither a name and its label nor a label and its name; {EXPECTED}")
        };
        match value {
            Value::String(name) => match (key.trim().parse(), name.trim().parse()) {
                (Ok(label), _) => rows.push((format!("key `{key}`"), row(label, name, None))),
                (Err(_), Ok(label)) => rows.push((format!("key `{key}`"), row(label, key, None))),
                _ => return Err(wrong()),
            },
            Value::Array(values) => {
                let several =
                    values.iter().map(Value::as_i64).collect::<Option<Vec<_>>>().ok_or_else(wrong)?;
                match several[..] {
                    [label] => rows.push((format!("key `{key}`"), row(label, key, None))),
                    _ => regions.push((key.clone(), several)),
                }
            }
            _ => rows.push((format!("key `{key}`"), row(value.as_i64().ok_or_else(wrong)?, key, None))),
        }
    }
    let rows = distinct(rows)?;
    for (_, labels) in &mut regions {
        labels.retain(|label| *label != 0);
    }
    regions.retain(|(_, labels)| !labels.is_empty());
    Ok(rows.into_iter().collect::<LabelTable>().with_regions(regions))
}
