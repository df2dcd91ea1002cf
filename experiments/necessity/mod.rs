//! "Necessity of the embedding technique": one vertebra by the distance transform and by a blur of 1 mm;
//! surfaces, slices, histograms.

use crate::Experiment;
use crate::bones::{paper_distance, phantom_mask};
use crate::desk::Desk;
use crate::table::Table;
use anyhow::{Context, Result};
use surfometry::Choice;
use surfometry::Measurement;
use surfometry::measurement::Object;
use surfometry::pictures::{PictureKind, PictureStyle, picture};
use surfometry::surface::{LocalQuantity, Surface};

pub(crate) const EXPERIMENT: Experiment =
    Experiment { name: "necessity", title: "Necessity of the embedding", run };

/// The paper's subject: 0.639 mm in plane, slices of 0.625 mm.
const SPEC: &str =
    "phantom:vertebra?individual=7&spacing=0.639,0.639,0.625&rotate=4,-3,6&shift=0.2,0.1,0.3&jitter=0.15";

fn run(desk: &mut Desk) -> Result<()> {
    let mask = phantom_mask(SPEC)?;
    desk.say(
        "One vertebra with the paper's spacing, 0.639 and 0.625 mm; distance transform against a blur of 1 mm. The paper finds curvature from the distance transform severely quantised; so is \
         ours, and the standard deviation of K over the vertices, which the exact bone's smoothness bounds, says by how much.",
    );
    let mut table = Table::new("embedding | sd of H (1/mm) | sd of K (1/mm²) | χ");
    for (name, title, measurement) in [
        ("distance", "Distance transform", paper_distance()),
        ("blur", "Blur, sigma 1 mm", Measurement::paper().sigma_mm(1.0)),
    ] {
        let object = measurement.prepare(&mask)?;
        let surface = object.surface();
        let mut spread = |quantity: LocalQuantity| {
            let moments = surface.distribution(quantity).context("a surface")?.by_vertex;
            let value = moments.standard_deviation;
            anyhow::Ok(desk.number(format!("{name}.sd_{}", quantity.word()), value))
        };
        let (h, k) = (spread(LocalQuantity::MeanCurvature)?, spread(LocalQuantity::GaussianCurvature)?);
        let chi = object.measure().blurred.euler_characteristic.unwrap_or(f64::NAN);
        desk.number(format!("{name}.chi"), chi);
        table.row(&format!("{title} | {h:.3} | {k:.4} | {chi:.2}"));
        pictures(desk, &object, &surface, [name, title])?;
    }
    desk.say(&table.text());
    Ok(())
}

fn pictures(desk: &mut Desk, object: &Object, surface: &Surface, [name, title]: [&str; 2]) -> Result<()> {
    let mut figures = Vec::new();
    for (quantity, limit) in [(LocalQuantity::MeanCurvature, 0.3), (LocalQuantity::GaussianCurvature, 0.05)] {
        for kind in [PictureKind::Surface, PictureKind::Histogram] {
            let style = PictureStyle {
                quantity,
                limit: Some(limit),
                title: title.to_owned(),
                ..PictureStyle::default()
            };
            let figure = picture(kind, object, surface, &style)?;
            figures.push((format!("{name}-{}-{}", kind.word(), quantity.word()), figure));
        }
    }
    desk.figures(&figures, &format!("{title}: H and K on the surface, and their distributions."))?;
    let style = PictureStyle { title: title.to_owned(), ..PictureStyle::default() };
    let slices = picture(PictureKind::Slices, object, surface, &style)?;
    desk.figure(&format!("{name}-slices"), &slices, &format!("{title}: the embedding in slices."))
}
