//! `surfometry info`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::expand;
use crate::options::spacing;
use crate::output::{Layout, deliver};
use anyhow::Result;
use serde_json::{Value, json};
use std::fmt::Write;
use surfometry::runs::{LabelInput, open_labels};
use surfometry::volume::Spacing;

/// Show what a file holds: format, grid, orientation, labels
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
    let (mut text, mut documents, mut status) = (String::new(), Vec::new(), ALL_DONE);
    for input in expand(&args.inputs) {
        match open_labels(&input, args.spacing.map(|s| s.mm())) {
            Ok(source) if args.json => documents.push(document(&input, &source)),
            Ok(source) => text += &description(&input, &source),
            Err(error) => {
                eprintln!("surfometry: {input}: {error}");
                status = SOME_FAILED;
            }
        }
    }
    if args.json {
        text = serde_json::to_string_pretty(&documents)? + "\n";
    }
    deliver(&text, None)?;
    Ok(status)
}

fn document(input: &str, source: &LabelInput) -> Value {
    let grid = source.image.grid();
    let labels: Vec<Value> = source
        .image
        .summaries()
        .iter()
        .map(|s| {
            json!({
                "label": s.label,
                "voxels": s.voxels,
                "volume_mm3": s.voxels as f64 * grid.spacing().cell_volume(),
                "bounding_box": [s.bounds.lower, s.bounds.upper.map(|u| u - 1)],
            })
        })
        .collect();
    json!({
        "input": input,
        "format": source.header.as_ref().map(|h| h.format.name()),
        "voxel_type": source.header.as_ref().map(|h| h.scalar.name()),
        "dimensions": grid.dimensions(),
        "spacing_mm": grid.spacing().mm(),
        "axes": grid.affine().axis_codes(),
        "affine_ras_mm": { "linear": grid.affine().linear, "origin": grid.affine().origin },
        "labels": labels,
        "flags": source.flags,
    })
}

fn description(input: &str, source: &LabelInput) -> String {
    let document = document(input, source);
    let word = |key: &str| document[key].as_str().unwrap_or("phantom").to_owned();
    let list = |key: &str| {
        let values = document[key].as_array().into_iter().flatten();
        values.map(Value::to_string).collect::<Vec<_>>().join(" x ")
    };
    let mut text = format!(
        "{input}\n  {}, {}, {} voxels of {} mm, axes {}\n",
        word("format"),
        word("voxel_type"),
        list("dimensions"),
        list("spacing_mm"),
        word("axes"),
    );
    let mut layout = Layout::new(&["label", "voxels", "volume mm³", "first voxel", "last voxel"]);
    for label in document["labels"].as_array().into_iter().flatten() {
        let corner = |i: usize| label["bounding_box"][i].to_string();
        layout.row(vec![
            label["label"].to_string(),
            label["voxels"].to_string(),
            format!("{:.2}", label["volume_mm3"].as_f64().unwrap_or_default()),
            corner(0),
            corner(1),
        ]);
    }
    if source.image.summaries().is_empty() {
        text += "  no foreground: every voxel is 0\n";
    } else {
        text += &layout.text();
    }
    for flag in &source.flags {
        writeln!(text, "  ! {}: {}", flag.code, flag.message).expect("writing to a string");
    }
    text
}
