//! Many inputs, one task.

use super::fingerprint::Fingerprint;
use super::{Failure, RunError};
use crate::inputs::{OpenOptions, Source, distinct_parts, open};
#[cfg(feature = "report")]
use crate::io::HashedFile;
use crate::{Control, Event};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashSet};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

/// Inputs to which the same is done: read once each, small ones side by side, large ones one after the other,
/// what comes out in the order of the inputs.
///
/// ```
/// use surfometry::{Control, runs::{Batch, Collected, MeasureTask}};
/// let inputs = ["phantom:ball?radius=6".to_owned(), "phantom:ball?radius=7".to_owned()];
/// let (control, mut found) = (Control::default(), Collected::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// batch.run(&MeasureTask::default(), &mut found)?;
/// assert_eq!((found.results.len(), found.failures.len()), (2, 0));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Batch<'a> {
    /// Names of the inputs.
    pub inputs: &'a [String],
    /// What the caller knows better than they.
    pub open: OpenOptions,
    /// Who hears of the run's progress and may stop it.
    pub control: &'a Control,
    /// The front end's own words for the cure of an error, where it has any: how an option is called.
    pub cure: fn(&RunError) -> Option<&'static str>,
}

/// What is done with every input.
pub trait Task: Sync {
    /// What comes out, one an object or several.
    type Row: Send;

    /// Whether small inputs may be done at the same time: what comes of one does not depend on those before.
    fn side_by_side(&self) -> bool {
        true
    }

    /// Does all that is wanted of an input, and hands out rows and failures as they come.
    ///
    /// # Errors
    /// [`RunError`]: nothing more of this input comes then.
    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<Self::Row>)) -> Result<(), RunError>;
}

/// An input that was opened.
pub struct Opened<'a> {
    /// Its name, as given.
    pub name: &'a str,
    /// What tells names of its files from those of other inputs; `None` where it is the only one.
    pub part: Option<&'a str>,
    /// The input.
    pub source: Box<dyn Source + 'a>,
    /// Who hears of the run's progress and may stop it.
    pub control: &'a Control,
    pub(super) fingerprint: Arc<Fingerprint>,
    /// Why some of what was asked of it could not be done; `None` where that is an error of all.
    lacking: Option<Mutex<Vec<RunError>>>,
}

impl<'a> Opened<'a> {
    /// An input under its name.
    pub fn new(
        name: &'a str,
        part: Option<&'a str>,
        source: Box<dyn Source + 'a>,
        control: &'a Control,
    ) -> Self {
        let fingerprint = Arc::new(Fingerprint::of(&*source));
        Self { name, part, source, control, fingerprint, lacking: None }
    }

    /// The same, of which what is there is done where some of what was asked is not.
    fn whatever_is_there(self) -> Self {
        Self { lacking: Some(Mutex::default()), ..self }
    }

    /// Hears of objects that were asked for and are not there.
    ///
    /// # Errors
    /// The first of them, where all must be there.
    pub(super) fn lacks(&self, errors: impl IntoIterator<Item = RunError>) -> Result<(), RunError> {
        let mut errors = errors.into_iter();
        let Some(lacking) = &self.lacking else { return errors.next().map_or(Ok(()), Err) };
        lacking.lock().unwrap_or_else(PoisonError::into_inner).extend(errors);
        Ok(())
    }

    /// Does a task, and hands out as failures what the input lacks.
    pub(super) fn done<T: Task>(
        &self,
        task: &T,
        cure: fn(&RunError) -> Option<&'static str>,
        out: &mut dyn FnMut(Item<T::Row>),
    ) -> Result<(), RunError> {
        let done = task.run(self, out);
        let lacking = self
            .lacking
            .iter()
            .flat_map(|lacking| std::mem::take(&mut *lacking.lock().unwrap_or_else(PoisonError::into_inner)));
        // Some inputs are read twice, and lack the same then.
        let mut told = HashSet::new();
        for failure in lacking.map(|error| Failure::of(self.name, &error, cure)) {
            if told.insert(failure.error.clone()) {
                self.fail(failure, out);
            }
        }
        done
    }

    /// Begins to hash its files, beside what is done with it, for who will say which they were.
    pub fn begin_hashing(&self) {
        self.fingerprint.begin();
    }

    /// Its files as they are told apart from any others, where all can be read still.
    #[cfg(feature = "report")]
    pub(crate) fn hashed_files(&self) -> Option<&[HashedFile]> {
        self.fingerprint.files()
    }
}

/// What a task hands out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Item<R> {
    /// A result.
    Row(R),
    /// Something that was asked for and could not be had; the rest could.
    Failure(Failure),
}

/// Where results go, one after the other.
pub trait Sink<R> {
    /// Takes a result.
    ///
    /// # Errors
    /// Whatever keeps it from being written; the run ends.
    fn row(&mut self, row: R) -> io::Result<()>;

    /// Takes a failure.
    ///
    /// # Errors
    /// As of [`Sink::row`].
    fn failure(&mut self, failure: Failure) -> io::Result<()>;

    /// Hears that all of an input was handed over.
    ///
    /// # Errors
    /// As of [`Sink::row`].
    fn input_ends(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A sink that keeps everything.
#[derive(Debug, Clone, PartialEq)]
pub struct Collected<R> {
    /// The results.
    pub results: Vec<R>,
    /// What failed.
    pub failures: Vec<Failure>,
}

impl<R> Default for Collected<R> {
    fn default() -> Self {
        Self { results: Vec::new(), failures: Vec::new() }
    }
}

impl<R> Sink<R> for Collected<R> {
    fn row(&mut self, row: R) -> io::Result<()> {
        self.results.push(row);
        Ok(())
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.failures.push(failure);
        Ok(())
    }
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outcome {
    /// How many results there are.
    pub rows: usize,
    /// How many failures.
    pub failures: usize,
    /// Whether it was told to stop before all was done.
    pub stopped: bool,
}

/// Voxels up to which an input is small: several are in memory at once, and each is too short to share out
/// well.
const SMALL: usize = 1 << 21;
/// Inputs for each thread that are looked at together.
const AHEAD: usize = 4;

/// What came of an input.
enum Done<'a, R> {
    /// All of it.
    All(Vec<Item<R>>),
    /// It is large, and waits for its turn.
    Large(Opened<'a>),
    /// The run was told to stop.
    Stopped,
}

impl<R> Done<'_, R> {
    fn items(self) -> Option<Vec<Item<R>>> {
        if let Self::All(items) = self { Some(items) } else { None }
    }
}

impl Batch<'_> {
    /// Does a task with every input. An input that fails is handed to the sink as a failure, and the others
    /// are done.
    ///
    /// # Errors
    /// The sink's.
    pub fn run<T: Task>(&self, task: &T, sink: &mut dyn Sink<T::Row>) -> io::Result<Outcome> {
        let parts = distinct_parts(self.inputs);
        let named: Vec<(&str, Option<&str>)> =
            self.inputs.iter().map(String::as_str).zip(parts.iter().map(Option::as_deref)).collect();
        let mut outcome = Outcome::default();
        for window in named.chunks(AHEAD * rayon::current_num_threads()) {
            let (sender, receiver) = mpsc::channel();
            rayon::in_place_scope(|scope| {
                for (number, &named) in window.iter().enumerate() {
                    let sender = sender.clone();
                    scope.spawn(move |_| {
                        // Who has gone away after an error wants no more.
                        let _ = sender.send((number, self.done_if_small(task, named)));
                    });
                }
                // In their order, each as soon as it and those before it are done.
                let mut early = BTreeMap::new();
                for (number, (name, _)) in window.iter().enumerate() {
                    let done = waited_for(number, &receiver, &mut early);
                    match done {
                        Done::All(items) => {
                            items.into_iter().try_for_each(|item| outcome.hand(item, sink))?;
                        }
                        Done::Large(input) => self.in_turn(task, &input, &mut outcome, sink)?,
                        Done::Stopped => outcome.stopped = true,
                    }
                    if outcome.stopped {
                        // What was finished behind one that was not.
                        early.extend(receiver.try_iter());
                        let done = early.into_values().filter_map(Done::items);
                        return done.flatten().try_for_each(|item| outcome.hand(item, sink));
                    }
                    sink.input_ends()?;
                    self.control.tell(&Event::Finished { input: name });
                }
                Ok::<(), io::Error>(())
            })?;
            if outcome.stopped {
                break;
            }
        }
        Ok(outcome)
    }

    fn done_if_small<'n, T: Task>(
        &'n self,
        task: &T,
        (name, part): (&'n str, Option<&'n str>),
    ) -> Done<'n, T::Row> {
        if self.control.is_stopped() {
            return Done::Stopped;
        }
        let failed = |error: &RunError| Done::All(vec![Item::Failure(self.failed(name, error))]);
        let source = match caught(|| Ok(open(name, &self.open)?)) {
            Ok(source) => source,
            Err(error) => return failed(&error),
        };
        let input = Opened::new(name, part, source, self.control).whatever_is_there();
        if self.inputs.len() == 1 || !task.side_by_side() || input.source.grid().voxel_count() > SMALL {
            return Done::Large(input);
        }
        let mut items = Vec::new();
        match self.told(task, &input, &mut |item| items.push(item)) {
            Err(error) if error.is_stop() => Done::Stopped,
            Err(error) => {
                items.push(Item::Failure(self.failed(name, &error)));
                Done::All(items)
            }
            Ok(()) => Done::All(items),
        }
    }

    /// Hands over what comes of a large input as it comes.
    fn in_turn<T: Task>(
        &self,
        task: &T,
        input: &Opened,
        outcome: &mut Outcome,
        sink: &mut dyn Sink<T::Row>,
    ) -> io::Result<()> {
        let mut written = Ok(());
        let ended = self.told(task, input, &mut |item| {
            if written.is_ok() {
                written = outcome.hand(item, sink);
            }
        });
        written?;
        match ended {
            Err(error) if error.is_stop() => outcome.stopped = true,
            Err(error) => outcome.hand(Item::Failure(self.failed(input.name, &error)), sink)?,
            Ok(()) => {}
        }
        Ok(())
    }

    fn told<T: Task>(
        &self,
        task: &T,
        input: &Opened,
        out: &mut dyn FnMut(Item<T::Row>),
    ) -> Result<(), RunError> {
        self.control.tell(&Event::Started { input: input.name });
        caught(|| input.done(task, self.cure, out))
    }

    /// The failure of an input, of which whoever listens is told at once.
    fn failed(&self, input: &str, error: &RunError) -> Failure {
        let failure = Failure::of(input, error, self.cure);
        self.control.tell(&Event::Failed { input, error: &failure.error });
        failure
    }
}

/// What panics is the failure of one input: the others are done, and nobody waits for it for ever.
fn caught<T>(work: impl FnOnce() -> Result<T, RunError>) -> Result<T, RunError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        Err(RunError::Fault(text.unwrap_or("it panicked").to_owned()))
    })
}

/// What comes of an input by its number; what comes before its turn is kept. On a thread of the pool, the pool's work is done
/// while it is waited for: there may be no other thread.
fn waited_for<T>(number: usize, receiver: &mpsc::Receiver<(usize, T)>, early: &mut BTreeMap<usize, T>) -> T {
    loop {
        if let Some(done) = early.remove(&number) {
            return done;
        }
        let came = match rayon::yield_now() {
            Some(rayon::Yield::Executed) => receiver.try_recv().ok(),
            _ => receiver.recv_timeout(Duration::from_millis(1)).ok(),
        };
        early.extend(came);
    }
}

impl Outcome {
    pub(super) fn hand<R>(&mut self, item: Item<R>, sink: &mut dyn Sink<R>) -> io::Result<()> {
        match item {
            Item::Row(row) => {
                self.rows += 1;
                sink.row(row)
            }
            Item::Failure(failure) => {
                self.failures += 1;
                sink.failure(failure)
            }
        }
    }
}

impl Opened<'_> {
    /// Hands out a failure that leaves the rest of the input, of which whoever listens is told at once.
    pub(super) fn fail<R>(&self, failure: Failure, out: &mut dyn FnMut(Item<R>)) {
        self.control.tell(&Event::Failed { input: &failure.input, error: &failure.error });
        out(Item::Failure(failure));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Faulty;

    impl Task for Faulty {
        type Row = String;

        fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<String>)) -> Result<(), RunError> {
            assert!(!input.name.contains("radius=5"), "no five");
            out(Item::Row(input.name.to_owned()));
            Ok(())
        }
    }

    #[derive(Default)]
    struct Taken(Vec<String>, Vec<Failure>);

    impl Sink<String> for Taken {
        fn row(&mut self, row: String) -> io::Result<()> {
            self.0.push(row);
            Ok(())
        }

        fn failure(&mut self, failure: Failure) -> io::Result<()> {
            self.1.push(failure);
            Ok(())
        }
    }

    #[test]
    fn a_fault_is_one_inputs_failure() {
        let all =
            ["phantom:ball?radius=4", "phantom:ball?radius=5", "phantom:ball?radius=6"].map(str::to_owned);
        let control = Control::default();
        for inputs in [&all[..], &all[1..2]] {
            let batch = Batch { inputs, open: OpenOptions::default(), control: &control, cure: |_| None };
            let mut taken = Taken::default();
            let outcome = batch.run(&Faulty, &mut taken).unwrap();
            assert_eq!((outcome.rows, taken.0.len(), taken.1.len()), (inputs.len() - 1, inputs.len() - 1, 1));
            assert!(
                taken.1[0].error.contains("a fault of surfometry itself (no five)"),
                "{}",
                taken.1[0].error
            );
        }
    }
}
