//! Two tables.

use crate::errors::raise;
use crate::measured::text;
use crate::options::wrong;
use pyo3::prelude::*;
use std::path::Path;
use surfometry::comparison::{ColumnPair, Table, TableError, compare as compared, names_of};
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
    names: Option<[String; 2]>,
    bootstrap: usize,
) -> PyResult<String> {
    if bootstrap < 100 {
        return Err(wrong(py, "bootstrap", &bootstrap.to_string(), &"take at least 100 samples"));
    }
    let pair = |text: &str| text.parse::<ColumnPair>().unwrap_or_else(|never| match never {});
    let (object, columns) = (pair(object), columns.iter().map(|text| pair(text)).collect::<Vec<_>>());
    let how = Bootstrap { samples: bootstrap, ..Bootstrap::default() };
    let agreement = py.detach(|| {
        let tables = [(method, &object.method), (standard, &object.standard)];
        let [method_table, standard_table] =
            tables.map(|(path, named)| Table::read_named(Path::new(path), named));
        let names = names.unwrap_or_else(|| names_of([method, standard]));
        compared([&method_table?, &standard_table?], names, &columns, how)
    });
    agreement.map_err(|error| of_table(py, &error)).and_then(|agreement| text(&agreement))
}

fn of_table(py: Python, error: &TableError) -> PyErr {
    let class = if error.is_of_file() { "FileError" } else { "InputError" };
    raise(py, class, &error.to_string(), &[])
}
