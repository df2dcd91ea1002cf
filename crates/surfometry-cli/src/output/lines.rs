//! A line an object, for runs of many.

use super::numbers::{counted, digits_or_dash, with_error};
use super::raised::{EXPLAIN, Raised, RaisedFlags};
use super::width::{shortened, width, wrapped};
use std::collections::BTreeSet;
use surfometry::accuracy::Flag;
use surfometry::measurement::{DescribedSurface, Measured};
use surfometry::runs::Record;

/// A column: its heading, how wide it is, and what it holds.
struct Column {
    heading: &'static str,
    width: usize,
    cell: fn(&Measured) -> String,
}

/// Columns of numbers, those first that are shown in narrow windows too.
const COLUMNS: [Column; 5] = [
    Column {
        heading: "volume mm\u{b3}",
        width: 16,
        cell: |m| with_error(m.volume_mm3, m.standard_error.volume_mm3),
    },
    Column {
        heading: "area mm\u{b2}",
        width: 15,
        cell: |m| with_error(m.surface_area_mm2, m.standard_error.surface_area_mm2),
    },
    Column {
        heading: "total H mm",
        width: 14,
        cell: |m| with_error(m.total_mean_curvature_mm, m.standard_error.total_mean_curvature_mm),
    },
    Column { heading: "chi", width: 5, cell: |m| digits_or_dash(m.euler_characteristic.map(f64::round)) },
    Column {
        heading: "mean H 1/mm",
        width: 19,
        cell: |m| with_error(m.average_mean_curvature_per_mm, m.standard_error.average_mean_curvature_per_mm),
    },
];
/// Columns of a window that is not wide.
const NARROW: usize = 4;
/// Window from which on all are shown.
const WIDE: usize = 110;
/// Flags: as many letters as stand beside each other.
const FLAGS: usize = 7;

/// Lines of a run's objects, and what their flags' letters stand for.
#[derive(Default)]
pub(crate) struct Lines {
    raised: RaisedFlags,
    has_heading: bool,
}

impl Lines {
    /// An object's line under a name; above the first the headings of the columns.
    pub(crate) fn line(&mut self, name: &str, record: &Record) -> String {
        let heading = if self.has_heading { String::new() } else { heading() };
        self.has_heading = true;
        let m = &record.measured;
        let numbers = columns().map(|column| format!(" {:>1$}", (column.cell)(m), column.width));
        let numbers = numbers.collect::<Vec<_>>().concat();
        let text = format!("{}{numbers}  {}", named(name), self.letters(name, &m.flags));
        format!("{heading}{}\n", text.trim_end())
    }

    fn letters(&mut self, name: &str, flags: &[Flag]) -> String {
        let numbers: BTreeSet<usize> = flags.iter().map(|flag| self.raised.add(name, flag)).collect();
        numbers.into_iter().map(letter).collect()
    }

    /// Whether there is any.
    pub(crate) fn any(&self) -> bool {
        self.has_heading
    }

    /// What stands below the lines.
    pub(crate) fn ending(&self) -> String {
        let explained = |(number, raised): (usize, &Raised)| {
            let first = format!("  {} ", letter(number));
            let (many, words) = (counted(raised.objects, "object"), raised.in_words(EXPLAIN));
            wrapped(&format!("{}, {many}: {words}", raised.code), &first, "    ")
        };
        self.raised.iter().enumerate().map(explained).collect()
    }
}

/// What the lines' numbers are of.
pub(crate) fn legend(all_original: bool) -> String {
    let surface = if all_original {
        "of the objects as they were segmented, \u{b1} their standard errors"
    } else {
        "of the surface that the choices made say (`surface` in JSON)"
    };
    let text = format!(
        "Numbers are {surface}. H > 0 on a ball; chi is the surface's (ball 2, torus 0). --details shows all."
    );
    wrapped(&text, "", "")
}

/// Whether a record's numbers are those of the object as it was segmented.
pub(crate) fn is_original(record: &Record) -> bool {
    record.measured.surface == DescribedSurface::Original
}

fn columns() -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().take(if width() < WIDE { NARROW } else { COLUMNS.len() })
}

fn heading() -> String {
    let headings = columns().map(|column| format!(" {:>1$}", column.heading, column.width));
    format!("{}{}  flags\n", named("object"), headings.collect::<Vec<_>>().concat())
}

/// A name in what is left of the width.
fn named(name: &str) -> String {
    let numbers: usize = columns().map(|column| column.width + 1).sum();
    let room = width() - numbers - FLAGS;
    format!("{:<room$}", shortened(name, room))
}

/// a to z, then A to Z: there are fewer codes.
fn letter(number: usize) -> char {
    (b'a'..=b'z').chain(b'A'..=b'Z').nth(number).map_or('*', char::from)
}
