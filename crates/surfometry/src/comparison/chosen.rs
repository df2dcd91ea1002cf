//! Two tables as a user names their columns.

use super::{ColumnChoice, ColumnPair, KeyColumns, Table, TableError, TableFiles};
use std::path::Path;

/// Reads a method's table and a standard's, whose objects are told by the columns of their inputs and, where that is
/// not `label`, of their labels.
///
/// # Errors
/// [`TableError`], also where what was chosen can be read in two ways.
pub fn read_tables(
    paths: [&Path; 2],
    object: &ColumnChoice,
    label: Option<&ColumnChoice>,
) -> Result<[Table; 2], TableError> {
    let [method, standard] = paths.map(TableFiles::read);
    let (method, standard) = (method?, standard?);
    let meant = |choice| meant(choice, |name| method.has(name), |name| standard.has(name));
    let object = meant(object)?;
    let label = label.map(meant).transpose()?;
    let [of_method, of_standard] = label.map_or([None, None], |l| [Some(l.method), Some(l.standard)]);
    Ok([
        method.into_table(&KeyColumns { object: object.method, label: of_method })?,
        standard.into_table(&KeyColumns { object: object.standard, label: of_standard })?,
    ])
}

/// The columns of two tables that were chosen.
///
/// # Errors
/// [`TableError::Ambiguous`] where a choice can be read in two ways.
pub fn chosen_columns(
    [method, standard]: [&Table; 2],
    choices: &[ColumnChoice],
) -> Result<Vec<ColumnPair>, TableError> {
    choices.iter().map(|choice| meant(choice, |name| method.has(name), |name| standard.has(name))).collect()
}

fn meant(
    choice: &ColumnChoice,
    of_method: impl Fn(&str) -> bool,
    of_standard: impl Fn(&str) -> bool,
) -> Result<ColumnPair, TableError> {
    choice.resolve(of_method, of_standard).map_err(|readings| {
        let told = |pair: &ColumnPair| format!("`{}` against `{}`", pair.method, pair.standard);
        let readings: Vec<String> = readings.iter().map(told).collect();
        TableError::Ambiguous { choice: choice.to_string(), readings: readings.join(" or ") }
    })
}
