//! The extension module behind the Python package: arrays and options in, the library's tasks, numbers and arrays out.
//!
//! It is private: `python/surfometry` is what users see, and says what everything means. Here is no default and no rule
//! but those of crossing the border: threads, signals, panics, errors.
#![expect(clippy::needless_pass_by_value, reason = "arguments of Python come as values")]

mod array_source;
mod arrays;
mod blocks;
mod cohorts;
mod compared;
mod differentiated;
mod errors;
mod input;
mod measured;
mod options;
mod pool;
mod reading;
mod reported;
mod session;
mod surfaces;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::blocks::{Blocks, Part, merged};
    #[pymodule_export]
    use crate::cohorts::{CohortJournal, cohort, measured_line};
    #[pymodule_export]
    use crate::compared::compare;
    #[pymodule_export]
    use crate::differentiated::{integrals, integrals_vjp};
    #[pymodule_export]
    use crate::measured::{columns_of, describe, measure, measure_columns, reference, sweep};
    #[pymodule_export]
    use crate::reading::{affine_of_directions, read};
    #[pymodule_export]
    use crate::reported::report;
    #[pymodule_export]
    use crate::surfaces::{surface, voxel_maps, write_mesh};

    use pyo3::prelude::*;
    use std::ffi::OsString;

    /// Version of the library.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    /// What is said of an image with so many labels.
    #[pyfunction]
    fn grey_image_warning(name: &str, labels: usize) -> Option<String> {
        surfometry::inputs::grey_image_warning(name, labels)
    }

    /// The command line: its exit status.
    #[pyfunction]
    fn main(py: Python, arguments: Vec<OsString>) -> u8 {
        py.detach(|| surfometry_cli::run(arguments))
    }
}
