//! How a quantity is distributed over a surface.

use super::canvas::{Anchor, Canvas, FAINT, INK, LABEL, RULE, SMALL, text_width};
use super::color_scale::ColorScale;
use super::error::PictureError;
use super::figure::Figure;
use super::frame::{MARGIN, caption, title};
use super::quantity::Quantity;
use super::raster::Raster;
use super::ticks::{Ticks, short};

/// Size of the area between the axes.
const PLOT: [f64; 2] = [520.0, 270.0];
/// From the figure's left edge to the vertical axis.
const LEFT: f64 = 74.0;
/// Height of the strip of colours along the horizontal axis.
const STRIP: f64 = 7.0;
/// Outlines, told apart by the colour-blind too (Okabe and Ito 2008), and the filling of the first.
const COLORS: [&str; 4] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"];
const FILLING: &str = "#cfe3f1";
/// How the median is dashed.
const DASHES: &str = "5 3";

/// One distribution.
#[derive(Debug, Clone, Copy)]
pub struct HistogramSeries<'a> {
    /// What is counted, such as `by area`.
    pub name: &'a str,
    /// Weight in every bin: a number of vertices or an area; only the shares are drawn.
    pub weights: &'a [f64],
    /// Marked by a line.
    pub mean: Option<f64>,
    /// Marked by a dashed line.
    pub median: Option<f64>,
}

/// Distributions of a quantity in common bins, one filled and up to three drawn over it.
#[derive(Debug, Clone, Copy)]
pub struct HistogramPicture<'a> {
    /// Bounds of the bins, ascending; one more than there are bins.
    pub edges: &'a [f64],
    /// The distributions, such as by area and by vertex.
    pub series: &'a [HistogramSeries<'a>],
    /// What is distributed.
    pub quantity: Quantity<'a>,
    /// Colours of the values, shown along the axis: the key to a [`super::SurfacePicture`] beside it.
    pub scale: Option<ColorScale>,
    /// Above all; may be empty.
    pub title: &'a str,
    /// Below all; may be empty.
    pub caption: &'a str,
    /// Width of the figure in CSS pixels; `None` where it follows from what is in it.
    pub width: Option<f64>,
}

/// From values and shares to the figure.
struct Axes {
    origin: [f64; 2],
    range: [f64; 2],
    highest: f64,
}

impl Axes {
    fn x(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        self.origin[0] + PLOT[0] * (value - low) / (high - low)
    }

    fn y(&self, share: f64) -> f64 {
        self.origin[1] - PLOT[1] * share / self.highest
    }
}

impl HistogramPicture<'_> {
    /// Draws it.
    ///
    /// # Errors
    /// Only if the PNG encoder fails.
    pub fn figure(&self) -> Result<Figure, PictureError> {
        let total = LEFT + PLOT[0] + MARGIN + 8.0;
        let mut canvas = Canvas::default();
        let top = title(&mut canvas, self.title, total);
        let top = self.legend(&mut canvas, top);
        let origin = [LEFT, top + PLOT[1]];
        let shares: Vec<Vec<f64>> = self.series.iter().map(|s| self.shares(s)).collect();
        let highest = shares.iter().flatten().fold(0.0f64, |m, s| m.max(*s));
        let axes =
            Axes { origin, range: self.range(), highest: if highest > 0.0 { 1.06 * highest } else { 1.0 } };
        canvas.grid(&axes);
        for (i, shares) in shares.iter().enumerate() {
            self.steps(&mut canvas, &axes, i, shares);
        }
        for (series, color) in self.series.iter().zip(COLORS.iter().cycle()) {
            canvas.marks(&axes, series, color);
        }
        if highest == 0.0 {
            let middle = [axes.origin[0] + 0.5 * PLOT[0], axes.origin[1] - 0.5 * PLOT[1]];
            canvas.centered_text(middle, LABEL, FAINT, Anchor::Middle, "no data");
        }
        let bottom = self.horizontal_axis(&mut canvas, &axes)?;
        let bottom = caption(&mut canvas, self.caption, bottom + 6.0, total);
        Ok(canvas.finish_at([total, bottom + MARGIN], self.width, self.title))
    }

    fn bins(&self) -> usize {
        self.edges.len().saturating_sub(1)
    }

    /// Percent of the weight in each bin.
    fn shares(&self, series: &HistogramSeries) -> Vec<f64> {
        let weight =
            |i: usize| series.weights.get(i).copied().filter(|w| w.is_finite()).unwrap_or(0.0).max(0.0);
        let sum: f64 = (0..self.bins()).map(weight).sum();
        (0..self.bins()).map(|i| if sum > 0.0 { 100.0 * weight(i) / sum } else { 0.0 }).collect()
    }

    /// From the first to the last edge, widened where they are equal.
    fn range(&self) -> [f64; 2] {
        match (self.edges.first(), self.edges.last()) {
            (Some(low), Some(high)) if low.is_finite() && high.is_finite() && low < high => [*low, *high],
            (Some(low), _) if low.is_finite() => [low - 1.0, low + 1.0],
            _ => [-1.0, 1.0],
        }
    }

    /// The outline of a distribution; the first is filled.
    fn steps(&self, canvas: &mut Canvas, axes: &Axes, number: usize, shares: &[f64]) {
        let corners = |(i, share): (usize, &f64)| {
            [self.edges[i], self.edges[i + 1]].map(|v| [axes.x(v), axes.y(*share)])
        };
        let mut points: Vec<[f64; 2]> = shares.iter().enumerate().flat_map(corners).collect();
        let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { return };
        points.insert(0, [first[0], axes.origin[1]]);
        points.push([last[0], axes.origin[1]]);
        if number == 0 {
            canvas.polygon(&points, FILLING);
        }
        canvas.polyline(&points, COLORS[number % COLORS.len()], 1.6, "");
    }

    /// A line a distribution with its mean and median; returns where the plot begins.
    fn legend(&self, canvas: &mut Canvas, top: f64) -> f64 {
        let unit =
            if self.quantity.unit.is_empty() { String::new() } else { format!(" {}", self.quantity.unit()) };
        let key = |canvas: &mut Canvas, x: f64, y: f64, color: &str, dashes: &str| {
            canvas.polyline(&[[x, y], [x + 22.0, y]], color, 1.8, dashes);
        };
        for (i, (series, color)) in self.series.iter().zip(COLORS.iter().cycle()).enumerate() {
            let y = top + 9.0 + 19.0 * i as f64;
            if i == 0 {
                canvas.rect([LEFT, y - 6.0, 22.0, 12.0], FILLING);
            }
            canvas.outline([LEFT, y - 6.0, 22.0, 12.0], color, 1.6);
            canvas.centered_text([LEFT + 30.0, y], SMALL, INK, Anchor::Start, series.name);
            let mut x = LEFT
                + 30.0
                + self.series.iter().map(|s| text_width(s.name, SMALL)).fold(60.0, f64::max)
                + 12.0;
            for (what, value, dashes) in [("mean", series.mean, ""), ("median", series.median, DASHES)] {
                if let Some(value) = value {
                    key(canvas, x, y, color, dashes);
                    let text = format!("{what} {}{unit}", short(value));
                    canvas.centered_text([x + 29.0, y], SMALL, INK, Anchor::Start, &text);
                }
                x += 175.0;
            }
        }
        top + 19.0 * self.series.len() as f64 + 12.0
    }

    /// Axis, numbers and name of the quantity; returns where they end.
    fn horizontal_axis(&self, canvas: &mut Canvas, axes: &Axes) -> Result<f64, PictureError> {
        let [left, bottom] = axes.origin;
        let mut below = bottom;
        if let Some(scale) = self.scale {
            let [low, high] = axes.range;
            let color = |[x, _]: [usize; 2]| scale.rgb(low + (high - low) * (x as f64 + 0.5) / 512.0);
            canvas.image([left, bottom, PLOT[0], STRIP], &Raster::from_colors([512, 16], color))?;
            below += STRIP;
        }
        canvas.polyline(&[[left, bottom - PLOT[1]], axes.origin, [left + PLOT[0], bottom]], INK, 1.0, "");
        let ticks = Ticks::new(axes.range, 7);
        for value in &ticks.values {
            canvas.line([axes.x(*value), below], [axes.x(*value), below + 4.0], INK, 1.0);
            canvas.text([axes.x(*value), below + 17.0], SMALL, INK, Anchor::Middle, &ticks.label(*value));
        }
        canvas.text([left + 0.5 * PLOT[0], below + 37.0], LABEL, INK, Anchor::Middle, &self.quantity.label());
        Ok(below + 42.0)
    }
}

impl Canvas {
    /// Rules and numbers of the vertical axis.
    fn grid(&mut self, axes: &Axes) {
        let [left, bottom] = axes.origin;
        let ticks = Ticks::new([0.0, axes.highest], 5);
        for share in &ticks.values {
            let y = axes.y(*share);
            self.line([left - 4.0, y], [left, y], INK, 1.0);
            if *share > 0.0 {
                self.line([left, y], [left + PLOT[0], y], RULE, 0.5);
            }
            self.centered_text([left - 8.0, y], SMALL, INK, Anchor::End, &ticks.label(*share));
        }
        let name = [MARGIN + LABEL, bottom - 0.5 * PLOT[1]];
        self.text(name, LABEL, INK, Anchor::MiddleUpward, "Share per bin (%)");
    }

    /// Mean and median.
    fn marks(&mut self, axes: &Axes, series: &HistogramSeries, color: &str) {
        let [low, high] = axes.range;
        for (value, dashes) in [(series.mean, ""), (series.median, DASHES)] {
            if let Some(value) = value.filter(|v| (low..=high).contains(v)) {
                let x = axes.x(value);
                self.polyline(&[[x, axes.origin[1]], [x, axes.origin[1] - PLOT[1]]], color, 1.4, dashes);
            }
        }
    }
}
