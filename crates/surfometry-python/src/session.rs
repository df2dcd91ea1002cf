//! Work beside the interpreter: without its lock, on threads of our own, stopped by Ctrl-C, heard of by a progress bar.

use crate::errors::{Name, of_run, raise};
use crate::pool::pool;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;
use surfometry::runs::RunError;
use surfometry::{Control, Event};

/// How long Ctrl-C and the progress bar wait to be looked at.
const PAUSE: Duration = Duration::from_millis(40);

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
struct Heard {
    text: String,
    done: usize,
    of: usize,
    labels: usize,
}

impl Session<'_> {
    /// Does some work under a control; its result, or the exception that it ended with.
    pub(crate) fn run<T: Send>(
        &self,
        py: Python,
        name: Name,
        work: impl FnOnce(&Control) -> Result<T, RunError> + Send,
    ) -> PyResult<T> {
        let pool = pool(self.threads).map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
        let heard = Arc::new(Mutex::new(Heard::default()));
        let listener = Arc::clone(&heard);
        let control = Control::heard_by(move |event| hear(event, &mut lock(&listener)));
        let (sender, receiver) = channel();
        let ended = thread::scope(|scope| {
            let control = &control;
            scope.spawn(move || {
                let worked = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(control))));
                // Whoever waits is there until it is sent.
                let _ = sender.send(worked);
            });
            self.wait(py, control, &heard, receiver)
        });
        match ended? {
            Ok(Ok(result)) => Ok(result),
            Ok(Err(error)) => Err(of_run(py, Some(&name), &error)),
            Err(panic) => Err(of_panic(py, &*panic)),
        }
    }

    /// Waits for a result; what a signal or a listener raises stops the run, and is raised when that has ended.
    fn wait<T: Send>(
        &self,
        py: Python,
        control: &Control,
        heard: &Mutex<Heard>,
        mut receiver: Receiver<T>,
    ) -> PyResult<T> {
        let mut told = Heard::default();
        loop {
            // Lent as a whole, for it may be used by one thread at a time.
            let lent = &mut receiver;
            match py.detach(move || lent.recv_timeout(PAUSE)) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err("the measuring thread went away"));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            let now = lock(heard).clone();
            if let Err(raised) = py.check_signals().and_then(|()| self.tell(&now, &told)) {
                control.stop();
                let _ = py.detach(move || receiver.recv());
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
