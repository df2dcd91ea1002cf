//! Edges at which faces meet, as a rounded surface shows them.

use super::Surface;
use super::local_scale::indices;
use super::spread_mean::SpreadMean;
use crate::space::{dot, length};
use crate::volume::Grid;

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
/// Area that an edge may have over its rounding, as a share of the latter: that of 110 degrees. An acute one has more, up to
/// as much again.
const MOST: f64 = 0.5;
const MOST_OF_ACUTE: f64 = 1.5;
/// Cosines of half of the angles, 110 and 90 degrees, from which on an edge may as well be the rim of a thin part, and up to
/// which it is none: what rims are short of is given back elsewhere.
const RIM: [f64; 2] = [0.57, 0.71];

/// How many times as curved as what lies around a place is that may be an edge of small faces, and one that looks like it.
/// Balls have 1, rods 1.2, ellipsoids 1.5 at their ends.
const SUDDEN: [f64; 2] = [1.3, 1.8];
/// How much an object may have that is as hollow, in units of what is suddenly curved, and still be taken for a body of faces:
/// bones and organs are wavy.
const WAVY: [f64; 2] = [0.1, 0.35];
/// Mean curvature, 1 / voxel, of the shallow hollows beside an edge that voxels speak for, and their share around it:
/// there, a smooth surface overshoots. Rounded rims have next to none.
const OVERSHOT: f64 = -0.03;
const OVERSHOOTING: [f64; 2] = [0.06, 0.16];
/// Cosine of the angle, 8 degrees, up to which a surface lies along the grid, and the share around an edge of faces that do.
const ALONG: f64 = 0.99;
const GRIDDED: [f64; 2] = [0.1, 0.25];
/// The cosine for faces that the grid moves as a whole, 5 degrees, and three times the share of a ball's area that lies so to
/// an axis.
const FACING: f64 = 0.996;
const USUAL: f64 = 0.012;

/// Area of the voxels' faces, in units of that of the surface, of which rounding alone may have made it smaller, and at which
/// it has not: that of boxes along the grid is that of their voxels; balls have 1.5, tubes along the grid 1.27.
const BOX_ALONG: [f64; 2] = [1.25, 1.12];

/// What rounding may have taken of a surface's edges, mm^2.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Creases {
    /// Area that convex edges of flat faces have over their rounding.
    pub(crate) lost_area: f64,
    /// That of edges that are no rims.
    pub(crate) plain_area: f64,
    /// That of edges that voxels speak for.
    pub(crate) overshot_area: f64,
    /// What acute ones have beyond it.
    pub(crate) acute_area: f64,
    /// Rounded area that may be edges of faces too small to be flat.
    pub(crate) suspected_area: f64,
    /// That of it at faces along the grid.
    suspected_along_grid: f64,
    /// That of it which is told by hollows beside it, or by faces along the grid.
    pub(crate) told_area: f64,
    /// Rounded area at edges of flat faces along the grid, which no voxel tells of.
    pub(crate) gridded_area: f64,
    /// What a body of faces along the grid has more: area of its voxels' faces.
    pub(crate) boxed_area: f64,
    /// Integral of |H| over hollow edges, mm.
    pub(crate) hollow_mean_curvature: f64,
    /// Faces along the grid, by axis: the grid moves them as a whole.
    pub(crate) faces: [f64; 3],
}

impl Creases {
    /// Of a surface with its vertices' areas in mm^2, in an image's grid.
    ///
    /// An edge that turns by an angle t and is rounded by a radius r has r t of surface for each mm of length, and 2 r tan(t
    /// / 2) before it was rounded. Normals around it, half on each side, have a mean of length cos(t / 2).
    pub(crate) fn of(surface: &Surface, areas: &[f64], grid: &Grid) -> Self {
        let voxel = grid.spacing().geometric_mean();
        let normals = in_grid(surface, grid);
        let around = Surroundings::of(surface, areas, &normals, grid);
        let (faces, boxed_area) = (faces_along(&normals, areas), boxed_area(&normals, areas));
        let mut creases = Self { boxed_area, faces, ..Self::default() };
        let (mut sudden, mut wavy) = (0.0, 0.0);
        for ((vertex, &area), around) in surface.vertices.iter().zip(areas).zip(&around) {
            let [_, least] = vertex.curvature.principal();
            if -least * voxel * ROUNDED > 1.0 {
                wavy += area;
            }
            let larger = vertex.curvature.larger() * voxel;
            let mean_curvature = vertex.curvature.mean_curvature;
            if larger * ROUNDED > 1.0 && mean_curvature > 0.0 {
                let is_sudden = ramp(larger / around.larger, SUDDEN);
                sudden += area * is_sudden;
                creases.add_convex(area, is_sudden, around);
            } else if larger * ROUNDED > 1.0 {
                creases.hollow_mean_curvature -= area * around.flat * mean_curvature;
            }
        }
        // Faces along the grid are faces, however wavy the object.
        let wavy = ramp(wavy / sudden.max(f64::MIN_POSITIVE), WAVY);
        creases.suspected_area -= wavy * (creases.suspected_area - creases.suspected_along_grid);
        creases.told_area -= wavy * (creases.told_area - creases.suspected_along_grid);
        creases
    }

    fn add_convex(&mut self, area: f64, is_sudden: f64, around: &Surroundings) {
        let &Surroundings { cosine, flat, gridded, overshot, .. } = around;
        let share = lost_of_edge(cosine);
        let lost = area * flat * share.min(MOST);
        self.lost_area += lost;
        self.plain_area += lost * ramp(cosine, RIM);
        self.overshot_area += lost * overshot;
        self.acute_area += area * flat * overshot * (share.min(MOST_OF_ACUTE) - MOST).max(0.0);
        self.gridded_area += area * flat * gridded;
        let suspected = area * (is_sudden - flat).max(0.0);
        self.suspected_area += suspected;
        self.told_area += suspected * gridded.max(overshot);
        self.suspected_along_grid += suspected * gridded;
    }
}

/// What lies around a vertex.
#[derive(Debug, Clone, Copy)]
struct Surroundings {
    /// Cosine of half of the angle by which the surface turns.
    cosine: f64,
    /// Whether there are flat faces, from 0 to 1.
    flat: f64,
    /// Mean of the larger principal curvature, 1 / voxel.
    larger: f64,
    /// Whether there are hollows as beside an edge that voxels speak for, and faces along the grid, from 0 to 1.
    overshot: f64,
    gridded: f64,
}

impl Surroundings {
    /// By vertex; normals are along the image's axes.
    fn of(surface: &Surface, areas: &[f64], normals: &[[f64; 3]], grid: &Grid) -> Vec<Self> {
        let (voxel, spacing) = (grid.spacing().geometric_mean(), grid.spacing().mm());
        let indices = indices(&surface.mesh.vertices, grid);
        // Neighbours are averaged by a lattice that begins with the object, so that nothing depends on where it lies.
        let first: [f64; 3] =
            std::array::from_fn(|a| indices.iter().map(|index| index[a]).fold(f64::INFINITY, f64::min));
        let place = |index: &[f64; 3]| std::array::from_fn(|a| (index[a] - first[a]) * spacing[a]);
        let places: Vec<[f64; 3]> = indices.iter().map(place).collect();
        let larger = |n: usize| surface.vertices[n].curvature.larger() * voxel;
        let of_vertex = |(n, normal): (usize, &[f64; 3])| {
            let overshot = surface.vertices[n].curvature.mean_curvature * voxel < OVERSHOT;
            let along = normal.iter().any(|part| part.abs() > ALONG);
            [normal[0], normal[1], normal[2], larger(n), one_if(overshot), one_if(along)]
        };
        let values: Vec<[f64; 6]> = normals.iter().enumerate().map(of_vertex).collect();
        let flat: Vec<[f64; 1]> = (0..normals.len()).map(|n| [one_if(larger(n) * FLAT < 1.0)]).collect();
        let across = SpreadMean::new(&places, ACROSS * voxel).of(&values, areas);
        let beside = SpreadMean::new(&places, BESIDE * voxel).of(&flat, areas);
        let around = |([x, y, z, larger, overshot, along], [flat]): ([f64; 6], [f64; 1])| Self {
            cosine: (length([x, y, z]) / STRAIGHT).min(1.0),
            flat: ramp(flat, FLAT_BESIDE),
            larger,
            overshot: ramp(overshot, OVERSHOOTING),
            gridded: ramp(along, GRIDDED),
        };
        across.into_iter().zip(beside).map(around).collect()
    }
}

/// Normals along the image's axes.
fn in_grid(surface: &Surface, grid: &Grid) -> Vec<[f64; 3]> {
    let axes = grid.axes();
    surface.vertices.iter().map(|vertex| axes.map(|axis| dot(vertex.normal, axis))).collect()
}

/// Area that the voxels' faces have more than the surface, by its normals, where that may be what rounding took.
fn boxed_area(normals: &[[f64; 3]], areas: &[f64]) -> f64 {
    let whole: f64 = areas.iter().sum();
    let sides = |normal: &[f64; 3]| normal.iter().map(|part| part.abs()).sum::<f64>();
    let of_faces: f64 = normals.iter().zip(areas).map(|(normal, area)| area * sides(normal)).sum();
    if whole > 0.0 { (of_faces - whole) * ramp(of_faces / whole, BOX_ALONG) } else { 0.0 }
}

/// Area of the faces along the grid, by axis, beyond what a round body has.
fn faces_along(normals: &[[f64; 3]], areas: &[f64]) -> [f64; 3] {
    let whole: f64 = areas.iter().sum();
    std::array::from_fn(|a| {
        let facing = normals.iter().zip(areas).filter(|(normal, _)| normal[a].abs() > FACING);
        let seen = facing.map(|(_, area)| area).sum::<f64>();
        (seen - USUAL * whole).max(0.0)
    })
}

/// Area that an edge has over its rounding, as a share of the latter, by the cosine of half of its angle.
fn lost_of_edge(cosine: f64) -> f64 {
    let half_angle = libm::acos(cosine);
    if half_angle > 0.0 { libm::tan(half_angle) / half_angle - 1.0 } else { 0.0 }
}

fn one_if(condition: bool) -> f64 {
    f64::from(u8::from(condition))
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
        let object = recovering.prepare(phantom.labels().unwrap().mask(1)).unwrap();
        let surface = object.surface();
        let areas = surface.mesh.vertex_areas();
        let area: f64 = areas.iter().sum();
        (Creases::of(&surface, &areas, object.grid()), area, phantom.truth().unwrap().surface_area)
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
