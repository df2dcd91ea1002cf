//! `surfometry validate`.

use super::ALL_DONE;
use crate::console::progress_bar;
use crate::output::{check_output, deliver, json_text, rivalry_table, validation_table};
use crate::values::one_of;
use anyhow::{Result, bail};
use clap::ValueEnum;
use serde_json::{Value, json};
use std::path::PathBuf;
use surfometry::measurement::CurvatureScale;
use surfometry::runs::words::{WordError, curvature_scale, positive};
use surfometry::runs::write_zoo;
use surfometry::text::did_you_mean;
use surfometry::validation::{CaseResult, MadeCase, Noise, Validation, Zoo, against, summarise};

/// Measure a zoo of shapes with exact truth, in many poses, and print how far off the numbers are
///
/// Each shape is made with a radius of curvature R (1 / rms of the larger principal curvature) of some
/// voxels, on cubic and on unequal spacings, rotated and shifted off the grid, and measured with the
/// defaults; local curvature at an automatic scale. Nothing is read but the program itself.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::VALIDATE)]
pub(crate) struct Args {
    /// Which shapes
    #[arg(long, default_value = "bodies", value_parser = one_of::<Zoo>())]
    zoo: Zoo,
    /// What is done to their masks
    #[arg(long, default_value = "none", value_parser = one_of::<Noise>())]
    noise: Noise,
    /// R in units of the largest spacing [default: 10,20; of thin shapes 1.5,2,2.5,3]
    #[arg(long, value_name = "R,R", value_delimiter = ',', value_parser = resolution)]
    resolutions: Option<Vec<f64>>,
    /// Largest over smallest spacing
    #[arg(long, value_name = "Q,Q", value_delimiter = ',', default_value = "1,3", value_parser = ratio)]
    ratios: Vec<f64>,
    /// Poses of each shape
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=MOST_POSES))]
    poses: u32,
    /// Number of the first pose: other poses are other rotations, shifts and sizes
    #[arg(long, default_value_t = 0)]
    first_pose: u32,
    /// Shapes: those whose name has this in it; may be given several times [default: all]
    #[arg(long, value_name = "NAME")]
    shape: Vec<String>,
    /// Write the phantoms into a folder as NIfTI instead, with truth.csv: for other programs to measure
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["against", "output"])]
    write: Option<PathBuf>,
    /// Compare with another program's numbers for the phantoms of --write: a table whose column `input` has their
    /// files' names, and the others the names of ours, volume_mm3, surface_area_mm2, total_mean_curvature_mm
    #[arg(long, value_name = "FILE.csv")]
    against: Option<PathBuf>,
    /// Scale of local curvature: `auto` and `local`, one at each vertex, or `object`, one for each shape
    #[arg(long, value_name = "auto|local|object", default_value = "auto", value_parser = automatic)]
    curvature_sigma: CurvatureScale,
    /// Integrals alone
    #[arg(long)]
    no_local: bool,
    /// What to print: a table, or JSON with every case
    #[arg(long, value_enum, default_value = "table")]
    format: Format,
    /// Where to write, instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Table,
    Json,
}

/// Most poses of a shape, and voxels of a radius: 10^9 voxels an image.
const MOST_POSES: i64 = 10_000;
const MOST_RESOLUTION: f64 = 200.0;

fn resolution(text: &str) -> Result<f64, String> {
    let value = positive(text).map_err(|error: WordError| error.to_string())?;
    if value <= MOST_RESOLUTION { Ok(value) } else { Err(format!("at most {MOST_RESOLUTION} voxels")) }
}

fn automatic(text: &str) -> Result<CurvatureScale, String> {
    let automatic = curvature_scale(text).ok().filter(|scale| !matches!(scale, CurvatureScale::Mm(_)));
    automatic.ok_or_else(|| "it must be auto, local or object".to_owned())
}

fn ratio(text: &str) -> Result<f64, String> {
    let value = positive(text).map_err(|error: WordError| error.to_string())?;
    if (1.0..=10.0).contains(&value) { Ok(value) } else { Err("it must lie between 1 and 10".to_owned()) }
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    check_output(args.output.as_deref(), &[])?;
    let validation = Validation {
        zoo: args.zoo,
        noise: args.noise,
        resolutions: args.resolutions.clone().unwrap_or_else(|| args.zoo.resolutions().to_vec()),
        ratios: args.ratios.clone(),
        poses: args.poses as usize,
        first_pose: args.first_pose as usize,
        shapes: args.shape.clone(),
        local: !args.no_local && args.zoo == Zoo::Bodies && args.against.is_none(),
        curvature: args.curvature_sigma,
    };
    if validation.cases().is_empty() {
        let names: Vec<&str> = args.zoo.shapes().iter().map(|shape| shape.name).collect();
        let near: String = args.shape.iter().map(|name| did_you_mean(name, &names)).collect();
        bail!("no shape is called like that; {near}there are {}", names.join(", "));
    }
    let progress = progress_bar(validation.cases().len(), quiet);
    let made = validation.made()?;
    if let Some(folder) = &args.write {
        write_zoo(folder, &made, |_| progress.inc(1))?;
        progress.finish_and_clear();
        return Ok(ALL_DONE);
    }
    let results = validation.run_made(&made, || progress.inc(1))?;
    progress.finish_and_clear();
    if let Some(path) = &args.against {
        let rivalries = against(path, &made, &results)?;
        if rivalries.is_empty() {
            bail!(
                "{}: no row is of these phantoms; write them with --write, and the same other options",
                path.display()
            );
        }
        let text = match args.format {
            Format::Table => rivalry_table(&rivalries),
            Format::Json => json_text(&json!({
                "schema": "surfometry.validate-against/1",
                "version": env!("CARGO_PKG_VERSION"),
                "results": rivalries,
            }))?,
        };
        deliver(&text, args.output.as_deref())?;
        return Ok(ALL_DONE);
    }
    let summaries = summarise(&results);
    let text = match args.format {
        Format::Table => validation_table(&summaries),
        Format::Json => json_text(&json!({
            "schema": "surfometry.validate/1",
            "version": env!("CARGO_PKG_VERSION"),
            "summaries": summaries,
            "cases": named(&made, &results)?,
        }))?,
    };
    deliver(&text, args.output.as_deref())?;
    Ok(ALL_DONE)
}

/// The cases with their names, those of the files of --write without an ending, by which `compare` matches them.
fn named(made: &[MadeCase], results: &[CaseResult]) -> Result<Vec<Value>> {
    let named = |(made, result): (&MadeCase, &CaseResult)| {
        let mut case = serde_json::to_value(result)?;
        case["input"] = made.case.name().into();
        Ok(case)
    };
    made.iter().zip(results).map(named).collect()
}
