//! What depends on the blur, and where it does not.

use crate::measurement::Object;
use crate::pictures::ChartPanel;
use crate::runs::sweep_panels;
use serde::Serialize;

/// Numbers of one object at several blurs.
#[derive(Debug, Clone, Serialize)]
pub struct BlurSweep {
    /// The blurs, mm, ascending.
    pub sigma_mm: Vec<f64>,
    /// The one that the numbers of the page are had with, mm.
    pub used_mm: f64,
    /// What they amount to.
    pub panels: Vec<SweepPanel>,
    /// Where the choice does not matter; `None` where there is no such place.
    pub plateau: Option<Plateau>,
}

/// Lines in common axes.
#[derive(Debug, Clone, Serialize)]
pub struct SweepPanel {
    /// With its unit.
    pub name: String,
    /// `original`, `blurred` and `voxels`, as far as there are.
    pub lines: Vec<SweepLine>,
}

/// A number at each blur, and half of its 95 % interval.
#[derive(Debug, Clone, Serialize)]
pub struct SweepLine {
    /// Of what.
    pub name: String,
    /// Null where it could not be had.
    pub values: Vec<Option<f64>>,
    /// The same; empty without a model.
    pub intervals: Vec<Option<f64>>,
}

/// Blurs, mm, from which to which volume, area and total mean curvature of the original object stay the same.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Plateau {
    /// The least.
    pub from_mm: f64,
    /// The largest.
    pub to_mm: f64,
}

/// Blurs from half to twice the one in use, as powers of the fourth root of 2.
const STEPS: std::ops::RangeInclusive<i32> = -4..=4;
/// Fewest blurs in a row that make a plateau: they differ by a factor of 1.68.
const FEWEST: usize = 4;
/// Relative differences that are none, where error bars are smaller.
const SAME: f64 = 0.005;
/// Relative differences that are some, however large error bars are.
const OTHER: f64 = 0.02;
/// Half of an interval, as a share of its value, of which one is known too little to be steady.
const UNKNOWN: f64 = 0.1;
/// Panels in which a plateau shows: V, A, M.
const STEADY: usize = 3;

impl BlurSweep {
    /// Of an object whose field is a blur of voxels.
    pub fn of(object: &Object) -> Option<Self> {
        let used_mm = object.parameters().sigma_mm?;
        let sigmas: Vec<f64> = STEPS.map(|n| used_mm * libm::exp2(f64::from(n) / 4.0)).collect();
        let measured = object.measure_at(&sigmas);
        let panels = sweep_panels(&measured.iter().collect::<Vec<_>>());
        let sigma_mm: Vec<f64> = measured.iter().filter_map(|m| m.parameters.sigma_mm).collect();
        let plateau = plateau(&sigma_mm, &panels);
        let panels = panels.into_iter().map(SweepPanel::of).collect();
        Some(Self { sigma_mm, used_mm, panels, plateau })
    }
}

impl SweepPanel {
    fn of(panel: ChartPanel) -> Self {
        let line = |line: crate::pictures::ChartLine| SweepLine {
            name: line.name.to_owned(),
            values: line.values,
            intervals: line.errors,
        };
        Self { name: panel.name.to_owned(), lines: panel.lines.into_iter().map(line).collect() }
    }
}

/// The longest row of blurs at which each of V, A and M of the original object stays within its error bars, the
/// first of equally long ones.
fn plateau(sigmas: &[f64], panels: &[ChartPanel]) -> Option<Plateau> {
    let lines: Vec<_> = panels.iter().take(STEADY).filter_map(|panel| panel.lines.first()).collect();
    let steady = |range: std::ops::Range<usize>| {
        lines.iter().all(|line| {
            let errors = line.errors.get(range.clone()).unwrap_or_default();
            is_steady(line.values.get(range.clone()).unwrap_or_default(), errors)
        })
    };
    let count = sigmas.len();
    let mut ranges = (FEWEST..=count)
        .rev()
        .flat_map(|length| (0..=count - length).map(move |start| start..start + length));
    let range = ranges.find(|range| steady(range.clone()))?;
    Some(Plateau { from_mm: sigmas[range.start], to_mm: sigmas[range.end - 1] })
}

/// Whether values lie within the least of their intervals, or hardly differ.
fn is_steady(values: &[Option<f64>], intervals: &[Option<f64>]) -> bool {
    let Some(values) = values.iter().copied().collect::<Option<Vec<f64>>>() else { return false };
    let Some(least) = values.iter().copied().reduce(f64::min) else { return false };
    let most = values.iter().copied().fold(least, f64::max);
    let is_unknown =
        |(value, interval): (&f64, &Option<f64>)| interval.unwrap_or_default() > UNKNOWN * value.abs();
    if values.iter().zip(intervals).any(is_unknown) {
        return false;
    }
    // Without a model of its error a value may not differ within others' bars.
    let known = intervals.iter().map(|interval| interval.unwrap_or_default());
    let interval = known.reduce(f64::min).unwrap_or_default();
    let size = least.abs();
    most - least <= (2.0 * interval).max(SAME * size).min(OTHER * size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::ChartLine;

    #[test]
    fn only_what_stays_within_its_bars_is_steady() {
        let some = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
        assert!(is_steady(&some(&[100.0, 100.4, 100.1]), &[]));
        assert!(!is_steady(&some(&[100.0, 102.0]), &some(&[0.3, 5.0])));
        assert!(is_steady(&some(&[100.0, 102.0]), &some(&[1.1, 1.2])));
        assert!(!is_steady(&some(&[100.0, 103.0]), &some(&[9.0, 9.0])));
        assert!(!is_steady(&some(&[100.0, 102.0]), &[None, Some(3.0)]));
        assert!(!is_steady(&[Some(1.0), None], &[]));
        // A value of which next to nothing is known agrees with all.
        assert!(!is_steady(&some(&[100.0, 100.1]), &some(&[1.0, 40.0])));
        assert!(!is_steady(&[], &[]));
    }

    #[test]
    fn a_plateau_is_the_longest_row_that_all_three_share() {
        let sigmas = [1.0, 1.2, 1.4, 1.7, 2.0, 2.4];
        let panel = |values: [f64; 6]| ChartPanel {
            name: "",
            lines: vec![ChartLine::new("original", values.map(Some).to_vec())],
        };
        let level = panel([5.0; 6]);
        let panels = [level.clone(), panel([9.0, 7.0, 7.0, 7.0, 7.0, 7.0]), level.clone()];
        assert_eq!(plateau(&sigmas, &panels), Some(Plateau { from_mm: 1.2, to_mm: 2.4 }));
        let drifting = [level.clone(), panel([9.0, 8.0, 7.0, 7.0, 7.0, 6.0]), level];
        assert_eq!(plateau(&sigmas, &drifting), None);
    }
}
