//! Characteristics that are not rounded, as they come.

use super::axes::Axes;
use super::canvas::{Anchor, Canvas, INK, LABEL};
use super::figure::Figure;
use super::frame::{MARGIN, caption};

const PLOT: [f64; 2] = [330.0, 150.0];
const LEFT: f64 = 88.0;
const BELOW: f64 = 48.0;
const COLOR: &str = "#0072b2";
/// Most bars.
const BARS: f64 = 66.0;

/// Counts of Euler characteristics by several methods, side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct EulerHistogram<'a> {
    /// Name and values of each.
    pub series: &'a [(&'a str, Vec<f64>)],
}

impl EulerHistogram<'_> {
    /// Draws it, all on one scale.
    pub fn figure(&self) -> Figure {
        let all = || self.series.iter().flat_map(|(_, values)| values).copied();
        let low = all().fold(f64::INFINITY, f64::min).min(0.0).floor() - 1.0;
        let high = all().fold(f64::NEG_INFINITY, f64::max).max(2.0).ceil() + 1.0;
        // Whole and even numbers fall into the middle of a bar.
        let width = ((high - low) / BARS).max(0.1);
        let mut canvas = Canvas::default();
        let total = self.series.len() as f64 * (LEFT + PLOT[0] + MARGIN) + MARGIN;
        let bottom = MARGIN + 24.0 + PLOT[1];
        for (number, (name, values)) in self.series.iter().enumerate() {
            let origin = [LEFT + number as f64 * (LEFT + PLOT[0] + MARGIN), bottom];
            let mut counts = std::collections::BTreeMap::new();
            for value in values {
                *counts.entry(libm::round(value / width) as i64).or_insert(0u32) += 1;
            }
            let most = counts.values().copied().max().unwrap_or(1);
            let axes = Axes {
                origin,
                size: PLOT,
                along: [low, high],
                range: [0.0, 1.05 * f64::from(most)],
                log: false,
            };
            axes.draw(&mut canvas, "Euler characteristic");
            for (bar, count) in counts {
                let (left, right) = (axes.x((bar as f64 - 0.5) * width), axes.x((bar as f64 + 0.5) * width));
                let top = axes.y(f64::from(count));
                canvas.rect([left, top, (right - left).max(1.5), bottom - top], COLOR);
            }
            canvas.text([origin[0], bottom - PLOT[1] - 10.0], LABEL, INK, Anchor::Start, name);
        }
        let text =
            "Number of objects by Euler characteristic, not rounded. A closed surface has an even one.";
        let end = caption(&mut canvas, text, bottom + BELOW, total);
        canvas.finish([total, end + MARGIN], "Euler characteristics")
    }
}
