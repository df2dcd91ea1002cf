//! What was measured with, in slices: the mask, the embedding and the contour between inside and outside.

use super::canvas::{Canvas, LABEL, RULE, text_width};
use super::color_bar::ColorBar;
use super::color_scale::ColorScale;
use super::error::PictureError;
use super::figure::Figure;
use super::frame::{DENSITY, Frame, LETTER, NAME, Place, draw_letters, name, pixels};
use super::layout::{Content, Layout};
use super::quantity::Quantity;
use super::raster::Raster;

/// Foreground and background of the mask.
const INSIDE: [u8; 3] = [176; 3];
const OUTSIDE: [u8; 3] = [246; 3];
/// The contour on the mask and on the embedding.
const ON_MASK: &str = "#c1121f";
const ON_EMBEDDING: &str = "#000000";

/// A plane of voxels: u runs to the right, v upward. What is seen depends only on what the caller puts in.
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    /// Name and place, such as `Axial, z = 12.0 mm`.
    pub name: String,
    /// Directions at the left, right, bottom and top, such as R, L, P, A; may be empty.
    pub letters: [String; 4],
    /// Voxels along u and v.
    pub size: [usize; 2],
    /// Spacing along u and v, mm.
    pub spacing: [f64; 2],
    /// The mask, u fastest.
    pub mask: Vec<bool>,
    /// The embedding or another quantity at the voxels' centres, u fastest; where it is NaN, the mask is shown.
    pub values: Vec<f32>,
    /// Segments of the contour; u and v of both ends in mm from the first voxel's centre.
    pub contour: Vec<[[f64; 2]; 2]>,
}

/// Slices, each as mask and as a quantity, with the contour on both. Voxels are drawn as they are, without
/// interpolation.
#[derive(Debug, Clone, Copy)]
pub struct SlicePicture<'a> {
    /// The slices: three orthogonal ones as a rule.
    pub slices: &'a [Slice],
    /// What the values are.
    pub quantity: Quantity<'a>,
    /// Its colours.
    pub scale: ColorScale,
    /// Above all; may be empty.
    pub title: &'a str,
    /// Below all; may be empty.
    pub caption: &'a str,
    /// Width of the figure in CSS pixels; `None` where it follows from what is in it.
    pub width: Option<f64>,
}

impl SlicePicture<'_> {
    /// Draws it: a slice's mask and embedding side by side or one above the other, whichever is larger; all
    /// at one scale.
    ///
    /// # Errors
    /// Only if the PNG encoder fails.
    pub fn figure(&self) -> Result<Figure, PictureError> {
        let count = self.slices.len();
        let beside = |i: usize| (i / 2, i.is_multiple_of(2));
        let below = |i: usize| (i % count, i < count);
        let [pairs, rows] = [self.contents(beside), self.contents(below)];
        let values = self.slices.iter().flat_map(|s| s.values.iter().map(|v| f64::from(*v)));
        let bar =
            ColorBar { scale: &self.scale, quantity: &self.quantity, exceeded: self.scale.exceeded(values) };
        let frame = Frame { title: self.title, caption: self.caption, width: self.width, bar };
        let (wide, tall) = (Layout::new(&pairs, 2, frame.room()), Layout::new(&rows, count, frame.room()));
        if wide.units_per_mm > tall.units_per_mm {
            frame.compose(&pairs, &wide, |canvas, i, place| self.draw(canvas, beside(i), place))
        } else {
            frame.compose(&rows, &tall, |canvas, i, place| self.draw(canvas, below(i), place))
        }
    }

    /// What the panels hold; `order` gives a panel's slice and whether it shows the mask.
    fn contents(&self, order: impl Fn(usize) -> (usize, bool)) -> Vec<Content> {
        let content = |i: usize| {
            let (number, is_mask) = order(i);
            let slice = &self.slices[number];
            let name = if is_mask { &slice.name } else { self.quantity.name };
            let rim = [2.0 * LETTER, NAME + 2.0 * LETTER];
            Content { extent: slice.extent(), rim, least_width: text_width(name, LABEL) }
        };
        (0..2 * self.slices.len()).map(content).collect()
    }

    fn draw(
        &self,
        canvas: &mut Canvas,
        (number, is_mask): (usize, bool),
        place: Place,
    ) -> Result<(), PictureError> {
        let slice = &self.slices[number];
        name(canvas, place, if is_mask { &slice.name } else { self.quantity.name });
        let [x, y] = place.middle();
        let [width, height] = slice.extent().map(|mm| mm * place.units_per_mm);
        if width * height > 0.0 {
            let [left, top] = [x - 0.5 * width, y - 0.5 * height];
            canvas.image(
                [left, top, width, height],
                &self.raster(slice, is_mask, pixels([width, height], DENSITY)),
            )?;
            canvas.outline([left, top, width, height], RULE, 0.8);
            let at = |[u, v]: [f64; 2]| {
                let [u, v] = [u + 0.5 * slice.spacing[0], v + 0.5 * slice.spacing[1]];
                [left + u * place.units_per_mm, top + height - v * place.units_per_mm]
            };
            let color = if is_mask { ON_MASK } else { ON_EMBEDDING };
            canvas.segments(slice.contour.iter().map(|ends| ends.map(at)), color, 1.1);
        }
        draw_letters(canvas, &slice.letters, [x, y], [width, height]);
        Ok(())
    }

    /// The voxel in which each pixel lies.
    fn raster(&self, slice: &Slice, is_mask: bool, pixels: [usize; 2]) -> Raster {
        let [nu, nv] = slice.size;
        Raster::from_colors(pixels, |[x, y]| {
            let u = (2 * x + 1) * nu / (2 * pixels[0]);
            let v = nv - 1 - (2 * y + 1) * nv / (2 * pixels[1]);
            let voxel = v * nu + u;
            let value = slice.values.get(voxel).map_or(f64::NAN, |v| f64::from(*v));
            match slice.mask.get(voxel) {
                _ if !is_mask && !value.is_nan() => self.scale.rgb(value),
                Some(true) => INSIDE,
                _ => OUTSIDE,
            }
        })
    }
}

impl Slice {
    /// Width and height of its voxels, mm; 0 where that is none.
    fn extent(&self) -> [f64; 2] {
        let extent: [f64; 2] = std::array::from_fn(|i| self.size[i] as f64 * self.spacing[i]);
        if extent.iter().all(|e| e.is_finite() && *e > 0.0) { extent } else { [0.0; 2] }
    }
}
