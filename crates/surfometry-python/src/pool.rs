//! Threads that belong to the process: those of a parent are not there after a fork.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::mem;
use std::sync::{Arc, Mutex, PoisonError};

struct Owned {
    process: u32,
    pool: Arc<ThreadPool>,
}

static POOL: Mutex<Option<Owned>> = Mutex::new(None);

/// So many threads of this process; kept for the next call that wants as many.
pub(crate) fn pool(threads: usize) -> Result<Arc<ThreadPool>, ThreadPoolBuildError> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    match &*kept {
        Some(owned) if owned.process == process && owned.pool.current_num_threads() == threads => {
            return Ok(Arc::clone(&owned.pool));
        }
        // Its threads were the parent's: to end them would wait for ever.
        Some(owned) if owned.process != process => mem::forget(kept.take()),
        _ => {}
    }
    let pool = Arc::new(ThreadPoolBuilder::new().num_threads(threads).build()?);
    *kept = Some(Owned { process, pool: Arc::clone(&pool) });
    Ok(pool)
}

/// Gives the threads up: what they do is not waited for, and the next call gets others.
pub(crate) fn leave_behind() {
    POOL.lock().unwrap_or_else(PoisonError::into_inner).take();
}
