//! Inputs, from a name to records: what the command line and other front ends share.

mod file_names;
mod flatten;
mod input;
mod objects;
mod output;
mod surface_record;

pub use file_names::{input_stem, with_parts};
pub use flatten::{columns_of, flatten};
pub use input::{InputError, InputOptions, LabelInput, measure_input, open_labels};
pub use objects::{InputObject, visit_objects};
pub use output::{Failure, Output, Record, SCHEMA};
pub use surface_record::{MAP_SCHEMA, SurfaceRecord};
