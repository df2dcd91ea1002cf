//! Which rows of two tables are of the same object.

use super::{ObjectKey, Row, Table, TableError};
use std::collections::BTreeMap;
use std::path::Path;

/// Rows of the same objects.
#[derive(Debug, Clone, PartialEq)]
pub struct Matching<'a> {
    /// Of the method and of the standard, in the method's order.
    pub pairs: Vec<(&'a Row, &'a Row)>,
    /// Objects of the method alone.
    pub only_method: Vec<ObjectKey>,
    /// Objects of the standard alone.
    pub only_standard: Vec<ObjectKey>,
}

impl<'a> Matching<'a> {
    /// Matches by input, label and component; where no input is in both tables, by the inputs' file names
    /// without their folders.
    ///
    /// # Errors
    /// [`TableError::Twice`], [`TableError::NoMatch`].
    pub fn new(method: &'a Table, standard: &'a Table) -> Result<Self, TableError> {
        let whole = |key: &ObjectKey| key.clone();
        let found = Self::by(method, standard, whole)?;
        let found = if found.pairs.is_empty() { Self::by(method, standard, without_folder)? } else { found };
        if found.pairs.is_empty() {
            let example = method.rows.first().map_or_else(String::new, |row| row.key.to_string());
            return Err(TableError::NoMatch {
                method: method.path.clone(),
                standard: standard.path.clone(),
                example,
            });
        }
        Ok(found)
    }

    fn by(
        method: &'a Table,
        standard: &'a Table,
        name: impl Fn(&ObjectKey) -> ObjectKey,
    ) -> Result<Self, TableError> {
        by_name(method, &name)?;
        let mut standards = by_name(standard, &name)?;
        let mut found = Self { pairs: Vec::new(), only_method: Vec::new(), only_standard: Vec::new() };
        for row in &method.rows {
            match standards.remove(&name(&row.key)) {
                Some(other) => found.pairs.push((row, other)),
                None => found.only_method.push(row.key.clone()),
            }
        }
        found.only_standard = standards.into_values().map(|row| row.key.clone()).collect();
        Ok(found)
    }
}

/// The rows of a table by what an object is called.
///
/// # Errors
/// [`TableError::Twice`].
pub(crate) fn by_name(
    table: &Table,
    name: impl Fn(&ObjectKey) -> ObjectKey,
) -> Result<BTreeMap<ObjectKey, &Row>, TableError> {
    let mut rows = BTreeMap::new();
    for row in &table.rows {
        if rows.insert(name(&row.key), row).is_some() {
            return Err(TableError::Twice { path: table.path.clone(), object: row.key.to_string() });
        }
    }
    Ok(rows)
}

fn without_folder(key: &ObjectKey) -> ObjectKey {
    let file = Path::new(&key.input).file_name().and_then(|name| name.to_str());
    ObjectKey { input: file.unwrap_or(&key.input).to_owned(), ..key.clone() }
}
