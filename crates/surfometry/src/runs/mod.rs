//! Inputs, from a name to records: what the command line and other front ends share.

mod cohort_files;
#[cfg(feature = "pictures")]
mod file_ledger;
mod file_names;
mod flatten;
mod input;
#[cfg(feature = "pictures")]
mod map_files;
mod objects;
mod output;
mod reference;
mod surface_record;
#[cfg(feature = "pictures")]
mod sweep_chart;

pub use cohort_files::{CohortFile, write_cohort};
#[cfg(feature = "pictures")]
pub use file_ledger::FileLedger;
pub use file_names::{distinct_parts, input_title, with_parts};
pub use flatten::{columns_of, flatten};
pub use input::{
    ExplainTopology, InputError, InputOptions, InputRecords, LabelInput, measure_input, open_labels,
};
#[cfg(feature = "pictures")]
pub use map_files::{MapFile, MapStyle, write_figure, write_map_files};
pub use objects::{InputObject, visit_objects};
pub use output::{Failure, Output, Record, SCHEMA};
pub use reference::{REFERENCE_SCHEMA, ReferenceRecord, reference_input};
pub use surface_record::{MAP_SCHEMA, SurfaceRecord};
#[cfg(feature = "pictures")]
pub(crate) use sweep_chart::sweep_panels;
#[cfg(feature = "pictures")]
pub use sweep_chart::{SweepAxis, write_sweep_chart};
