//! What inputs hold, as text.

use super::{Layout, digits};
use serde_json::Value;
use std::fmt::Write;

/// The document for people.
pub(crate) fn description_text(document: &Value) -> String {
    let facts = document.get("header").unwrap_or(document);
    let word = |value: &Value| value.as_str().unwrap_or("-").to_owned();
    let list = |value: &Value| {
        let numbers = value.as_array().into_iter().flatten().filter_map(Value::as_f64);
        numbers.map(digits).collect::<Vec<_>>().join(" x ")
    };
    let mut text = format!("{}\n", word(&document["input"]));
    if facts.is_null() {
        return text + "  " + &word(&document["error"]) + "\n";
    }
    let spacing =
        if facts["spacing_mm"].is_null() { "unknown".to_owned() } else { list(&facts["spacing_mm"]) };
    let (format, kind) = (word(&facts["format"]), word(&facts["voxel_type"]));
    let labels = match document["labels"].as_array() {
        None => format!("\n  no label image: {}\n", word(&document["error"])),
        Some(labels) if labels.is_empty() => "\n  no foreground: every voxel is 0\n".to_owned(),
        Some(labels) => format!(", axes {}\n{}", word(&document["axes"]), label_table(labels)),
    };
    text = format!("{text}  {format}, {kind}, {} voxels of {spacing} mm{labels}", list(&facts["dimensions"]));
    for flag in document["flags"].as_array().into_iter().flatten() {
        writeln!(text, "  ! {}: {}", word(&flag["code"]), word(&flag["message"]))
            .expect("writing to a string");
    }
    text
}

fn label_table(labels: &[Value]) -> String {
    let mut layout = Layout::new(&["label", "name", "voxels", "volume mm³", "first voxel", "last voxel"]);
    for label in labels {
        layout.row(vec![
            label["label"].to_string(),
            label["name"].as_str().unwrap_or_default().to_owned(),
            label["voxels"].to_string(),
            digits(label["volume_mm3"].as_f64().unwrap_or_default()),
            label["bounding_box"][0].to_string(),
            label["bounding_box"][1].to_string(),
        ]);
    }
    layout.text()
}
