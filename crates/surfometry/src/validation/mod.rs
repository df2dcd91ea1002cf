//! The zoo: shapes with exact truth in many poses, and how far the measured numbers are from it.
//!
//! ```
//! use surfometry::validation::{Validation, summarise};
//! let one = Validation {
//!     shapes: vec!["torus 2:1".to_owned()],
//!     resolutions: vec![8.0],
//!     ratios: vec![1.0],
//!     poses: 1,
//!     local: false,
//!     ..Validation::default()
//! };
//! let summaries = summarise(&one.run(|| {})?);
//! assert!(summaries[0].worst_original.area < 1.0);
//! # Ok::<(), surfometry::measurement::MeasureError>(())
//! ```

mod case;
mod poses;
#[cfg(feature = "io")]
mod rival;
mod summary;
mod zoo;

pub use case::{Case, CaseResult, LocalErrors, MadeCase, Noise};
#[cfg(feature = "io")]
pub use rival::{PoseErrors, Rivalry, against};
pub use summary::{Summary, summarise};
pub use zoo::{THIN_ZOO, ZOO, Zoo, ZooShape};

use crate::measurement::{CurvatureScale, MeasureError};
use case::Unit;
use poses::pose;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// Which shapes.
    pub zoo: Zoo,
    /// What is done to their masks.
    pub noise: Noise,
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
            zoo: Zoo::default(),
            noise: Noise::default(),
            resolutions: Zoo::default().resolutions().to_vec(),
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
                    let noise = self.noise;
                    cases.extend(poses.map(|number| Case {
                        shape,
                        resolution,
                        ratio,
                        number,
                        pose: pose(number),
                        noise,
                    }));
                }
            }
        }
        cases
    }

    fn wanted(&self) -> impl Iterator<Item = &'static ZooShape> + '_ {
        let named = |shape: &&ZooShape| self.shapes.iter().any(|part| shape.name.contains(part.as_str()));
        self.zoo.shapes().iter().filter(move |shape| self.shapes.is_empty() || named(shape))
    }

    /// All cases as phantoms, for whoever measures them: in the order of [`Validation::cases`].
    ///
    /// # Errors
    /// [`MeasureError`] of a case whose grid is too large.
    pub fn made(&self) -> Result<Vec<MadeCase>, MeasureError> {
        // The truth of a shape is that of its unit, scaled.
        let units: BTreeMap<_, _> =
            self.wanted().par_bridge().map(|shape| (shape.name, Unit::of(shape))).collect();
        self.cases().iter().map(|case| case.made(&units[case.shape.name])).collect()
    }

    /// Measures all cases; `progress` is told after each, from whichever thread.
    ///
    /// # Errors
    /// [`MeasureError`] of a case that cannot be measured.
    pub fn run(&self, progress: impl Fn() + Sync) -> Result<Vec<CaseResult>, MeasureError> {
        self.run_made(&self.made()?, progress)
    }

    /// The same of cases that were made already.
    ///
    /// # Errors
    /// As of [`Validation::run`].
    pub fn run_made(
        &self,
        made: &[MadeCase],
        progress: impl Fn() + Sync,
    ) -> Result<Vec<CaseResult>, MeasureError> {
        let run = |case: &MadeCase| {
            let result = case.run(self.local.then_some(self.curvature));
            progress();
            result
        };
        made.par_iter().map(run).collect()
    }
}
