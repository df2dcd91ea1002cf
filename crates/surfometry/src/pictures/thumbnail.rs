//! A surface as a small picture.

use super::camera::{Camera, Prospect};
use super::raster::{Background, Raster};
use super::surface_rendering::{ColoredSurface, render_surface};
use super::view::View;

/// Share of the picture's side that the object takes.
const FILLED: f64 = 0.94;

/// The whole of a surface in a square, from in front, the left and above.
pub(crate) fn thumbnail(surface: &ColoredSurface, side: usize) -> Raster {
    let prospect = Prospect::of(View::Oblique.into(), surface.mesh.vertices.iter().copied());
    let [width, height] = prospect.extent;
    let camera = Camera {
        basis: View::Oblique.basis(),
        center: prospect.center,
        mm_per_pixel: width.max(height).max(f64::MIN_POSITIVE) / (FILLED * side as f64),
        size: [side; 2],
    };
    render_surface(surface, &camera, Background::White)
}
