//! One subject's bones over a range of a parameter, by the paper's settings and by ours.

use crate::bones::{phantom_mask, progress};
use anyhow::Result;
use surfometry::Measurement;
use surfometry::measurement::Measured;
use surfometry::pictures::{ChartLine, ChartPanel};
use surfometry::volume::{Grid, Mask};

/// The paper's subject: 0.672 mm in plane, slices of 1 mm.
pub(crate) const SUBJECT: [(&str, &str); 2] = [
    (
        "Femur",
        "phantom:femur?individual=5&spacing=0.672,0.672,1.0&rotate=4,-3,6&shift=0.2,0.1,0.3&jitter=0.15",
    ),
    (
        "L4",
        "phantom:vertebra?individual=23&spacing=0.672,0.672,1.0&rotate=4,-3,6&shift=0.2,0.1,0.3&jitter=0.15",
    ),
];

/// Voxels between its bones, further than any blur here reaches.
const APART: usize = 60;

/// Both of its bones as they lie in one scan: the vertebra above the femur and to its left, on one grid.
pub(crate) fn subject() -> Result<[(&'static str, Mask); 2]> {
    let [femur, vertebra] = SUBJECT.map(|(_, spec)| phantom_mask(spec));
    let (femur, vertebra) = (femur?, vertebra?);
    let [below, above] = [&femur, &vertebra].map(|mask| mask.grid().dimensions());
    let start: [usize; 3] = below.map(|n| n + APART);
    let grid = Grid::new(std::array::from_fn(|a| start[a] + above[a]), *femur.grid().affine())?;
    // A mask moved by whole voxels is the same mask.
    let placed = |mask: &Mask, start: [usize; 3]| {
        let own = |index: [usize; 3]| std::array::from_fn(|a| index[a] as i64 - start[a] as i64);
        Mask::from_predicate(grid, |index| mask.get(own(index)))
    };
    Ok([(SUBJECT[0].0, placed(&femur, [0; 3])), (SUBJECT[1].0, placed(&vertebra, start))])
}

/// Values of a range.
pub(crate) const STEPS: usize = 100;

/// Evenly, both ends included.
pub(crate) fn range([first, last]: [f64; 2]) -> Vec<f64> {
    (0..STEPS).map(|n| first + (last - first) * n as f64 / (STEPS - 1) as f64).collect()
}

/// One of a measurement's values.
pub(crate) type Value = fn(&Measured) -> Option<f64>;

/// A bone measured at each value of a range.
pub(crate) struct Swept {
    pub(crate) paper: Vec<Measured>,
    pub(crate) ours: Vec<Measured>,
}

impl Swept {
    /// Measures; `settings` gives the paper's and ours for a value.
    pub(crate) fn over(
        kind: &'static str,
        mask: &Mask,
        values: &[f64],
        settings: impl Fn(f64) -> [Measurement; 2],
    ) -> Result<Self> {
        let bar = progress(kind, values.len());
        let mut swept = Self { paper: Vec::new(), ours: Vec::new() };
        for &value in values {
            let [paper, ours] = settings(value);
            swept.paper.push(paper.prepare(mask)?.measure());
            swept.ours.push(ours.prepare(mask)?.measure());
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(swept)
    }

    /// V, A, average H and chi of the blurred object, and of the original one where `original` wants it.
    pub(crate) fn panels(&self, original: bool) -> Vec<ChartPanel<'static>> {
        let line = |name, of: &[Measured], value: Value| ChartLine::new(name, of.iter().map(value).collect());
        let panel = |name, plain: Value, compensated: Option<Value>| {
            let mut lines = vec![line("paper", &self.paper, plain), line("defaults", &self.ours, plain)];
            let compensated = compensated.filter(|_| original);
            lines.extend(compensated.map(|value| line("original", &self.ours, value)));
            ChartPanel { name, lines }
        };
        vec![
            panel("volume (mm³)", |m| m.blurred.volume_mm3, Some(|m| m.volume_mm3)),
            panel("surface area (mm²)", |m| m.blurred.surface_area_mm2, Some(|m| m.surface_area_mm2)),
            panel(
                "average mean curvature (1/mm)",
                |m| m.blurred.average_mean_curvature_per_mm,
                Some(|m| m.average_mean_curvature_per_mm),
            ),
            panel("Euler characteristic", |m| m.blurred.euler_characteristic, None),
        ]
    }
}
