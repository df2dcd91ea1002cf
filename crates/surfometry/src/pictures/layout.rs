//! Panels in rows and columns at one scale.

/// Where the panels are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// Picture units (1/96 inch) a millimetre, the same in all panels.
    pub(crate) units_per_mm: f64,
    /// x, y, width, height of every panel, from the upper left corner of all.
    pub(crate) panels: Vec<[f64; 4]>,
    /// Width and height of all.
    pub(crate) size: [f64; 2],
}

/// Room for all panels, and for one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Room {
    pub(crate) size: [f64; 2],
    pub(crate) largest: f64,
}

impl Default for Room {
    fn default() -> Self {
        Self { size: [800.0, 640.0], largest: 460.0 }
    }
}

impl Room {
    /// Of a width; a page is higher than wide.
    pub(crate) fn wide(width: f64) -> Self {
        Self { size: [width, 1.2 * width.max(300.0)], largest: f64::INFINITY }
    }
}

/// Between panels.
const GAP: f64 = 14.0;

/// What a panel holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Content {
    /// Width and height, mm.
    pub(crate) extent: [f64; 2],
    /// Room around it for text, in units: left and right together, bottom and top together.
    pub(crate) rim: [f64; 2],
    /// Width of its name.
    pub(crate) least_width: f64,
}

impl Layout {
    /// Panels in rows of `columns`, as large as the room allows.
    pub(crate) fn new(contents: &[Content], columns: usize, room: Room) -> Self {
        let columns = columns.clamp(1, contents.len().max(1));
        let rows = contents.len().div_ceil(columns);
        let across: Vec<Line> =
            (0..columns).map(|c| Line::of(0, contents.iter().skip(c).step_by(columns))).collect();
        let down: Vec<Line> =
            (0..rows).map(|r| Line::of(1, contents.iter().skip(r * columns).take(columns))).collect();
        let units_per_mm = fitting(&across, &down, room);
        let sizes = |lines: &[Line]| -> Vec<f64> {
            lines.iter().map(|l| (l.extent * units_per_mm + l.rim).max(l.least)).collect()
        };
        let (widths, heights) = (sizes(&across), sizes(&down));
        let panel = |i: usize| {
            let (row, column) = (i / columns, i % columns);
            [before(&widths, column), before(&heights, row), widths[column], heights[row]]
        };
        let size = [before(&widths, columns) - GAP, before(&heights, rows) - GAP];
        Self {
            units_per_mm,
            panels: (0..contents.len()).map(panel).collect(),
            size: size.map(|v| v.max(0.0)),
        }
    }

    /// The number of columns, of those offered, that makes panels largest; of equal ones the last.
    pub(crate) fn best(contents: &[Content], columns: impl IntoIterator<Item = usize>, room: Room) -> Self {
        let layouts = columns.into_iter().map(|n| Self::new(contents, n, room));
        let best = layouts.max_by(|a, b| a.units_per_mm.total_cmp(&b.units_per_mm));
        best.unwrap_or_else(|| Self::new(contents, 1, room))
    }
}

/// The largest content of a row's height or a column's width.
struct Line {
    extent: f64,
    rim: f64,
    least: f64,
}

impl Line {
    fn of<'a>(axis: usize, contents: impl Iterator<Item = &'a Content>) -> Self {
        let largest = |line: Self, c: &Content| Self {
            extent: line.extent.max(c.extent[axis]),
            rim: line.rim.max(c.rim[axis]),
            least: line.least.max([c.least_width, 0.0][axis]),
        };
        contents.fold(Self { extent: 0.0, rim: 0.0, least: 0.0 }, largest)
    }
}

/// Units a millimetre with which columns and rows fill the room but do not exceed it.
fn fitting(across: &[Line], down: &[Line], room: Room) -> f64 {
    let along = |axis: usize, lines: &[Line]| {
        let fixed: f64 = lines.iter().map(|l| l.rim + GAP).sum();
        let total: f64 = lines.iter().map(|l| l.extent).sum();
        let largest = lines.iter().fold(0.0f64, |m, l| m.max(l.extent));
        ((room.size[axis] - fixed).max(60.0) / total).min(room.largest / largest)
    };
    let scale = along(0, across).min(along(1, down));
    if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
}

/// Sizes of the first lines with the gaps behind them.
fn before(sizes: &[f64], count: usize) -> f64 {
    sizes[..count].iter().map(|s| s + GAP).sum()
}
