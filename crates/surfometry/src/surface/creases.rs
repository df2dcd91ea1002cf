//! Edges at which flat faces meet, as a rounded surface shows them.

use super::Surface;
use super::mesh::length;
use super::spread_mean::SpreadMean;

/// Radius of curvature, in voxels, below which a surface may be a rounded edge: near the grid no voxel tells of an edge, and
/// it is as round as the blur makes it.
const ROUNDED: f64 = 3.3;
/// Radius of curvature, in voxels, above which a surface counts as flat.
const FLAT: f64 = 5.0;
/// Edges, in voxels, of the lattices by which neighbours are averaged: across an edge, and far into the faces beside it.
const ACROSS: f64 = 5.0;
const BESIDE: f64 = 7.0;
/// Share of flat surface around, from which on a round place is taken for an edge of faces, and at which it surely is one. Of
/// thin parts and organs, which are curved beside where they are most curved, next to none has as much.
const FLAT_BESIDE: [f64; 2] = [0.4, 0.55];
/// Length of the mean of the normals around an edge of no angle.
const STRAIGHT: f64 = 0.95;
/// Area that an edge may have over its rounding, as a share of the latter: that of 110 degrees.
const MOST: f64 = 0.5;

/// Cosines of half of the angles, 110 and 90 degrees, from which on an edge may as well be the rim of a thin part, and up to
/// which it is none: what rims are short of is given back elsewhere.
const RIM: [f64; 2] = [0.57, 0.71];

/// What rounding may have taken of a surface's edges.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Creases {
    /// Area that convex edges have over their rounding, mm^2.
    pub(crate) lost_area: f64,
    /// That of edges that are no rims.
    pub(crate) plain_area: f64,
    /// Integral of |H| over hollow ones, mm.
    pub(crate) hollow_mean_curvature: f64,
}

impl Creases {
    /// Of a surface with its vertices' areas in mm^2, in an image of a voxel size in mm.
    ///
    /// An edge that turns by an angle t and is rounded by a radius r has r t of surface for each mm of length, and 2 r tan(t
    /// / 2) before it was rounded. Normals around it, half on each side, have a mean of length cos(t / 2).
    pub(crate) fn of(surface: &Surface, areas: &[f64], voxel: f64) -> Self {
        let places = &surface.mesh.vertices;
        let normals: Vec<[f64; 3]> = surface.vertices.iter().map(|vertex| vertex.normal).collect();
        let mean_normals = SpreadMean::new(places, ACROSS * voxel).of(&normals, areas);
        let is_flat = surface.vertices.iter().map(|vertex| vertex.curvature.larger() * voxel * FLAT < 1.0);
        let flat: Vec<[f64; 1]> = is_flat.map(|is_flat| [f64::from(u8::from(is_flat))]).collect();
        let flat_beside = SpreadMean::new(places, BESIDE * voxel).of(&flat, areas);
        let mut creases = Self::default();
        let around = mean_normals.into_iter().zip(flat_beside);
        for ((vertex, &area), (normal, [flat])) in surface.vertices.iter().zip(areas).zip(around) {
            if vertex.curvature.larger() * voxel * ROUNDED > 1.0 {
                let mean_curvature = vertex.curvature.mean_curvature;
                let is_edge = ramp(flat, FLAT_BESIDE);
                if mean_curvature > 0.0 {
                    let cosine = (length(normal) / STRAIGHT).min(1.0);
                    let lost = area * is_edge * lost_of_edge(cosine);
                    creases.lost_area += lost;
                    creases.plain_area += lost * ramp(cosine, RIM);
                } else {
                    creases.hollow_mean_curvature -= area * is_edge * mean_curvature;
                }
            }
        }
        creases
    }
}

/// Area that an edge has over its rounding, as a share of the latter, by the cosine of half of its angle.
fn lost_of_edge(cosine: f64) -> f64 {
    let half_angle = libm::acos(cosine);
    if half_angle > 0.0 { (libm::tan(half_angle) / half_angle - 1.0).min(MOST) } else { 0.0 }
}

/// 0 up to a first value, 1 from a second on.
fn ramp(value: f64, [none, all]: [f64; 2]) -> f64 {
    ((value - none) / (all - none)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Measurement;
    use crate::measurement::EmbeddingKind;
    use crate::phantoms::Phantom;

    fn creases(spec: &str) -> (Creases, f64, f64) {
        let phantom = Phantom::from_spec(spec).unwrap();
        let recovering = Measurement::default().embedding(EmbeddingKind::Recovering);
        let surface = recovering.prepare(phantom.labels().unwrap().mask(1)).unwrap().surface();
        let areas = surface.mesh.vertex_areas();
        let area: f64 = areas.iter().sum();
        (Creases::of(&surface, &areas, 1.0), area, phantom.truth().unwrap().surface_area)
    }

    /// What a cuboid's edges have lost is known to a half: its exact area is that much larger.
    #[test]
    fn edges_of_cuboids_are_seen() {
        for rotation in ["0,0,0", "3,5,2", "20,30,40"] {
            let (creases, area, exact) = creases(&format!(
                "rounded-box?radii=9,11,13&radius=0.01&rotate={rotation}&shift=0.3,0.1,0.2"
            ));
            let ratio = creases.lost_area / (exact - area);
            assert!((0.5..2.0).contains(&ratio), "{rotation}: {ratio}");
        }
    }

    /// Thin tubes and round bodies have none. The rim of a flat ellipsoid, of R = 1.8 voxels between faces that are nearly
    /// flat, is not told from an edge: what it counts for is small.
    #[test]
    fn curved_bodies_have_none() {
        for (spec, most) in [
            ("capsule?radius=2&length=30&rotate=20,30,40", 0.003),
            ("ellipsoid?radii=12,10,8&rotate=20,30,40", 0.003),
            ("ellipsoid?radii=14,12,5&rotate=20,30,40", 0.04),
        ] {
            let (creases, area, _) = creases(spec);
            assert!(creases.lost_area < most * area, "{spec}: {creases:?} of {area}");
        }
    }
}
