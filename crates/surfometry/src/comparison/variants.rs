//! Tables with several rows of an object, a row a method, turned into tables with a row an object.

use super::TableError;
use super::table::{FLAGS, ObjectKey, Row, Table, refuse_repeated, whole_number_text};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// What tells the rows of an object apart: methods, or the values of what was swept.
const TELLS_APART: [&str; 4] =
    ["method", "parameters_sigma_mm", "parameters_thickness_mm", "parameters_level"];
/// Between a column's name and the method's.
pub(super) const AT: char = '@';

impl Table {
    /// The same with one row an object, where a column tells its rows apart; else as it is. A column `x` of
    /// rows of methods `a` and `b` becomes `x@a` and `x@b`, and stays `x` as well where the rows of each
    /// object have the same in it.
    ///
    /// # Errors
    /// [`TableError::RepeatedColumn`] where there is a column of that name already.
    pub(super) fn with_methods_as_columns(self) -> Result<Self, TableError> {
        let objects: HashSet<&ObjectKey> = self.rows.iter().map(|row| &row.key).collect();
        let repeats = objects.len() < self.rows.len();
        let telling = TELLS_APART.into_iter().find(|column| repeats && self.tells_apart(column));
        match telling {
            Some(column) => self.by(column),
            None => Ok(self),
        }
    }

    fn tells_apart(&self, column: &str) -> bool {
        let mut seen = HashSet::new();
        let variant = |row: &Row| whole_number_text(row.cell(column));
        self.rows.iter().all(|row| !row.cell(column).is_empty() && seen.insert((&row.key, variant(row))))
    }

    fn by(self, telling: &str) -> Result<Self, TableError> {
        let objects = self.objects();
        let same = |column: &&String| {
            objects.iter().all(|rows| rows.iter().all(|row| row.cell(column) == rows[0].cell(column)))
        };
        let (flags, others): (Vec<&String>, Vec<&String>) =
            self.columns.iter().filter(|column| *column != telling).partition(|column| *column == FLAGS);
        let common: Vec<&String> = others.iter().copied().filter(|column| same(column)).collect();
        let mut variants: Vec<String> = Vec::new();
        for variant in self.rows.iter().map(|row| whole_number_text(row.cell(telling))) {
            if !variants.contains(&variant) {
                variants.push(variant);
            }
        }
        let of_variants =
            variants.iter().flat_map(|variant| others.iter().map(move |column| at(column, variant)));
        let columns: Vec<String> =
            common.iter().chain(&flags).map(|&column| column.clone()).chain(of_variants).collect();
        refuse_repeated(&self.path, &columns)?;
        let places: Arc<HashMap<String, usize>> = Arc::new(columns.iter().cloned().zip(0..).collect());
        let joined = |rows: &Vec<&Row>| {
            let of_methods = rows.iter().flat_map(|row| {
                let variant = whole_number_text(row.cell(telling));
                others.iter().map(move |column| (at(column, &variant), row.cell(column).to_owned()))
            });
            let of_object = common.iter().map(|&column| (column.clone(), rows[0].cell(column).to_owned()));
            let mut cells: HashMap<String, String> = of_object.chain(of_methods).collect();
            cells.insert(FLAGS.to_owned(), all_flags(rows));
            let cells = columns.iter().map(|column| cells.remove(column).unwrap_or_default()).collect();
            Row::new(rows[0].key.clone(), cells, &places)
        };
        let rows = objects.iter().map(joined).collect();
        Ok(Self { columns: columns.clone(), rows, ..self.clone() })
    }

    /// The rows of each object, in the order in which the objects come.
    fn objects(&self) -> Vec<Vec<&Row>> {
        let mut places: HashMap<&ObjectKey, usize> = HashMap::new();
        let mut objects: Vec<Vec<&Row>> = Vec::new();
        for row in &self.rows {
            let place = *places.entry(&row.key).or_insert(objects.len());
            if place == objects.len() {
                objects.push(Vec::new());
            }
            objects[place].push(row);
        }
        objects
    }

    /// Whether a name stands for a column, or for those of methods.
    pub fn has(&self, name: &str) -> bool {
        !self.variants_of(name).is_empty()
    }

    /// What a name stands for: the column, or, where there is none, those of the methods that give anything.
    pub(super) fn variants_of(&self, name: &str) -> Vec<&str> {
        if let Some(column) = self.columns.iter().find(|column| *column == name) {
            return vec![column];
        }
        let is_variant = |column: &&str| column.strip_prefix(name).is_some_and(|rest| rest.starts_with(AT));
        self.filled_columns().into_iter().filter(is_variant).collect()
    }
}

fn at(column: &str, variant: &str) -> String {
    format!("{column}{AT}{variant}")
}

/// Each flag of any of the rows, once.
fn all_flags(rows: &[&Row]) -> String {
    let mut codes: Vec<&str> = rows.iter().flat_map(|row| row.flags()).collect();
    codes.sort_unstable();
    codes.dedup();
    codes.join(";")
}
