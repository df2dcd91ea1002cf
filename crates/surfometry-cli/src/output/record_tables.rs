//! Results of a measurement for people: one object in full, many a line each.

use super::details::{details, heading};
use super::lines::{Lines, is_original, legend};
use super::numbers::digits;
use super::parts_text::parts_text;
use super::raised::flags_text;
use super::table_sink::Presenter;
use super::{one_line, width::wrapped};
use std::collections::BTreeMap;
use surfometry::inputs::distinct_parts;
use surfometry::measurement::Parameters;
use surfometry::runs::Record;

/// What stands below the details of blurred objects.
const LEGEND: &str = "original: the object as it was segmented, s.e.: its standard error; blurred, recovering: the smooth surface that was \
                      integrated over; voxels: counted. H > 0 on a ball; chi is the surface's (ball 2, torus 0).";

/// How much is shown.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shown {
    /// Every object in full, however many there are.
    pub(crate) details: bool,
    /// Also the terms of the compensation and the places where topology changed.
    pub(crate) explain: bool,
}

/// Results of a measurement for people.
pub(crate) struct RecordTables {
    shown: Shown,
    /// What tells the inputs apart, by their names, where there are several.
    parts: BTreeMap<String, String>,
    one_input: bool,
    lines: Lines,
    all_original: bool,
    any_blurred: bool,
}

impl RecordTables {
    /// Of some inputs.
    pub(crate) fn new(shown: Shown, inputs: &[String]) -> Self {
        let mut parts = BTreeMap::new();
        for (input, part) in inputs.iter().zip(distinct_parts(inputs)) {
            // Of an input that is named twice, the first one's.
            if let Some(part) = part {
                parts.entry(input.clone()).or_insert(part);
            }
        }
        Self {
            shown,
            parts,
            one_input: inputs.len() == 1,
            lines: Lines::default(),
            all_original: true,
            any_blurred: false,
        }
    }

    fn in_full(&self, records: &[Record]) -> String {
        let of_record = |record: &Record| {
            let above = if records.len() > 1 { heading(record) } else { String::new() };
            above + &details(record, self.shown.explain)
        };
        let tables: String = records.iter().map(of_record).collect();
        input_heading(records)
            + &tables
            + &parts_text(records)
            + &flags_text(&records.iter().collect::<Vec<_>>())
    }

    fn in_lines(&mut self, records: &[Record]) -> String {
        let input = &records[0].input;
        let name = one_line(self.parts.get(input).unwrap_or(input)).into_owned();
        match records {
            [only] if !self.one_input => self.lines.line(&name, only) + &parts_text(records),
            _ => {
                let above = if self.one_input { input_heading(records) } else { name + "\n" };
                let line = |record: &Record| self.lines.line(&format!("  {}", record_name(record)), record);
                above + &records.iter().map(line).collect::<String>() + &parts_text(records)
            }
        }
    }
}

impl Presenter<Record> for RecordTables {
    fn of_input(&mut self, records: &[Record]) -> String {
        self.all_original &= records.iter().all(is_original);
        self.any_blurred |= records.iter().any(|record| record.measured.parameters.sigma_mm.is_some());
        if self.shown.details || self.shown.explain || self.one_input && records.len() == 1 {
            self.in_full(records)
        } else {
            self.in_lines(records)
        }
    }

    /// Lines of several inputs are one table.
    fn is_separated(&self) -> bool {
        !self.lines.any()
    }

    fn ending(&self) -> String {
        match (self.lines.any(), self.any_blurred) {
            (true, _) => format!("{}\n{}", self.lines.ending(), legend(self.all_original)),
            (false, true) => format!("\n{}", wrapped(LEGEND, "", "")),
            (false, false) => String::new(),
        }
    }
}

/// An input's name, its lattice and the lengths that it was measured with.
fn input_heading(records: &[Record]) -> String {
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
    let text = format!(
        "{} voxels of {} mm; {blur}t {} mm, epsilon {}",
        join(m.grid.dimensions.map(|n| n.to_string())),
        join(m.grid.spacing_mm.map(digits)),
        all(|parameters| Some(parameters.thickness_mm)),
        all(|parameters| Some(parameters.epsilon)),
    );
    format!("{}\n{}", one_line(&record.input), wrapped(&text, "  ", "  "))
}

/// An object's label, with its name, and which of its pieces it is.
pub(crate) fn record_name(record: &Record) -> String {
    let mut label = record.label.as_ref().map_or_else(String::new, ToString::to_string);
    if let Some(name) = &record.name {
        label = format!("{label} {}", one_line(name));
    }
    record.component.map_or(label.clone(), |component| format!("{label} #{component}"))
}
