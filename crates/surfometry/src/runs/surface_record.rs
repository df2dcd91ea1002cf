//! What is written of a surface besides its files.

use super::Record;
use crate::surface::{CurvatureSummary, Distribution, QUANTILES, Surface};
use serde::Serialize;

/// Name and version of the format.
pub const MAP_SCHEMA: &str = "surfometry.map/1";

/// One object's results and how curvature is distributed over its surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceRecord {
    /// The results of `measure`.
    #[serde(flatten)]
    pub record: Record,
    /// Curvature over the surface; `None` where the blur left nothing.
    pub curvature: Option<CurvatureSummary>,
    /// Shares that the distributions' quantiles are at.
    pub quantiles: [f64; QUANTILES.len()],
    /// One a quantity.
    pub distributions: Vec<Distribution>,
    /// Vertices without a normal, whose curvature counts as 0.
    pub vertices_without_normal: u64,
    /// The files that were written.
    pub files: Vec<String>,
}

impl SurfaceRecord {
    /// Of a surface and its results.
    pub fn new(record: Record, surface: &Surface) -> Self {
        Self {
            record,
            curvature: surface.curvature_summary(),
            quantiles: QUANTILES,
            distributions: surface.distributions(),
            vertices_without_normal: surface.vertices_without_normal,
            files: Vec::new(),
        }
    }
}
