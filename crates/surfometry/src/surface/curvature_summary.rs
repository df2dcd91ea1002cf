//! Curvature of a whole surface in the numbers that cortical morphometry reports.

use super::VertexGeometry;
use crate::local_geometry::Curvature;
use serde::Serialize;
use std::f64::consts::PI;

/// Integrals and means over the surface of the functions of k1 and k2 that FreeSurfer's
/// `mris_curvature_stats` prints, from the geometry at vertices, weighted by area. Here k1 >= k2 and H > 0 on
/// a ball.
///
/// # References
/// Van Essen and Drury 1997 (folding and intrinsic curvature index); Koenderink and van Doorn 1992 (shape
/// index, curvedness); Pienaar et al. 2008 (`mris_curvature_stats`, where k_max is the one of larger
/// magnitude).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvatureSummary {
    /// Integral of k1^2 + k2^2 (BE). A ball: 8 pi.
    pub bending_energy: f64,
    /// Integral of |k_max| (|k_max| - |k_min|) over 4 pi (FI). A ball: 0; it grows with folds.
    pub folding_index: f64,
    /// Integral of the positive part of K over 4 pi (ICI). A convex surface: 1.
    pub intrinsic_curvature_index: f64,
    /// Integral of (k1 - k2)^2, the sharpness (S). A ball: 0.
    pub sharpness: f64,
    /// Mean shape index (SI), from -1 in a hollow to 1 on a ball.
    pub mean_shape_index: f64,
    /// Mean curvedness (C), 1/mm.
    pub mean_curvedness_per_mm: f64,
    /// Share of the area with H > 0.
    pub convex_share: f64,
    /// Share of the area with K < 0: saddles.
    pub saddle_share: f64,
}

impl CurvatureSummary {
    /// Of vertices and the areas that they stand for; `None` without area.
    pub fn of(vertices: &[VertexGeometry], areas: &[f64]) -> Option<Self> {
        let total: f64 = areas.iter().sum();
        let integral = |f: &dyn Fn(&Curvature) -> f64| {
            vertices.iter().zip(areas).map(|(v, area)| f(&v.curvature) * area).sum::<f64>()
        };
        let share = |holds: &dyn Fn(&Curvature) -> bool| integral(&|c| f64::from(u8::from(holds(c)))) / total;
        (total > 0.0).then(|| Self {
            bending_energy: integral(&|c| {
                4.0 * c.mean_curvature * c.mean_curvature - 2.0 * c.gaussian_curvature
            }),
            folding_index: integral(&folding) / (4.0 * PI),
            intrinsic_curvature_index: integral(&|c| c.gaussian_curvature.max(0.0)) / (4.0 * PI),
            sharpness: integral(&|c| {
                4.0 * (c.mean_curvature * c.mean_curvature - c.gaussian_curvature).max(0.0)
            }),
            mean_shape_index: integral(&Curvature::shape_index) / total,
            mean_curvedness_per_mm: integral(&Curvature::curvedness) / total,
            convex_share: share(&|c| c.mean_curvature > 0.0),
            saddle_share: share(&|c| c.gaussian_curvature < 0.0),
        })
    }
}

fn folding(c: &Curvature) -> f64 {
    let [k1, k2] = c.principal().map(f64::abs);
    k1.max(k2) * (k1 - k2).abs()
}
