//! Another program's numbers for the phantoms of the zoo, beside ours.

use super::{CaseResult, MadeCase};
use crate::comparison::{ObjectKey, Row, Table, TableError, by_name};
use crate::integrals::Globals;
use crate::measurement::SurfaceValues;
use serde::Serialize;
use std::path::Path;

/// Mean and rms of the errors over poses, in %.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PoseErrors {
    /// Their mean.
    pub bias: Globals,
    /// The root of the mean of their squares.
    pub rms: Globals,
}

/// A shape on one kind of grid, by both.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rivalry {
    /// Shape.
    pub shape: &'static str,
    /// R in units of the largest spacing.
    pub resolution: f64,
    /// Largest over smallest spacing.
    pub ratio: f64,
    /// Poses that the other has a row of; the rest does not count in either.
    pub cases: usize,
    /// The other's errors.
    pub theirs: PoseErrors,
    /// Ours on the same.
    pub ours: PoseErrors,
}

/// Compares a table, whose column `input` names the files of
/// [`write_zoo`](crate::runs::write_zoo) and whose other columns are named as ours (`volume_mm3`, `surface_area_mm2`,
/// `total_mean_curvature_mm`; a missing one is NaN), with our results of the same cases, in their order.
///
/// # Errors
/// [`TableError`] of a table that cannot be read, has a phantom twice, or words for numbers.
pub fn against(path: &Path, made: &[MadeCase], ours: &[CaseResult]) -> Result<Vec<Rivalry>, TableError> {
    let table = Table::read(path)?;
    let rows = by_name(&table, |key| called(phantom_of(&key.input)))?;
    let mut pairs = Vec::new();
    for (made, ours) in made.iter().zip(ours) {
        if let Some(row) = rows.get(&called(made.case.name())) {
            pairs.push((ours, made.errors(&values_of(&table, row)?)));
        }
    }
    let same = |a: &(&CaseResult, Globals), b: &(&CaseResult, Globals)| {
        (a.0.shape, a.0.resolution.to_bits(), a.0.ratio.to_bits())
            == (b.0.shape, b.0.resolution.to_bits(), b.0.ratio.to_bits())
    };
    let rivalry = |cases: &[(&CaseResult, Globals)]| Rivalry {
        shape: cases[0].0.shape,
        resolution: cases[0].0.resolution,
        ratio: cases[0].0.ratio,
        cases: cases.len(),
        theirs: PoseErrors::of(cases.iter().map(|case| case.1)),
        ours: PoseErrors::of(cases.iter().map(|case| case.0.original)),
    };
    Ok(pairs.chunk_by(same).map(rivalry).collect())
}

/// What a phantom's file is called, without folders and endings.
fn phantom_of(input: &str) -> String {
    let file = Path::new(input).file_name().unwrap_or_default().to_string_lossy().into_owned();
    [".nii.gz", ".nii"].iter().find_map(|end| file.strip_suffix(end)).unwrap_or(&file).to_owned()
}

/// A phantom has one object.
fn called(input: String) -> ObjectKey {
    ObjectKey { input, label: String::new(), component: String::new() }
}

fn values_of(table: &Table, row: &Row) -> Result<SurfaceValues, TableError> {
    Ok(SurfaceValues {
        volume_mm3: table.number(row, "volume_mm3")?,
        surface_area_mm2: table.number(row, "surface_area_mm2")?,
        total_mean_curvature_mm: table.number(row, "total_mean_curvature_mm")?,
        ..SurfaceValues::default()
    })
}

impl PoseErrors {
    fn of(errors: impl Iterator<Item = Globals>) -> Self {
        let errors: Vec<Globals> = errors.collect();
        let mean = |power: i32| {
            Globals::each(|part| {
                errors.iter().map(|error| part(error).powi(power)).sum::<f64>() / errors.len() as f64
            })
        };
        let squares = mean(2);
        Self { bias: mean(1), rms: Globals::each(|part| part(&squares).sqrt()) }
    }
}
