//! Surfaces, coloured by a quantity, from several sides.

use rayon::prelude::*;

use super::ambient_occlusion::openness;
use super::camera::Prospect;
use super::color_bar::ColorBar;
use super::color_scale::ColorScale;
use super::error::PictureError;
use super::figure::Figure;
use super::frame::{DENSITY, Frame};
use super::quantity::Quantity;
use super::raster::Background;
use super::surface_rendering::{ColoredSurface, render_surface};
use super::view_panels::{Panel, compose_views};
use super::viewpoint::Viewpoint;
use crate::surface::Mesh;

/// A surface with a value at every vertex.
#[derive(Debug, Clone, Copy)]
pub struct SceneSurface<'a> {
    /// Its name, for the panels; of one alone it is not told.
    pub name: &'a str,
    /// The surface.
    pub mesh: &'a Mesh,
    /// A value at every vertex; NaN and missing ones are dark grey.
    pub values: &'a [f64],
    /// Outward normals at the vertices (RAS); without any (`&[]`) triangles are shaded flat, and places that
    /// see little of the sky are not darker.
    pub normals: &'a [[f64; 3]],
}

/// Surfaces from several sides, on one scale of colours and of lengths.
#[derive(Debug, Clone, Copy)]
pub struct SurfacePicture<'a> {
    /// The surfaces: a panel each and view. What is to be seen together is one mesh.
    pub surfaces: &'a [SceneSurface<'a>],
    /// What the values are.
    pub quantity: Quantity<'a>,
    /// Their colours.
    pub scale: ColorScale,
    /// One panel each.
    pub views: &'a [Viewpoint],
    /// Above all; may be empty.
    pub title: &'a str,
    /// Below all; may be empty.
    pub caption: &'a str,
    /// Width of the figure in CSS pixels; `None` where it follows from what is in it.
    pub width: Option<f64>,
}

/// What is drawn of a surface, from all sides.
struct Painted<'a> {
    surface: &'a SceneSurface<'a>,
    colors: Vec<[u8; 3]>,
    openness: Vec<f32>,
}

impl SurfacePicture<'_> {
    /// Draws it: all panels at one scale, with their names, directions, a scale bar and a colour bar.
    ///
    /// # Errors
    /// Only if the PNG encoder fails.
    pub fn figure(&self) -> Result<Figure, PictureError> {
        let painted: Vec<Painted> = self.surfaces.iter().map(|surface| self.painted(surface)).collect();
        let panels: Vec<Panel> = self.surfaces.iter().flat_map(|surface| self.panels(surface)).collect();
        let values = self.surfaces.iter().flat_map(|surface| surface.values.iter().copied());
        let bar =
            ColorBar { scale: &self.scale, quantity: &self.quantity, exceeded: self.scale.exceeded(values) };
        let frame = Frame { title: self.title, caption: self.caption, width: self.width, bar };
        compose_views(&frame, &panels, DENSITY, |panel, camera| {
            let Painted { surface, colors, openness } = &painted[panel / self.views.len()];
            let SceneSurface { mesh, normals, .. } = *surface;
            render_surface(&ColoredSurface { mesh, colors, normals, openness }, camera, Background::White)
        })
    }

    fn painted<'s>(&self, surface: &'s SceneSurface<'s>) -> Painted<'s> {
        let mut colors = self.scale.colors(surface.values);
        colors.resize(surface.mesh.vertices.len(), self.scale.rgb(f64::NAN));
        Painted { surface, colors, openness: openness(surface.mesh, surface.normals) }
    }

    /// A panel a view. Of several surfaces each has its name.
    fn panels(&self, surface: &SceneSurface) -> Vec<Panel> {
        let panel = |view: &Viewpoint| {
            let panel = Panel::of_view(Prospect::of(*view, surface.mesh.vertices.iter().copied()));
            match (self.surfaces.len(), self.views.len()) {
                (1, _) => panel,
                (_, 1) => Panel { name: surface.name.to_owned(), ..panel },
                _ => Panel { name: format!("{}: {}", surface.name, panel.name), ..panel },
            }
        };
        self.views.par_iter().map(panel).collect()
    }
}
