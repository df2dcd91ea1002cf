//! Numbers against a parameter, in panels that share it.

use super::axes::Axes;
use super::canvas::{Anchor, Canvas, FAINT, INK, LABEL, SMALL, text_width};
use super::figure::Figure;
use super::frame::{MARGIN, caption, title};

/// Size of a panel's area between its axes.
const PLOT: [f64; 2] = [300.0, 190.0];
/// From a panel's left edge to its vertical axis, and from its bottom edge to the horizontal one.
const LEFT: f64 = 82.0;
const BELOW: f64 = 46.0;
/// Above a panel: its name.
const ABOVE: f64 = 30.0;
/// Panels side by side.
const COLUMNS: usize = 2;
/// Lines, told apart by the colour-blind too (Okabe and Ito 2008), and the filling of their error bands.
const COLORS: [(&str, &str); 3] = [("#0072b2", "#cfe3f1"), ("#d55e00", "#f8dcc8"), ("#666666", "#dddddd")];

/// One quantity over the range of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartLine<'a> {
    /// For the legend; lines of the same name share their colour.
    pub name: &'a str,
    /// A value for each of the parameter's; none where it could not be had.
    pub values: Vec<Option<f64>>,
    /// Half-widths of a band around them; may be empty.
    pub errors: Vec<Option<f64>>,
}

impl<'a> ChartLine<'a> {
    /// Without errors.
    pub fn new(name: &'a str, values: Vec<Option<f64>>) -> Self {
        Self { name, values, errors: Vec::new() }
    }
}

/// Lines in common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartPanel<'a> {
    /// Above it, with its unit.
    pub name: &'a str,
    /// The lines.
    pub lines: Vec<ChartLine<'a>>,
}

/// Panels over the same parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct LineChart<'a> {
    /// The parameter, with its unit.
    pub along: &'a str,
    /// Its values, ascending or descending.
    pub values: &'a [f64],
    /// Values of it that a dashed line marks.
    pub marks: &'a [f64],
    /// Whether equal ratios are equally far apart.
    pub log: bool,
    /// The panels.
    pub panels: &'a [ChartPanel<'a>],
    /// Above all.
    pub title: &'a str,
    /// Below all.
    pub caption: &'a str,
}

/// A value of a line, and half the width of its band.
#[derive(Debug, Clone, Copy)]
struct Point {
    at: f64,
    value: f64,
    error: Option<f64>,
}

impl LineChart<'_> {
    /// Draws it.
    pub fn figure(&self) -> Figure {
        let columns = self.panels.len().clamp(1, COLUMNS);
        let total = columns as f64 * (LEFT + PLOT[0] + MARGIN) + MARGIN;
        let mut canvas = Canvas::default();
        let top = title(&mut canvas, self.title, total);
        let top = self.legend(&mut canvas, top);
        let height = ABOVE + PLOT[1] + BELOW;
        for (number, panel) in self.panels.iter().enumerate() {
            let (column, row) = ((number % columns) as f64, (number / columns) as f64);
            let left = column * (LEFT + PLOT[0] + MARGIN) + LEFT;
            self.panel(&mut canvas, panel, [left, top + row * height + ABOVE + PLOT[1]]);
        }
        let bottom = top + self.panels.len().div_ceil(columns) as f64 * height;
        let bottom = caption(&mut canvas, self.caption, bottom, total);
        canvas.finish([total, bottom + MARGIN], self.title)
    }

    /// The names of all lines, in the order in which they first occur.
    fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for line in self.panels.iter().flat_map(|panel| &panel.lines) {
            if !names.contains(&line.name) {
                names.push(line.name);
            }
        }
        names
    }

    fn colors(&self, line: &ChartLine) -> (&'static str, &'static str) {
        let number = self.names().iter().position(|name| *name == line.name).unwrap_or_default();
        COLORS[number % COLORS.len()]
    }

    /// Returns where the panels begin.
    fn legend(&self, canvas: &mut Canvas, top: f64) -> f64 {
        let mut x = LEFT;
        for (name, (color, _)) in self.names().into_iter().zip(COLORS.iter().cycle()) {
            canvas.line([x, top + 8.0], [x + 22.0, top + 8.0], color, 2.0);
            canvas.centered_text([x + 29.0, top + 8.0], SMALL, INK, Anchor::Start, name);
            x += 29.0 + text_width(name, SMALL) + 26.0;
        }
        top + 16.0
    }

    fn panel(&self, canvas: &mut Canvas, panel: &ChartPanel, origin: [f64; 2]) {
        let [left, bottom] = origin;
        canvas.text([left, bottom - PLOT[1] - 10.0], LABEL, INK, Anchor::Start, panel.name);
        let Some(axes) = self.axes(panel, origin) else {
            let middle = [left + 0.5 * PLOT[0], bottom - 0.5 * PLOT[1]];
            return canvas.centered_text(middle, LABEL, FAINT, Anchor::Middle, "no data");
        };
        axes.draw(canvas, self.along);
        for &mark in self.marks {
            let x = axes.x(mark);
            canvas.polyline(&[[x, bottom], [x, bottom - PLOT[1]]], FAINT, 1.2, "5 4");
        }
        for line in &panel.lines {
            self.band(canvas, &axes, line);
        }
        for line in &panel.lines {
            let (color, _) = self.colors(line);
            for piece in self.pieces(line) {
                let points: Vec<[f64; 2]> =
                    piece.iter().map(|point| [axes.x(point.at), axes.y(point.value)]).collect();
                canvas.polyline(&points, color, 1.8, "");
                for [x, y] in points {
                    canvas.rect([x - 1.8, y - 1.8, 3.6, 3.6], color);
                }
            }
        }
    }

    /// Parts of a line without gaps.
    fn pieces(&self, line: &ChartLine) -> Vec<Vec<Point>> {
        let finite = |value: Option<f64>| value.filter(|v| v.is_finite());
        let point = |(n, (value, &at)): (usize, (&Option<f64>, &f64))| {
            let error = finite(line.errors.get(n).copied().flatten());
            finite(*value).map(|value| Point { at, value, error })
        };
        let points: Vec<Option<Point>> = line.values.iter().zip(self.values).enumerate().map(point).collect();
        let pieces = points.split(Option::is_none).filter(|piece| !piece.is_empty());
        pieces.map(|piece| piece.iter().copied().flatten().collect()).collect()
    }

    /// The errors of a line, where neighbours have them.
    fn band(&self, canvas: &mut Canvas, axes: &Axes, line: &ChartLine) {
        let [low, high] = axes.range;
        let pieces = self.pieces(line);
        for piece in pieces.iter().flat_map(|piece| piece.split(|point| point.error.is_none())) {
            let edge = |sign: f64| {
                let place = move |point: &Point| {
                    let value = point.value + sign * point.error.unwrap_or_default();
                    [axes.x(point.at), axes.y(value.clamp(low, high))]
                };
                piece.iter().map(place)
            };
            if piece.len() > 1 {
                let outline: Vec<[f64; 2]> = edge(1.0).chain(edge(-1.0).rev()).collect();
                canvas.polygon(&outline, self.colors(line).1);
            }
        }
    }

    /// Axes that hold all values, and their bands as far as these do not dwarf them; `None` without any.
    fn axes(&self, panel: &ChartPanel, origin: [f64; 2]) -> Option<Axes> {
        let points: Vec<Point> = panel.lines.iter().flat_map(|line| self.pieces(line)).flatten().collect();
        let low = points.iter().map(|point| point.value).reduce(f64::min)?;
        let high = points.iter().map(|point| point.value).reduce(f64::max)?;
        let span = if high > low { high - low } else { low.abs().max(1.0) * 0.02 };
        let most = |sign: f64, end: f64| {
            let reach = points.iter().map(|point| sign * point.value + point.error.unwrap_or_default());
            reach.fold(f64::NEG_INFINITY, f64::max).clamp(sign * end, sign * end + span)
        };
        let range = [-most(-1.0, low) - 0.06 * span, most(1.0, high) + 0.06 * span];
        let along =
            [self.values.iter().copied().reduce(f64::min)?, self.values.iter().copied().reduce(f64::max)?];
        (along[0] < along[1]).then_some(Axes { origin, size: PLOT, along, range, log: self.log })
    }
}
