//! Pictures of a measured object.

use super::contour::contour;
use super::slice_plane::SlicePlane;
use super::ticks::significant;
use super::{
    ColorScale, Figure, HistogramPicture, HistogramSeries, PictureError, Quantity, ScaleKind, Slice,
    SlicePicture, SurfacePicture, View, VolumeRendering,
};
use crate::Choice;
use crate::choice::choices;
use crate::measurement::{EmbeddingKind, Object, VoxelQuantity};
use crate::surface::{LocalQuantity, Surface};
use crate::tiling::{Block, IndexBox};
use crate::volume::Affine;

/// What a picture of an object shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PictureKind {
    /// The surface, coloured by a quantity, from named views.
    #[default]
    Surface,
    /// Mask and embedding with the contour, in three slices.
    Slices,
    /// The quantity's distribution by area and by vertex.
    Histogram,
    /// The paper's volume rendering, coloured by H (or K, where that is the quantity).
    Volume,
}

choices!(PictureKind, "picture": {
    Surface = "surface": "the coloured surface, from the chosen views",
    Slices = "slices": "mask and embedding with the contour, in three slices",
    Histogram = "histogram": "the quantity's distribution",
    Volume = "volume": "the paper's volume rendering, from the chosen views",
});

/// How pictures of an object are made.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureStyle {
    /// What colours show.
    pub quantity: LocalQuantity,
    /// Largest magnitude on the colour scale; `None` takes a robust one from the surface.
    pub limit: Option<f64>,
    /// Where the viewer stands.
    pub views: Vec<View>,
    /// Above the picture.
    pub title: String,
}

impl Default for PictureStyle {
    /// H from one oblique view.
    fn default() -> Self {
        Self {
            quantity: LocalQuantity::default(),
            limit: None,
            views: vec![View::Oblique],
            title: String::new(),
        }
    }
}

/// The colours of a quantity on a surface.
pub fn color_scale(surface: &Surface, quantity: LocalQuantity, limit: Option<f64>) -> ColorScale {
    let kind = if quantity.is_signed() { ScaleKind::Diverging } else { ScaleKind::Sequential };
    match (limit, quantity) {
        (Some(limit), _) => ColorScale::new(kind, limit),
        (None, LocalQuantity::ShapeIndex) => ColorScale::new(kind, 1.0),
        (None, _) => {
            let values = surface.values(quantity).unwrap_or_default();
            ColorScale::robust(kind, &values, &surface.mesh.vertex_areas())
        }
    }
}

/// Draws one picture of an object and its surface.
///
/// # Errors
/// A quantity that is not defined for this embedding, or what drawing says.
pub fn picture(
    kind: PictureKind,
    object: &Object,
    surface: &Surface,
    style: &PictureStyle,
) -> Result<Figure, PictureError> {
    match kind {
        PictureKind::Surface => surface_figure(surface, style, &caption(object, sign(style.quantity))),
        PictureKind::Slices => slices_figure(object, style, &caption(object, "φ < 0 inside.")),
        PictureKind::Histogram => {
            let remark = format!("{} {OUTER_BINS}", sign(style.quantity));
            histogram_figure(surface, style, &caption(object, &remark))
        }
        PictureKind::Volume => volume_figure(object, surface, style),
    }
}

impl From<LocalQuantity> for Quantity<'static> {
    fn from(quantity: LocalQuantity) -> Self {
        Self { name: quantity.meaning(), unit: quantity.unit() }
    }
}

/// The convention without which a quantity's sign cannot be read; its words stay on one line.
fn sign(quantity: LocalQuantity) -> &'static str {
    match quantity {
        LocalQuantity::MeanCurvature | LocalQuantity::K1 | LocalQuantity::K2 => {
            "H\u{a0}>\u{a0}0 on a\u{a0}ball."
        }
        LocalQuantity::GaussianCurvature => "K\u{a0}<\u{a0}0 on a\u{a0}saddle.",
        LocalQuantity::ShapeIndex => "1 on a\u{a0}ball, 0 on a\u{a0}saddle, −1 in a\u{a0}hollow.",
        LocalQuantity::Curvedness => "1/R on a\u{a0}ball.",
        LocalQuantity::Displacement => "Negative where the blur moved the surface inward.",
        LocalQuantity::Distance => "Positive where the\u{a0}later surface lies outside.",
        LocalQuantity::MeanCurvatureChange => "Positive where the\u{a0}later surface bends outward more.",
    }
}

const OUTER_BINS: &str = "The outer bins hold all that lies beyond.";

/// How the surface was made, as a paper's figure legend would say, and what has to be known of the picture.
fn caption(object: &Object, remark: &str) -> String {
    let parameters = object.parameters();
    let of = |sigma: f64| significant(sigma, 4);
    let how = match (object.local_sigmas(), parameters.sigma_mm, parameters.level) {
        (Some([least, most]), ..) => format!(
            "Recovering embedding, sigma {} to {} mm by vertex: the original surface",
            of(least),
            of(most)
        ),
        (_, Some(sigma), _) if parameters.embedding == EmbeddingKind::Recovering => {
            format!("Recovering embedding, sigma {} mm: the original surface", of(sigma))
        }
        (_, Some(sigma), _) if parameters.embedding == EmbeddingKind::Corrected => {
            format!("Corrected embedding, sigma {} mm: the original surface", of(sigma))
        }
        (_, Some(sigma), Some(level)) => format!("Gaussian blur, sigma {} mm, level {level}", of(sigma)),
        _ => format!("{:?} embedding", parameters.embedding),
    };
    format!("{how}. {remark} surfometry {}", env!("CARGO_PKG_VERSION"))
}

fn values(surface: &Surface, quantity: LocalQuantity) -> Result<Vec<f64>, PictureError> {
    surface
        .values(quantity)
        .ok_or(PictureError::Undefined { quantity: quantity.meaning(), condition: quantity.condition() })
}

fn surface_figure(surface: &Surface, style: &PictureStyle, caption: &str) -> Result<Figure, PictureError> {
    let normals: Vec<[f64; 3]> = surface.vertices.iter().map(|v| v.normal).collect();
    SurfacePicture {
        mesh: &surface.mesh,
        values: &values(surface, style.quantity)?,
        normals: &normals,
        quantity: style.quantity.into(),
        scale: color_scale(surface, style.quantity, style.limit),
        views: &style.views,
        title: &style.title,
        caption,
    }
    .figure()
}

fn histogram_figure(surface: &Surface, style: &PictureStyle, caption: &str) -> Result<Figure, PictureError> {
    values(surface, style.quantity)?;
    let distribution = surface.distribution(style.quantity);
    let series = distribution.map_or_else(Vec::new, |d| {
        let one = |name, weights, moments: &crate::surface::Moments| HistogramSeries {
            name,
            weights,
            mean: Some(moments.mean),
            median: Some(moments.median()),
        };
        let h = &d.histogram;
        vec![one("by area", h.by_area.as_slice(), &d.by_area), one("by vertex", &h.by_vertex, &d.by_vertex)]
    });
    HistogramPicture {
        edges: distribution.map_or(&[], |d| &d.histogram.edges),
        series: &series,
        quantity: style.quantity.into(),
        scale: Some(color_scale(surface, style.quantity, style.limit)),
        title: &style.title,
        caption,
    }
    .figure()
}

/// The object's box with some of the background around it.
pub(crate) fn surroundings(object: &Object) -> IndexBox {
    let spacing = object.grid().spacing().mm();
    let margin = object.parameters().sigma_mm.map_or(object.parameters().thickness_mm, |s| 2.5 * s);
    let halo = spacing.map(|h| (margin / h).ceil().max(3.0) as i64);
    object.available(&object.mask().bounds().grown(halo))
}

fn slices_figure(object: &Object, style: &PictureStyle, caption: &str) -> Result<Figure, PictureError> {
    let slices: Vec<Slice> = [2, 1, 0].into_iter().filter_map(|world| slice(object, world)).collect();
    let reach = object.delta().half_width().max(object.parameters().level.unwrap_or_default());
    SlicePicture {
        slices: &slices,
        quantity: Quantity { name: "Embedding φ", unit: "" },
        scale: ColorScale::new(ScaleKind::Diverging, reach),
        title: &style.title,
        caption,
    }
    .figure()
}

/// The slice through the middle of the object's box, of those image slices that lie most nearly across a
/// world axis.
fn slice(object: &Object, world: usize) -> Option<Slice> {
    let plane = SlicePlane::across(object.grid(), world, surroundings(object));
    let bounds = object.mask().bounds();
    let middle = i64::midpoint(bounds.lower[plane.axis], bounds.upper[plane.axis] - 1);
    let phi = object.voxel_map(VoxelQuantity::Phi, &plane.region(middle))?;
    let (size, spacing) = (plane.size(), plane.spacing());
    let phi: Vec<f32> = plane.voxels(middle).map(|voxel| phi.get(voxel)).collect();
    Some(Slice {
        name: format!("{}, voxel {} = {middle}", plane.name, ['x', 'y', 'z'][plane.axis]),
        letters: plane.letters.map(String::from),
        size,
        spacing,
        mask: plane.voxels(middle).map(|voxel| object.mask().get(voxel)).collect(),
        contour: contour(&phi, size)
            .into_iter()
            .map(|ends| ends.map(|[u, v]| [u * spacing[0], v * spacing[1]]))
            .collect(),
        phi,
    })
}

fn volume_figure(object: &Object, surface: &Surface, style: &PictureStyle) -> Result<Figure, PictureError> {
    let (quantity, voxels) = match style.quantity {
        LocalQuantity::GaussianCurvature => (style.quantity, VoxelQuantity::GaussianCurvature),
        _ => (LocalQuantity::MeanCurvature, VoxelQuantity::MeanCurvature),
    };
    let region = surroundings(object);
    let map = |quantity| object.voxel_map(quantity, &region).unwrap_or_else(|| Block::filled(region, 0.0));
    let (phi, colors) = (map(VoxelQuantity::Phi), map(voxels));
    let affine = object.grid().affine();
    VolumeRendering {
        dimensions: region.extent(),
        affine: Affine { origin: affine.apply(region.lower.map(|l| l as f64)), ..*affine },
        phi: phi.values(),
        values: colors.values(),
        delta: *object.delta(),
        quantity: quantity.into(),
        scale: color_scale(surface, quantity, style.limit.filter(|_| quantity == style.quantity)),
        views: &style.views,
        title: &style.title,
        caption: &caption(object, sign(quantity)),
    }
    .figure()
}
