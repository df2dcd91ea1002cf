//! `surfometry info`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::expand;
use crate::options::spacing;
use crate::output::{Layout, deliver, digits, json_text, say};
use anyhow::Result;
use serde_json::{Value, json};
use std::fmt::Write;
use surfometry::io::{ImageHeader, read_header};
use surfometry::runs::{Failure, LabelInput, open_labels};
use surfometry::volume::Spacing;

/// Show what a file holds: format, grid, orientation, labels
///
/// Where the voxels are no labels, as in a field or a grey image, the header is shown and the reason given.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,
    /// Voxel spacing in mm, fastest axis first: replaces the file's, or supplies what it lacks
    #[arg(long, value_name = "X,Y,Z", value_parser = spacing, allow_hyphen_values = true)]
    spacing: Option<Spacing>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<u8> {
    let (mut documents, mut status) = (Vec::new(), ALL_DONE);
    for input in expand(&args.inputs) {
        let document = match open_labels(&input, args.spacing.map(|s| s.mm())) {
            Ok(source) => document(&input, &source),
            Err(error) => {
                status = SOME_FAILED;
                let failure = Failure::new(&input, &error);
                say(&failure.to_string());
                let header = read_header(&input).ok();
                json!({ "input": input, "error": failure.error, "header": header.as_ref().map(facts) })
            }
        };
        documents.push(document);
    }
    let text = if args.json { json_text(&documents)? } else { documents.iter().map(description).collect() };
    deliver(&text, None)?;
    Ok(status)
}

/// What a header alone says.
fn facts(header: &ImageHeader) -> Value {
    json!({
        "format": header.format.name(),
        "voxel_type": header.scalar.name(),
        "dimensions": header.dimensions,
        "spacing_mm": header.affine.map(|a| a.column_lengths()),
    })
}

fn document(input: &str, source: &LabelInput) -> Value {
    let grid = source.image.grid();
    let label = |s: &surfometry::volume::LabelSummary| {
        json!({
            "label": s.label,
            "voxels": s.voxels,
            "volume_mm3": s.voxels as f64 * grid.spacing().cell_volume(),
            "bounding_box": [s.bounds.lower, s.bounds.upper.map(|u| u - 1)],
        })
    };
    json!({
        "input": input,
        "format": source.header.as_ref().map_or("phantom", |h| h.format.name()),
        "voxel_type": source.header.as_ref().map_or("uint8", |h| h.scalar.name()),
        "dimensions": grid.dimensions(),
        "spacing_mm": grid.spacing().mm(),
        "axes": grid.affine().axis_codes(),
        "affine_ras_mm": { "linear": grid.affine().linear, "origin": grid.affine().origin },
        "labels": source.image.summaries().iter().map(label).collect::<Vec<_>>(),
        "flags": source.flags,
    })
}

/// The document for people.
fn description(document: &Value) -> String {
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
    let mut layout = Layout::new(&["label", "voxels", "volume mm³", "first voxel", "last voxel"]);
    for label in labels {
        layout.row(vec![
            label["label"].to_string(),
            label["voxels"].to_string(),
            digits(label["volume_mm3"].as_f64().unwrap_or_default()),
            label["bounding_box"][0].to_string(),
            label["bounding_box"][1].to_string(),
        ]);
    }
    layout.text()
}
