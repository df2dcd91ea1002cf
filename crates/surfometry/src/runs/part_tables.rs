//! Tables of what records hold lists of: the parts of objects by regions, and their interfaces.

use super::document::text_cell;
use super::{Failure, Plan, Record, Sink};
use crate::inputs::with_parts;
use crate::io::write_whole;
use crate::measurement::{Interface, InterfaceValues, RegionPart, SurfaceValues};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

const OBJECT: [&str; 4] = ["input", "label", "name", "component"];
const REGION: [&str; 4] = ["region", "region_name", "voxels", "border_area_mm2"];
const CONTACT: [&str; 5] = ["input", "label_1", "label_2", "name_1", "name_2"];

/// The tables that lie beside one of objects, as far as they are asked for: `x_regions.csv` and `x_interfaces.csv` beside
/// `x.csv`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PartFiles {
    regions: Option<PathBuf>,
    interfaces: Option<PathBuf>,
}

impl PartFiles {
    /// Those that a plan asks for.
    pub fn beside(path: &Path, plan: &Plan) -> Self {
        let named = |name| with_parts(path, &[name]);
        Self {
            regions: plan.regions.as_ref().map(|_| named("regions")),
            interfaces: plan.interfaces.then(|| named("interfaces")),
        }
    }

    /// Their names.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.regions.iter().chain(&self.interfaces).map(PathBuf::as_path)
    }
}

/// Hands records on, and keeps the rows of the tables that lie beside theirs.
pub struct PartTables<'a> {
    inner: &'a mut dyn Sink<Record>,
    files: &'a PartFiles,
    regions: Vec<Vec<String>>,
    interfaces: Vec<Vec<String>>,
    /// Interfaces that have a row: each is in the records of both objects.
    known: BTreeSet<[String; 3]>,
}

impl<'a> PartTables<'a> {
    /// In front of a sink.
    pub fn new(inner: &'a mut dyn Sink<Record>, files: &'a PartFiles) -> Self {
        Self { inner, files, regions: Vec::new(), interfaces: Vec::new(), known: BTreeSet::new() }
    }

    /// Writes them, each whole or not at all.
    ///
    /// # Errors
    /// Whatever keeps one from being written.
    pub fn write(self) -> io::Result<()> {
        if let Some(path) = &self.files.regions {
            let values = names_of(&SurfaceValues::default())?;
            let blurred = values.iter().map(|name| format!("blurred_{name}"));
            let columns = [strings(&OBJECT), strings(&REGION), with_errors(&values)].concat();
            write_table(path, &columns.into_iter().chain(blurred).collect::<Vec<_>>(), &self.regions)?;
        }
        if let Some(path) = &self.files.interfaces {
            let values = with_errors(&names_of(&InterfaceValues::default())?);
            let columns = [strings(&CONTACT), values, strings(&["curvature_share"])].concat();
            write_table(path, &columns, &self.interfaces)?;
        }
        Ok(())
    }

    fn add_region(&mut self, record: &Record, part: &RegionPart) -> io::Result<()> {
        let label = record.label.as_ref().map(ToString::to_string).map(text_cell).unwrap_or_default();
        let component = record.component.map(|piece| piece.to_string()).unwrap_or_default();
        let mut row = vec![text_cell(record.input.clone()), label, text(record.name.as_ref()), component];
        row.extend([part.region.to_string(), text(part.name.as_ref())]);
        row.extend([part.voxels.to_string(), part.border_area_mm2.to_string()]);
        for values in [&part.values, &part.standard_error, &part.blurred] {
            row.extend(cells_of(values)?);
        }
        self.regions.push(row);
        Ok(())
    }

    fn add_interface(&mut self, record: &Record, interface: &Interface) -> io::Result<()> {
        let [first, second] = interface.labels.each_ref().map(|label| text_cell(label.to_string()));
        if !self.known.insert([record.input.clone(), first.clone(), second.clone()]) {
            return Ok(());
        }
        let mut row = vec![text_cell(record.input.clone()), first, second];
        row.extend(interface.names.iter().map(|name| text(name.as_ref())));
        row.extend(cells_of(&interface.values)?);
        row.extend(cells_of(&interface.standard_error)?);
        row.push(interface.curvature_share.to_string());
        self.interfaces.push(row);
        Ok(())
    }
}

impl Sink<Record> for PartTables<'_> {
    fn row(&mut self, row: Record) -> io::Result<()> {
        for part in row.regions.iter().flatten().filter(|_| self.files.regions.is_some()) {
            self.add_region(&row, part)?;
        }
        for interface in row.interfaces.iter().flatten().filter(|_| self.files.interfaces.is_some()) {
            self.add_interface(&row, interface)?;
        }
        self.inner.row(row)
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.inner.failure(failure)
    }

    fn input_ends(&mut self) -> io::Result<()> {
        self.inner.input_ends()
    }
}

fn strings(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

fn with_errors(values: &[String]) -> Vec<String> {
    let errors = values.iter().map(|name| format!("standard_error_{name}"));
    values.iter().cloned().chain(errors).collect()
}

/// Names of a structure's fields, in the order in which their values come.
fn names_of(values: &impl Serialize) -> io::Result<Vec<String>> {
    let Value::Object(fields) = serde_json::to_value(values)? else { return Ok(Vec::new()) };
    Ok(fields.into_iter().map(|(name, _)| name).collect())
}

fn cells_of(values: &impl Serialize) -> io::Result<Vec<String>> {
    let Value::Object(fields) = serde_json::to_value(values)? else { return Ok(Vec::new()) };
    let cell = |value: Value| if value.is_null() { String::new() } else { value.to_string() };
    Ok(fields.into_iter().map(|(_, value)| cell(value)).collect())
}

fn text(name: Option<&String>) -> String {
    name.cloned().map(text_cell).unwrap_or_default()
}

fn write_table(path: &Path, columns: &[String], rows: &[Vec<String>]) -> io::Result<()> {
    write_whole(path, |out| {
        let mut table = csv::Writer::from_writer(out);
        table.write_record(columns)?;
        rows.iter().try_for_each(|row| table.write_record(row))?;
        table.flush()
    })
}
