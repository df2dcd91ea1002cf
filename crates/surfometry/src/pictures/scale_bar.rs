//! The scale bar.

use super::canvas::{Anchor, Canvas, INK, SMALL};
use super::ticks::{round_down, short};

/// Draws a bar of a round length near a fifth of `width`, its left end at a position, and the length to its
/// right. Nothing where a pixel has no size.
pub(crate) fn draw_scale_bar(canvas: &mut Canvas, [x, y]: [f64; 2], width: f64, mm_per_unit: f64) {
    let wanted = 0.3 * width * mm_per_unit;
    if !(wanted.is_finite() && wanted > 0.0) {
        return;
    }
    let millimetres = round_down(wanted);
    let length = millimetres / mm_per_unit;
    canvas.rect([x, y - 1.5, length, 3.0], INK);
    canvas.centered_text(
        [x + length + 7.0, y],
        SMALL,
        INK,
        Anchor::Start,
        &format!("{} mm", short(millimetres)),
    );
}
