//! Regression and Bland-Altman plots, side by side for each measure.

use super::axes::Axes;
use super::canvas::{Anchor, Canvas, FAINT, INK, LABEL, SMALL};
use super::figure::Figure;
use super::frame::{MARGIN, caption, title};
use crate::statistics::{Agreement, BlandAltman, Estimate};

/// Most objects that are named in a plot, and most letters of a name.
const MOST_NAMED: usize = 6;
const LONGEST: usize = 26;
const PLOT: [f64; 2] = [330.0, 230.0];
const LEFT: f64 = 88.0;
const ABOVE: f64 = 30.0;
const BELOW: f64 = 48.0;
/// Points, and the line through them (Okabe and Ito 2008); what encloses an estimate.
const POINT: &str = "#0072b2";
const FITTED: &str = "#d55e00";
const INTERVAL: &str = "#f8dcc8";
const LIMITS: &str = "#e6e6e6";
const IDEAL: &str = "#999999";

/// A measure by two methods.
#[derive(Debug, Clone, PartialEq)]
pub struct AgreementPanel<'a> {
    /// What it is, with its unit.
    pub name: &'a str,
    /// Values of the method and of the standard.
    pub pairs: &'a [(f64, f64)],
    /// Names of the objects, of which those beyond the limits of agreement are told; may be empty.
    pub objects: &'a [String],
    /// What was made of them.
    pub agreement: &'a Agreement,
}

/// Panels of several measures.
#[derive(Debug, Clone, PartialEq)]
pub struct AgreementChart<'a> {
    /// The method's name.
    pub method: &'a str,
    /// The standard's.
    pub standard: &'a str,
    /// A row each.
    pub panels: &'a [AgreementPanel<'a>],
}

impl AgreementChart<'_> {
    /// Draws it.
    pub fn figure(&self) -> Figure {
        let total = 2.0 * (LEFT + PLOT[0] + MARGIN) + MARGIN;
        let heading = format!("{} against {}", self.method, self.standard);
        let mut canvas = Canvas::default();
        let top = title(&mut canvas, &heading, total);
        let height = ABOVE + PLOT[1] + BELOW;
        for (row, panel) in self.panels.iter().enumerate() {
            let bottom = top + row as f64 * height + ABOVE + PLOT[1];
            self.regression(&mut canvas, panel, [LEFT, bottom]);
            self.differences(&mut canvas, panel, [2.0 * LEFT + PLOT[0] + MARGIN, bottom]);
        }
        let bottom = top + self.panels.len() as f64 * height;
        let text = "Left: each object by both methods; dashed: equality; line: least squares. Right: difference (method minus standard) against the mean of both; line: bias, \
                    grey: limits of agreement (1.96 standard deviations), shaded: 95 % intervals of bias and limits; dashed: no difference.";
        let bottom = caption(&mut canvas, text, bottom, total);
        canvas.finish([total, bottom + MARGIN], &heading)
    }

    fn regression(&self, canvas: &mut Canvas, panel: &AgreementPanel, origin: [f64; 2]) {
        let range = reach(panel.pairs.iter().flat_map(|&(method, standard)| [method, standard]));
        let axes = Axes { origin, size: PLOT, along: range, range, log: false };
        name(canvas, &axes, &format!("{} by {}", panel.name, self.method));
        axes.draw(canvas, &format!("by {}", self.standard));
        let [low, high] = range;
        dashed(canvas, &axes, [[low, low], [high, high]]);
        let fit = &panel.agreement.regression;
        if fit.slope.value.is_finite() {
            let on_line = |x: f64| fit.intercept.value + fit.slope.value * x;
            let ends = reach_of(panel.pairs.iter().map(|pair| pair.1));
            let line: Vec<[f64; 2]> = ends.iter().map(|&x| [axes.x(x), axes.y(on_line(x))]).collect();
            canvas.polyline(&line, FITTED, 1.6, "");
        }
        points(canvas, &axes, panel.pairs.iter().map(|&(method, standard)| [standard, method]));
        let told = |name: &str, value: f64| {
            if value.is_finite() { format!("{name} {value:.4}, ") } else { String::new() }
        };
        let text = told("slope", fit.slope.value)
            + &told("R\u{b2}", fit.r_squared)
            + &format!("n {}", panel.agreement.count);
        canvas.text([origin[0] + 10.0, origin[1] - PLOT[1] + 14.0], SMALL, FAINT, Anchor::Start, &text);
    }

    fn differences(&self, canvas: &mut Canvas, panel: &AgreementPanel, origin: [f64; 2]) {
        let places: Vec<[f64; 2]> = panel.pairs.iter().map(|&(m, s)| [0.5 * (m + s), m - s]).collect();
        let BlandAltman { bias, limits, .. } = panel.agreement.bland_altman;
        let ends = [limits[0].interval[0], limits[1].interval[1], 0.0];
        let axes = Axes {
            origin,
            size: PLOT,
            along: reach(places.iter().map(|place| place[0])),
            range: reach(places.iter().map(|place| place[1]).chain(ends)),
            log: false,
        };
        name(canvas, &axes, &format!("difference: {} minus {}", self.method, self.standard));
        let shade = |canvas: &mut Canvas, estimate: &Estimate, color: &str| {
            let [low, high] = estimate.interval.map(|v| axes.y(v));
            canvas.rect([origin[0], high, PLOT[0], low - high], color);
        };
        for limit in &limits {
            shade(canvas, limit, LIMITS);
        }
        shade(canvas, &bias, INTERVAL);
        axes.draw(canvas, &format!("mean of both, {}", panel.name));
        dashed(canvas, &axes, [[axes.along[0], 0.0], [axes.along[1], 0.0]]);
        for (value, color) in [(bias.value, FITTED), (limits[0].value, FAINT), (limits[1].value, FAINT)] {
            canvas.line([origin[0], axes.y(value)], [origin[0] + PLOT[0], axes.y(value)], color, 1.6);
        }
        points(canvas, &axes, places.iter().copied());
        outliers(canvas, panel, &axes, &places);
    }
}

/// Names of the objects beyond the limits of agreement, the farthest first, as far as they do not cover each
/// other.
fn outliers(canvas: &mut Canvas, panel: &AgreementPanel, axes: &Axes, places: &[[f64; 2]]) {
    let BlandAltman { bias, limits, .. } = panel.agreement.bland_altman;
    let [low, high] = [limits[0].value, limits[1].value];
    let mut beyond: Vec<([f64; 2], &String)> = places
        .iter()
        .copied()
        .zip(panel.objects)
        .filter(|([_, difference], _)| *difference < low || *difference > high)
        .collect();
    let distance = |[_, difference]: [f64; 2]| (difference - bias.value).abs();
    beyond.sort_by(|a, b| distance(b.0).total_cmp(&distance(a.0)));
    let mut taken: Vec<f64> = Vec::new();
    for ([mean, difference], object) in beyond.into_iter().take(MOST_NAMED) {
        let [x, y] = [axes.x(mean), axes.y(difference)];
        if taken.iter().any(|other| (other - y).abs() < SMALL) {
            continue;
        }
        taken.push(y);
        // On the side that has more room.
        let right = x < axes.origin[0] + 0.5 * axes.size[0];
        let (at, anchor) = if right { (x + 6.0, Anchor::Start) } else { (x - 6.0, Anchor::End) };
        canvas.centered_text([at, y], SMALL - 1.5, INK, anchor, &shortened(object));
    }
}

/// The end of a name that is long, which tells files apart.
fn shortened(name: &str) -> String {
    let letters = name.chars().count();
    if letters <= LONGEST {
        return name.to_owned();
    }
    let end: String = name.chars().skip(letters + 1 - LONGEST).collect();
    format!("\u{2026}{end}")
}

fn name(canvas: &mut Canvas, axes: &Axes, text: &str) {
    canvas.text([axes.origin[0], axes.origin[1] - axes.size[1] - 10.0], LABEL, INK, Anchor::Start, text);
}

fn points(canvas: &mut Canvas, axes: &Axes, places: impl Iterator<Item = [f64; 2]>) {
    places.for_each(|[x, y]| canvas.rect([axes.x(x) - 2.0, axes.y(y) - 2.0, 4.0, 4.0], POINT));
}

fn dashed(canvas: &mut Canvas, axes: &Axes, ends: [[f64; 2]; 2]) {
    canvas.polyline(&ends.map(|[x, y]| [axes.x(x), axes.y(y)]), IDEAL, 1.0, "5 4");
}

/// Least and largest.
fn reach_of(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// The same with room on both sides.
fn reach(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = reach_of(values);
    let room = if high > low { 0.06 * (high - low) } else { low.abs().max(1e-9) };
    [low - room, high + room]
}
