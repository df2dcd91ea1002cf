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
    /// The same made of each of the three.
    pub fn each(number: impl Fn(fn(&Self) -> f64) -> f64) -> Self {
        Self {
            volume: number(|one| one.volume),
            area: number(|one| one.area),
            total_mean_curvature: number(|one| one.total_mean_curvature),
        }
    }

    /// Of values and what each is changed by.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self::each(|part| part(self) + part(other))
    }
}
