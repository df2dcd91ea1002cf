//! The surface as the measurement sees it: a smeared layer, not triangles.

use rayon::prelude::*;

use super::camera::{Camera, Prospect};
use super::color_bar::ColorBar;
use super::color_scale::ColorScale;
use super::error::PictureError;
use super::figure::Figure;
use super::frame::Frame;
use super::quantity::Quantity;
use super::raster::{Background, Raster};
use super::ray_marching::{Marcher, Medium};
use super::view_panels::{Panel, compose_views};
use super::viewpoint::Viewpoint;
use crate::integrals::SmearedDelta;
use crate::volume::Affine;

/// Rays a picture unit (192 an inch): the layer is smooth, so more would cost much and show little.
const DENSITY: f64 = 2.0;

/// The paper's volume rendering: parallel rays through the embedding, whose opacity is the smeared Heaviside
/// of -phi and whose colour is a quantity's.
///
/// Rays sample phi trilinearly at half the smallest spacing, from front to back; theta(-phi) is the opacity
/// of one smallest spacing. Shading follows the gradient of phi.
#[derive(Debug, Clone, Copy)]
pub struct VolumeRendering<'a> {
    /// Voxels of the block, x first.
    pub dimensions: [usize; 3],
    /// World position (RAS, mm) of the block's voxels, its first being (0, 0, 0).
    pub affine: Affine,
    /// The embedding, x fastest, negative inside. NaN counts as outside.
    pub phi: &'a [f32],
    /// The quantity at the same voxels; used where |phi| is below the half-width.
    pub values: &'a [f32],
    /// The smeared delta that was measured with.
    pub delta: SmearedDelta,
    /// What the values are.
    pub quantity: Quantity<'a>,
    /// Their colours: the transfer function.
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

impl VolumeRendering<'_> {
    /// Draws it, framed as a [`super::SurfacePicture`].
    ///
    /// # Errors
    /// Where there are not as many values as voxels, the affine is singular, or the PNG encoder fails.
    pub fn figure(&self) -> Result<Figure, PictureError> {
        let marcher = self.marcher()?;
        let outline = self.outline();
        let panel = |view: &Viewpoint| Panel::of_view(Prospect::of(*view, outline.iter().copied()));
        let panels: Vec<Panel> = self.views.par_iter().map(panel).collect();
        let exceeded = self.scale.exceeded(self.valid_values());
        let bar = ColorBar { scale: &self.scale, quantity: &self.quantity, exceeded };
        let frame = Frame { title: self.title, caption: self.caption, width: self.width, bar };
        compose_views(&frame, &panels, DENSITY, |_, camera| marcher.render(camera, Background::White))
    }

    /// The bare picture from a camera.
    ///
    /// # Errors
    /// As [`VolumeRendering::figure`].
    pub fn render(&self, camera: &Camera, background: Background) -> Result<Raster, PictureError> {
        Ok(self.marcher()?.render(camera, background))
    }

    fn marcher(&self) -> Result<Marcher<'_>, PictureError> {
        let expected = self.dimensions.iter().product();
        if let Some(found) = [self.phi.len(), self.values.len()].into_iter().find(|n| *n != expected) {
            return Err(PictureError::Values { expected, found });
        }
        let Self { dimensions, affine, phi, values, delta, scale, .. } = *self;
        Marcher::new(&Medium { dimensions, affine, phi, values, delta, scale })
            .ok_or(PictureError::SingularAffine)
    }

    fn valid_values(&self) -> impl Iterator<Item = f64> {
        let near = self.delta.half_width();
        let pairs = self.phi.iter().zip(self.values).filter(move |(phi, _)| f64::from(phi.abs()) < near);
        pairs.map(|(_, value)| f64::from(*value))
    }

    /// World positions of the first and the last voxel in each row that can be seen.
    fn outline(&self) -> Vec<[f64; 3]> {
        let [nx, ny, _] = self.dimensions;
        let seen = |phi: &f32| f64::from(*phi) < self.delta.half_width();
        let ends = |(row, phi): (usize, &[f32])| {
            let world = |x: usize| self.affine.apply([x, row % ny, row / ny].map(|i| i as f64));
            [phi.iter().position(seen).map(world), phi.iter().rposition(seen).map(world)]
        };
        self.phi.chunks_exact(nx.max(1)).enumerate().flat_map(ends).flatten().collect()
    }
}
