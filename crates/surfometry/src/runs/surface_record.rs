//! What is written of a surface besides its files.

use super::{AgainstRecord, Record, Row};
use crate::accuracy::{Flag, FlagCode};
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
    /// Vertices where the field's gradient has collapsed: their curvature is given as 0, and distributions
    /// leave them out.
    pub vertices_without_normal: u64,
    /// How the surface of a later image differs; `None` where none was named, or it lacks the object.
    pub against: Option<AgainstRecord>,
    /// The files that were written.
    pub files: Vec<String>,
}

impl Row for SurfaceRecord {
    const SCHEMA: &'static str = MAP_SCHEMA;

    fn columns() -> Vec<String> {
        Record::columns()
    }
}

impl SurfaceRecord {
    /// Of a surface and its results.
    pub fn new(mut record: Record, surface: &Surface) -> Self {
        let vertices_without_normal = surface.vertices_without_normal();
        if vertices_without_normal > 0 {
            let message = format!(
                "the gradient has collapsed at {vertices_without_normal} of the surface's {} vertices: their curvature is given \
                 as 0, and distributions leave them out",
                surface.vertices.len()
            );
            record.measured.flags.push(Flag::new(FlagCode::VanishingGradient, message));
        }
        Self {
            record,
            curvature: surface.curvature_summary(),
            quantiles: QUANTILES,
            distributions: surface.distributions().to_vec(),
            vertices_without_normal,
            against: None,
            files: Vec::new(),
        }
    }
}
