//! Results of a run, to where and in which form they were asked for.

use super::table_sink::{Presenter, TableSink};
use crate::console::{INTERRUPTED, STOPPED};
use crate::options::{OutputFormat, OutputOptions};
use crate::output::{counted, is_one_place, say};
use anyhow::{Context, Result, anyhow};
use std::io::{self, ErrorKind};
use std::path::Path;
use surfometry::io::{ResultOutput, unfinished};
use surfometry::runs::{DocumentForm, Outcome, Row, ScaleLedger, Settings, SigmaRange, Sink};

/// Whether stderr tells of failures while a run goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Failures {
    Told,
    Untold,
}

/// Runs something that hands its results to a sink, and writes them as the options say; the exit status. Which file was written is
/// told, unless that is not wanted.
pub(crate) fn write_results<R: Row>(
    options: &OutputOptions,
    presenter: impl Presenter<R>,
    settings: &Settings,
    quiet: bool,
    failures: Failures,
    run: impl FnOnce(&mut dyn Sink<R>) -> io::Result<Outcome>,
) -> Result<u8> {
    let out = match options.path() {
        Some(path) => {
            // Not as an error of writing: nothing is measured yet.
            ResultOutput::create(path).map_err(|e| anyhow!("{}: cannot be written: {e}", path.display()))?
        }
        None => ResultOutput::stdout(),
    };
    // Where both go to one place, stderr has told the failures there.
    let list_failures = options.path().is_some() || failures == Failures::Untold || !is_one_place();
    let written = match options.format() {
        OutputFormat::Table => {
            let mut sink = TableSink::new(out, presenter, list_failures);
            run(&mut sink).and_then(|outcome| Ok((outcome, sink.finish()?)))
        }
        OutputFormat::Json => DocumentForm::Json.write(out, settings, run),
        OutputFormat::Jsonl => DocumentForm::JsonLines.write(out, settings, run),
        OutputFormat::Csv => DocumentForm::Csv.write(out, settings, run),
    };
    let finished = written.and_then(|(outcome, out)| out.end(outcome.stopped).map(|_| outcome));
    match finished {
        // The reader went away, as `head` does: nothing is wrong.
        Err(error) if error.kind() == ErrorKind::BrokenPipe && options.path().is_none() => Ok(0),
        Err(error) => {
            let name = options.path().map_or_else(|| "stdout".to_owned(), |path| path.display().to_string());
            let kept = options.path().map(unfinished).map_or_else(String::new, |partial| kept_text(&partial));
            Err(error).with_context(|| format!("{name}: cannot be written{kept}"))
        }
        Ok(outcome) => {
            if let Some(path) = options.path().filter(|_| !quiet) {
                say_written(path, outcome);
            }
            Ok(status(outcome))
        }
    }
}

/// Where what was finished is; an unfinished file without any is taken away.
fn kept_text(partial: &Path) -> String {
    let Some(found) = partial.metadata().ok().filter(std::fs::Metadata::is_file) else {
        return String::new();
    };
    if found.len() > 0 {
        return format!("; what was finished is in {}", partial.display());
    }
    // It is empty: whether it goes is no matter.
    let _gone = std::fs::remove_file(partial);
    String::new()
}

/// Tells of a file with all results of a run that was not stopped.
pub(crate) fn say_written(path: &Path, outcome: Outcome) {
    if !outcome.stopped {
        say(&format!("wrote {}: {}", path.display(), outcome_text(outcome)));
    }
}

fn outcome_text(outcome: Outcome) -> String {
    let results = counted(outcome.rows, "result");
    if outcome.failures == 0 {
        results
    } else {
        format!("{results}, {}", counted(outcome.failures, "failure"))
    }
}

/// Tells that the automatic blurs of a run's images differ, where they do.
pub(crate) fn say_sigmas(sigmas: &SigmaRange) {
    if let Some([low, high]) = sigmas.differing() {
        say(&format!(
            "the images differ in spacing, so the automatic sigma ran from {low:.4} to {high:.4} mm; use --sigma \
             {high:.4} to make the results comparable"
        ));
    }
}

/// Tells of lengths by label what no input had, which is a failure, and what some lacked; the exit status.
pub(crate) fn with_scales(status: u8, ledger: &ScaleLedger, quiet: bool) -> u8 {
    let unused = ledger.unused();
    let lacked = if quiet { Vec::new() } else { ledger.partly_used() };
    unused.iter().chain(&lacked).for_each(|words| say(words));
    if unused.is_empty() { status } else { status.max(crate::commands::SOME_FAILED) }
}

/// The exit status of a run.
pub(crate) fn status(outcome: Outcome) -> u8 {
    if outcome.stopped {
        say(STOPPED);
        return INTERRUPTED;
    }
    if outcome.failures == 0 { crate::commands::ALL_DONE } else { crate::commands::SOME_FAILED }
}
