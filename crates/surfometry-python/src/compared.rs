//! Two tables.

use crate::errors::raise;
use crate::measured::text;
use crate::options::wrong;
use pyo3::prelude::*;
use std::path::Path;
use surfometry::comparison::{
    ColumnChoice, TableError, chosen_columns, compare as compared, names_of, read_tables,
};
use surfometry::statistics::Bootstrap;

/// How far two tables agree, as JSON.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an option of the command")]
pub(crate) fn compare(
    py: Python,
    method: &str,
    standard: &str,
    columns: Vec<String>,
    object: &str,
    label: Option<&str>,
    names: Option<[String; 2]>,
    bootstrap: usize,
) -> PyResult<String> {
    if bootstrap < 100 {
        return Err(wrong(py, "bootstrap", &bootstrap.to_string(), &"take at least 100 samples"));
    }
    let choice = |text: &str| text.parse::<ColumnChoice>().unwrap_or_else(|never| match never {});
    let (object, label) = (choice(object), label.map(choice));
    let columns: Vec<_> = columns.iter().map(|text| choice(text)).collect();
    let how = Bootstrap { samples: bootstrap, ..Bootstrap::default() };
    let agreement = py.detach(|| {
        let tables = read_tables([method, standard].map(Path::new), &object, label.as_ref())?;
        let columns = chosen_columns(tables.each_ref(), &columns)?;
        let names = names.unwrap_or_else(|| names_of([method, standard]));
        compared(tables.each_ref(), names, &columns, how)
    });
    agreement.map_err(|error| of_table(py, &error)).and_then(|agreement| text(&agreement))
}

fn of_table(py: Python, error: &TableError) -> PyErr {
    let class = if error.is_of_file() { "FileError" } else { "InputError" };
    raise(py, class, &error.to_string(), &[])
}
