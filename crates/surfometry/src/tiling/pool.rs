//! Work space that threads hand on.

use std::sync::{Mutex, PoisonError};

/// Values that are used again instead of being made anew for each tile: memory for a tile costs more to get
/// from the system, page by page, than to fill.
#[derive(Debug, Default)]
pub struct Pool<T>(Mutex<Vec<T>>);

impl<T: Default> Pool<T> {
    /// Calls `work` with a value that no other thread has: one that was used before, in whatever state it was
    /// left, or a new one.
    pub fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        // A panic while the lock is held is impossible; one in `work` only loses that value.
        let spare = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = spare().pop();
        let mut value = taken.unwrap_or_default();
        let result = work(&mut value);
        spare().push(value);
        result
    }
}
