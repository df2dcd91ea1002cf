//! A cohort of phantoms as files, with a table of their exact integrals.

use super::RunError;
use crate::inputs::{OpenOptions, open};
use crate::io::{write_labels, write_whole};
use crate::phantoms::{CohortMember, Truth};
use crate::volume::LabelImage;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// A bone of a cohort that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct CohortFile {
    /// Where its labels are.
    pub path: PathBuf,
    /// Its exact integrals.
    pub truth: Truth,
}

/// What `truth.csv` says of a bone; columns are named as those of `measure`, so that `compare` takes it.
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

/// Writes a cohort's labels and `truth.csv` into a folder, which is made where it is not there; bones that
/// are there already, with their row in the table, are left as they are. `told` hears each bone's name before
/// it is made.
///
/// # Errors
/// [`RunError`].
pub fn write_cohort(
    folder: &Path,
    members: &[CohortMember],
    mut told: impl FnMut(&str),
) -> Result<Vec<CohortFile>, RunError> {
    let failed = |path: &Path, source: io::Error| RunError::Write { path: path.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    let table = folder.join("truth.csv");
    let known = known_rows(&table);
    let (mut rows, mut files): (Vec<TruthRow>, Vec<CohortFile>) = (Vec::new(), Vec::new());
    for member in members {
        told(&member.name);
        let input = format!("{}.nii.gz", member.name);
        let path = folder.join(&input);
        let row = known.iter().find(|row| row.phantom == member.spec && path.exists());
        let truth = match row {
            Some(row) => Truth::new(
                row.volume_mm3,
                row.surface_area_mm2,
                row.total_mean_curvature_mm,
                row.euler_characteristic,
            ),
            None => write_bone(member, &path)?,
        };
        rows.push(TruthRow {
            input,
            label: 1,
            volume_mm3: truth.volume,
            surface_area_mm2: truth.surface_area,
            total_mean_curvature_mm: truth.total_mean_curvature,
            average_mean_curvature_per_mm: truth.average_mean_curvature,
            euler_characteristic: truth.euler_characteristic,
            phantom: member.spec.clone(),
        });
        // After each bone, so that a run that is stopped loses one.
        write_rows(&table, &rows).map_err(|e| failed(&table, e))?;
        files.push(CohortFile { path, truth });
    }
    Ok(files)
}

fn write_bone(member: &CohortMember, path: &Path) -> Result<Truth, RunError> {
    let source = open(&member.spec, &OpenOptions::default())?;
    let image = LabelImage::from_slabs(&mut source.slabs()?)?;
    write_labels(path, &image).map_err(|source| RunError::Write { path: path.to_owned(), source })?;
    source.truth().ok_or(RunError::Unfit("the exact integrals of a bone of this cohort do not converge"))
}

/// Rows of an earlier run; none where there is no table, or another one.
fn known_rows(table: &Path) -> Vec<TruthRow> {
    let rows = csv::Reader::from_path(table).map(|reader| reader.into_deserialize().collect());
    rows.and_then(|rows: Result<Vec<TruthRow>, csv::Error>| rows).unwrap_or_default()
}

fn write_rows(table: &Path, rows: &[TruthRow]) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    write_whole(table, |out| out.write_all(&bytes))
}
