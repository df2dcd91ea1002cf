//! The paper's workflow on a vertebra, and its table of parameters.

use crate::Experiment;
use crate::bones::{phantom_mask, surface_picture};
use crate::desk::Desk;
use crate::sweeps::SUBJECT;
use crate::table::Table;
use anyhow::{Context, Result};
use surfometry::Measurement;
use surfometry::pictures::{PictureKind, PictureStyle, View, picture};
use surfometry::surface::LocalQuantity;

pub(crate) const EXPERIMENT: Experiment =
    Experiment { name: "workflow", title: "The method on a vertebra", run };

fn run(desk: &mut Desk) -> Result<()> {
    let mask = phantom_mask(SUBJECT[1].1)?;
    let object = Measurement::paper().prepare(&mask)?;
    let (measured, surface) = (object.measure(), object.surface());
    let style = PictureStyle { title: "mask and embedding".to_owned(), ..PictureStyle::default() };
    let volume = PictureStyle { title: "volume rendering, H".to_owned(), limit: Some(0.2), ..style.clone() };
    let figures = [
        ("slices", picture(PictureKind::Slices, &object, &surface, &style)?),
        ("volume", picture(PictureKind::Volume, &object, &surface, &volume)?),
        (
            "mean-curvature",
            surface_picture(
                &object,
                "H at phi = 0",
                (LocalQuantity::MeanCurvature, Some(0.2)),
                View::Oblique,
            )?,
        ),
        (
            "gaussian-curvature",
            surface_picture(
                &object,
                "K at phi = 0",
                (LocalQuantity::GaussianCurvature, Some(0.02)),
                View::Oblique,
            )?,
        ),
    ];
    desk.figures(
        &figures.map(|(name, figure)| (name.to_owned(), figure)),
        "From the mask to phi = T - G * I, and to H and K in the band and on the surface.",
    )?;
    let values = measured.blurred.values;
    let number = |desk: &mut Desk, name: &str, value: Option<f64>| -> Result<f64> {
        Ok(desk.number(name, value.context("a number")?))
    };
    let v = number(desk, "V", values.volume_mm3)?;
    let a = number(desk, "A", values.surface_area_mm2)?;
    let h = number(desk, "H", values.average_mean_curvature_per_mm)?;
    let chi = number(desk, "chi", values.euler_characteristic)?;
    let epsilon = desk.number("epsilon", measured.parameters.epsilon);
    desk.say(&format!(
        "Summed over the band, with the paper's settings: V = {v:.0} mm³, A = {a:.0} mm², ⟨H⟩ = {h:.4} / mm, χ = {chi:.2}. The paper's table of parameters, with what is taken here:"
    ));
    let mut table = Table::new("parameter | paper | here, `--paper` | our default");
    table.row(&format!(
        "ε, half-width of the band in phi | erf(t / (2 √2 σ)) / 2 | {epsilon:.4} | the same formula"
    ));
    table.row("σ, the blur (mm) | below the structure's thickness; 2.0 in the validation | 2.0 | 2 × the mean spacing");
    table.row("t, thickness of the band (mm) | above the voxel's edge; 2.5 in the validation | 2.5 | 2.5 × the largest spacing");
    table.row("T, level | 0.5 | 0.5 | 0.5");
    desk.say(&table.text());
    Ok(())
}
