//! A reader's slabs with the errors of all inputs.

use super::InputError;
use crate::volume::{Grid, Slab, SlabReader};
use std::time::Duration;

/// A reader whose errors are those of inputs.
pub(super) struct Reader<R>(pub(super) R);

impl<R: SlabReader> SlabReader for Reader<R>
where
    R::Error: Into<InputError>,
{
    type Error = InputError;

    fn grid(&self) -> &Grid {
        self.0.grid()
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, InputError> {
        self.0.next_slab().map_err(Into::into)
    }

    fn file_time(&self) -> Duration {
        self.0.file_time()
    }
}
