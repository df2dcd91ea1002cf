//! Time of work that is spread over threads.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time that threads spend on the parts of a work, added up. A part hands nothing to other threads, or it
/// would count their work for its own.
#[derive(Debug, Default)]
pub struct WorkTime(AtomicU64);

impl WorkTime {
    /// Does a part of the work.
    pub fn of<T>(&self, part: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let done = part();
        self.0.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }

    /// All of it so far.
    pub fn total(&self) -> Duration {
        Duration::from_nanos(self.0.load(Ordering::Relaxed))
    }
}
