//! The paper's overview of surfaces: the femur and the vertebra of median average mean curvature, H and K on
//! them and their histograms.

use crate::Experiment;
use crate::bones::KINDS;
use crate::bones::median_of;
use crate::desk::Desk;
use crate::validation::{Row, read_rows};
use anyhow::{Context, Result};
use surfometry::Choice;
use surfometry::Measurement;
use surfometry::pictures::{PictureKind, PictureStyle, picture};
use surfometry::surface::LocalQuantity;

pub(crate) const EXPERIMENT: Experiment = Experiment { name: "overview", title: "Surface overview", run };

fn run(desk: &mut Desk) -> Result<()> {
    let rows = read_rows(desk)?;
    let cohort = desk.cohort()?;
    desk.say(
        "The bones of median ⟨H⟩ by the paper's settings. The paper: the fovea is hollow, tips of transverse processes have the largest H, histograms have fat tails, the vertebra's H is skewed and the femur's H has \
         a spike at zero, its flat cut. Our femurs are cut alike and have no fovea.",
    );
    for kind in KINDS {
        let of_kind: Vec<&Row> = rows.iter().filter(|r| r.kind == kind && r.method == "paper").collect();
        let median = median_of(of_kind, |r| r.average_mean_curvature);
        let bone = cohort.iter().find(|bone| bone.name == median.bone).context("a bone of the cohort")?;
        let mask = bone.mask()?;
        let object = Measurement::paper().prepare(&mask)?;
        let surface = object.surface();
        let mut figures = Vec::new();
        for (quantity, limit) in
            [(LocalQuantity::MeanCurvature, 0.2), (LocalQuantity::GaussianCurvature, 0.02)]
        {
            let moments = surface.distribution(quantity).context("a surface")?.by_area;
            desk.number(format!("{kind}.{}.skewness", quantity.word()), moments.skewness);
            desk.number(format!("{kind}.{}.excess_kurtosis", quantity.word()), moments.excess_kurtosis);
            for what in [PictureKind::Surface, PictureKind::Histogram] {
                let style = PictureStyle {
                    quantity,
                    limit: Some(limit),
                    title: bone.name.clone(),
                    ..PictureStyle::default()
                };
                let figure = picture(what, &object, &surface, &style)?;
                figures.push((format!("{kind}-{}-{}", what.word(), quantity.word()), figure));
            }
        }
        desk.figures(
            &figures,
            &format!("{kind} of median ⟨H⟩: H and K on its surface, and their distributions."),
        )?;
    }
    Ok(())
}
