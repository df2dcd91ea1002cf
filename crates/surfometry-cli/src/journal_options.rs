//! A run that goes on where it was, or does a part of its inputs.

use crate::output::say;
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use surfometry::io::unfinished;
use surfometry::runs::{DocumentForm, Journal, Plan, RunHead, Shard};

/// Where a run keeps what it has finished.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Results")]
pub(crate) struct JournalOptions {
    /// Measures every N-th input only, beginning with the I-th, for one of N machines or jobs; -o FILE.jsonl is a shard
    /// then, of which `surfometry merge` makes a table, CSV or JSON
    #[arg(long, value_name = "I/N", requires = "output", conflicts_with_all = ["png", "format"], allow_hyphen_values = true)]
    shard: Option<Shard>,
    /// Goes on where an earlier run of the same command was killed, and leaves out what it has measured, unless a file
    /// changed since; what failed is tried again. What is finished is in FILE.journal, of a shard in FILE itself
    #[arg(long, requires = "output", conflicts_with = "png")]
    resume: bool,
}

impl JournalOptions {
    pub(crate) fn is_shard(&self) -> bool {
        self.shard.is_some()
    }

    /// The inputs that are to be measured.
    pub(crate) fn own(&self, inputs: &[String]) -> Vec<String> {
        self.shard.unwrap_or(Shard::ALL).inputs(inputs)
    }

    /// The journal of the run, where it keeps one.
    pub(crate) fn begin(
        &self,
        plan: &Plan,
        inputs: &[String],
        output: Option<&Path>,
    ) -> Result<Option<Journal>> {
        let shard = match self.shard {
            None if !self.resume => return Ok(None),
            shard => shard.unwrap_or(Shard::ALL),
        };
        let Some(output) = output else {
            bail!("--shard and --resume keep what is finished in a file: name one with -o FILE");
        };
        let head = RunHead::new(plan, shard, inputs)?;
        let path = if self.is_shard() { shard_path(output)? } else { Journal::beside(output) };
        if self.resume && output.is_file() && !is_begun(&path) {
            say(&format!(
                "{}: the run that wrote it kept no journal ({}), as one without --resume: all inputs are measured again",
                output.display(),
                path.display()
            ));
        }
        let begun = if self.resume { Journal::resume(&path, head) } else { Journal::begin(&path, head) };
        Ok(Some(begun?))
    }
}

/// Whether there is something to go on with, finished or not.
fn is_begun(journal: &Path) -> bool {
    journal.is_file() || unfinished(journal).is_file()
}

fn shard_path(output: &Path) -> Result<PathBuf> {
    if DocumentForm::of_path(output) != Some(DocumentForm::JsonLines) {
        bail!(
            "{}: a shard is lines of JSON, of which `surfometry merge` makes tables: name it .jsonl",
            output.display()
        );
    }
    Ok(output.to_owned())
}
