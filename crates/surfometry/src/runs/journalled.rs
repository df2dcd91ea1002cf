//! A run that keeps a journal: a task and a sink around those of any other.

use super::journal::{Entry, Journal};
use super::stamps::FileStamps;
use super::{Failure, Item, Opened, Record, RunError, Sink, Task};
use crate::Control;
use crate::inputs::{OpenOptions, open};
use std::io;

/// A task that writes what comes of each input to a journal as soon as it is known, and hands out what the journal has
/// instead of doing it again.
pub(super) struct JournalledTask<'a, T> {
    /// What is done with an input.
    pub(super) task: T,
    /// The journal.
    pub(super) journal: &'a Journal,
    /// As of [`Batch`](super::Batch).
    pub(super) cure: fn(&RunError) -> Option<&'static str>,
}

impl<T: Task<Row = Record>> Task for JournalledTask<'_, T> {
    type Row = Record;

    fn side_by_side(&self) -> bool {
        self.task.side_by_side()
    }

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<Record>)) -> Result<(), RunError> {
        let files = FileStamps::of(&*input.source);
        if let Some(items) = self.journal.earlier(input.name, &files) {
            items.into_iter().for_each(out);
            return Ok(());
        }
        self.journal.add(entry_of(&self.task, input, self.cure, out)?);
        Ok(())
    }
}

/// Does a task with an input; what came of it, failures too. An error is a stop.
fn entry_of<T: Task<Row = Record>>(
    task: &T,
    input: &Opened,
    cure: fn(&RunError) -> Option<&'static str>,
    out: &mut dyn FnMut(Item<Record>),
) -> Result<Entry, RunError> {
    // Before the voxels are read: a file that changes while they are is another one next time.
    let files = FileStamps::of(&*input.source);
    let mut items = Vec::new();
    let mut kept = |item: Item<Record>| {
        items.push(item.clone());
        out(item);
    };
    match input.done(task, cure, &mut kept) {
        Err(error) if error.is_stop() => return Err(error),
        Err(error) => input.fail(Failure::of(input.name, &error, cure), &mut kept),
        Ok(()) => {}
    }
    Ok(Entry { input: input.name.to_owned(), files, items })
}

/// Does a task with an input, which may be read by nobody else; the line that a journal has of it
/// ([`Journal::add_line`]). A failure is a line, too.
///
/// # Errors
/// A stop.
pub fn journal_line<T: Task<Row = Record>>(
    input: &str,
    options: &OpenOptions,
    task: &T,
    control: &Control,
    cure: fn(&RunError) -> Option<&'static str>,
) -> Result<String, RunError> {
    let entry = match open(input, options) {
        // One of several, whatever the others are.
        Ok(source) => entry_of(task, &Opened::new(input, Some(input), source, control), cure, &mut |_| {})?,
        Err(error) => Entry::of_failure(Failure::of(input, &error.into(), cure)),
    };
    Ok(entry.line())
}

/// A sink that writes to a journal what no task could: that an input could not be opened.
pub(super) struct JournalledSink<'j, 's> {
    journal: &'j Journal,
    inner: Option<&'s mut dyn Sink<Record>>,
}

impl<'j, 's> JournalledSink<'j, 's> {
    /// Before another sink, or by itself.
    pub(super) fn new(journal: &'j Journal, inner: Option<&'s mut dyn Sink<Record>>) -> Self {
        Self { journal, inner }
    }
}

impl Sink<Record> for JournalledSink<'_, '_> {
    fn row(&mut self, row: Record) -> io::Result<()> {
        self.inner.as_mut().map_or(Ok(()), |inner| inner.row(row))
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        if !self.journal.has(&failure.input) {
            self.journal.add(Entry::of_failure(failure.clone()));
        }
        self.inner.as_mut().map_or(Ok(()), |inner| inner.failure(failure))
    }

    fn input_ends(&mut self) -> io::Result<()> {
        self.journal.check()?;
        self.inner.as_mut().map_or(Ok(()), |inner| inner.input_ends())
    }
}
