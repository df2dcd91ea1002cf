//! Columns of numbers as text.

use comfy_table::{CellAlignment, Table, presets};

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
