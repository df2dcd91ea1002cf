//! Phantoms as files, with a table of their exact integrals: a cohort of bones, or the zoo.

use super::RunError;
use crate::inputs::{OpenOptions, open};
use crate::io::{write_labels, write_whole};
use crate::phantoms::{CohortMember, Truth};
use crate::validation::MadeCase;
use crate::volume::LabelImage;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// A phantom that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct CohortFile {
    /// Where its labels are.
    pub path: PathBuf,
    /// Its exact integrals.
    pub truth: Truth,
}

/// What `truth.csv` says of a phantom; columns are named as those of `measure`, so that `compare` takes it.
#[derive(Debug, Serialize, Deserialize)]
struct TruthRow {
    input: String,
    label: u8,
    volume_mm3: f64,
    surface_area_mm2: f64,
    total_mean_curvature_mm: f64,
    average_mean_curvature_per_mm: f64,
    euler_characteristic: i64,
    phantom: String,
}

/// A phantom to be written.
trait Member {
    /// Of its file, without the ending.
    fn name(&self) -> String;

    /// What it is; where a file of the same is there already, it is left as it is.
    fn spec(&self) -> String;

    fn made(&self) -> Result<(LabelImage, Truth), RunError>;
}

impl Member for CohortMember {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn spec(&self) -> String {
        self.spec.clone()
    }

    fn made(&self) -> Result<(LabelImage, Truth), RunError> {
        let source = open(&self.spec, &OpenOptions::default())?;
        let image = LabelImage::from_slabs(&mut source.slabs()?)?;
        let truth = source.truth();
        Ok((image, truth.ok_or(RunError::Unfit("a bone's exact integrals do not converge"))?))
    }
}

impl Member for MadeCase {
    fn name(&self) -> String {
        self.case.name()
    }

    fn spec(&self) -> String {
        self.case.name()
    }

    fn made(&self) -> Result<(LabelImage, Truth), RunError> {
        Ok((self.phantom.labels()?, self.truth))
    }
}

/// Writes a cohort's labels and `truth.csv` into a folder, which is made where it is not there; bones that
/// are there already, with their row in the table, are left as they are, also those that this cohort lacks: their rows
/// stand behind its own. `told` hears each bone's name before it is made.
///
/// # Errors
/// [`RunError`], also where `truth.csv` is there and is another table.
pub fn write_cohort(
    folder: &Path,
    members: &[CohortMember],
    told: impl FnMut(&str),
) -> Result<Vec<CohortFile>, RunError> {
    write_members(folder, members, told)
}

/// The same with the phantoms of the zoo ([`Validation`](crate::validation::Validation)), for other programs to measure.
///
/// # Errors
/// [`RunError`].
pub fn write_zoo(
    folder: &Path,
    cases: &[MadeCase],
    told: impl FnMut(&str),
) -> Result<Vec<CohortFile>, RunError> {
    write_members(folder, cases, told)
}

fn write_members(
    folder: &Path,
    members: &[impl Member],
    mut told: impl FnMut(&str),
) -> Result<Vec<CohortFile>, RunError> {
    let failed = |path: &Path, source: io::Error| RunError::Write { path: path.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    let table = folder.join("truth.csv");
    let mut others = known_rows(&table, folder).map_err(|e| failed(&table, e))?;
    let (mut rows, mut files): (Vec<TruthRow>, Vec<CohortFile>) = (Vec::new(), Vec::new());
    for member in members {
        let (name, spec) = (member.name(), member.spec());
        told(&name);
        let input = format!("{name}.nii.gz");
        let path = folder.join(&input);
        let known = others.iter().position(|row| row.input == input).map(|at| others.remove(at));
        let truth = if let Some(row) = known.filter(|row| row.phantom == spec) {
            let [volume, area, mean] = [row.volume_mm3, row.surface_area_mm2, row.total_mean_curvature_mm];
            Truth::new(volume, area, mean, row.euler_characteristic)
        } else {
            let (image, truth) = member.made()?;
            write_labels(&path, &image).map_err(|e| failed(&path, e))?;
            truth
        };
        rows.push(TruthRow {
            input,
            label: 1,
            volume_mm3: truth.volume,
            surface_area_mm2: truth.surface_area,
            total_mean_curvature_mm: truth.total_mean_curvature,
            average_mean_curvature_per_mm: truth.average_mean_curvature,
            euler_characteristic: truth.euler_characteristic,
            phantom: spec,
        });
        // After each, so that a run that is stopped loses one.
        write_rows(&table, rows.iter().chain(&others)).map_err(|e| failed(&table, e))?;
        files.push(CohortFile { path, truth });
    }
    Ok(files)
}

/// Rows of earlier runs whose images still are there; none where there is no table.
fn known_rows(table: &Path, folder: &Path) -> io::Result<Vec<TruthRow>> {
    if !table.exists() {
        return Ok(Vec::new());
    }
    let rows = csv::Reader::from_path(table).map(|reader| reader.into_deserialize().collect());
    let rows: Vec<TruthRow> = rows.and_then(|rows: Result<_, csv::Error>| rows).map_err(|error| {
        io::Error::other(format!(
            "it is no table of an earlier run ({error}); choose another folder, or take it away"
        ))
    })?;
    Ok(rows.into_iter().filter(|row| folder.join(&row.input).exists()).collect())
}

fn write_rows<'a>(table: &Path, mut rows: impl Iterator<Item = &'a TruthRow>) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.try_for_each(|row| writer.serialize(row))?;
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    write_whole(table, |out| out.write_all(&bytes))
}
