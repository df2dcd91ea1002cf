//! `surfometry report`.

use super::SOME_FAILED;
use crate::console::{Voice, before_the_end, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::options::{CurvatureOptions, MeasureOptions};
use crate::output::{PageSink, check_output, say, say_written, status, with_scales};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use surfometry::inputs::input_title;
use surfometry::report::ReportTask;
use surfometry::runs::{Batch, Outcome};

/// Write one HTML page: of each object its numbers with error bars and flags, the surface to turn, coloured by any of
/// its quantities, distributions, slices, what changed its topology, method and provenance
///
/// The page needs no network, and the same inputs make the same page. Of many objects it has a table to sort, search
/// and filter, those of an image are shown together, and each has a page of its own. For display large surfaces have
/// fewer triangles, those of many objects fewer still; numbers are always of the whole surface.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::REPORT)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
    inputs: Vec<String>,
    /// Page to write
    #[arg(short, long, value_name = "FILE.html", help_heading = "Results")]
    output: PathBuf,
    /// Heading [default: the input's name]
    #[arg(long, help_heading = "Results")]
    title: Option<String>,
    /// When the page was made, as it is to say; without it a page tells no time, unless the environment has
    /// SOURCE_DATE_EPOCH
    #[arg(long, value_name = "TEXT", help_heading = "Results")]
    date: Option<String>,
    #[command(flatten)]
    curvature: CurvatureOptions,
    #[command(flatten)]
    options: MeasureOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let plan = args.options.plan(args.curvature.scale())?;
    let inputs = expand(&args.inputs);
    check_ending(&args.output)?;
    check_output(Some(&args.output), &args.options.files_read(&inputs, None))?;
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let scale_ledger = plan.scale_ledger.clone();
    let batch = Batch { inputs: &inputs, open: plan.open.clone(), control: &control, cure };
    let title = args.title.clone().unwrap_or_else(|| match inputs.as_slice() {
        [one] => input_title(one),
        many => format!("{} images", many.len()),
    });
    let mut page = PageSink::new(args.output.clone(), title, args.date.clone());
    let finished = page.clone();
    before_the_end(move || finished.save());
    let is_free = args.curvature.asked().is_none() && !args.options.choices().names_a_field();
    let task = ReportTask::new(plan).of_inputs(inputs.len()).of_free_choice(is_free);
    let outcome = batch.run(&task, &mut page)?;
    let Some(objects) = page.finish(outcome.stopped)? else {
        say(&format!("{}: not written, for there is nothing to show", args.output.display()));
        return Ok(if outcome.stopped { status(outcome) } else { SOME_FAILED });
    };
    if !quiet && args.output != Path::new("-") {
        say_written(&args.output, Outcome { rows: objects, ..outcome });
    }
    Ok(with_scales(status(outcome), &scale_ledger, quiet))
}

/// A page under the name of another kind of file would be opened as such.
fn check_ending(path: &Path) -> Result<()> {
    let is_page = path
        .extension()
        .is_none_or(|ending| ["html", "htm"].iter().any(|of_page| ending.eq_ignore_ascii_case(of_page)));
    if !is_page {
        bail!("{}: a page is HTML, so its name must end in .html or .htm", path.display());
    }
    Ok(())
}
