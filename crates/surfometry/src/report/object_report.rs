//! What a report shows of one object.

use super::BlurSweep;
use super::display_mesh::DisplayMesh;
use super::page_share::PageShare;
use super::scene::{NamedSurface, scene};
use crate::measurement::{EmbeddingKind, MeasureError, Object};
use crate::pictures::{ColoredSurface, PictureError, color_scale, how_mapped, thumbnail};
use crate::runs::{InputObject, RunError, SurfaceRecord};
use crate::surface::{LocalQuantity, Mesh, Surface};
use crate::volume::hexadecimal;
use serde::Serialize;

/// One object's part of a page.
#[derive(Debug, Clone, Serialize)]
pub struct ObjectReport {
    /// Heading.
    pub title: String,
    /// The object's colour in its file, as `#rrggbb`.
    pub colour: Option<String>,
    /// All numbers.
    pub result: SurfaceRecord,
    /// How the surface that is shown was made, as a figure's caption says it.
    pub mapped: String,
    /// Triangles of the surface that is shown: of large ones it has fewer than the one that was measured.
    pub shown_triangles: usize,
    /// The surface, coloured by H, as the address of a PNG picture.
    pub thumbnail: Option<String>,
    /// Its numbers over a range of blurs, where the page has few objects.
    pub sweep: Option<BlurSweep>,
    /// Why there is no surface to turn.
    pub scene_note: Option<String>,
    /// What the viewer shows, packed; not part of the page's JSON.
    #[serde(skip)]
    pub scene: Option<String>,
}

const NO_SURFACE: &str =
    "Nothing is left inside the level set at this sigma and level, so there is no surface.";

impl ObjectReport {
    /// Measures and draws one of so many objects of a page.
    ///
    /// # Errors
    /// What measuring at the other side of the blur says, and drawing.
    pub fn of(source: &InputObject, objects: usize) -> Result<Self, RunError> {
        let share = PageShare { objects };
        let (object, surface) = (source.local(), source.surface());
        let other = other_side(source)?;
        let other_surface = other.as_ref().map(|other| (name_of(other), other.surface()));
        let other_surface = other_surface.as_ref().map(|&(name, ref surface)| NamedSurface { name, surface });
        let shown = NamedSurface { name: name_of(object), surface };
        let scene = scene(&source.object, &shown, other_surface.as_ref(), share)
            .map_err(|_| RunError::Unfit("a surface that cannot be packed"))?;
        let (scene, mesh) = scene.unzip();
        Ok(Self {
            title: source.title(),
            colour: source.colour.map(hexadecimal),
            mapped: how_mapped(object),
            result: SurfaceRecord::without_regions(source),
            shown_triangles: mesh.as_ref().map_or(0, |mesh| mesh.triangles.len()),
            thumbnail: mesh.map(|mesh| picture(surface, mesh, share.thumbnail())).transpose()?,
            sweep: share.looks_closely().then(|| BlurSweep::of(&source.object)).flatten(),
            scene_note: scene.is_none().then(|| NO_SURFACE.to_owned()),
            scene,
        })
    }
}

/// The object as it was segmented where the blurred one is shown, and the blurred one where that is.
fn other_side(source: &InputObject) -> Result<Option<Object>, MeasureError> {
    let measured = &source.object;
    let is_mapped_apart = !std::ptr::eq(source.local(), measured);
    if is_mapped_apart && measured.parameters().embedding == EmbeddingKind::Gaussian {
        return Ok(Some(measured.clone()));
    }
    source.local().counterpart()
}

/// Which surface an object's field has.
fn name_of(object: &Object) -> &'static str {
    match object.parameters().embedding {
        EmbeddingKind::Corrected | EmbeddingKind::Recovering => "original",
        kind if kind.is_blur() => "blurred",
        EmbeddingKind::Given => "given",
        _ => "embedded",
    }
}

/// A picture of a mesh of some of a surface's vertices.
fn picture(surface: &Surface, shown: DisplayMesh, side: usize) -> Result<String, PictureError> {
    let vertices = || shown.vertices.iter().map(|&v| v as usize);
    let quantity = LocalQuantity::MeanCurvature;
    let scale = color_scale(surface, quantity, None);
    let values: Vec<f64> = vertices().filter_map(|v| quantity.at(&surface.vertices[v])).collect();
    let mesh =
        Mesh { vertices: vertices().map(|v| surface.mesh.vertices[v]).collect(), triangles: shown.triangles };
    let normals: Vec<[f64; 3]> =
        shown.vertices.iter().map(|&v| surface.vertices[v as usize].normal).collect();
    let colored =
        ColoredSurface { mesh: &mesh, colors: &scale.colors(&values), normals: &normals, openness: &[] };
    thumbnail(&colored, side).to_data_uri()
}
