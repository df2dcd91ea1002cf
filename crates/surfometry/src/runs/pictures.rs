//! Pictures beside records, of the same reading.

use super::{FileLedger, InputObject, Item, MapStyle, Opened, RunError, write_map_files};
use crate::inputs::with_parts;
use std::path::PathBuf;

/// Where pictures of an input's objects go.
#[derive(Debug)]
pub struct Pictures {
    /// The file; where there are several inputs or objects, `_NAME` and `_label-N` go before its ending.
    pub path: PathBuf,
    /// How they are made.
    pub style: MapStyle,
    /// The files of the run.
    pub ledger: FileLedger,
}

impl Pictures {
    /// Draws an object. That it has no surface is in its record, and nothing to draw.
    pub(super) fn draw<R>(&self, input: &Opened, object: &InputObject, out: &mut dyn FnMut(Item<R>)) {
        let path = with_parts(&self.path, input.part.as_slice());
        match write_map_files(object, &path, &self.style, &self.ledger) {
            Ok(_) | Err(RunError::NoSurface) => {}
            Err(error) => input.fail(object.failure(&format!("no picture: {error}")), out),
        }
    }
}
