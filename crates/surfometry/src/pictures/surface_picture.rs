//! A surface, coloured by a quantity, from several sides.

use rayon::prelude::*;

use super::camera::Prospect;
use super::color_bar::ColorBar;
use super::color_scale::ColorScale;
use super::error::PictureError;
use super::figure::Figure;
use super::frame::{DENSITY, Frame};
use super::quantity::Quantity;
use super::raster::Background;
use super::surface_rendering::{ColoredSurface, render_surface};
use super::view::View;
use super::view_panels::compose_views;
use crate::surface::Mesh;

/// A surface with a value at every vertex, from several sides.
#[derive(Debug, Clone, Copy)]
pub struct SurfacePicture<'a> {
    /// The surface.
    pub mesh: &'a Mesh,
    /// A value at every vertex; NaN and missing ones are dark grey.
    pub values: &'a [f64],
    /// Outward normals at the vertices (RAS); without any (`&[]`) triangles are shaded flat.
    pub normals: &'a [[f64; 3]],
    /// What the values are.
    pub quantity: Quantity<'a>,
    /// Their colours.
    pub scale: ColorScale,
    /// One panel each.
    pub views: &'a [View],
    /// Above all; may be empty.
    pub title: &'a str,
    /// Below all; may be empty.
    pub caption: &'a str,
}

impl SurfacePicture<'_> {
    /// Draws it: all panels at one scale, with the views' names, directions, a scale bar and a colour bar.
    ///
    /// # Errors
    /// Only if the PNG encoder fails.
    pub fn figure(&self) -> Result<Figure, PictureError> {
        let mut colors = self.scale.colors(self.values);
        colors.resize(self.mesh.vertices.len(), self.scale.rgb(f64::NAN));
        let surface = ColoredSurface { mesh: self.mesh, colors: &colors, normals: self.normals };
        let prospects: Vec<Prospect> =
            self.views.par_iter().map(|v| Prospect::of(*v, self.mesh.vertices.iter().copied())).collect();
        let exceeded = self.scale.exceeded(self.values.iter().copied());
        let bar = ColorBar { scale: &self.scale, quantity: &self.quantity, exceeded };
        let frame = Frame { title: self.title, caption: self.caption, bar };
        compose_views(&frame, &prospects, DENSITY, |camera| {
            render_surface(&surface, camera, Background::White)
        })
    }
}
