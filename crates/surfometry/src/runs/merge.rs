//! Shards of a run as one.

use super::journal::{JournalError, Lines, RunHead};
use super::{Outcome, Record, Settings, Sink};
use crate::text::listed;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

/// All shards of a run, each once, complete, and made alike.
#[derive(Debug)]
pub struct Shards {
    /// What the first of them says of the run.
    head: RunHead,
    /// In order of their numbers.
    lines: Vec<Lines>,
}

impl Shards {
    /// Reads the journals of a run's shards, in any order.
    ///
    /// # Errors
    /// [`JournalError`] for files that are none, shards that are missing, doubled or unfinished, and runs that were not
    /// made alike.
    pub fn read(paths: &[PathBuf]) -> Result<Self, JournalError> {
        let mut read = Vec::new();
        for path in paths {
            read.push((path.as_path(), Lines::read(path)?));
        }
        read.sort_by_key(|(_, lines)| lines.head.shard);
        let Some(((first, reference), others)) = read.split_first() else {
            return Err(JournalError::Unmergeable(
                "no shards: name the files that `measure --shard` wrote".to_owned(),
            ));
        };
        let head = reference.head.clone();
        others.iter().try_for_each(|other| check_alike((first, &head), other))?;
        check_all_there(&read)?;
        read.iter().try_for_each(|(path, lines)| check_finished(path, lines))?;
        Ok(Self { head, lines: read.into_iter().map(|(_, lines)| lines).collect() })
    }

    /// The choices of the run.
    pub fn settings(&self) -> &Settings {
        &self.head.settings
    }

    /// The inputs of the run, in their order.
    pub fn inputs(&self) -> Vec<String> {
        self.places().map(|(shard, number)| self.lines[shard].head.inputs[number].clone()).collect()
    }

    /// The shard of each input, and which of the shard's own it is.
    fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (count, all) = (self.lines.len(), self.lines.iter().map(|lines| lines.head.inputs.len()).sum());
        (0..all).map(move |place| (place % count, place / count))
    }

    /// Hands everything to a sink, in the order in which one run over all inputs would have.
    ///
    /// # Errors
    /// The sink's.
    pub fn replay(mut self, sink: &mut dyn Sink<Record>) -> io::Result<Outcome> {
        let mut outcome = Outcome::default();
        for (shard, number) in self.places() {
            let lines = &mut self.lines[shard];
            let Some(entry) = lines.entries.remove(&lines.head.inputs[number]) else { continue };
            entry.items.into_iter().try_for_each(|item| outcome.hand(item, sink))?;
            sink.input_ends()?;
        }
        Ok(outcome)
    }
}

type Read<'a> = [(&'a Path, Lines)];

fn unmergeable(words: impl Display) -> Result<(), JournalError> {
    Err(JournalError::Unmergeable(words.to_string()))
}

fn check_alike((first, head): (&Path, &RunHead), (path, lines): &(&Path, Lines)) -> Result<(), JournalError> {
    let own = &lines.head;
    let different = if own.shard.of() != head.shard.of() {
        Some(format!("shards {} and {}", head.shard, own.shard))
    } else if own.all_inputs != head.all_inputs {
        Some(format!("lists of {} and {} inputs", head.all_inputs, own.all_inputs))
    } else if own.list != head.list {
        Some("the list of inputs changed between them".to_owned())
    } else {
        head.settings.difference(&own.settings)
    };
    let Some(different) = different else { return Ok(()) };
    unmergeable(format_args!(
        "{} and {} are of different runs ({different}): merge the shards of one run",
        first.display(),
        path.display()
    ))
}

fn check_all_there(read: &Read) -> Result<(), JournalError> {
    for pair in read.windows(2) {
        let [(first, one), (second, other)] = pair else { continue };
        if one.head.shard == other.head.shard {
            return unmergeable(format_args!(
                "{} and {} are both shard {}: name each shard once",
                first.display(),
                second.display(),
                one.head.shard
            ));
        }
    }
    let of = read.first().map_or(0, |(_, lines)| lines.head.shard.of());
    let is_there = |number: &usize| read.iter().any(|(_, lines)| lines.head.shard.number() == *number);
    let missing: Vec<String> =
        (1..=of).filter(|number| !is_there(number)).map(|n| format!("{n}/{of}")).collect();
    if missing.is_empty() {
        return Ok(());
    }
    unmergeable(format_args!(
        "of {of} shards {} {} missing: {}; measure what is missing, or name its files",
        missing.len(),
        if missing.len() == 1 { "is" } else { "are" },
        listed(missing.iter(), SHOWN)
    ))
}

/// Names that are shown of those that lack.
const SHOWN: usize = 10;

fn check_finished(path: &Path, lines: &Lines) -> Result<(), JournalError> {
    let inputs = &lines.head.inputs;
    let lacking: Vec<String> =
        inputs.iter().filter(|input| !lines.entries.contains_key(*input)).cloned().collect();
    if lacking.is_empty() {
        return Ok(());
    }
    unmergeable(format_args!(
        "{}: shard {} is unfinished, {} of {} inputs are not measured: {}; run its command again with --resume",
        path.display(),
        lines.head.shard,
        lacking.len(),
        inputs.len(),
        listed(lacking.iter(), SHOWN)
    ))
}
