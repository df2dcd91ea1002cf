//! Inputs, from a name to records: what the command line and other front ends share.

mod flatten;
mod input;
mod output;

pub use flatten::{columns_of, flatten};
pub use input::{InputError, InputOptions, LabelInput, measure_input, open_labels};
pub use output::{Failure, Output, Record, SCHEMA};
