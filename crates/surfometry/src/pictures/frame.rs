//! What pictures have in common: title, panels at one scale, colour bar, scale bar, caption.

use super::canvas::{Anchor, Canvas, FAINT, INK, LABEL, SMALL, TITLE, wrapped};
use super::color_bar::ColorBar;
use super::error::PictureError;
use super::figure::Figure;
use super::layout::{Content, Layout, Room};
use super::scale_bar::draw_scale_bar;

/// Pixels a picture unit in embedded rasters: 288 an inch, which journals ask for.
pub(crate) const DENSITY: f64 = 3.0;
/// Around everything.
pub(crate) const MARGIN: f64 = 16.0;
/// Height of a panel's name.
pub(crate) const NAME: f64 = 20.0;
/// Room for direction letters.
pub(crate) const LETTER: f64 = 18.0;

/// Title, caption, width and colours of a picture.
pub(crate) struct Frame<'a> {
    pub(crate) title: &'a str,
    pub(crate) caption: &'a str,
    /// Of everything; `None` where it follows from what is in it.
    pub(crate) width: Option<f64>,
    pub(crate) bar: ColorBar<'a>,
}

/// Where a panel is to be drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// x, y, width and height of what lies below the panel's name.
    pub(crate) area: [f64; 4],
    pub(crate) units_per_mm: f64,
}

impl Place {
    pub(crate) fn middle(&self) -> [f64; 2] {
        let [x, y, width, height] = self.area;
        [x + 0.5 * width, y + 0.5 * height]
    }
}

/// Pixels of an embedded raster of this size.
pub(crate) fn pixels(size: [f64; 2], density: f64) -> [usize; 2] {
    size.map(|v| libm::round(v * density).max(1.0) as usize)
}

/// Between the panels and the colour bar.
const BEFORE_BAR: f64 = 22.0;

impl Frame<'_> {
    /// Room that is left to the panels.
    pub(crate) fn room(&self) -> Room {
        let beside = 2.0 * MARGIN + BEFORE_BAR + self.bar.width();
        self.width.map_or_else(Room::default, |width| Room::wide(width - beside))
    }

    /// A figure with the panels that `draw` makes by their number.
    pub(crate) fn compose(
        &self,
        contents: &[Content],
        layout: &Layout,
        mut draw: impl FnMut(&mut Canvas, usize, Place) -> Result<(), PictureError>,
    ) -> Result<Figure, PictureError> {
        let [width, height] = layout.size;
        let bar_left = MARGIN + width + BEFORE_BAR;
        let total = bar_left + self.bar.width() + MARGIN;
        let mut canvas = Canvas::default();
        let top = title(&mut canvas, self.title, total);
        for (i, [x, y, width, height]) in layout.panels.iter().enumerate() {
            let area = [MARGIN + x, top + y + NAME, *width, height - NAME];
            draw(&mut canvas, i, Place { area, units_per_mm: layout.units_per_mm })?;
        }
        let bar_height = height.clamp(170.0, 330.0);
        let bar_top = top + (0.5 * (height - bar_height)).max(0.0);
        self.bar.draw(&mut canvas, [bar_left, bar_top], bar_height)?;
        let bottom = top + height.max(bar_height);
        if contents.iter().any(|c| c.extent != [0.0; 2]) {
            draw_scale_bar(
                &mut canvas,
                [MARGIN + LETTER, bottom + 16.0],
                width.min(420.0),
                1.0 / layout.units_per_mm,
            );
        }
        let bottom = caption(&mut canvas, self.caption, bottom + 28.0, total);
        Ok(canvas.finish_at([total, bottom + MARGIN], self.width, self.title))
    }
}

/// Draws the title, if there is one, and returns where the rest begins.
pub(crate) fn title(canvas: &mut Canvas, title: &str, total: f64) -> f64 {
    let lines = wrapped(title, TITLE, total - 2.0 * MARGIN);
    for (i, line) in lines.iter().enumerate() {
        let baseline = MARGIN + TITLE * (0.9 + 1.3 * i as f64);
        canvas.text([MARGIN, baseline], TITLE, INK, Anchor::Start, line);
    }
    MARGIN + if lines.is_empty() { 0.0 } else { 1.3 * TITLE * lines.len() as f64 + 8.0 }
}

/// Draws the caption below `top` and returns where it ends.
pub(crate) fn caption(canvas: &mut Canvas, caption: &str, top: f64, total: f64) -> f64 {
    let lines = wrapped(caption, SMALL, total - 2.0 * MARGIN);
    for (i, line) in lines.iter().enumerate() {
        canvas.text([MARGIN, top + 1.4 * SMALL * (i + 1) as f64], SMALL, FAINT, Anchor::Start, line);
    }
    top + 1.4 * SMALL * lines.len() as f64
}

/// Draws a panel's name.
pub(crate) fn name(canvas: &mut Canvas, place: Place, name: &str) {
    canvas.text([place.middle()[0], place.area[1] - 6.0], LABEL, INK, Anchor::Middle, name);
}

/// Letters at the left, right, bottom and top of what has a middle and a size.
pub(crate) fn draw_letters(canvas: &mut Canvas, letters: &[String; 4], [x, y]: [f64; 2], size: [f64; 2]) {
    let [across, down] = size.map(|s| 0.5 * (s + LETTER));
    let places = [[x - across, y], [x + across, y], [x, y + down], [x, y - down]];
    for (place, letter) in places.into_iter().zip(letters) {
        canvas.centered_text(place, SMALL, FAINT, Anchor::Middle, letter);
    }
}
