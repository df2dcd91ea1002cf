//! The colour bar.

use super::canvas::{Anchor, Canvas, INK, LABEL, SMALL, text_width};
use super::color_scale::ColorScale;
use super::error::PictureError;
use super::quantity::Quantity;
use super::raster::Raster;

/// Width of the bar itself.
const THICKNESS: f64 = 15.0;
/// From the bar to its numbers.
const TICK: f64 = 7.0;
/// Height of the arrow that says that values go on.
const ARROW: f64 = 11.0;

/// An upright colour bar with ticks, numbers and title.
pub(crate) struct ColorBar<'a> {
    pub(crate) scale: &'a ColorScale,
    pub(crate) quantity: &'a Quantity<'a>,
    /// Whether there are values below and above the limits: the ends are pointed then.
    pub(crate) exceeded: [bool; 2],
}

impl ColorBar<'_> {
    /// Width of everything: bar, numbers, title.
    pub(crate) fn width(&self) -> f64 {
        THICKNESS + TICK + self.numbers() + 1.5 * LABEL
    }

    /// Width of the widest number.
    fn numbers(&self) -> f64 {
        let marks = self.scale.marks();
        marks.values.iter().map(|v| text_width(&marks.label(*v), SMALL)).fold(0.0, f64::max)
    }

    /// Draws it from an upper left corner, `height` high.
    pub(crate) fn draw(
        &self,
        canvas: &mut Canvas,
        [x, y]: [f64; 2],
        height: f64,
    ) -> Result<(), PictureError> {
        let (top, length) = (y + ARROW, (height - 2.0 * ARROW).max(1.0));
        self.tips(canvas, [x, top], length);
        canvas.image([x, top, THICKNESS, length], &self.strip())?;
        canvas.polyline(&self.around([x, top], length), INK, 0.8, "");
        let marks = self.scale.marks();
        let [low, high] = self.scale.limits();
        for value in &marks.values {
            let at = top + length * (high - value) / (high - low);
            canvas.line([x + THICKNESS, at], [x + THICKNESS + 4.0, at], INK, 0.8);
            canvas.centered_text([x + THICKNESS + TICK, at], SMALL, INK, Anchor::Start, &marks.label(*value));
        }
        let title = [x + self.width() - 0.2 * LABEL, top + 0.5 * length];
        canvas.text(title, LABEL, INK, Anchor::MiddleUpward, &self.quantity.label());
        Ok(())
    }

    /// The colours, highest value first; several columns, so that smoothing does not eat into the sides.
    fn strip(&self) -> Raster {
        let stops = self.scale.stops(512);
        Raster::from_colors([30, stops.len()], |[_, y]| stops[stops.len() - 1 - y].1)
    }

    /// Points beyond the ends where values go on.
    fn tip_points(&self, [x, top]: [f64; 2], length: f64) -> [Option<[f64; 2]>; 2] {
        let [below, above] = self.exceeded;
        let middle = x + 0.5 * THICKNESS;
        [below.then_some([middle, top + length + ARROW]), above.then_some([middle, top - ARROW])]
    }

    /// The tips' colours, reaching under the bar a little so that no seam shows.
    fn tips(&self, canvas: &mut Canvas, [x, top]: [f64; 2], length: f64) {
        let places = [(top + length, -1.0), (top, 1.0)];
        let tips = self.tip_points([x, top], length).into_iter().zip(places).zip(self.scale.limits());
        for ((tip, (edge, inward)), value) in tips {
            if let Some(tip) = tip {
                let [r, g, b] = self.scale.rgb(value);
                let (right, under) = (x + THICKNESS, edge + inward);
                let points = [[x, under], [x, edge], tip, [right, edge], [right, under]];
                canvas.polygon(&points, &format!("#{r:02x}{g:02x}{b:02x}"));
            }
        }
    }

    /// The outline with its tips, closed.
    fn around(&self, [x, top]: [f64; 2], length: f64) -> Vec<[f64; 2]> {
        let (right, bottom) = (x + THICKNESS, top + length);
        let [below, above] = self.tip_points([x, top], length);
        let start = Some([x, top]);
        let corners =
            [start, above, Some([right, top]), Some([right, bottom]), below, Some([x, bottom]), start];
        corners.into_iter().flatten().collect()
    }
}
