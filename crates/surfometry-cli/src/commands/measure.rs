//! `surfometry measure`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::{expand, grey_image_warning};
use crate::options::{MeasureOptions, OutputFormat, OutputOptions};
use crate::output::{
    check_output, csv_text, deliver, failures_text, json_text, memory_text, say, table_text, timings_text,
};
use crate::progress::{progress_bar, said_failure};
use anyhow::{Result, bail};
use std::cell::Cell;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use surfometry::Measurement;
use surfometry::measurement::CurvatureScale;
use surfometry::runs::{
    ExplainTopology, Failure, FileLedger, InputError, InputOptions, MapFile, MapStyle, Output, Record,
    distinct_parts, measure_input, visit_objects, with_parts, write_map_files,
};

/// Measure the objects of label images
///
/// INPUT is a file (NIfTI, MetaImage, NRRD, NumPy), a pattern, or a built-in shape with known truth:
/// phantom:NAME?key=value&... with NAME ball, ellipsoid, capsule, torus, rounded-box, shell, two-balls, genus, gyroid,
/// schwarz-p, femur or vertebra and keys radius, radii, major, minor, length, inner, genus, period, size, individual, holes,
/// spacing, rotate, shift, jitter. A closed mesh (STL, PLY) is put on the lattice of --spacing.
///
/// Exit status: 0 all measured, 1 some inputs failed (they are listed, the others are measured), 2 the command was
/// wrong.
#[derive(Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,
    #[command(flatten)]
    options: MeasureOptions,
    #[command(flatten)]
    results: OutputOptions,
    /// Picture of the surface, coloured by mean curvature; `map` makes others. Where there are several inputs or objects,
    /// `_NAME` and `_label-N` go before the ending
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,
    /// Shows, in the table, what was added for the original object, term by term, and every place where the blur or the band changes
    /// the object's topology (docs/quantities.md); the places are in JSON too, and are looked for where voxels and surface agree as well
    #[arg(long)]
    explain: bool,
    /// Measures each 26-connected piece as an object of its own, the largest first
    #[arg(long, conflicts_with = "png")]
    per_component: bool,
    /// Says on stderr where the time went, stage by stage
    #[arg(long)]
    timings: bool,
    /// Says on stderr how much memory was needed
    #[arg(long, short)]
    verbose: bool,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let measurement = args.options.measurement()?;
    let wanted = InputOptions {
        explain_topology: if args.explain { ExplainTopology::Always } else { ExplainTopology::default() },
        per_component: args.per_component,
        ..args.options.inputs(CurvatureScale::AsMeasured)
    };
    let inputs = expand(&args.inputs);
    check_output(args.results.path(), &inputs)?;
    check_output(args.png.as_deref(), &inputs)?;
    check_picture(args)?;
    let progress = progress_bar(inputs.len(), quiet);
    let (mut results, mut failures) = (Vec::new(), Vec::new());
    let (mut ledger, mut all_drawn) = (FileLedger::new(&inputs), true);
    for (input, part) in inputs.iter().zip(distinct_parts(&inputs)) {
        progress.set_message(input.clone());
        let warned = Cell::new(quiet);
        let outcome = measure_input(input, &measurement, &wanted, |at| {
            if let Some(warning) = grey_image_warning(input, at.labels).filter(|_| !warned.replace(true)) {
                progress.suspend(|| say(&warning));
            }
            progress.set_message(format!("{input}, slice {} of {}", at.slices, at.of_slices));
        });
        match outcome {
            Ok(found) => {
                if args.timings {
                    progress.suspend(|| say(&timings_text(input, &found)));
                }
                if args.verbose {
                    progress.suspend(|| say(&memory_text(input)));
                }
                results.extend(found.records);
                if let Some(path) = &args.png {
                    let path = with_parts(path, part.as_slice());
                    for failure in draw(input, &measurement, &wanted, &path, &mut ledger) {
                        progress.suspend(|| say(&format!("no picture: {failure}")));
                        all_drawn = false;
                    }
                }
            }
            Err(error) => failures.push(said_failure(&progress, input, &error)),
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if !quiet && args.options.sigma_is_automatic() {
        warn_of_mixed_sigma(&results);
    }
    let output = Output::new(results, failures);
    let text = match args.results.format() {
        // A terminal has shown the failures already.
        OutputFormat::Table if args.results.path().is_none() && std::io::stdout().is_terminal() => {
            table_text(&output, args.explain)
        }
        OutputFormat::Table => table_text(&output, args.explain) + &failures_text(&output),
        OutputFormat::Json => json_text(&output)?,
        OutputFormat::Csv => csv_text(&output)?,
    };
    deliver(&text, args.results.path())?;
    Ok(if output.failures.is_empty() && all_drawn { ALL_DONE } else { SOME_FAILED })
}

fn check_picture(args: &Args) -> Result<()> {
    let Some(path) = &args.png else { return Ok(()) };
    if MapFile::of_path(path) != Some(MapFile::Png) {
        bail!("{}: the picture's name must end in .png", path.display());
    }
    if args.results.path() == Some(path) {
        bail!("{}: named twice, for the results and for the picture", path.display());
    }
    Ok(())
}

/// Draws the surfaces of an input's objects; what could not be drawn. That an object has no surface is in its record, and nothing
/// to draw.
fn draw(
    input: &str,
    measurement: &Measurement,
    wanted: &InputOptions,
    path: &Path,
    ledger: &mut FileLedger,
) -> Vec<Failure> {
    let mut failures = Vec::new();
    let outcome = visit_objects(input, measurement, wanted, |source| {
        match write_map_files(source, path, &MapStyle::default(), ledger) {
            Ok(_) | Err(InputError::NoSurface) => {}
            Err(error) => failures.push(source.failure(&error)),
        }
        Ok(())
    });
    failures.extend(outcome.err().map(|error| Failure::new(input, &error)));
    failures
}

/// An automatic sigma follows the spacing; numbers of images that differ in it are then not comparable.
fn warn_of_mixed_sigma(results: &[Record]) {
    let sigmas = results.iter().filter_map(|r| r.measured.parameters.sigma_mm);
    let (low, high) = sigmas.fold((f64::INFINITY, 0.0f64), |(low, high), s| (low.min(s), high.max(s)));
    // Spacings written in f32 differ in the seventh digit.
    if low < high * (1.0 - 1e-5) {
        say(&format!(
            "the images differ in spacing, so the automatic sigma ran from {low:.4} to {high:.4} mm; use --sigma {high:.4} \
             to make the results comparable"
        ));
    }
}
