//! Inputs whose labels the caller has names for.

use super::{HeaderFacts, InputError, OpenOptions, Preparations, Slabs, Source};
use crate::accuracy::Flag;
use crate::phantoms::Truth;
use crate::volume::{Grid, LabelTable, Segments};
use std::path::PathBuf;
use std::sync::Arc;

/// The input with the names that the caller has for its labels, in the place of its own.
pub fn named<'a>(source: Box<dyn Source + 'a>, options: &OpenOptions) -> Box<dyn Source + 'a> {
    if options.names.is_empty() {
        return source;
    }
    let table = source.label_table().overlaid(&options.names);
    Box::new(Named { source, table })
}

struct Named<'a> {
    source: Box<dyn Source + 'a>,
    table: LabelTable,
}

impl Source for Named<'_> {
    fn grid(&self) -> &Grid {
        self.source.grid()
    }

    fn slabs(&self) -> Result<Slabs<'_>, InputError> {
        self.source.slabs()
    }

    fn header(&self) -> HeaderFacts {
        self.source.header()
    }

    fn truth(&self) -> Option<Truth> {
        self.source.truth()
    }

    fn is_object(&self) -> bool {
        self.source.is_object()
    }

    fn label_table(&self) -> LabelTable {
        self.table.clone()
    }

    fn segments(&self) -> Option<Segments> {
        self.source.segments()
    }

    fn preparations(&self) -> Option<Arc<Preparations>> {
        self.source.preparations()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.source.files()
    }

    fn flags(&self) -> Vec<Flag> {
        self.source.flags()
    }
}
