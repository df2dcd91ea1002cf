//! What a run has finished so far, an input a line, in a file: so that a run that was killed goes on where it was, and
//! runs of parts of the inputs become one.

use super::journalled::{JournalledSink, JournalledTask};
use super::settings::Settings;
use super::stamps::FileStamps;
use super::{Batch, Failure, Item, Outcome, Plan, Record, Shard, Sink, Task};
use crate::inputs::{OpenOptions, files_of, open};
use crate::io::{GrowingFile, read_handed_on, sha256_text};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::{BTreeSet, HashMap};
use std::io::{self, Write};
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use thiserror::Error;

/// Name and version of the lines' format.
pub const JOURNAL_SCHEMA: &str = "surfometry.journal/1";

/// What a run is, as its journal says in front of its results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunHead {
    schema: String,
    /// Version of this library: others may round differently.
    version: String,
    pub(super) shard: Shard,
    pub(super) settings: Settings,
    /// What the files of the image of regions were, where there is one.
    #[serde(default)]
    beside: FileStamps,
    /// How many inputs all shards have.
    pub(super) all_inputs: usize,
    /// SHA-256 of their names in their order: whether shards were cut out of one list is seen in no other way.
    pub(super) list: String,
    /// Its own inputs, in order.
    pub(super) inputs: Vec<String>,
}

/// What came of an input.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Entry {
    pub(super) input: String,
    pub(super) files: FileStamps,
    pub(super) items: Vec<Item<Record>>,
}

impl Entry {
    /// Of an input of which nothing else is known.
    pub(super) fn of_failure(failure: Failure) -> Self {
        Self {
            input: failure.input.clone(),
            files: FileStamps::default(),
            items: vec![Item::Failure(failure)],
        }
    }

    /// As a journal has it.
    pub(super) fn line(self) -> String {
        Line::Result(self).text()
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    Run(Box<RunHead>),
    Result(Entry),
}

impl Line {
    fn text(&self) -> String {
        serde_json::to_string(self).expect("names of fields are text, and numbers have their forms")
    }
}

/// Why a journal cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JournalError {
    /// It cannot be read or written.
    #[error("{path}: cannot be read or written: {source}", path = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is something else.
    #[error("{path}: no journal of a run: its first line is not that of `measure --shard` or `--resume`", path = path.display())]
    NotOne {
        /// The file.
        path: PathBuf,
    },
    /// It was cut off or changed.
    #[error("{path}: line {line} is damaged ({reason}): copy the file again, or remove it and measure again", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The line, from 1 on.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// It is of another version of the library.
    #[error("{path}: written by version {version}, which may round differently from {own}: measure all with one version", path = path.display(), own = env!("CARGO_PKG_VERSION"))]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        version: String,
    },
    /// It is of a run that is not the one that goes on.
    #[error("{path}: it is of another run ({what}): take another name, or remove it to begin anew", path = path.display())]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// In what they differ.
        what: String,
    },
    /// A run that keeps none.
    #[error(
        "lengths for labels of their own are checked over all inputs of a run, so it can neither be cut into shards nor go on: give one length for all"
    )]
    OwnLengths,
    /// An input that is twice in the list.
    #[error("{0}: named twice among the inputs: name it once, so that it is in one shard")]
    NamedTwice(String),
    /// Runs that cannot be one.
    #[error("{0}")]
    Unmergeable(String),
}

impl RunHead {
    /// Of a run over a part of some inputs.
    ///
    /// # Errors
    /// [`JournalError`] for runs that keep no journal, and inputs named twice.
    pub fn new(plan: &Plan, shard: Shard, all: &[String]) -> Result<Self, JournalError> {
        if plan.has_scales() {
            return Err(JournalError::OwnLengths);
        }
        let mut seen = BTreeSet::new();
        if let Some(twice) = all.iter().find(|input| !seen.insert(*input)) {
            return Err(JournalError::NamedTwice(twice.clone()));
        }
        Ok(Self {
            schema: JOURNAL_SCHEMA.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            shard,
            settings: Settings::of(plan),
            beside: plan
                .regions
                .as_ref()
                .map(|regions| FileStamps::of_files(&files_of(regions.file())))
                .unwrap_or_default(),
            all_inputs: all.len(),
            list: digest(all),
            inputs: shard.inputs(all),
        })
    }

    fn check(&self, path: &Path) -> Result<(), JournalError> {
        let (path, version) = (path.to_owned(), self.version.clone());
        if self.schema != JOURNAL_SCHEMA {
            return Err(JournalError::NotOne { path });
        }
        if version != env!("CARGO_PKG_VERSION") {
            return Err(JournalError::OtherVersion { path, version });
        }
        Ok(())
    }

    /// What an earlier run has finished: in the file of that name, and in the unfinished one.
    fn left(&self, path: &Path, left: &str, partial: &Path) -> Result<(Entries, Entries), JournalError> {
        let unfinished = Lines::of_text(left, partial)?;
        let finished = if path.is_file() { Some(Lines::read(path)?) } else { None };
        let entries = |lines: Option<Lines>, path: &Path| match lines {
            Some(lines) => self.check_goes_on(&lines.head, path).map(|()| lines.entries),
            None => Ok(HashMap::new()),
        };
        Ok((entries(finished, path)?, entries(unfinished, partial)?))
    }

    fn check_goes_on(&self, earlier: &Self, path: &Path) -> Result<(), JournalError> {
        let other_shard = (self.shard != earlier.shard).then(|| format!("shard {}", earlier.shard));
        let other_settings = || earlier.settings.difference(&self.settings);
        let other_beside = || {
            (self.beside != earlier.beside)
                .then(|| "the file of regions, which is another one now".to_owned())
        };
        match other_shard.or_else(other_settings).or_else(other_beside) {
            Some(what) => Err(JournalError::OtherRun { path: path.to_owned(), what }),
            None => Ok(()),
        }
    }
}

/// Of names that hold no NUL.
fn digest(names: &[String]) -> String {
    sha256_text(Sha256::new_with_prefix(names.join("\0")))
}

/// By inputs.
type Entries = HashMap<String, Entry>;

/// The lines of a journal: the last head, and the last entry of each input.
#[derive(Debug)]
pub(super) struct Lines {
    pub(super) head: RunHead,
    pub(super) entries: Entries,
}

impl Lines {
    /// Of a finished file.
    pub(super) fn read(path: &Path) -> Result<Self, JournalError> {
        let not_one = || JournalError::NotOne { path: path.to_owned() };
        let text = String::from_utf8(read_handed_on(path).map_err(at(path))?).map_err(|_| not_one())?;
        Self::of_text(&text, path)?.ok_or_else(not_one)
    }

    /// Nothing of an empty text.
    fn of_text(text: &str, path: &Path) -> Result<Option<Self>, JournalError> {
        let mut all: Option<Self> = None;
        for (number, line) in (1..).zip(text.lines()) {
            let read = serde_json::from_str(line);
            match (&mut all, read) {
                (None, Ok(Line::Run(head))) => {
                    head.check(path)?;
                    all = Some(Self { head: *head, entries: HashMap::new() });
                }
                (Some(all), Ok(Line::Run(head))) => {
                    head.check_goes_on(&all.head, path)?;
                    all.head = *head;
                }
                (Some(all), Ok(Line::Result(entry))) => {
                    all.entries.insert(entry.input.clone(), entry);
                }
                (None, _) => return Err(JournalError::NotOne { path: path.to_owned() }),
                (Some(_), Err(error)) => {
                    let (path, reason) = (path.to_owned(), error.to_string());
                    return Err(JournalError::Damaged { path, line: number, reason });
                }
            }
        }
        Ok(all)
    }
}

/// A journal that is written while a run goes on: `NAME.partial` until it is finished.
#[derive(Debug)]
pub struct Journal {
    head: RunHead,
    keeps_failures: bool,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    file: GrowingFile,
    /// What an earlier run has finished.
    earlier: Entries,
    /// Inputs of which this run has written what came of them.
    written: BTreeSet<String>,
    failed: Option<io::Error>,
}

impl Journal {
    /// Where the journal of results is that go to a file.
    pub fn beside(results: &Path) -> PathBuf {
        let mut name = results.as_os_str().to_owned();
        name.push(".journal");
        name.into()
    }

    /// Begins a journal.
    ///
    /// # Errors
    /// [`JournalError`].
    pub fn begin(path: &Path, head: RunHead) -> Result<Self, JournalError> {
        let file = GrowingFile::create(path).map_err(at(path))?;
        Self::new(path, file, head)
    }

    /// Goes on with what an earlier run of the same inputs and choices has left, finished or not; begins where there is
    /// nothing. A half line at its end is taken away.
    ///
    /// # Errors
    /// [`JournalError`], also where the earlier run was another one.
    pub fn resume(path: &Path, head: RunHead) -> Result<Self, JournalError> {
        let (file, left) = GrowingFile::reopen_lines(path).map_err(at(path))?;
        let (mut earlier, newer) = match head.left(path, &left, file.partial()) {
            Ok(found) => found,
            Err(refused) => {
                if left.is_empty() {
                    // The file was made by this run, which is refused.
                    let _removed = file.discard();
                }
                return Err(refused);
            }
        };
        let journal = Self::new(path, file, head)?;
        // The finished file is replaced by this one at the end.
        let only_finished = earlier.values().filter(|entry| !newer.contains_key(&entry.input));
        only_finished.cloned().try_for_each(|entry| journal.write(entry)).map_err(at(path))?;
        earlier.extend(newer);
        journal.state().written.clear();
        journal.state().earlier = earlier;
        Ok(journal)
    }

    fn new(path: &Path, file: GrowingFile, head: RunHead) -> Result<Self, JournalError> {
        let mut state = State { file, earlier: HashMap::new(), written: BTreeSet::new(), failed: None };
        state.line(&Line::Run(Box::new(head.clone()))).map_err(at(path))?;
        Ok(Self { head, keeps_failures: false, state: Mutex::new(state) })
    }

    /// Does a task with the inputs of a batch, keeps this journal of it, and ends it. Rows go to a sink, where there is
    /// one, in the order of the inputs.
    ///
    /// # Errors
    /// The sink's, and whatever keeps the journal from being written.
    pub fn run<T: Task<Row = Record>>(
        self,
        batch: &Batch,
        task: T,
        sink: Option<&mut dyn Sink<Record>>,
    ) -> io::Result<Outcome> {
        let task = JournalledTask { task, journal: &self, cure: batch.cure };
        let outcome = batch.run(&task, &mut JournalledSink::new(&self, sink))?;
        self.end(outcome.stopped)?;
        Ok(outcome)
    }

    /// Counts what failed in an earlier run as done.
    #[must_use]
    pub fn keeping_failures(self) -> Self {
        Self { keeps_failures: true, ..self }
    }

    /// The inputs that no earlier run has done, or that are other files now.
    pub fn pending(&self, options: &OpenOptions) -> Vec<String> {
        let is_done = |input: &&String| {
            let stamps = open(input, options).map(|source| FileStamps::of(&*source));
            stamps.is_ok_and(|files| {
                self.state().earlier.get(*input).is_some_and(|entry| self.holds(entry, &files))
            })
        };
        self.head.inputs.iter().filter(|input| !is_done(input)).cloned().collect()
    }

    /// Writes the line that [`journal_line`](super::journal_line) made.
    ///
    /// # Errors
    /// [`JournalError`] for any other line, and for what cannot be written.
    pub fn add_line(&self, line: &str) -> Result<(), JournalError> {
        let path = || self.state().file.partial().to_owned();
        match serde_json::from_str(line) {
            Ok(Line::Result(entry)) => {
                self.write(entry).map_err(|source| JournalError::Io { path: path(), source })
            }
            _ => Err(JournalError::NotOne { path: path() }),
        }
    }

    /// Writes that an input failed.
    ///
    /// # Errors
    /// [`JournalError`] for what cannot be written.
    pub fn add_failure(&self, failure: Failure) -> Result<(), JournalError> {
        self.add_line(&Entry::of_failure(failure).line())
    }

    /// Gives the file its name, unless the run was stopped: then it goes on later.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn end(self, stopped: bool) -> io::Result<()> {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        if stopped { Ok(()) } else { state.file.finish() }
    }

    /// What an earlier run found in an input, if all of it could be done and its files are the same.
    pub(super) fn earlier(&self, input: &str, files: &FileStamps) -> Option<Vec<Item<Record>>> {
        let mut state = self.state();
        let found = state.earlier.get_mut(input).filter(|entry| self.holds(entry, files))?;
        let items = mem::take(&mut found.items);
        state.written.insert(input.to_owned());
        Some(items)
    }

    fn holds(&self, entry: &Entry, files: &FileStamps) -> bool {
        let is_whole = |item: &Item<Record>| self.keeps_failures || matches!(item, Item::Row(_));
        entry.files == *files && entry.items.iter().all(is_whole)
    }

    /// Writes what came of an input. What keeps it from being written is told by [`Journal::check`].
    pub(super) fn add(&self, entry: Entry) {
        if let Err(error) = self.write(entry) {
            self.state().failed.get_or_insert(error);
        }
    }

    fn write(&self, entry: Entry) -> io::Result<()> {
        let mut state = self.state();
        state.written.insert(entry.input.clone());
        state.line(&Line::Result(entry))
    }

    /// Whether this run has written what came of an input.
    pub(super) fn has(&self, input: &str) -> bool {
        self.state().written.contains(input)
    }

    /// Tells of what could not be written, once.
    pub(super) fn check(&self) -> io::Result<()> {
        self.state().failed.take().map_or(Ok(()), Err)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// By one call to the system, so that of a run that is killed there is at most half a line.
    fn line(&mut self, line: &Line) -> io::Result<()> {
        self.file.write_all((line.text() + "\n").as_bytes())
    }
}

fn at(path: &Path) -> impl Fn(io::Error) -> JournalError + '_ {
    |source| JournalError::Io { path: path.to_owned(), source }
}
