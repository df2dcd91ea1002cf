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
use surfometry::volume::{Grid, Mask};

pub(crate) const EXPERIMENT: Experiment = Experiment { name: "overview", title: "Surface overview", run };

fn run(desk: &mut Desk) -> Result<()> {
    let rows = read_rows(desk)?;
    let cohort = desk.cohort()?;
    desk.say(
        "The bones of median ⟨H⟩ by the paper's settings. The paper: the fovea is hollow, tips of transverse processes have the largest H, histograms have fat tails, the vertebra's H is skewed and the femur's H has \
         a spike at zero, its flat cut. Our femurs end in a rounded stump and have no fovea; one that the image cuts follows below.",
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
        if kind == KINDS[0] {
            cut_off(desk, &mask)?;
        }
    }
    Ok(())
}

/// Share of its length that the image cuts off.
const CUT: f64 = 0.3;
/// |H| below which a surface counts as flat, 1/mm.
const FLAT: f64 = 0.004;

/// A femur that the image cuts, closed by background as the paper closes it: the spike at H = 0.
fn cut_off(desk: &mut Desk, whole: &Mask) -> Result<()> {
    let grid = whole.grid();
    let [nx, ny, nz] = grid.dimensions();
    let bounds = whole.bounds();
    let first = bounds.lower[2] as usize + (CUT * bounds.extent()[2] as f64) as usize;
    let mut affine = *grid.affine();
    affine.origin = affine.apply([0.0, 0.0, first as f64]);
    let own = |[x, y, z]: [usize; 3]| [x as i64, y as i64, (z + first) as i64];
    let cut = Mask::from_predicate(Grid::new([nx, ny, nz - first], affine)?, |index| whole.get(own(index)));
    let mut shares = Vec::new();
    let mut figures = Vec::new();
    for (name, mask) in [("whole", whole), ("cut", &cut)] {
        let object = Measurement::paper().prepare(mask)?;
        let surface = object.surface();
        let curvatures = surface.vertices.iter().map(|v| v.curvature.mean_curvature);
        let flat = curvatures.filter(|h| h.abs() < FLAT).count();
        let share = 100.0 * flat as f64 / surface.vertices.len() as f64;
        shares.push(desk.number(format!("Femur.{name}.flat_vertices_percent"), share));
        if name == "cut" {
            let measured = object.measure();
            let cap = measured.voxels.cut_area_mm2;
            let area = measured.blurred.surface_area_mm2.context("a surface")?;
            shares.push(desk.number("Femur.cut.cap_percent", 100.0 * cap / area));
            for what in [PictureKind::Surface, PictureKind::Histogram] {
                let style = PictureStyle {
                    limit: Some(0.2),
                    title: "a femur that the image cuts".to_owned(),
                    ..PictureStyle::default()
                };
                figures.push((format!("cut-{}", what.word()), picture(what, &object, &surface, &style)?));
            }
        }
    }
    desk.say(&format!(
        "The same femur in an image that ends above the lowest {:.0} % of it, as the paper's scans end at the lesser trochanter; background beyond the edge closes it with a flat cap of {:.1} % of its \
         surface (flag `touches-border`). Of its vertices {:.1} % have |H| below {FLAT} / mm, {:.1} % before: the spike at zero that the paper shows.",
        100.0 * CUT, shares[2], shares[1], shares[0]
    ));
    desk.figures(
        &figures,
        "A femur that the image cuts: H on its surface, and its distribution with the spike of the cap.",
    )
}
