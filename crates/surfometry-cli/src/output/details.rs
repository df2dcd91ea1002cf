//! All that is known of an object, as a table for people.

use super::layout::Layout;
use super::numbers::{MISSING, digits, digits_or_dash, signed, thousandths, to_its_error};
use super::record_name;
use surfometry::accuracy::CompensationTerms;
use surfometry::integrals::Globals;
use surfometry::measurement::{ChangeStage, DescribedSurface, EmbeddingKind, Measured, SurfaceValues};
use surfometry::runs::Record;

const COLUMNS: [&str; 7] =
    ["surface", "volume mm³", "area mm²", "total H mm", "mean H 1/mm", "chi", "chi mesh"];

/// An object's rows; `explain`: with the terms of the compensation and the places where topology changed.
pub(crate) fn details(record: &Record, explain: bool) -> String {
    let mut layout = Layout::new(&COLUMNS);
    layout.rows(rows(record, explain));
    layout.text() + &if explain { changes(record) } else { String::new() }
}

/// Where the topology of an object changes, place by place.
fn changes(record: &Record) -> String {
    let places: Vec<_> = record.measured.topology.changes.iter().flatten().collect();
    if places.is_empty() {
        return String::new();
    }
    let mut layout = Layout::new(&["changed by", "topology", "x mm", "y mm", "z mm", "width mm", "chi"]);
    for change in places {
        let by = match change.stage {
            ChangeStage::Blur => "blur",
            ChangeStage::Band => "band",
        };
        let mut row = vec![by.to_owned(), change.kind.to_string()];
        row.extend(change.position_mm.map(digits));
        row.extend([digits(change.width_mm), format!("{:+.3}", change.euler_characteristic())]);
        layout.row(row);
    }
    layout.text()
}

/// What stands above the details of one of several objects.
pub(crate) fn heading(record: &Record) -> String {
    format!("label {}\n", record_name(record))
}

fn rows(record: &Record, explain: bool) -> Vec<Vec<String>> {
    let m = &record.measured;
    let errors = m.standard_error;
    // What is explained term by term adds up, to all digits.
    let noise = if explain { SurfaceValues::default() } else { errors };
    let mesh = m.topology.euler_characteristic_mesh.map_or_else(|| MISSING.to_owned(), |chi| chi.to_string());
    let mut rows = Vec::new();
    if m.surface == DescribedSurface::Original {
        let mut original = value_row("original", &m.values, &noise);
        original.push(digits_or_dash(m.values.euler_characteristic));
        rows.push(original);
        if errors.volume_mm3.is_some() {
            rows.push(value_row("s.e.", &errors, &errors));
        }
    }
    let mut blurred = value_row(embedding_name(m.parameters.embedding), &m.blurred, &noise);
    blurred.extend([thousandths(m.blurred.euler_characteristic), mesh]);
    rows.push(blurred);
    if explain {
        rows.extend(m.compensation.iter().flat_map(term_rows));
        rows.extend(count_row(m));
    }
    let counted = SurfaceValues { volume_mm3: Some(m.voxels.volume_mm3), ..SurfaceValues::default() };
    let mut voxels = vec!["voxels".to_owned()];
    voxels.extend(sizes(&counted).map(|size| size.map_or_else(String::new, digits)));
    voxels.push(m.topology.euler_characteristic_voxels_26.to_string());
    rows.push(voxels);
    if let Some(truth) = record.truth {
        let sizes =
            [truth.volume, truth.surface_area, truth.total_mean_curvature, truth.average_mean_curvature];
        let mut row = vec!["exact".to_owned()];
        row.extend(sizes.map(digits));
        row.push(truth.euler_characteristic.to_string());
        rows.push(row);
    }
    rows
}

fn sizes(values: &SurfaceValues) -> [Option<f64>; 4] {
    [
        values.volume_mm3,
        values.surface_area_mm2,
        values.total_mean_curvature_mm,
        values.average_mean_curvature_per_mm,
    ]
}

/// Values with the digits that their errors leave.
fn value_row(name: &str, values: &SurfaceValues, errors: &SurfaceValues) -> Vec<String> {
    let number = |(value, error): (Option<f64>, Option<f64>)| {
        value.map_or_else(|| MISSING.to_owned(), |value| to_its_error(value, error))
    };
    let numbers = sizes(values).into_iter().zip(sizes(errors)).map(number);
    [name.to_owned()].into_iter().chain(numbers).collect()
}

/// What compensation adds to the blurred values, cause by cause.
fn term_rows(terms: &CompensationTerms) -> Vec<Vec<String>> {
    let causes = [("blur's shift", terms.shift), ("band's width", terms.band), ("terraces", terms.terraces)];
    let row = |(name, term): (&str, Globals)| {
        vec![name.to_owned(), signed(term.volume), signed(term.area), signed(term.total_mean_curvature)]
    };
    causes.into_iter().map(row).collect()
}

/// What is left of V, which is the voxels'.
fn count_row(m: &Measured) -> Option<Vec<String>> {
    let terms = m.compensation?;
    let compensated = m.blurred.volume_mm3? + terms.shift.volume + terms.band.volume + terms.terraces.volume;
    let rest = m.volume_mm3.filter(|_| m.surface == DescribedSurface::Original)? - compensated;
    Some(vec!["count".to_owned(), signed(rest)])
}

fn embedding_name(embedding: EmbeddingKind) -> &'static str {
    match embedding {
        EmbeddingKind::Gaussian => "blurred",
        EmbeddingKind::Corrected => "corrected",
        EmbeddingKind::Recovering => "recovering",
        EmbeddingKind::Distance | EmbeddingKind::DistanceToVoxels => "distance",
        EmbeddingKind::Probability => "soft, blurred",
        EmbeddingKind::Given => "given",
    }
}
