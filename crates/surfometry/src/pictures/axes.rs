//! A panel's axes.

use super::canvas::{Anchor, Canvas, INK, RULE, SMALL, text_width};
use super::ticks::Ticks;

/// From numbers to places in a panel, y upwards.
pub(super) struct Axes {
    /// Lower left corner.
    pub(super) origin: [f64; 2],
    /// Width and height.
    pub(super) size: [f64; 2],
    /// Numbers at the left and right end.
    pub(super) along: [f64; 2],
    /// Numbers at the lower and upper end.
    pub(super) range: [f64; 2],
    /// Whether equal ratios are equally far apart along x.
    pub(super) log: bool,
}

impl Axes {
    pub(super) fn x(&self, value: f64) -> f64 {
        let scaled = |v: f64| if self.log { libm::log(v) } else { v };
        let [low, high] = self.along.map(scaled);
        self.origin[0] + self.size[0] * (scaled(value) - low) / (high - low)
    }

    pub(super) fn y(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        self.origin[1] - self.size[1] * (value - low) / (high - low)
    }

    /// Lines, ticks and numbers, and what is along x.
    pub(super) fn draw(&self, canvas: &mut Canvas, along: &str) {
        let ([left, bottom], [width, height]) = (self.origin, self.size);
        let ticks = Ticks::new(self.range, 5);
        for &value in &ticks.values {
            let y = self.y(value);
            canvas.line([left, y], [left + width, y], RULE, 0.5);
            canvas.line([left - 4.0, y], [left, y], INK, 1.0);
            canvas.centered_text([left - 8.0, y], SMALL, INK, Anchor::End, &ticks.label(value));
        }
        let ticks = if self.log { Ticks::on_log(self.along) } else { Ticks::new(self.along, 6) };
        let mut free = f64::NEG_INFINITY;
        for &value in &ticks.values {
            let (x, label) = (self.x(value), ticks.label(value));
            canvas.line([x, bottom], [x, bottom + 4.0], INK, 1.0);
            let half = 0.5 * text_width(&label, SMALL);
            if x - half >= free {
                canvas.text([x, bottom + 16.0], SMALL, INK, Anchor::Middle, &label);
                free = x + half + 4.0;
            }
        }
        canvas.polyline(&[[left, bottom - height], self.origin, [left + width, bottom]], INK, 1.0, "");
        canvas.text([left + 0.5 * width, bottom + 34.0], SMALL, INK, Anchor::Middle, along);
    }
}
