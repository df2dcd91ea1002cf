//! Which rows of two tables are of the same object.

use super::{ObjectKey, Row, Table, TableError};
use crate::inputs::{Kind, known_stem};
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
    /// Whether names are the same only without their endings.
    pub without_endings: bool,
}

impl<'a> Matching<'a> {
    /// Matches by input, label and component, as far as both tables have them; where no input is in both
    /// tables, by the inputs' file names without their folders, and then without the endings of files that are
    /// read or written, `.gz` around them too: other points are the names' own, as in `left.1.5mm`.
    ///
    /// # Errors
    /// [`TableError::Twice`], [`TableError::NoMatch`].
    pub fn new(method: &'a Table, standard: &'a Table) -> Result<Self, TableError> {
        let both = |part: fn(&ObjectKey) -> &str| {
            [method, standard].iter().all(|table| table.rows.iter().any(|row| !part(&row.key).is_empty()))
        };
        let (labels, components) = (both(|key| &key.label), both(|key| &key.component));
        let known = |key: &ObjectKey, input: &str| ObjectKey {
            input: input.to_owned(),
            label: if labels { key.label.clone() } else { String::new() },
            component: if components { key.component.clone() } else { String::new() },
        };
        let ways: [(NameOf, bool); 3] = [(whole, false), (without_folder, false), (without_ending, true)];
        for (input_of, without_endings) in ways {
            let found = Self::by(method, standard, |key| known(key, input_of(&key.input)))?;
            if !found.pairs.is_empty() {
                return Ok(Self { without_endings, ..found });
            }
        }
        let first = |table: &Table| table.rows.first().map_or_else(String::new, |row| row.key.to_string());
        Err(TableError::NoMatch {
            method: method.path.clone(),
            standard: standard.path.clone(),
            example: first(method),
            other: first(standard),
        })
    }

    /// What is assumed where names are the same only without their endings, or where one file name stands for all and only
    /// folders may tell subjects apart, as FreeSurfer has it.
    pub(super) fn doubts(&self) -> Vec<String> {
        let inputs = || self.pairs.iter().map(|(own, other)| [own, other].map(|row| row.key.input.as_str()));
        let shortened = inputs().next().filter(|_| self.without_endings);
        let mut names = inputs().map(|[own, _]| without_folder(own));
        let is_one_name = names.next().is_some_and(|first| names.all(|name| name == first));
        let moved = inputs().find(|names| is_one_name && are_in_other_folders(*names));
        let told = [("endings", shortened), ("folders", moved)];
        let words = |(part, names): (&str, Option<[&str; 2]>)| {
            let [own, other] = names?;
            Some(format!(
                "names are the same only without their {part}, as `{own}` and `{other}`: check that they are of the same objects"
            ))
        };
        told.into_iter().filter_map(words).collect()
    }

    fn by(
        method: &'a Table,
        standard: &'a Table,
        name: impl Fn(&ObjectKey) -> ObjectKey,
    ) -> Result<Self, TableError> {
        by_name(method, &name)?;
        let mut standards = by_name(standard, &name)?;
        let mut found = Self {
            pairs: Vec::new(),
            only_method: Vec::new(),
            only_standard: Vec::new(),
            without_endings: false,
        };
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
        let name = name(&row.key);
        let object = name.to_string();
        if rows.insert(name, row).is_some() {
            return Err(TableError::Twice { path: table.path.clone(), object });
        }
    }
    Ok(rows)
}

/// Whether both names have folders, and not the same.
fn are_in_other_folders(names: [&str; 2]) -> bool {
    let [own, other] =
        names.map(|name| Path::new(name).parent().filter(|folder| !folder.as_os_str().is_empty()));
    own.zip(other).is_some_and(|(own, other)| own != other)
}

/// What of an input's name counts.
type NameOf = fn(&str) -> &str;

fn whole(input: &str) -> &str {
    input
}

fn without_folder(input: &str) -> &str {
    Path::new(input).file_name().and_then(|name| name.to_str()).unwrap_or(input)
}

fn without_ending(input: &str) -> &str {
    let name = without_folder(input);
    // What a phantom's name ends in is a value.
    if Kind::of(input).is_path() { known_stem(name) } else { name }
}
