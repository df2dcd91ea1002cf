//! What a report shows of one object.

use super::{MOST_TRIANGLES, Scene};
use crate::measurement::Object;
use crate::pictures::{LineChart, PictureError, PictureKind, PictureStyle, View, Viewpoint, picture};
use crate::runs::{InputObject, SurfaceRecord, sweep_panels};
use crate::surface::{LocalQuantity, Surface};
use crate::volume::hexadecimal;
use serde::Serialize;

/// One object's section.
#[derive(Debug, Clone, Serialize)]
pub struct ObjectReport {
    /// Heading.
    pub title: String,
    /// The object's colour in its file, as `#rrggbb`.
    pub colour: Option<String>,
    /// All numbers.
    pub result: SurfaceRecord,
    /// The surface to turn; `None` where it has none or is too large.
    pub scene: Option<Scene>,
    /// Why there is no scene.
    pub scene_note: Option<String>,
    /// The surface from six sides, coloured by H, as SVG.
    pub views: Option<String>,
    /// Distributions, as SVG.
    pub histograms: Vec<String>,
    /// Mask and embedding, as SVG.
    pub slices: String,
    /// V, A, M and chi over a range of sigma, as SVG; `None` without a blur.
    pub plateau: Option<String>,
}

/// Quantities whose distributions are drawn.
const DRAWN: [LocalQuantity; 4] = [
    LocalQuantity::MeanCurvature,
    LocalQuantity::GaussianCurvature,
    LocalQuantity::ShapeIndex,
    LocalQuantity::Curvedness,
];

const VIEWS: [View; 6] =
    [View::Anterior, View::Posterior, View::Left, View::Right, View::Superior, View::Inferior];

impl ObjectReport {
    /// Triangles of its surface.
    pub fn triangles(&self) -> Option<u64> {
        self.result.record.measured.mesh.triangles
    }

    /// Measures and draws an object; `room` is how many triangles the page can still take.
    ///
    /// # Errors
    /// What drawing says.
    pub fn of(source: &InputObject, room: usize) -> Result<Self, PictureError> {
        let surface = source.surface();
        let scene = Scene::of(surface, room);
        let draw = |kind, quantity| {
            let views = VIEWS.map(Viewpoint::from).to_vec();
            let style = PictureStyle { quantity, views, ..PictureStyle::default() };
            Ok::<_, PictureError>(picture(kind, source.local(), surface, &style)?.svg().to_owned())
        };
        let shown: &[LocalQuantity] = if surface.is_empty() { &[] } else { &DRAWN };
        Ok(Self {
            title: source.title(),
            colour: source.colour.map(hexadecimal),
            result: SurfaceRecord::new(source.record(), surface),
            scene_note: scene.is_none().then(|| why_no_scene(surface)),
            scene,
            views: (!surface.is_empty())
                .then(|| draw(PictureKind::Surface, LocalQuantity::MeanCurvature))
                .transpose()?,
            histograms: shown.iter().map(|&q| draw(PictureKind::Histogram, q)).collect::<Result<_, _>>()?,
            slices: draw(PictureKind::Slices, LocalQuantity::MeanCurvature)?,
            plateau: plateau(&source.object),
        })
    }
}

/// What depends on the blur: numbers at half to twice the sigma in use.
fn plateau(object: &Object) -> Option<String> {
    let sigma = object.parameters().sigma_mm?;
    let sigmas: Vec<f64> = (-4..=4).map(|n| sigma * libm::exp2(f64::from(n) / 4.0)).collect();
    let measured = object.measure_at(&sigmas);
    let values: Vec<f64> = measured.iter().filter_map(|m| m.parameters.sigma_mm).collect();
    let chart = LineChart {
        along: "sigma (mm)",
        values: &values,
        marks: &[],
        log: true,
        panels: &sweep_panels(&measured.iter().collect::<Vec<_>>()),
        title: "",
        caption: "",
    };
    Some(chart.figure().svg().to_owned())
}

fn why_no_scene(surface: &Surface) -> String {
    if surface.is_empty() {
        return "Nothing is left inside the level set at this sigma and level, so there is no surface."
            .to_owned();
    }
    format!(
        "A page can turn {MOST_TRIANGLES} triangles, and there is no room left for the {} of this surface: write it with `surfometry \
         map -o surface.vtp` and open it in ParaView or 3D Slicer.",
        surface.mesh.triangles.len()
    )
}
