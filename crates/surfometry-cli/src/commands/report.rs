//! `surfometry report`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::expand;
use crate::options::{CurvatureOptions, MeasureOptions};
use crate::output::{check_output, deliver, say};
use crate::progress::{announce, progress_bar, said_failure};
use anyhow::Result;
use indicatif::ProgressBar;
use std::path::PathBuf;
use surfometry::Measurement;
use surfometry::report::{MOST_TRIANGLES, ObjectReport, Provenance, Report, Source, render};
use surfometry::runs::{InputError, InputOptions, input_title, visit_objects};

/// Write one HTML page with the numbers, the surface to turn, its distributions, slices, method and provenance
///
/// The page needs no network. Each object of each input gets a section; a page of more than a few dozen surfaces is slow in
/// browsers.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,
    /// Page to write
    #[arg(short, long, value_name = "FILE.html")]
    output: PathBuf,
    /// Heading [default: the input's name]
    #[arg(long)]
    title: Option<String>,
    #[command(flatten)]
    curvature: CurvatureOptions,
    #[command(flatten)]
    options: MeasureOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let measurement = args.options.measurement()?;
    let wanted = args.options.inputs(args.curvature.scale());
    let inputs = expand(&args.inputs);
    check_output(Some(&args.output), &inputs)?;
    let progress = progress_bar(inputs.len(), quiet);
    let (mut objects, mut sources, mut failures) = (Vec::new(), Vec::new(), Vec::new());
    for input in &inputs {
        match add_input(input, &measurement, &wanted, &progress, &mut objects) {
            Ok(source) => sources.push(source),
            Err(error) => failures.push(said_failure(&progress, input, &error)),
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if objects.is_empty() {
        say(&format!("{}: not written, for there is nothing to show", args.output.display()));
        return Ok(SOME_FAILED);
    }
    let status = if failures.is_empty() { ALL_DONE } else { SOME_FAILED };
    let title = args.title.clone().unwrap_or_else(|| match inputs.as_slice() {
        [one] => input_title(one),
        many => format!("{} images", many.len()),
    });
    let command: Vec<String> = std::env::args().collect();
    let provenance = Provenance::new(command.join(" "), sources);
    deliver(&render(&Report { title, objects, failures, provenance })?, Some(&args.output))?;
    Ok(status)
}

/// Adds a section for each object of an input.
fn add_input(
    input: &str,
    measurement: &Measurement,
    wanted: &InputOptions,
    progress: &ProgressBar,
    sections: &mut Vec<ObjectReport>,
) -> Result<Source, InputError> {
    visit_objects(input, measurement, wanted, |source| {
        announce(progress, source);
        let shown: u64 =
            sections.iter().filter(|s| s.scene.is_some()).filter_map(ObjectReport::triangles).sum();
        sections.push(ObjectReport::of(source, MOST_TRIANGLES.saturating_sub(shown as usize))?);
        Ok(())
    })?;
    Ok(Source::of(input)?)
}
