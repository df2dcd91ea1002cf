//! Agreement, column by column.

use super::table::FLAGS;
use super::variants::AT;
use super::{ColumnPair, Matching, ObjectKey, Row, Table, TableError};
use crate::statistics::{Agreement, Bootstrap, ConfusionMatrix, EulerRounding, Paired};
use crate::text::did_you_mean;
use serde::Serialize;
use std::collections::BTreeMap;

/// Name and version of the document.
pub const COMPARE_SCHEMA: &str = "surfometry.compare/1";
/// Compared where both tables have them; the last are errors, of `validate`.
const MEASURES: [&str; 8] = [
    "volume_mm3",
    "surface_area_mm2",
    "total_mean_curvature_mm",
    "average_mean_curvature_per_mm",
    EULER,
    "original_volume",
    "original_surface_area",
    "original_total_mean_curvature",
];
const ONE_VALUE: &str = "all values of one are the same, so neither slope nor correlation is defined";
/// Columns with this in their name hold Euler characteristics: classes, not sizes.
const EULER: &str = "euler_characteristic";

/// An object's value by both.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairedValue {
    /// The object, as the method's table names it.
    #[serde(flatten)]
    pub object: ObjectKey,
    /// By the method.
    pub method: f64,
    /// By the standard.
    pub standard: f64,
}

/// A size by both methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasureAgreement {
    /// The method's column.
    pub column: String,
    /// The standard's.
    pub standard_column: String,
    /// Matched objects of which one or both have no value.
    pub left_out: usize,
    /// What can be said; `None` where `problem` says why not.
    pub agreement: Option<Agreement>,
    /// Why nothing, or not all, can be said.
    pub problem: Option<String>,
    /// All pairs.
    pub values: Vec<PairedValue>,
}

/// Euler characteristics by both methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EulerAgreement {
    /// The method's column.
    pub column: String,
    /// The standard's.
    pub standard_column: String,
    /// Matched objects of which one or both have no value.
    pub left_out: usize,
    /// Rounded to even numbers.
    pub even: ConfusionMatrix,
    /// Rounded to whole numbers, as in the paper.
    pub integer: ConfusionMatrix,
    /// All pairs, not rounded.
    pub values: Vec<PairedValue>,
}

/// What the rows of a table say of themselves, beside their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RowsTold {
    /// How many rows more are of inputs that failed.
    pub failed: usize,
    /// How many carry warnings; `None` where the table has no column `flags`.
    pub flagged: Option<usize>,
    /// How many carry each.
    pub flags: BTreeMap<String, usize>,
    /// How many describe which surface, `original`, `blurred` or `given`, where there is a column `surface`.
    pub surfaces: BTreeMap<String, usize>,
}

impl RowsTold {
    fn of(table: &Table, rows: &[&Row]) -> Self {
        let has_flags = table.columns.iter().any(|column| column == FLAGS);
        let surfaces = rows.iter().map(|row| row.cell("surface")).filter(|surface| !surface.is_empty());
        Self {
            failed: table.failed,
            flagged: has_flags.then(|| rows.iter().filter(|row| row.flags().next().is_some()).count()),
            flags: counts(rows.iter().flat_map(|row| row.flags())),
            surfaces: counts(surfaces),
        }
    }
}

fn counts<'a>(names: impl Iterator<Item = &'a str>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for name in names {
        *counts.entry(name.to_owned()).or_insert(0) += 1;
    }
    counts
}

/// How far two tables agree.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// [`COMPARE_SCHEMA`].
    pub schema: &'static str,
    /// Version of surfometry.
    pub version: &'static str,
    /// The method's name.
    pub method: String,
    /// The standard's.
    pub standard: String,
    /// Objects in both.
    pub matched: usize,
    /// Objects of the method alone.
    pub only_method: Vec<ObjectKey>,
    /// Objects of the standard alone.
    pub only_standard: Vec<ObjectKey>,
    /// What was assumed and may be wrong: that names are of the same object which are the same only without their
    /// endings; how numbers are meant that may be a thousand times as large, where nothing in their table tells.
    pub doubts: Vec<String>,
    /// What the method's rows of the matched objects say of themselves.
    pub method_rows: RowsTold,
    /// What the standard's do.
    pub standard_rows: RowsTold,
    /// Sizes.
    pub measures: Vec<MeasureAgreement>,
    /// Euler characteristics.
    pub euler: Vec<EulerAgreement>,
}

/// Compares a method's table with the standard's.
///
/// `names` are those of method and standard; without `columns`, V, A, M, M / A and chi are compared, as far
/// as both tables have them: of tables of `measure`, the original object's. A column that a table has of
/// several methods, as `x@a` and `x@b`, is compared for each of them.
///
/// # Errors
/// [`TableError`].
pub fn compare(
    [method, standard]: [&Table; 2],
    names: [String; 2],
    columns: &[ColumnPair],
    how: Bootstrap,
) -> Result<Comparison, TableError> {
    let matching = Matching::new(method, standard)?;
    let columns =
        if columns.is_empty() { shared(method, standard)? } else { named(method, standard, columns)? };
    let [name, standard_name] = names;
    let (own, others): (Vec<&Row>, Vec<&Row>) = matching.pairs.iter().copied().unzip();
    let mut comparison = Comparison {
        schema: COMPARE_SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        method: name,
        standard: standard_name,
        matched: matching.pairs.len(),
        only_method: matching.only_method.clone(),
        only_standard: matching.only_standard.clone(),
        doubts: matching.doubts(),
        method_rows: RowsTold::of(method, &own),
        standard_rows: RowsTold::of(standard, &others),
        measures: Vec::new(),
        euler: Vec::new(),
    };
    for pair in columns {
        let values = values(&matching, [method, standard], &pair)?;
        let left_out = matching.pairs.len() - values.len();
        let doubts = [method.doubt(&pair.method), standard.doubt(&pair.standard)];
        comparison.doubts.extend(doubts.into_iter().flatten());
        if pair.method.contains(EULER) {
            comparison.euler.push(euler(pair, left_out, values));
        } else {
            comparison.measures.push(measure(pair, left_out, values, how));
        }
    }
    Ok(comparison)
}

fn shared(method: &Table, standard: &Table) -> Result<Vec<ColumnPair>, TableError> {
    // What cannot be read is refused later, by name; only columns without any value are passed over.
    let filled = |table: &Table, name: &str| -> Vec<String> {
        let filled = table.filled_columns();
        let variants = table.variants_of(name).into_iter();
        variants.filter(|column| filled.contains(column)).map(str::to_owned).collect()
    };
    let mut columns = Vec::new();
    for name in MEASURES {
        let (of_method, of_standard) = (filled(method, name), filled(standard, name));
        if !of_method.is_empty() && !of_standard.is_empty() {
            columns.extend(pairs([method, standard], &of_method, &of_standard)?);
        }
    }
    if columns.is_empty() {
        return Err(TableError::NoMeasure { method: method.path.clone(), standard: standard.path.clone() });
    }
    Ok(columns)
}

fn named(method: &Table, standard: &Table, columns: &[ColumnPair]) -> Result<Vec<ColumnPair>, TableError> {
    let found = columns.iter().map(|pair| {
        let (of_method, of_standard) = (required(method, &pair.method)?, required(standard, &pair.standard)?);
        pairs([method, standard], &of_method, &of_standard)
    });
    Ok(found.collect::<Result<Vec<_>, _>>()?.concat())
}

fn required(table: &Table, column: &str) -> Result<Vec<String>, TableError> {
    let found: Vec<String> = table.variants_of(column).into_iter().map(str::to_owned).collect();
    if found.is_empty() {
        let known = table.numeric_columns();
        return Err(TableError::NoColumn {
            path: table.path.clone(),
            column: column.to_owned(),
            near: did_you_mean(column, &known),
            known: known.join(", "),
        });
    }
    Ok(found)
}

/// Which of the columns that a name stands for in either table are compared: each of several methods with the
/// one column of the other table, or, where both have several, with itself.
fn pairs(
    [method, standard]: [&Table; 2],
    of_method: &[String],
    of_standard: &[String],
) -> Result<Vec<ColumnPair>, TableError> {
    let pair = |a: &String, b: &String| ColumnPair { method: a.clone(), standard: b.clone() };
    if let ([own], others) = (of_method, of_standard) {
        return Ok(others.iter().map(|other| pair(own, other)).collect());
    }
    if let (owns, [other]) = (of_method, of_standard) {
        return Ok(owns.iter().map(|own| pair(own, other)).collect());
    }
    let variant = |column: &String| column.split_once(AT).map(|(_, variant)| variant.to_owned());
    let same = |own: &String| of_standard.iter().find(|other| variant(other) == variant(own));
    let found: Vec<ColumnPair> =
        of_method.iter().filter_map(|own| same(own).map(|other| pair(own, other))).collect();
    if found.is_empty() {
        return Err(TableError::OtherVariants {
            method: method.path.clone(),
            standard: standard.path.clone(),
            of_method: of_method[0].clone(),
            of_standard: of_standard[0].clone(),
        });
    }
    Ok(found)
}

/// Objects that have a value in both tables.
fn values(
    matching: &Matching,
    [method, standard]: [&Table; 2],
    pair: &ColumnPair,
) -> Result<Vec<PairedValue>, TableError> {
    let mut values = Vec::new();
    for (own, other) in &matching.pairs {
        let found = (method.number(own, &pair.method)?, standard.number(other, &pair.standard)?);
        if let (Some(method), Some(standard)) = found {
            values.push(PairedValue { object: own.key.clone(), method, standard });
        }
    }
    Ok(values)
}

fn measure(pair: ColumnPair, left_out: usize, values: Vec<PairedValue>, how: Bootstrap) -> MeasureAgreement {
    let of = |value: fn(&PairedValue) -> f64| values.iter().map(value).collect();
    let pairs = Paired::new(of(|v| v.method), of(|v| v.standard));
    MeasureAgreement {
        column: pair.method,
        standard_column: pair.standard,
        left_out,
        agreement: pairs.as_ref().ok().map(|pairs| Agreement::of(pairs, how)),
        problem: match &pairs {
            Ok(pairs) if pairs.vary() => None,
            Ok(_) => Some(ONE_VALUE.to_owned()),
            Err(error) => Some(error.to_string()),
        },
        values,
    }
}

fn euler(pair: ColumnPair, left_out: usize, values: Vec<PairedValue>) -> EulerAgreement {
    let pairs: Vec<(f64, f64)> = values.iter().map(|v| (v.method, v.standard)).collect();
    EulerAgreement {
        column: pair.method,
        standard_column: pair.standard,
        left_out,
        even: ConfusionMatrix::new(&pairs, EulerRounding::Even),
        integer: ConfusionMatrix::new(&pairs, EulerRounding::Integer),
        values,
    }
}
