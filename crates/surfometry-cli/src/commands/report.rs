//! `surfometry report`.

use super::SOME_FAILED;
use crate::console::{Voice, before_the_end, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::options::{CurvatureOptions, MeasureOptions};
use crate::output::{PageSink, check_output, say, status, with_scales};
use anyhow::Result;
use std::path::PathBuf;
use surfometry::inputs::input_title;
use surfometry::report::ReportTask;
use surfometry::runs::Batch;

/// Write one HTML page with the numbers, the surface to turn, its distributions, slices, method and
/// provenance
///
/// The page needs no network. Each object of each input gets a section; a page of more than a few dozen
/// surfaces is slow in browsers.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
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
    let scale_ledger = plan.scale_ledger.clone();
    let batch = Batch { inputs: &inputs, open: plan.open.clone(), control: &control, cure };
    let title = args.title.clone().unwrap_or_else(|| match inputs.as_slice() {
        [one] => input_title(one),
        many => format!("{} images", many.len()),
    });
    let mut page = PageSink::new(args.output.clone(), title);
    let finished = page.clone();
    before_the_end(move || finished.save());
    let outcome = batch.run(&ReportTask::new(plan), &mut page)?;
    if !page.finish(outcome.stopped)? {
        say(&format!("{}: not written, for there is nothing to show", args.output.display()));
        return Ok(if outcome.stopped { status(outcome) } else { SOME_FAILED });
    }
    Ok(with_scales(status(outcome), &scale_ledger, quiet))
}
