//! The paper's figure of its data: the femur and the vertebra of median volume, three slices and the surface.

use crate::Experiment;
use crate::bones::{Bone, KINDS, median_of, surface_picture};
use crate::desk::Desk;
use crate::table::Table;
use anyhow::Result;
use surfometry::Measurement;
use surfometry::pictures::{PictureKind, PictureStyle, View, picture};
use surfometry::statistics::Spread;
use surfometry::surface::{LocalQuantity, Surface};
use surfometry::volume::Grid;

pub(crate) const EXPERIMENT: Experiment = Experiment { name: "dataset", title: "The data", run };

/// Mean and standard deviation of V in the paper's table, mm^3.
const PAPER: [(f64, f64); 2] = [(160_513.90, 45_992.36), (67_009.42, 12_961.63)];

fn run(desk: &mut Desk) -> Result<()> {
    let cohort = desk.cohort()?;
    desk.say(
        "The paper has 50 clinical CT scans, from which a right proximal femur and a fourth lumbar vertebra were drawn by hand. They are not public. Ours is a cohort that anyone can make: \
         `surfometry cohort` writes 50 and 50 bones of different individuals, smooth unions of simple parts with the paper's spacings (0.58 to 0.98 mm in plane, slices of 0.62 to 1 mm), poses of a \
         few degrees, slices shifted by 0.15 mm against each other as hand-drawn contours are, and two vertebrae with a second hole. Their exact integrals are known. They are not anatomy: sizes, \
         curvatures and thicknesses are those of bones, fine detail is missing.",
    );
    let mut table = Table::new("bones | V, ours (mm³) | V, paper (mm³)");
    for (kind, (mean, deviation)) in KINDS.into_iter().zip(PAPER) {
        let volumes: Vec<f64> = cohort.iter().filter(|b| b.kind() == kind).map(|b| b.truth.volume).collect();
        let spread = Spread::of(&volumes);
        let our_mean = desk.number(format!("{kind}.volume_mean"), spread.mean);
        let ours = desk.number(format!("{kind}.volume_deviation"), spread.deviation);
        table.row(&format!("{kind} | {our_mean:.0} ± {ours:.0} | {mean:.0} ± {deviation:.0}"));
    }
    desk.say(&table.text());
    let described = spacings(desk, &cohort)?;
    desk.say(&described);
    for kind in KINDS {
        let median =
            median_of(cohort.iter().filter(|b| b.kind() == kind).collect::<Vec<&Bone>>(), |b| b.truth.volume);
        let mask = median.mask()?;
        let object = Measurement::paper().prepare(&mask)?;
        let style = PictureStyle { title: median.name.clone(), ..PictureStyle::default() };
        let slices = picture(PictureKind::Slices, &object, &Surface::default(), &style)?;
        let shown = (LocalQuantity::MeanCurvature, Some(0.2));
        let surface = surface_picture(&object, &median.name, shown, View::Oblique)?;
        desk.figures(
            &[(format!("{kind}-slices"), slices), (format!("{kind}-surface"), surface)],
            &format!("{kind} of median volume: mask and embedding in three slices, and the surface."),
        )?;
    }
    Ok(())
}

/// Median, least and largest spacing, as the paper describes its data.
fn spacings(desk: &mut Desk, cohort: &[Bone]) -> Result<String> {
    let mut table = Table::new("median [min, max] | in plane (mm) | slices (mm) | age (years) | male");
    for kind in KINDS {
        let of_kind = cohort.iter().filter(|bone| bone.kind() == kind);
        let mm = of_kind.map(|bone| Ok(*bone.mask()?.grid())).collect::<Result<Vec<Grid>>>()?;
        let mut cells = Vec::new();
        for (name, axis) in [("in_plane", 0), ("slices", 2)] {
            let mut lengths: Vec<f64> = mm.iter().map(|grid| grid.spacing().mm()[axis]).collect();
            lengths.sort_by(f64::total_cmp);
            let (n, half) = (lengths.len(), lengths.len() / 2);
            let median = 0.5 * (lengths[half] + lengths[(n - 1) / 2]);
            let [median, least, most] = [("median", median), ("min", lengths[0]), ("max", lengths[n - 1])]
                .map(|(what, value)| desk.number(format!("{kind}.{name}.{what}"), value));
            cells.push(format!("{median:.3} [{least:.3}, {most:.3}]"));
        }
        table.row(&format!("{kind} | {} | – | –", cells.join(" | ")));
    }
    table.row("*paper* | *0.703 [0.580, 0.977]* | *0.625 [0.624, 1.000]* | *61.5 [50, 102]* | *33 of 50*");
    Ok(table.text())
}
