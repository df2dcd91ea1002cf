//! Work beside the interpreter: without its lock, on threads of our own, stopped by Ctrl-C, heard of by a progress bar.

use crate::array_source::{SlicesWanted, Voxels};
use crate::errors::{of_run, raise};
use crate::input::{Held, Prepared};
use crate::pool::{leave_behind, pool};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};
use surfometry::runs::RunError;
use surfometry::{Control, Event};

/// How long Ctrl-C and the progress bar wait to be looked at.
const PAUSE: Duration = Duration::from_millis(40);
/// How long a run may take to stop before it is left behind.
const PATIENCE: Duration = Duration::from_millis(60);

/// How a call is run.
#[derive(FromPyObject)]
pub(crate) struct Session<'py> {
    threads: usize,
    /// Called with what is done (text, so much, of so much), where it is wanted.
    progress: Option<Bound<'py, PyAny>>,
    /// Called with how many labels there are as soon as there are several; what it raises ends the run.
    labels: Option<Bound<'py, PyAny>>,
}

/// What was last heard of a run.
#[derive(Clone, Default, PartialEq)]
pub(crate) struct Heard {
    text: String,
    done: usize,
    of: usize,
    labels: usize,
}

impl Heard {
    /// That one more of many is done.
    pub(crate) fn of_many(text: &str, before: &Self, of: usize) -> Self {
        Self { text: text.to_owned(), done: before.done + 1, of, labels: before.labels }
    }
}

/// What the thread that measures says to the one that waits.
enum Message<T> {
    /// Of an input, by its number.
    Wanted(usize, SlicesWanted),
    Ended(thread::Result<Result<T, RunError>>),
}

impl Session<'_> {
    /// Does some work on an input, under a control; its result, or the exception that it ended with.
    pub(crate) fn run<T: Send + 'static>(
        &self,
        py: Python,
        input: &Held,
        work: impl FnOnce(&Control, Prepared) -> Result<T, RunError> + Send + 'static,
    ) -> PyResult<T> {
        self.run_heard(py, input, hear, work)
    }

    /// The same on two inputs; exceptions name the first.
    pub(crate) fn run_both<T: Send + 'static>(
        &self,
        py: Python,
        inputs: [&Held; 2],
        work: impl FnOnce(&Control, [Prepared; 2]) -> Result<T, RunError> + Send + 'static,
    ) -> PyResult<T> {
        self.run_all(py, inputs, hear, work)
    }

    /// The same, of whose events something else is heard.
    pub(crate) fn run_heard<T: Send + 'static>(
        &self,
        py: Python,
        input: &Held,
        hear: impl Fn(&Event, &mut Heard) + Send + Sync + 'static,
        work: impl FnOnce(&Control, Prepared) -> Result<T, RunError> + Send + 'static,
    ) -> PyResult<T> {
        self.run_all(py, [input], hear, move |control, [prepared]| work(control, prepared))
    }

    fn run_all<const N: usize, T: Send + 'static>(
        &self,
        py: Python,
        inputs: [&Held; N],
        hear: impl Fn(&Event, &mut Heard) + Send + Sync + 'static,
        work: impl FnOnce(&Control, [Prepared; N]) -> Result<T, RunError> + Send + 'static,
    ) -> PyResult<T> {
        let pool = pool(self.threads).map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
        let heard = Arc::new(Mutex::new(Heard::default()));
        let listener = Arc::clone(&heard);
        let control = Control::heard_by(move |event| hear(event, &mut lock(&listener)));
        let (sender, receiver) = channel();
        let prepared = std::array::from_fn(|number| {
            let asking = sender.clone();
            inputs[number]
                .prepared(Box::new(move |wanted| asking.send(Message::Wanted(number, wanted)).is_ok()))
        });
        let controlled = control.clone();
        thread::spawn(move || {
            let worked = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(&controlled, prepared))));
            // Whoever was interrupted wants no more.
            let _ = sender.send(Message::Ended(worked));
        });
        match self.wait(py, &inputs, &control, &heard, receiver)? {
            Ok(Ok(result)) => Ok(result),
            Ok(Err(error)) => Err(of_run(py, inputs.first().map(|input| input.name()).as_ref(), &error)),
            Err(panic) => Err(of_panic(py, &*panic)),
        }
    }

    /// Hands out slices until there is a result. What a signal or a listener raises stops the run; where it does not end
    /// soon, it is left behind with its threads, and ends by itself when it next looks.
    fn wait<T: Send>(
        &self,
        py: Python,
        inputs: &[&Held],
        control: &Control,
        heard: &Mutex<Heard>,
        mut receiver: Receiver<Message<T>>,
    ) -> PyResult<thread::Result<Result<T, RunError>>> {
        let voxels: Vec<Option<Voxels>> = inputs.iter().map(|input| input.voxels()).collect();
        let mut told = Heard::default();
        let mut looked = Instant::now();
        loop {
            // Lent as a whole, for it may be used by one thread at a time.
            let (lent, voxels) = (&mut receiver, &voxels);
            let ended = py.detach(move || match lent.recv_timeout(PAUSE) {
                Ok(Message::Wanted(number, wanted)) => {
                    answer(voxels[number].as_ref(), &wanted);
                    None
                }
                Ok(Message::Ended(ended)) => Some(Ok(ended)),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => Some(Err(())),
            });
            match ended {
                Some(Ok(ended)) => return Ok(ended),
                Some(Err(())) => return Err(PyRuntimeError::new_err("the thread that measures went away")),
                None if looked.elapsed() < PAUSE => continue,
                None => looked = Instant::now(),
            }
            let now = lock(heard).clone();
            if let Err(raised) = py.check_signals().and_then(|()| self.tell(&now, &told)) {
                control.stop();
                if !py.detach(move || ends_soon(&receiver)) {
                    leave_behind();
                }
                return Err(raised);
            }
            told = now;
        }
    }

    fn tell(&self, now: &Heard, told: &Heard) -> PyResult<()> {
        if let Some(labels) = self.labels.as_ref().filter(|_| now.labels > told.labels) {
            labels.call1((now.labels,))?;
        }
        if let Some(progress) = self.progress.as_ref().filter(|_| now != told) {
            progress.call1((&now.text, now.done, now.of))?;
        }
        Ok(())
    }
}

/// Does some work of a moment on so many threads, without the interpreter's lock. A signal is looked at when it is done.
pub(crate) fn unlocked<T: Send>(py: Python, threads: usize, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool(threads).map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    let worked = py.detach(|| catch_unwind(AssertUnwindSafe(|| pool.install(work))));
    worked.map_err(|panic| of_panic(py, &*panic))
}

/// Hands out slices, unless the one who asked went away.
fn answer(voxels: Option<&Voxels>, wanted: &SlicesWanted) {
    if let Some(voxels) = voxels {
        let _ = wanted.reply.send(voxels.slices(wanted.first, wanted.last));
    }
}

/// Whether a run that was told to stop does so in time. It gets no more slices.
fn ends_soon<T>(receiver: &Receiver<Message<T>>) -> bool {
    let last = Instant::now() + PATIENCE;
    loop {
        match receiver.recv_timeout(last.saturating_duration_since(Instant::now())) {
            Ok(Message::Wanted(..)) => {}
            Ok(Message::Ended(_)) | Err(RecvTimeoutError::Disconnected) => return true,
            Err(RecvTimeoutError::Timeout) => return false,
        }
    }
}

fn hear(event: &Event, heard: &mut Heard) {
    match *event {
        Event::Slices { done, of, labels, .. } => {
            let labels = labels.max(heard.labels);
            *heard = Heard { text: "slices".to_owned(), done, of, labels };
        }
        Event::Object { number, of, .. } => {
            *heard = Heard { text: "objects".to_owned(), done: number - 1, of, labels: heard.labels.max(of) };
        }
        _ => {}
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn of_panic(py: Python, panic: &(dyn Any + Send)) -> PyErr {
    let said = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    let message = format!("a fault of surfometry's own, please report it: {}", said.unwrap_or("unknown"));
    raise(py, "InternalError", &message, &[])
}
