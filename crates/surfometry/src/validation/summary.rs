//! Cases of a shape at a resolution, in a few numbers.

use super::CaseResult;
use crate::integrals::Globals;
use serde::Serialize;

/// All poses of a shape on one kind of grid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Shape.
    pub shape: &'static str,
    /// Whether constants were fitted on such shapes.
    pub tuned: bool,
    /// R in units of the largest spacing.
    pub resolution: f64,
    /// Largest over smallest spacing.
    pub ratio: f64,
    /// How many.
    pub cases: usize,
    /// The largest errors of the blurred object.
    pub worst_blurred: Globals,
    /// The largest errors of the original object's, %.
    pub worst_original: Globals,
    /// Share of the original object's values, in %, within 1.96 standard errors of the truth; V, A and M
    /// together.
    pub coverage: Option<f64>,
    /// The largest error of Gauss-Bonnet.
    pub worst_euler_characteristic: f64,
    /// Cases in which V - E + F is not the exact characteristic.
    pub wrong_meshes: usize,
    /// Rms over poses of the local errors of H in % of 1/R.
    pub mean_curvature: Option<f64>,
    /// The same of K in % of 1/R^2.
    pub gaussian_curvature: Option<f64>,
    /// Rms distance from the exact surface, in voxels.
    pub position_voxels: Option<f64>,
    /// Shares of the surface, in %, within the error bars of H and K.
    pub local_coverage: Option<[f64; 2]>,
}

/// One for each shape, resolution and ratio, in order of the cases.
pub fn summarise(results: &[CaseResult]) -> Vec<Summary> {
    let same = |a: &CaseResult, b: &CaseResult| {
        (a.shape, a.resolution.to_bits(), a.ratio.to_bits())
            == (b.shape, b.resolution.to_bits(), b.ratio.to_bits())
    };
    results.chunk_by(same).map(summary).collect()
}

fn summary(cases: &[CaseResult]) -> Summary {
    let worst = |errors: &dyn Fn(&CaseResult) -> Globals| {
        Globals::each(|part| largest(cases.iter().map(|case| part(&errors(case)))))
    };
    let rms = |number: &dyn Fn(&CaseResult) -> Option<f64>| {
        let squares: Option<Vec<f64>> = cases.iter().map(|c| number(c).map(|n| n * n)).collect();
        squares.map(|squares| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    };
    let mean = |number: &dyn Fn(&CaseResult) -> Option<f64>| {
        let numbers: Option<Vec<f64>> = cases.iter().map(number).collect();
        numbers.map(|numbers| numbers.iter().sum::<f64>() / numbers.len() as f64)
    };
    let covered = |c: &CaseResult| {
        let e = c.standardised?;
        let within = |z: f64| if z.abs() <= 1.96 { 100.0 } else { 0.0 };
        Some((within(e.volume) + within(e.area) + within(e.total_mean_curvature)) / 3.0)
    };
    let first = &cases[0];
    Summary {
        shape: first.shape,
        tuned: first.tuned,
        resolution: first.resolution,
        ratio: first.ratio,
        cases: cases.len(),
        worst_blurred: worst(&|c| c.blurred),
        worst_original: worst(&|c| c.original),
        coverage: mean(&covered),
        worst_euler_characteristic: largest(cases.iter().map(|c| c.euler_characteristic)),
        wrong_meshes: cases.iter().filter(|c| c.mesh_euler_characteristic != 0).count(),
        mean_curvature: rms(&|c| c.local.map(|l| l.mean_curvature)),
        gaussian_curvature: rms(&|c| c.local.map(|l| l.gaussian_curvature)),
        position_voxels: rms(&|c| c.local.map(|l| l.position_voxels)),
        local_coverage: mean(&|c| c.local.map(|l| l.mean_coverage))
            .zip(mean(&|c| c.local.map(|l| l.gaussian_coverage)))
            .map(|(h, k)| [h, k]),
    }
}

/// The number of largest size, with its sign; a number that could not be had is larger than any.
fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |largest: f64, n| if n.is_nan() || n.abs() > largest.abs() { n } else { largest })
}
