//! Slices through a measured object.

use super::contour::contour;
use super::image_slices::ImageSlices;
use super::object_pictures::{PictureStyle, how_mapped};
use super::{ColorScale, Figure, PictureError, Quantity, ScaleKind, Slice, SlicePicture};
use crate::Choice;
use crate::measurement::{Object, VoxelQuantity};
use crate::surface::{LocalQuantity, Surface};
use crate::tiling::IndexBox;

/// A slice of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlicePlane {
    /// The image axis that it lies across: 0 for x, the fastest, 1, 2.
    pub axis: usize,
    /// Index of its voxels on that axis; `None` for the slice at the object's centroid.
    pub index: Option<i64>,
}

/// The object's box with some of the background around it.
pub(crate) fn surroundings(object: &Object) -> IndexBox {
    let spacing = object.grid().spacing().mm();
    let margin = object.parameters().sigma_mm.map_or(object.parameters().thickness_mm, |s| 2.5 * s);
    let halo = spacing.map(|h| (margin / h).ceil().max(3.0) as i64);
    object.available(&object.mask().bounds().grown(halo))
}

pub(crate) fn slices_figure(
    object: &Object,
    surface: &Surface,
    style: &PictureStyle,
) -> Result<Figure, PictureError> {
    let axes = object.grid().affine().nearest_axes();
    let standard = [2, 1, 0].map(|world| axes.iter().position(|&a| a == world).unwrap_or(world));
    let standard = standard.map(|axis| SlicePlane { axis, index: None });
    let planes = if style.slices.is_empty() { &standard[..] } else { &style.slices[..] };
    let shown = style.on_slices;
    let slices: Vec<Slice> = planes
        .iter()
        .map(|plane| slice(object, *plane, shown))
        .collect::<Result<Vec<_>, _>>()?
        .into_iter()
        .flatten()
        .collect();
    let name = shown_name(shown);
    SlicePicture {
        slices: &slices,
        quantity: Quantity { name, unit: shown.unit() },
        scale: scale(object, surface, style),
        title: &style.title,
        caption: &style.caption_of(&how_mapped(object), "φ < 0 inside."),
        width: style.width,
    }
    .figure()
}

fn shown_name(quantity: VoxelQuantity) -> &'static str {
    match quantity {
        VoxelQuantity::MeanCurvature => LocalQuantity::MeanCurvature.meaning(),
        VoxelQuantity::GaussianCurvature => LocalQuantity::GaussianCurvature.meaning(),
        VoxelQuantity::Delta => "Area a volume",
        VoxelQuantity::Phi => "Embedding φ",
        VoxelQuantity::Band => "Band",
    }
}

/// Colours of what slices show: of the embedding as far as the band or the level reaches, of curvature those of
/// the surface.
fn scale(object: &Object, surface: &Surface, style: &PictureStyle) -> ColorScale {
    let of_surface =
        |quantity: LocalQuantity| PictureStyle { quantity, ..style.clone() }.color_scale(surface);
    let up_to = |kind: ScaleKind, limit: f64| {
        let scale = ColorScale::new(kind, limit);
        style.palette.map_or(scale, |palette| scale.in_colors(palette))
    };
    match style.on_slices {
        VoxelQuantity::MeanCurvature => of_surface(LocalQuantity::MeanCurvature),
        VoxelQuantity::GaussianCurvature => of_surface(LocalQuantity::GaussianCurvature),
        VoxelQuantity::Phi => {
            let reach = object.delta().half_width().max(object.parameters().level.unwrap_or_default());
            up_to(ScaleKind::Diverging, reach)
        }
        // Its profile's largest value a millimetre of the band.
        VoxelQuantity::Delta => up_to(ScaleKind::Sequential, 2.0 / object.parameters().thickness_mm),
        VoxelQuantity::Band => up_to(ScaleKind::Sequential, 1.0),
    }
}

/// An image slice, named after the world axis that it lies most nearly across; `None` where the blur left
/// nothing.
fn slice(object: &Object, plane: SlicePlane, shown: VoxelQuantity) -> Result<Option<Slice>, PictureError> {
    let (across, within) = (plane.axis, surroundings(object));
    let world = object.grid().affine().nearest_axes()[across];
    let slices = ImageSlices::across(object.grid(), world, within);
    let index = plane.index.unwrap_or_else(|| centroid_slice(object, across));
    let (first, last) = (within.lower[across], within.upper[across] - 1);
    if !(first..=last).contains(&index) {
        return Err(PictureError::NoSlice { axis: AXES[across], index, first, last });
    }
    let region = slices.region(index);
    let map = |quantity| object.voxel_map_on(quantity, &region, f32::NAN);
    let (Some(phi), Some(values)) = (map(VoxelQuantity::Phi), map(shown)) else { return Ok(None) };
    let (size, spacing) = (slices.size(), slices.spacing());
    let phi: Vec<f32> = slices.voxels(index).map(|voxel| phi.get(voxel)).collect();
    Ok(Some(Slice {
        name: format!("{}, voxel {} = {index}", slices.name, AXES[across]),
        letters: slices.letters.map(String::from),
        size,
        spacing,
        mask: slices.voxels(index).map(|voxel| object.mask().get(voxel)).collect(),
        contour: contour(&phi, size)
            .into_iter()
            .map(|ends| ends.map(|[u, v]| [u * spacing[0], v * spacing[1]]))
            .collect(),
        values: slices.voxels(index).map(|voxel| values.get(voxel)).collect(),
    }))
}

/// Names of the image's axes.
const AXES: [char; 3] = ['x', 'y', 'z'];

/// Of the slices across an axis that hold voxels of the object, the one nearest to its centroid.
fn centroid_slice(object: &Object, axis: usize) -> i64 {
    let (mask, bounds) = (object.mask(), object.mask().bounds());
    let first = bounds.lower[axis];
    let mut counts = vec![0u64; bounds.extent()[axis]];
    for (y, z) in bounds.rows() {
        for (from, to) in mask.runs(y, z) {
            match axis {
                0 => (from..to).for_each(|x| counts[(x - first) as usize] += 1),
                _ => counts[([y, z][axis - 1] - first) as usize] += (to - from) as u64,
            }
        }
    }
    let total: u64 = counts.iter().sum();
    let moment: f64 = counts.iter().enumerate().map(|(i, n)| i as f64 * *n as f64).sum();
    let centroid = moment / total.max(1) as f64;
    let held = counts.iter().enumerate().filter(|(_, n)| **n > 0).map(|(i, _)| i);
    let away = |i: &usize| (*i as f64 - centroid).abs();
    first + held.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or_default() as i64
}
