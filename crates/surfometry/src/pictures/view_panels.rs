//! Panels that show an object from a side.

use super::camera::{Camera, Prospect};
use super::canvas::{Anchor, Canvas, FAINT, LABEL, SMALL, text_width};
use super::error::PictureError;
use super::figure::Figure;
use super::frame::{Frame, LETTER, NAME, Place, draw_letters, name, pixels};
use super::layout::{Content, Layout};
use super::raster::Raster;
use super::viewpoint::Viewpoint;

/// Reach of the axes of an oblique view.
const TRIAD: f64 = 18.0;
/// Height of the axes with their letters, which stand below the object.
const AXES: f64 = 56.0;

/// What a panel shows, and its name.
pub(crate) struct Panel {
    pub(crate) name: String,
    pub(crate) prospect: Prospect,
}

impl Panel {
    /// Named by the viewpoint.
    pub(crate) fn of_view(prospect: Prospect) -> Self {
        Self { name: prospect.view.name(), prospect }
    }

    /// Room for letters around the object, or for axes below it.
    fn content(&self) -> Content {
        let below = if self.prospect.view.basis().letters().is_some() { LETTER } else { AXES };
        let rim = [2.0 * LETTER, NAME + LETTER + below];
        Content { extent: self.prospect.extent, rim, least_width: text_width(&self.name, LABEL) }
    }
}

/// A figure with panels, each drawn by `render`, which is told its number, with `density` pixels a picture
/// unit.
pub(crate) fn compose_views(
    frame: &Frame,
    panels: &[Panel],
    density: f64,
    render: impl Fn(usize, &Camera) -> Raster,
) -> Result<Figure, PictureError> {
    let contents: Vec<Content> = panels.iter().map(Panel::content).collect();
    let layout = Layout::best(&contents, 1..=contents.len(), frame.room());
    frame.compose(&contents, &layout, |canvas, i, place| {
        let prospect = &panels[i].prospect;
        draw_panel(canvas, &panels[i], place, |lift| render(i, &camera(prospect, place, density, lift)))
    })
}

/// Picture, name and directions of a view; `render` is told how far above the panel's middle the object is to
/// be.
fn draw_panel(
    canvas: &mut Canvas,
    panel: &Panel,
    place: Place,
    render: impl Fn(f64) -> Raster,
) -> Result<(), PictureError> {
    let Panel { name: text, prospect } = panel;
    name(canvas, place, text);
    if prospect.extent == [0.0; 2] {
        canvas.centered_text(place.middle(), SMALL, FAINT, Anchor::Middle, "no surface");
        return Ok(());
    }
    let letters = prospect.view.basis().letters().map(|l| l.map(String::from));
    // Axes take room below the object, which moves up.
    let lift = if letters.is_some() { 0.0 } else { 0.5 * (AXES - LETTER) };
    canvas.image(place.area, &render(lift))?;
    let [x, y, _, height] = place.area;
    match letters {
        Some(letters) => {
            draw_letters(canvas, &letters, place.middle(), prospect.extent.map(|mm| mm * place.units_per_mm));
        }
        None => triad(canvas, prospect.view, [x + TRIAD + 12.0, y + height - TRIAD]),
    }
    Ok(())
}

/// A camera whose picture has the object's middle `lift` units above its own.
fn camera(prospect: &Prospect, place: Place, density: f64, lift: f64) -> Camera {
    let basis = prospect.view.basis();
    let lowered = lift / place.units_per_mm;
    let [.., width, height] = place.area;
    Camera {
        basis,
        center: std::array::from_fn(|i| prospect.center[i] - lowered * basis.up[i]),
        mm_per_pixel: 1.0 / (place.units_per_mm * density),
        size: pixels([width, height], density),
    }
}

/// The world's axes, for a view along none of them.
fn triad(canvas: &mut Canvas, view: Viewpoint, [x, y]: [f64; 2]) {
    for (axis, letter) in ["R", "A", "S"].into_iter().enumerate() {
        let mut direction = [0.0; 3];
        direction[axis] = 1.0;
        let [right, up, _] = view.basis().coordinates(direction);
        let at = |reach: f64| [x + reach * right, y - reach * up];
        canvas.line([x, y], at(TRIAD), FAINT, 1.2);
        canvas.centered_text(at(TRIAD + 8.0), SMALL - 1.0, FAINT, Anchor::Middle, letter);
    }
}
