//! Nested records as rows of a table: for CSV, Parquet and data frames.

use serde_json::{Map, Value};

/// Names of a list's entries: positions, or the two ends of a box.
const AXES: [&str; 3] = ["x", "y", "z"];
const ENDS: [&str; 2] = ["min", "max"];

/// Nested keys joined by `_`; vectors as `_x`, `_y`, `_z`, boxes as `_min_x` .. `_max_z`; flags as their
/// codes, changes of topology as their kinds, joined by `;`.
pub fn flatten(record: &Value) -> Map<String, Value> {
    let mut row = Map::new();
    each_field(&mut String::new(), record.clone(), &mut |key, value| {
        row.insert(key.to_owned(), value);
    });
    row
}

/// Every value of a record with the name that [`flatten`] gives it. The name is built in place: tables have a
/// hundred columns and many rows.
pub(super) fn each_field(key: &mut String, value: Value, take: &mut impl FnMut(&str, Value)) {
    match value {
        Value::Object(fields) => fields.into_iter().for_each(|(name, value)| part(key, &name, value, take)),
        Value::Array(list) if key == "flags" || list.iter().any(Value::is_object) => {
            let code = |entry: &Value| entry["code"].as_str().or(entry["kind"].as_str()).map(str::to_owned);
            let codes: Vec<String> = list.iter().filter_map(code).collect();
            take(key, codes.join(";").into());
        }
        Value::Array(list) => {
            let names: &[&str] = if list.iter().any(Value::is_array) { &ENDS } else { &AXES };
            list.into_iter().zip(names).for_each(|(value, name)| part(key, name, value, take));
        }
        plain => take(key, plain),
    }
}

fn part(key: &mut String, name: &str, value: Value, take: &mut impl FnMut(&str, Value)) {
    let length = key.len();
    if length > 0 {
        key.push('_');
    }
    key.push_str(name);
    each_field(key, value, take);
    key.truncate(length);
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nested_fields_become_columns() {
        let row = flatten(&json!({
            "label": 1, "voxels": {"centroid_mm": [1.5, 2.0, 3.0], "bounding_box": [[0, 1, 2], [3, 4, 5]]},
            "flags": [{"code": "a", "message": ""}, {"code": "b", "message": ""}], "none": null
        }));
        assert_eq!(row["voxels_centroid_mm_y"], 2.0);
        assert_eq!(row["voxels_bounding_box_min_x"], 0);
        assert_eq!(row["voxels_bounding_box_max_z"], 5);
        assert_eq!(row["flags"], "a;b");
        assert!(row["none"].is_null());
    }
}
