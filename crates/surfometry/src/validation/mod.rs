//! The zoo: shapes with exact truth in many poses, and how far the measured numbers are from it.

mod case;
mod poses;
mod summary;
mod zoo;

pub use case::{Case, CaseResult, LocalErrors, RelativeErrors};
pub use summary::{Summary, summarise};
pub use zoo::{ZOO, ZooShape};

use crate::measurement::{CurvatureScale, MeasureError};
use case::Unit;
use poses::pose;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// R = 1 / rms of the larger principal curvature, in units of the largest spacing.
    pub resolutions: Vec<f64>,
    /// Ratio of the largest to the smallest spacing; the second of three lies between.
    pub ratios: Vec<f64>,
    /// Rotations, shifts and sizes of each shape.
    pub poses: usize,
    /// Number of the first pose: poses from another on are held out from whatever was tuned on the first
    /// ones.
    pub first_pose: usize,
    /// Parts of the names of the shapes that are wanted; all where there are none.
    pub shapes: Vec<String>,
    /// Whether local curvature is looked at too.
    pub local: bool,
    /// At which scale.
    pub curvature: CurvatureScale,
}

impl Default for Validation {
    /// R = 10 and 20 voxels, cubic voxels and thick slices, three poses.
    fn default() -> Self {
        Self {
            resolutions: vec![10.0, 20.0],
            ratios: vec![1.0, 3.0],
            poses: 3,
            first_pose: 0,
            shapes: Vec::new(),
            local: true,
            curvature: CurvatureScale::Auto,
        }
    }
}

impl Validation {
    /// All cases, in order: shape by shape, the coarse ones first.
    pub fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for shape in self.wanted() {
            for &resolution in &self.resolutions {
                for &ratio in &self.ratios {
                    let poses = self.first_pose..self.first_pose + self.poses;
                    cases.extend(poses.map(|number| Case { shape, resolution, ratio, pose: pose(number) }));
                }
            }
        }
        cases
    }

    fn wanted(&self) -> impl Iterator<Item = &'static ZooShape> + '_ {
        let named = |shape: &&ZooShape| self.shapes.iter().any(|part| shape.name.contains(part.as_str()));
        ZOO.iter().filter(move |shape| self.shapes.is_empty() || named(shape))
    }

    /// Measures all cases; `progress` is told after each, from whichever thread.
    ///
    /// # Errors
    /// [`MeasureError`] of a case that cannot be measured.
    pub fn run(&self, progress: impl Fn() + Sync) -> Result<Vec<CaseResult>, MeasureError> {
        // The truth of a shape is that of its unit, scaled.
        let units: BTreeMap<_, _> =
            self.wanted().par_bridge().map(|shape| (shape.name, Unit::of(shape))).collect();
        let run = |case: &Case| {
            let result = case.run(&units[case.shape.name], self.local.then_some(self.curvature));
            progress();
            result
        };
        self.cases().par_iter().map(run).collect()
    }
}
