//! Values that a caller hands over, lends or shares.

use std::sync::Arc;

/// What several owners can hold: an [`Arc`], as it is; a value, which moves; or a reference, of which a copy
/// is made.
pub trait Shared<T> {
    /// The value, to be held.
    fn shared(self) -> Arc<T>;
}

impl<T> Shared<T> for T {
    fn shared(self) -> Arc<T> {
        Arc::new(self)
    }
}

impl<T: Clone> Shared<T> for &T {
    fn shared(self) -> Arc<T> {
        Arc::new(self.clone())
    }
}

impl<T> Shared<T> for Arc<T> {
    fn shared(self) -> Arc<T> {
        self
    }
}

impl<T> Shared<T> for &Arc<T> {
    fn shared(self) -> Arc<T> {
        Arc::clone(self)
    }
}
