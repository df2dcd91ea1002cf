//! `surfometry rerun`.

use crate::commands::{ALL_DONE, SOME_FAILED};
use crate::console::{Voice, control};
use crate::cures::cure;
use crate::output::{deliver, say, status};
use anyhow::Result;
use std::path::PathBuf;
use surfometry::runs::{Batch, Finding, MadeBy, MeasureTask, Repeated, Repetition, WrittenRun};

/// Measure again what a document of `measure` holds, with its settings, and compare every number
///
/// Paths of inputs are those of the document: run it in the folder in which they were measured. The numbers of one
/// version have the same bits whatever the machine, threads or slabs.
///
/// Exit status: 0 all the same to the last bit, 1 something differs, 2 the command was wrong.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::RERUN)]
pub(crate) struct Args {
    /// What `measure -o FILE.json` wrote
    #[arg(value_name = "FILE.json")]
    document: PathBuf,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let run = WrittenRun::read(&args.document)?;
    if !quiet {
        tell_other_program(run.made_by());
    }
    let (plan, inputs) = (run.plan(), run.inputs());
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let batch = Batch { inputs: &inputs, open: plan.open.clone(), control: &control, cure };
    let mut repetition = Repetition::of(&run);
    let outcome = batch.run(&MeasureTask { plan, ..MeasureTask::default() }, &mut repetition)?;
    if outcome.stopped {
        return Ok(status(outcome));
    }
    let repeated = repetition.finish();
    let lines: String = repeated.iter().map(line).collect();
    let same = repeated.iter().filter(|repeated| repeated.finding == Finding::Same).count();
    deliver(&format!("{lines}{same} of {} the same to the last bit\n", repeated.len()), None)?;
    Ok(if same == repeated.len() { ALL_DONE } else { SOME_FAILED })
}

fn tell_other_program(written: &MadeBy) {
    let this = MadeBy::this();
    if (&written.version, &written.commit) != (&this.version, &this.commit) {
        let named = |made: &MadeBy| {
            made.commit
                .as_ref()
                .map_or_else(|| made.version.clone(), |commit| format!("{} ({commit})", made.version))
        };
        say(&format!("measured by version {}, this is {}", named(written), named(&this)));
    }
}

fn line(Repeated { input, object, finding }: &Repeated) -> String {
    let object = if object.is_empty() { String::new() } else { format!(", label {object}") };
    let words = match finding {
        Finding::Same => "the same".to_owned(),
        Finding::New => "was not there".to_owned(),
        Finding::Missing(None) => "is no longer there".to_owned(),
        Finding::Missing(Some(error)) => format!("failed: {error}"),
        Finding::Differs { other_input, field, before, now, fields } => {
            let cause = if *other_input { "the file is another one; " } else { "" };
            format!("{cause}{fields} fields differ, most {field}: {before}, now {now}")
        }
    };
    format!("{input}{object}: {words}\n")
}
