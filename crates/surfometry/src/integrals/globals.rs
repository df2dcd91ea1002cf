//! V, A and M together.

use serde::Serialize;

/// What is told of an object as a whole: V, A and M, or a change or an error of each, in whatever units.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Globals {
    /// Of V: mm^3, % or standard errors.
    pub volume: f64,
    /// Of A: mm^2, % or standard errors.
    #[serde(rename = "surface_area")]
    pub area: f64,
    /// Of M, the integral of H: mm, % or standard errors.
    pub total_mean_curvature: f64,
}

impl Globals {
    /// Of values and what each is changed by.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            volume: self.volume + other.volume,
            area: self.area + other.area,
            total_mean_curvature: self.total_mean_curvature + other.total_mean_curvature,
        }
    }
}
