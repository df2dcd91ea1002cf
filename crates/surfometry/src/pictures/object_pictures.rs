//! Pictures of a measured object.

use super::object_slices::{slices_figure, surroundings};
use super::ticks::significant;
use super::{
    ColorScale, Figure, HistogramPicture, HistogramSeries, Palette, PictureError, Quantity, ScaleKind,
    SceneSurface, SlicePlane, SurfacePicture, View, Viewpoint, VolumeRendering,
};
use crate::Choice;
use crate::choice::choices;
use crate::measurement::{EmbeddingKind, Object, VoxelQuantity};
use crate::surface::{LocalQuantity, Surface};
use crate::tiling::Block;
use crate::volume::Affine;

/// What a picture of an object shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PictureKind {
    /// The surface, coloured by a quantity, from named views.
    #[default]
    Surface,
    /// Mask and embedding, or another quantity, with the contour, in slices.
    Slices,
    /// The quantity's distribution by area and by vertex.
    Histogram,
    /// The paper's volume rendering, coloured by H (or K, where that is the quantity).
    Volume,
}

choices!(PictureKind, "picture": {
    Surface = "surface": "the coloured surface, from the chosen views",
    Slices = "slices": "mask and embedding with the contour, in three slices or those of --slice",
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
    /// Both ends of the colour scale, the lower first, in the place of a limit.
    pub range: Option<[f64; 2]>,
    /// The colours; `None` takes those that suit the quantity.
    pub palette: Option<Palette>,
    /// Where the viewer stands.
    pub views: Vec<Viewpoint>,
    /// Which slices are shown; none stands for the three through the object's centroid.
    pub slices: Vec<SlicePlane>,
    /// What colours show on slices.
    pub on_slices: VoxelQuantity,
    /// Above the picture.
    pub title: String,
    /// Below it; `None` says how the surface was made.
    pub caption: Option<String>,
    /// Width of the picture in CSS pixels, of which an inch has 96; `None` where it follows from what is shown.
    pub width: Option<f64>,
}

impl Default for PictureStyle {
    /// H from one oblique view.
    fn default() -> Self {
        Self {
            quantity: LocalQuantity::default(),
            limit: None,
            range: None,
            palette: None,
            views: vec![View::Oblique.into()],
            slices: Vec::new(),
            on_slices: VoxelQuantity::Phi,
            title: String::new(),
            caption: None,
            width: None,
        }
    }
}

impl PictureStyle {
    /// The colours of a surface.
    pub fn color_scale(&self, surface: &Surface) -> ColorScale {
        self.scale(|| (surface.values(self.quantity).unwrap_or_default(), surface.mesh.vertex_areas()))
    }

    /// The colours of the quantity, whose values and their weights are asked for where the limits follow from
    /// them. Between limits of one sign nothing diverges.
    pub(crate) fn scale(&self, values: impl FnOnce() -> (Vec<f64>, Vec<f64>)) -> ColorScale {
        let spans_zero = self.range.is_none_or(|[low, high]| low < 0.0 && high > 0.0);
        let diverges = self.quantity.is_signed() && spans_zero;
        let kind = if diverges { ScaleKind::Diverging } else { ScaleKind::Sequential };
        let scale = match (self.range, self.limit, self.quantity) {
            (Some(range), ..) => ColorScale::between(kind, range),
            (None, Some(limit), _) => ColorScale::new(kind, limit),
            (None, None, LocalQuantity::ShapeIndex) => ColorScale::new(kind, 1.0),
            (None, None, _) => {
                let (values, weights) = values();
                ColorScale::robust(kind, &values, &weights)
            }
        };
        self.palette.map_or(scale, |palette| scale.in_colors(palette))
    }

    /// The quantity at a surface's vertices.
    pub(crate) fn values(&self, surface: &Surface) -> Result<Vec<f64>, PictureError> {
        let quantity = self.quantity;
        let undefined =
            PictureError::Undefined { quantity: quantity.meaning(), condition: quantity.condition() };
        surface.values(quantity).ok_or(undefined)
    }

    /// The words below a picture of the quantity, after how its surface was made.
    pub(crate) fn caption_with(&self, made: &str) -> String {
        self.caption_of(made, sign(self.quantity))
    }

    /// The words below a picture, with what has to be known of it.
    pub(crate) fn caption_of(&self, made: &str, remark: &str) -> String {
        self.caption.clone().unwrap_or_else(|| format!("{made} {remark} {PROGRAM}"))
    }
}

/// The colours of a quantity on a surface.
pub fn color_scale(surface: &Surface, quantity: LocalQuantity, limit: Option<f64>) -> ColorScale {
    PictureStyle { quantity, limit, ..PictureStyle::default() }.color_scale(surface)
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
    let made = how_mapped(object);
    match kind {
        PictureKind::Surface => {
            let remark = with_noise(surface, style.quantity);
            surface_figure(surface, style, &style.caption_of(&made, &remark))
        }
        PictureKind::Slices => slices_figure(object, surface, style),
        PictureKind::Histogram => {
            let remark = format!("{} {OUTER_BINS}", with_noise(surface, style.quantity));
            histogram_figure(surface, style, &style.caption_of(&made, &remark))
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
        _ => "One standard error.",
    }
}

/// The same, and how much of a change is noise.
fn with_noise(surface: &Surface, quantity: LocalQuantity) -> String {
    let change = surface.moments_of_change(quantity);
    let told = change.map(|change| match change.noise_rms.zip(change.share_beyond_noise) {
        Some((noise, share)) => format!(
            " Two masks of one object would differ by {}\u{a0}{} (rms); {:.0}\u{a0}% of the area differs by more than two standard errors, of one object about 5\u{a0}%.",
            significant(noise, 2),
            quantity.unit(),
            100.0 * share
        ),
        None => " How much of it is noise is not known at this scale.".to_owned(),
    });
    sign(quantity).to_owned() + &told.unwrap_or_default()
}

const OUTER_BINS: &str = "The outer bins hold all that lies beyond.";

/// What made a picture.
pub(crate) const PROGRAM: &str = concat!("surfometry ", env!("CARGO_PKG_VERSION"));

/// How the surface was made, as a paper's figure legend would say.
pub(crate) fn how_mapped(object: &Object) -> String {
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
    how + "."
}

fn surface_figure(surface: &Surface, style: &PictureStyle, caption: &str) -> Result<Figure, PictureError> {
    let normals: Vec<[f64; 3]> = surface.vertices.iter().map(|v| v.normal).collect();
    let values = style.values(surface)?;
    SurfacePicture {
        surfaces: &[SceneSurface { name: "", mesh: &surface.mesh, values: &values, normals: &normals }],
        quantity: style.quantity.into(),
        scale: style.color_scale(surface),
        views: &style.views,
        title: &style.title,
        caption,
        width: style.width,
    }
    .figure()
}

fn histogram_figure(surface: &Surface, style: &PictureStyle, caption: &str) -> Result<Figure, PictureError> {
    style.values(surface)?;
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
        scale: Some(style.color_scale(surface)),
        title: &style.title,
        caption,
        width: style.width,
    }
    .figure()
}

fn volume_figure(object: &Object, surface: &Surface, style: &PictureStyle) -> Result<Figure, PictureError> {
    let (quantity, voxels) = match style.quantity {
        LocalQuantity::GaussianCurvature => (style.quantity, VoxelQuantity::GaussianCurvature),
        _ => (LocalQuantity::MeanCurvature, VoxelQuantity::MeanCurvature),
    };
    // The limits that were asked for are those of another quantity.
    let style = if quantity == style.quantity {
        style.clone()
    } else {
        PictureStyle { quantity, limit: None, range: None, ..style.clone() }
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
        scale: style.color_scale(surface),
        views: &style.views,
        title: &style.title,
        caption: &style.caption_with(&how_mapped(object)),
        width: style.width,
    }
    .figure()
}
