//! Which rows of two tables are of the same object.

use super::{ObjectKey, Row, Table, TableError};
use crate::inputs::Kind;
use crate::io::known_stem;
use std::collections::{BTreeMap, HashSet};
use std::path::{Component, Path};

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
    /// Whether rows are told apart by the folders that both tables have.
    pub by_folders: bool,
}

impl<'a> Matching<'a> {
    /// Matches by input, label and component, as far as both tables have them; where no input is in both
    /// tables, by the inputs' file names without their folders, and then without the endings of files that are
    /// read or written, `.gz` around them too: other points are the names' own, as in `left.1.5mm`. Where file names alone
    /// do not tell a table's rows apart, as `manual/sub-01/seg.nii.gz`, folders stay, but for those that all rows of
    /// one table have and no row of the other.
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
        let folders = Folders::new(method, standard);
        let ways: [(&NameOf<'_>, [bool; 2]); 5] = [
            (&str::to_owned, [false, false]),
            (&|input| without_folder(input).to_owned(), [false, false]),
            (&|input| folders.common(input, without_folder(input)), [false, true]),
            (&|input| without_ending(input).to_owned(), [true, false]),
            (&|input| folders.common(input, without_ending(input)), [true, true]),
        ];
        let mut twice = None;
        for (input_of, [without_endings, by_folders]) in ways {
            match Self::by(method, standard, |key| known(key, &input_of(&key.input))) {
                Ok(found) if !found.pairs.is_empty() => {
                    return Ok(Self { without_endings, by_folders, ..found });
                }
                Ok(_) => {}
                Err(error) => twice = twice.or(Some(error)),
            }
        }
        if let Some(error) = twice {
            return Err(error);
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
        let unsure = is_one_name && !self.by_folders;
        let moved = inputs().find(|names| unsure && are_in_other_folders(*names));
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
            by_folders: false,
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
type NameOf<'a> = dyn Fn(&str) -> String + 'a;

/// Folders that only tell two tables apart, as `manual` and `auto`: all rows of one have them, and no row of the other.
struct Folders<'a>(HashSet<&'a str>);

impl<'a> Folders<'a> {
    fn new(method: &'a Table, standard: &'a Table) -> Self {
        let of = |table: &'a Table| -> Vec<HashSet<&'a str>> {
            table.rows.iter().map(|row| folders(&row.key.input).collect()).collect()
        };
        let tables = [of(method), of(standard)];
        let only = |own: usize| {
            let others: HashSet<&str> = tables[1 - own].iter().flatten().copied().collect();
            let first = tables[own].first().into_iter().flatten().copied();
            let in_all = |folder: &&str| tables[own].iter().all(|row| row.contains(folder));
            first.filter(in_all).filter(|folder| !others.contains(folder)).collect::<Vec<_>>()
        };
        Self([only(0), only(1)].concat().into_iter().collect())
    }

    /// A name with the other folders.
    fn common(&self, input: &str, name: &str) -> String {
        let kept = folders(input).filter(|folder| !self.0.contains(folder));
        kept.chain([name]).collect::<Vec<_>>().join("/")
    }
}

/// The names of the folders that a file lies in.
fn folders(input: &str) -> impl Iterator<Item = &str> {
    let parts = Path::new(input).parent().into_iter().flat_map(Path::components);
    parts.filter_map(|part| match part {
        Component::Normal(name) => name.to_str(),
        _ => None,
    })
}

fn without_folder(input: &str) -> &str {
    Path::new(input).file_name().and_then(|name| name.to_str()).unwrap_or(input)
}

fn without_ending(input: &str) -> &str {
    let name = without_folder(input);
    // What a phantom's name ends in is a value.
    if Kind::of(input).is_path() { known_stem(name) } else { name }
}
