//! Progress of a run, and a stop.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use thiserror::Error;

/// Tells a listener how a run gets on, and tells the run to stop. Clones are the same control.
///
/// The stop is looked at after every slab that is read and every tile that is summed, so that a run ends soon
/// after it.
///
/// ```
/// use surfometry::Control;
/// let control = Control::default();
/// assert!(control.check().is_ok());
/// control.stop();
/// assert!(control.check().is_err());
/// ```
#[derive(Clone, Default)]
pub struct Control {
    state: Arc<State>,
}

#[derive(Default)]
struct State {
    stopped: AtomicBool,
    listener: Option<Box<Listener>>,
}

type Listener = dyn Fn(&Event) + Send + Sync;

/// The run was told to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("stopped")]
pub struct Stopped;

/// What a run tells of itself. Inputs are named as they were given.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Event<'a> {
    /// An input is next.
    Started {
        /// The input.
        input: &'a str,
    },
    /// Slices of it were read.
    Slices {
        /// The input.
        input: &'a str,
        /// How many.
        done: usize,
        /// Of how many.
        of: usize,
        /// Labels that have occurred so far, background left out.
        labels: usize,
    },
    /// One of its objects is next.
    Object {
        /// The input.
        input: &'a str,
        /// Which, from 1 on.
        number: usize,
        /// Of how many.
        of: usize,
    },
    /// Something about it that a person may want to know.
    Note {
        /// The input.
        input: &'a str,
        /// What.
        text: &'a str,
    },
    /// It could not be done, or not all that was asked of it.
    Failed {
        /// The input.
        input: &'a str,
        /// Why.
        error: &'a str,
    },
    /// It is done, measured or failed.
    Finished {
        /// The input.
        input: &'a str,
    },
}

impl Control {
    /// A control whose events somebody hears, from whichever thread.
    pub fn heard_by(listener: impl Fn(&Event) + Send + Sync + 'static) -> Self {
        Self {
            state: Arc::new(State { stopped: AtomicBool::new(false), listener: Some(Box::new(listener)) }),
        }
    }

    /// Tells the run to end as soon as it can.
    pub fn stop(&self) {
        self.state.stopped.store(true, Ordering::Relaxed);
    }

    /// Whether the run was told to stop.
    pub fn is_stopped(&self) -> bool {
        self.state.stopped.load(Ordering::Relaxed)
    }

    /// Goes on, unless the run was told to stop.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn check(&self) -> Result<(), Stopped> {
        if self.is_stopped() { Err(Stopped) } else { Ok(()) }
    }

    /// Lets the listener hear of an event.
    pub fn tell(&self, event: &Event) {
        if let Some(listener) = &self.state.listener {
            listener(event);
        }
    }
}

impl fmt::Debug for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control").field("stopped", &self.is_stopped()).finish_non_exhaustive()
    }
}
