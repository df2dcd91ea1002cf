//! `surfometry report`.

use super::SOME_FAILED;
use crate::console::{Voice, control, written_at_end};
use crate::cures::cure;
use crate::inputs::expand;
use crate::options::{CurvatureOptions, MeasureOptions};
use crate::output::{check_output, deliver, say, status};
use anyhow::Result;
use std::path::{Path, PathBuf};
use surfometry::inputs::input_title;
use surfometry::report::{Provenance, Report, ReportPart, ReportTask, render};
use surfometry::runs::{Batch, Collected};

/// Write one HTML page with the numbers, the surface to turn, its distributions, slices, method and
/// provenance
///
/// The page needs no network. Each object of each input gets a section; a page of more than a few dozen
/// surfaces is slow in browsers.
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
    let plan = args.options.plan(args.curvature.scale())?;
    let inputs = expand(&args.inputs);
    check_output(Some(&args.output), &inputs)?;
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let batch = Batch { inputs: &inputs, open: plan.open, control: &control, cure };
    let mut parts = Collected::default();
    written_at_end();
    let outcome = batch.run(&ReportTask::new(plan), &mut parts)?;
    let (mut objects, mut sources) = (Vec::new(), Vec::new());
    for part in parts.results {
        match part {
            ReportPart::Object(object) => objects.push(*object),
            ReportPart::Source(source) => sources.push(source),
        }
    }
    if objects.is_empty() {
        say(&format!("{}: not written, for there is nothing to show", args.output.display()));
        return Ok(if outcome.stopped { status(outcome) } else { SOME_FAILED });
    }
    let title = args.title.clone().unwrap_or_else(|| match inputs.as_slice() {
        [one] => input_title(one),
        many => format!("{} images", many.len()),
    });
    let command: Vec<String> = std::env::args().collect();
    let provenance = Provenance::new(command.join(" "), sources);
    let page = render(&Report { title, objects, failures: parts.failures, provenance })?;
    // Of a run that was stopped, what was finished.
    let ending = if outcome.stopped { ".partial" } else { "" };
    let mut name = args.output.clone().into_os_string();
    name.push(ending);
    deliver(&page, Some(Path::new(&name)))?;
    Ok(status(outcome))
}
