//! `surfometry phantom`.

use super::ALL_DONE;
use crate::output::{check_output, deliver, json_text, say};
use anyhow::{Context, Result};
use serde_json::json;
use std::path::{Path, PathBuf};
use surfometry::inputs::{OpenOptions, open};
use surfometry::io::write_labels;
use surfometry::volume::LabelImage;

/// Write a phantom as NIfTI, and its exact integrals beside it as JSON
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::PHANTOM)]
pub(crate) struct Args {
    /// NAME?key=value&..., as in `measure`; a leading `phantom:` may be left out
    phantom: String,
    /// .nii or .nii.gz to write; the truth goes to the same name with .truth.json
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<u8> {
    let name = args.phantom.strip_prefix("phantom:").unwrap_or(&args.phantom);
    let spec = format!("phantom:{name}");
    let truth_path = truth_path(&args.output)?;
    check_output(Some(&args.output), &[])?;
    check_output(Some(&truth_path), &[])?;
    let source = open(&spec, &OpenOptions::default()).with_context(|| spec.clone())?;
    let slabs = source.slabs().and_then(|mut slabs| LabelImage::from_slabs(&mut slabs));
    let image = slabs.with_context(|| spec.clone())?;
    if image.summaries().is_empty() {
        say(&format!("{spec}: no voxel lies inside; the shape is small against the spacing"));
    }
    write_labels(&args.output, &image).with_context(|| args.output.display().to_string())?;
    let truth = json!({ "phantom": spec, "truth": source.truth() });
    deliver(&json_text(&truth)?, Some(&truth_path))?;
    Ok(ALL_DONE)
}

fn truth_path(image: &Path) -> Result<PathBuf> {
    let name = image.to_string_lossy();
    let lower = name.to_lowercase();
    let stem =
        [".nii.gz", ".nii"].iter().find(|e| lower.ends_with(**e)).map(|e| &name[..name.len() - e.len()]);
    let stem = stem.with_context(|| format!("{name}: a phantom is written as .nii or .nii.gz"))?;
    Ok(PathBuf::from(format!("{stem}.truth.json")))
}
