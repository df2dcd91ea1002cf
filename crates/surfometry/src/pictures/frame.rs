//! What pictures of surfaces have in common: panels at one scale, their names and directions, colour bar, scale bar.

use super::camera::{Camera, Prospect};
use super::canvas::{Anchor, Canvas, FAINT, INK, LABEL, SMALL, TITLE, wrapped};
use super::color_bar::ColorBar;
use super::error::PictureError;
use super::figure::Figure;
use super::layout::{Content, Layout};
use super::raster::Raster;
use super::scale_bar::draw_scale_bar;
use super::view::View;

/// Pixels a picture unit in embedded rasters: 288 an inch, which journals ask for.
pub(crate) const DENSITY: f64 = 3.0;
/// Around everything.
pub(crate) const MARGIN: f64 = 16.0;
/// Height of a panel's name.
const NAME: f64 = 20.0;
/// Room for direction letters.
pub(crate) const LETTER: f64 = 18.0;
/// Reach of the axes of an oblique view.
const TRIAD: f64 = 18.0;

/// Title, caption and colours of a picture.
pub(crate) struct Frame<'a> {
    pub(crate) title: &'a str,
    pub(crate) caption: &'a str,
    pub(crate) bar: ColorBar<'a>,
}

impl Frame<'_> {
    /// A figure with one panel a prospect, drawn by `render`.
    pub(crate) fn compose(
        &self,
        prospects: &[Prospect],
        render: impl Fn(&Camera) -> Raster,
    ) -> Result<Figure, PictureError> {
        let contents: Vec<Content> = prospects.iter().map(content).collect();
        let layout = Layout::best(&contents, 1..=contents.len());
        let [width, height] = layout.size;
        let bar_left = MARGIN + width + 22.0;
        let total = bar_left + self.bar.width() + MARGIN;
        let mut canvas = Canvas::default();
        let top = title(&mut canvas, self.title, total);
        for (prospect, [x, y, width, height]) in prospects.iter().zip(&layout.panels) {
            let place = [MARGIN + x, top + y + NAME, *width, height - NAME];
            draw_panel(&mut canvas, prospect, place, layout.units_per_mm, &render)?;
        }
        let bar_height = height.clamp(170.0, 330.0);
        let bar_top = top + (0.5 * (height - bar_height)).max(0.0);
        self.bar.draw(&mut canvas, [bar_left, bar_top], bar_height)?;
        let bottom = top + height.max(bar_height);
        if !prospects.iter().all(is_empty) {
            draw_scale_bar(
                &mut canvas,
                [MARGIN + LETTER, bottom + 16.0],
                width.min(420.0),
                1.0 / layout.units_per_mm,
            );
        }
        let bottom = caption(&mut canvas, self.caption, bottom + 28.0, total);
        Ok(canvas.finish([total, bottom + MARGIN], self.title))
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

fn is_empty(prospect: &Prospect) -> bool {
    prospect.extent == [0.0; 2]
}

/// Room for letters around the object, or for axes below it.
fn content(prospect: &Prospect) -> Content {
    let below = if prospect.view.letters().is_some() { LETTER } else { 2.0 * TRIAD };
    Content { extent: prospect.extent, rim: [2.0 * LETTER, NAME + LETTER + below] }
}

/// Picture, name and directions of a view; `place` is what lies below the name.
fn draw_panel(
    canvas: &mut Canvas,
    prospect: &Prospect,
    place: [f64; 4],
    units_per_mm: f64,
    render: impl Fn(&Camera) -> Raster,
) -> Result<(), PictureError> {
    let [x, y, width, height] = place;
    let name = prospect.view.name();
    canvas.text(
        [x + 0.5 * width, y - 6.0],
        LABEL,
        INK,
        Anchor::Middle,
        &(name[..1].to_uppercase() + &name[1..]),
    );
    if is_empty(prospect) {
        let middle = [x + 0.5 * width, y + 0.5 * height];
        canvas.centered_text(middle, SMALL, FAINT, Anchor::Middle, "no surface");
        return Ok(());
    }
    let letters = prospect.view.letters().map(|l| l.map(String::from));
    // Axes take room below the object, which moves up.
    let object_height = if letters.is_some() { height } else { height + LETTER - 2.0 * TRIAD };
    canvas.image(place, &render(&camera(prospect, place, object_height, units_per_mm)))?;
    match letters {
        Some(letters) => {
            let middle = [x + 0.5 * width, y + 0.5 * height];
            draw_letters(canvas, &letters, middle, prospect.extent.map(|mm| mm * units_per_mm));
        }
        None => triad(canvas, prospect.view, [x + TRIAD + 12.0, y + height - TRIAD]),
    }
    Ok(())
}

/// A camera whose picture has the object in the middle of the upper `object_height`.
fn camera(
    prospect: &Prospect,
    [.., width, height]: [f64; 4],
    object_height: f64,
    units_per_mm: f64,
) -> Camera {
    let basis = prospect.view.basis();
    let lowered = 0.5 * (height - object_height) / units_per_mm;
    Camera {
        basis,
        center: std::array::from_fn(|i| prospect.center[i] - lowered * basis.up[i]),
        mm_per_pixel: 1.0 / (units_per_mm * DENSITY),
        size: [width, height].map(|v| libm::round(v * DENSITY).max(1.0) as usize),
    }
}

/// Letters at the left, right, bottom and top of what has a middle and a size.
pub(crate) fn draw_letters(canvas: &mut Canvas, letters: &[String; 4], [x, y]: [f64; 2], size: [f64; 2]) {
    let [across, down] = size.map(|s| 0.5 * (s + LETTER));
    let places = [[x - across, y], [x + across, y], [x, y + down], [x, y - down]];
    for (place, letter) in places.into_iter().zip(letters) {
        canvas.centered_text(place, SMALL, FAINT, Anchor::Middle, letter);
    }
}

/// The world's axes, for a view along none of them.
fn triad(canvas: &mut Canvas, view: View, [x, y]: [f64; 2]) {
    for (axis, letter) in ["R", "A", "S"].into_iter().enumerate() {
        let mut direction = [0.0; 3];
        direction[axis] = 1.0;
        let [right, up, _] = view.basis().coordinates(direction);
        let at = |reach: f64| [x + reach * right, y - reach * up];
        canvas.line([x, y], at(TRIAD), FAINT, 1.2);
        canvas.centered_text(at(TRIAD + 8.0), SMALL - 1.0, FAINT, Anchor::Middle, letter);
    }
}
