//! Results as a table for people.

use super::parts_text::parts_text;
use super::{Legend, TableStyle};
use comfy_table::{CellAlignment, Table, presets};
use std::fmt::Write;
use surfometry::accuracy::{CompensationTerms, Flag, FlagCode};
use surfometry::integrals::Globals;
use surfometry::measurement::{
    ChangeStage, DescribedSurface, EmbeddingKind, Measured, Parameters, SurfaceValues, UNEXPLAINED,
};
use surfometry::runs::Record;

/// A plain table with columns of numbers. A long one has its header again and again, and is set part by part:
/// a table of a hundred thousand objects would take a kilobyte for each.
pub(crate) struct Layout {
    columns: Vec<String>,
    part: Table,
    set: String,
}

impl Layout {
    /// Rows from which on the next object has a header above it.
    const PART: usize = 12_288;

    pub(crate) fn new(columns: &[&str]) -> Self {
        let columns: Vec<String> = columns.iter().map(ToString::to_string).collect();
        Self { part: Self::part(&columns), columns, set: String::new() }
    }

    fn part(columns: &[String]) -> Table {
        let mut table = Table::new();
        table.load_style(presets::NOTHING).set_header(columns);
        table
    }

    pub(crate) fn row(&mut self, cells: Vec<String>) {
        self.rows(vec![cells]);
    }

    /// Rows that stay together.
    pub(crate) fn rows(&mut self, rows: Vec<Vec<String>>) {
        if self.part.row_count() >= Self::PART {
            self.end_part();
        }
        self.part.add_rows(rows);
    }

    fn end_part(&mut self) {
        let mut part = std::mem::replace(&mut self.part, Self::part(&self.columns));
        part.column_iter_mut().for_each(|c| c.set_cell_alignment(CellAlignment::Right));
        self.set += &(part.trim_fmt() + "\n");
    }

    pub(crate) fn text(mut self) -> String {
        self.end_part();
        self.set
    }
}

const COLUMNS: [&str; 8] =
    ["label", "surface", "volume mm³", "area mm²", "total H mm", "mean H 1/mm", "chi", "chi mesh"];

/// What stands below tables of blurred objects.
const LEGEND: &str = "original: the object as it was segmented, s.e.: its standard error; blurred: the smoothed surface that was \
                      integrated over; voxels: counted. H > 0 on a ball; chi is the surface's (ball 2, torus 0).";

/// Tables of records; `explain`: with the terms of the compensation and the places where topology changed.
pub(crate) fn record_tables(explain: bool) -> TableStyle<Record> {
    TableStyle {
        of_input: Box::new(move |records| input_text(records, explain)),
        legend: Some(Legend { text: LEGEND, wanted: |record| record.measured.parameters.sigma_mm.is_some() }),
    }
}

fn input_text(records: &[Record], explain: bool) -> String {
    let mut layout = Layout::new(&COLUMNS);
    for record in records {
        layout.rows(rows(record, explain));
    }
    let changes = if explain { changes_text(records) } else { String::new() };
    let parts = parts_text(records);
    heading(records) + &layout.text() + &changes + &parts + &flags_text(&records.iter().collect::<Vec<_>>())
}

/// Where the topology of the objects changes, place by place.
fn changes_text(records: &[Record]) -> String {
    let mut layout =
        Layout::new(&["label", "changed by", "topology", "x mm", "y mm", "z mm", "width mm", "chi"]);
    let mut any = false;
    for record in records {
        let label = name_in_table(record);
        for change in record.measured.topology.changes.iter().flatten() {
            any = true;
            let by = match change.stage {
                ChangeStage::Blur => "blur",
                ChangeStage::Band => "band",
            };
            let mut row = vec![label.clone(), by.to_owned(), change.kind.to_string()];
            row.extend(change.position_mm.map(digits));
            row.extend([digits(change.width_mm), format!("{:+.3}", change.euler_characteristic())]);
            layout.row(row);
        }
    }
    if any { layout.text() } else { String::new() }
}

fn heading(records: &[Record]) -> String {
    let (record, m) = (&records[0], &records[0].measured);
    // Labels may have lengths of their own.
    let all = |length: fn(&Parameters) -> Option<f64>| {
        let mut lengths: Vec<String> =
            records.iter().filter_map(|record| length(&record.measured.parameters)).map(digits).collect();
        lengths.dedup();
        lengths.join("/")
    };
    let join = |values: [String; 3]| values.join(" x ");
    let sigma = all(|parameters| parameters.sigma_mm);
    let blur = if sigma.is_empty() { String::new() } else { format!("sigma {sigma} mm, ") };
    format!(
        "{}\n  {} voxels of {} mm; {blur}t {} mm, epsilon {}\n",
        record.input,
        join(m.grid.dimensions.map(|n| n.to_string())),
        join(m.grid.spacing_mm.map(digits)),
        all(|parameters| Some(parameters.thickness_mm)),
        all(|parameters| Some(parameters.epsilon)),
    )
}

/// An object's label, with its name, and which of its pieces it is.
fn name_in_table(record: &Record) -> String {
    let mut label = record.label.as_ref().map_or_else(String::new, ToString::to_string);
    if let Some(name) = &record.name {
        label = format!("{label} {name}");
    }
    record.component.map_or(label.clone(), |component| format!("{label} #{component}"))
}

fn rows(record: &Record, explain: bool) -> Vec<Vec<String>> {
    let m = &record.measured;
    let mesh = m.topology.euler_characteristic_mesh.map_or_else(|| MISSING.to_owned(), |chi| chi.to_string());
    let mut blurred = value_row(embedding_name(m.parameters.embedding), &m.blurred);
    blurred.extend([thousandths(m.blurred.euler_characteristic), mesh]);
    let mut rows = Vec::new();
    if m.surface == DescribedSurface::Original {
        let mut original = value_row("original", &m.values);
        original.push(m.values.euler_characteristic.map_or_else(|| MISSING.to_owned(), digits));
        rows.push(original);
        if m.standard_error.volume_mm3.is_some() {
            rows.push(error_row(&m.standard_error));
        }
    }
    rows.push(blurred);
    if explain {
        rows.extend(m.compensation.iter().flat_map(term_rows));
        rows.extend(count_row(m));
    }
    rows.push(vec![
        String::new(),
        "voxels".to_owned(),
        digits(m.voxels.volume_mm3),
        String::new(),
        String::new(),
        String::new(),
        m.topology.euler_characteristic_voxels_26.to_string(),
    ]);
    if let Some(truth) = record.truth {
        let sizes =
            [truth.volume, truth.surface_area, truth.total_mean_curvature, truth.average_mean_curvature];
        let mut row = vec![String::new(), "exact".to_owned()];
        row.extend(sizes.map(digits));
        row.push(truth.euler_characteristic.to_string());
        rows.push(row);
    }
    rows[0][0] = name_in_table(record);
    rows
}

/// What stands for a number that could not be had.
const MISSING: &str = "-";

fn sizes(values: &SurfaceValues) -> [Option<f64>; 4] {
    [
        values.volume_mm3,
        values.surface_area_mm2,
        values.total_mean_curvature_mm,
        values.average_mean_curvature_per_mm,
    ]
}

fn value_row(name: &str, values: &SurfaceValues) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or_else(|| MISSING.to_owned(), digits);
    let mut row = vec![String::new(), name.to_owned()];
    row.extend(sizes(values).map(number));
    row
}

fn error_row(errors: &SurfaceValues) -> Vec<String> {
    let error = |value: Option<f64>| {
        value.map_or_else(|| MISSING.to_owned(), |value| format!("\u{b1} {}", significant(value, 2)))
    };
    let mut row = vec![String::new(), "s.e.".to_owned()];
    row.extend(sizes(errors).map(error));
    row
}

/// What compensation adds to the blurred values, cause by cause.
fn term_rows(terms: &CompensationTerms) -> Vec<Vec<String>> {
    let causes = [("blur's shift", terms.shift), ("band's width", terms.band), ("terraces", terms.terraces)];
    let row = |(name, term): (&str, Globals)| {
        vec![
            String::new(),
            name.to_owned(),
            signed(term.volume),
            signed(term.area),
            signed(term.total_mean_curvature),
        ]
    };
    causes.into_iter().map(row).collect()
}

/// What is left of V, which is the voxels'.
fn count_row(m: &Measured) -> Option<Vec<String>> {
    let terms = m.compensation?;
    let compensated = m.blurred.volume_mm3? + terms.shift.volume + terms.band.volume + terms.terraces.volume;
    let rest = m.volume_mm3.filter(|_| m.surface == DescribedSurface::Original)? - compensated;
    Some(vec![String::new(), "count".to_owned(), signed(rest)])
}

/// With its sign before a space.
fn signed(value: f64) -> String {
    format!("{}{}", if value < 0.0 { "- " } else { "+ " }, digits(value.abs()))
}

/// An Euler characteristic by Gauss and Bonnet. It is rounded before it is printed, and 0 is added, so that
/// no -0.000 appears.
fn thousandths(chi: Option<f64>) -> String {
    chi.map_or_else(|| MISSING.to_owned(), |chi| format!("{:.3}", (chi * 1000.0).round() / 1000.0 + 0.0))
}

/// Labels that a warning names before it only counts them.
const SHOWN_LABELS: usize = 12;

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

/// Each warning once, with the labels it is about. What the table does not show needs no `not-computed`.
pub(crate) fn flags_text(records: &[&Record]) -> String {
    let of_record = |record: &&'_ Record| {
        record.measured.flags.iter().map(|flag| (name_in_table(record), flag.clone())).collect::<Vec<_>>()
    };
    raised_text(&records.iter().flat_map(of_record).collect::<Vec<_>>(), records.len())
}

/// Flags of some objects, each with the name of the one that it is of: a line a code.
pub(crate) fn raised_text(all: &[(String, Flag)], objects: usize) -> String {
    let mut codes: Vec<FlagCode> = Vec::new();
    for (_, flag) in all {
        if flag.code != FlagCode::NotComputed && !codes.contains(&flag.code) {
            codes.push(flag.code);
        }
    }
    let mut text = String::new();
    for code in codes {
        let raised: Vec<&(String, Flag)> = all.iter().filter(|(_, flag)| flag.code == code).collect();
        let about = if objects == 1 { String::new() } else { format!(" (label {})", shown_labels(&raised)) };
        let same = raised.iter().all(|(_, flag)| flag.message == raised[0].1.message);
        let others = if same { "" } else { "for the first: " };
        let message = &raised[0].1.message;
        let how = if message.ends_with(UNEXPLAINED) { " (--explain)" } else { "" };
        writeln!(text, "  ! {code}{about}: {others}{message}{how}").expect("writing to a string");
    }
    text
}

fn shown_labels(raised: &[&(String, Flag)]) -> String {
    let labels = raised.iter().map(|(name, _)| name.as_str());
    let shown = labels.take(SHOWN_LABELS).collect::<Vec<_>>().join(", ");
    match raised.len().saturating_sub(SHOWN_LABELS) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Six significant digits, without an exponent where a reader can do without; a dash for what is not defined.
pub(crate) fn digits(value: f64) -> String {
    significant(value, 6)
}

fn significant(value: f64, count: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-4..15).contains(&magnitude) {
        return format!("{value:.*e}", (count - 1) as usize);
    }
    let text = format!("{value:.*}", (count - 1 - magnitude).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn six_digits() {
        let cases = [
            (184_541.62, "184542"),
            (2.0, "2"),
            (0.034_567_89, "0.0345679"),
            (-1.5e-7, "-1.50000e-7"),
            (0.0, "0"),
        ];
        for (value, text) in cases {
            assert_eq!(digits(value), text);
        }
    }
}
