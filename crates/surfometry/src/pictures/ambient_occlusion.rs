//! How much of the sky each place of a surface sees.
//!
//! By shadow maps: the surface is drawn from directions all around, and a vertex sees those from which nothing
//! is in front of it. That is the same from every viewpoint, smooth over the surface, and needs no random
//! numbers. Directions are looked at in parallel and added in their order, so the bits do not depend on the
//! number of threads.

use rayon::prelude::*;

use super::surface_rendering::{doubled_area, weights};
use super::view::Basis;
use crate::surface::{Mesh, cross, dot, unit};

/// Directions, evenly spread.
const DIRECTIONS: usize = 64;
/// Directions at a time, of which a bit a vertex is kept.
const TOGETHER: usize = 8;
/// Texels along the surface's largest extent in a shadow map.
const TEXELS: f64 = 640.0;
/// By how many texels a vertex is lifted off its own triangles.
const LIFT: f64 = 1.5;

/// Share of the sky above each vertex, by the cosine to its normal, that no part of the surface hides: 1 on a
/// convex body, little deep in a network. 1 for all without a normal each.
pub(crate) fn openness(mesh: &Mesh, normals: &[[f64; 3]]) -> Vec<f32> {
    if normals.len() != mesh.vertices.len() || mesh.triangles.is_empty() {
        return vec![1.0; mesh.vertices.len()];
    }
    let mut seen = vec![[0.0f32; 2]; normals.len()];
    let directions: Vec<[f64; 3]> = (0..DIRECTIONS).map(direction).collect();
    for some in directions.chunks(TOGETHER) {
        let lit: Vec<Vec<bool>> = some.par_iter().map(|&toward| lit(mesh, normals, toward)).collect();
        seen.par_iter_mut().enumerate().for_each(|(vertex, [open, all])| {
            for (toward, lit) in some.iter().zip(&lit) {
                let cosine = dot(normals[vertex], *toward).max(0.0) as f32;
                *all += cosine;
                *open += if lit[vertex] { cosine } else { 0.0 };
            }
        });
    }
    seen.into_iter().map(|[open, all]| if all > 0.0 { open / all } else { 1.0 }).collect()
}

/// Points of a Fibonacci sphere.
fn direction(number: usize) -> [f64; 3] {
    let golden = std::f64::consts::PI * (3.0 - libm::sqrt(5.0));
    let z = 1.0 - (2 * number + 1) as f64 / DIRECTIONS as f64;
    let (sin, cos) = libm::sincos(golden * number as f64);
    let across = libm::sqrt(1.0 - z * z);
    [across * cos, across * sin, z]
}

/// Which vertices are seen from a direction.
fn lit(mesh: &Mesh, normals: &[[f64; 3]], toward: [f64; 3]) -> Vec<bool> {
    let map = ShadowMap::of(mesh, toward);
    let lift = LIFT * map.mm_per_texel;
    let lifted = |(vertex, normal): (&[f64; 3], &[f64; 3])| {
        map.sees(std::array::from_fn(|i| vertex[i] + lift * normal[i]))
    };
    mesh.vertices.iter().zip(normals).map(lifted).collect()
}

/// What is nearest to a direction, texel by texel.
struct ShadowMap {
    basis: Basis,
    /// Of the lower left corner, along right and up.
    corner: [f64; 2],
    mm_per_texel: f64,
    size: [usize; 2],
    depth: Vec<f32>,
}

impl ShadowMap {
    fn of(mesh: &Mesh, toward: [f64; 3]) -> Self {
        let aside = if toward[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let right = unit(cross(aside, toward));
        let basis = Basis { right, up: cross(toward, right), toward };
        let points: Vec<[f64; 3]> = mesh.vertices.iter().map(|v| basis.coordinates(*v)).collect();
        let finite = || points.iter().filter(|p| p.iter().all(|v| v.is_finite()));
        let least = |a: usize| finite().map(|p| p[a]).fold(f64::INFINITY, f64::min);
        let most = |a: usize| finite().map(|p| p[a]).fold(f64::NEG_INFINITY, f64::max);
        let corner = [least(0), least(1)];
        let extent = [most(0) - corner[0], most(1) - corner[1]];
        let largest = extent[0].max(extent[1]);
        let mm_per_texel = if largest.is_finite() && largest > 0.0 { largest / TEXELS } else { 1.0 };
        let size = extent.map(|e| (e.max(0.0) / mm_per_texel) as usize + 1);
        let mut map =
            Self { basis, corner, mm_per_texel, size, depth: vec![f32::NEG_INFINITY; size[0] * size[1]] };
        for triangle in &mesh.triangles {
            if let [Some(a), Some(b), Some(c)] = triangle.map(|v| points.get(v as usize)) {
                map.draw([a, b, c].map(|p| map.place(*p)));
            }
        }
        map
    }

    /// Texels along right and up, and depth.
    fn place(&self, [x, y, depth]: [f64; 3]) -> [f64; 3] {
        [(x - self.corner[0]) / self.mm_per_texel, (y - self.corner[1]) / self.mm_per_texel, depth]
    }

    fn draw(&mut self, corners: [[f64; 3]; 3]) {
        let area = doubled_area(corners);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let covered = |a: usize| {
            let least = corners.iter().map(|c| c[a]).fold(f64::INFINITY, f64::min);
            let most = corners.iter().map(|c| c[a]).fold(f64::NEG_INFINITY, f64::max);
            (least - 0.5).max(0.0) as usize..((most + 0.5).max(0.0) as usize).min(self.size[a])
        };
        let (columns, rows) = (covered(0), covered(1));
        for row in rows {
            for column in columns.clone() {
                let shares = weights(corners, [column as f64 + 0.5, row as f64 + 0.5]).map(|w| w / area);
                if shares.iter().all(|share| *share >= 0.0) {
                    let depth: f64 = shares.iter().zip(corners).map(|(share, c)| share * c[2]).sum();
                    let texel = &mut self.depth[row * self.size[0] + column];
                    *texel = texel.max(depth as f32);
                }
            }
        }
    }

    /// Whether nothing is before a point.
    fn sees(&self, point: [f64; 3]) -> bool {
        let [x, y, depth] = self.place(self.basis.coordinates(point));
        let inside = |v: f64, count: usize| (v >= 0.0 && v < count as f64).then_some(v as usize);
        match (inside(x, self.size[0]), inside(y, self.size[1])) {
            (Some(column), Some(row)) => f64::from(self.depth[row * self.size[0] + column]) <= depth,
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantoms::Phantom;
    use crate::{Measurement, surface::Surface};

    fn surface(spec: &str) -> Surface {
        let mask = Phantom::from_spec(spec).unwrap().labels().unwrap().mask(1);
        Measurement::default().prepare(mask).unwrap().surface()
    }

    fn open(surface: &Surface) -> Vec<f32> {
        let normals: Vec<[f64; 3]> = surface.vertices.iter().map(|v| v.normal).collect();
        openness(&surface.mesh, &normals)
    }

    #[test]
    fn a_convex_body_sees_the_whole_sky() {
        let body = surface("ellipsoid?radii=14,10,8&rotate=20,30,40&spacing=0.8,1,1.3");
        let least = open(&body).into_iter().fold(1.0, f32::min);
        assert!(least > 0.985, "{least}");
    }

    /// The rim of a torus' hole sees the sky on one side of the tube's opposite wall only; from its outside, all.
    #[test]
    fn a_hole_sees_less_and_a_cavity_nothing() {
        let torus = surface("torus?major=12&minor=5&rotate=10,20,30");
        let open_there = open(&torus);
        let outward = |v: &crate::surface::VertexGeometry| v.curvature.gaussian_curvature > 0.02;
        let within = |v: &crate::surface::VertexGeometry| v.curvature.gaussian_curvature < -0.02;
        let mean = |of: &dyn Fn(&crate::surface::VertexGeometry) -> bool| {
            let kept: Vec<f32> =
                torus.vertices.iter().zip(&open_there).filter(|(v, _)| of(v)).map(|(_, o)| *o).collect();
            assert!(kept.len() > 100);
            kept.iter().sum::<f32>() / kept.len() as f32
        };
        assert!(mean(&outward) > 0.97 && mean(&within) < 0.85, "{} {}", mean(&outward), mean(&within));
        let shell = surface("shell?radius=14&inner=8");
        let (inner, outer): (Vec<f32>, Vec<f32>) = {
            let [mut inner, mut outer] = [Vec::new(), Vec::new()];
            for (vertex, open) in shell.vertices.iter().zip(open(&shell)) {
                if vertex.curvature.mean_curvature < 0.0 { &mut inner } else { &mut outer }.push(open);
            }
            (inner, outer)
        };
        assert!(inner.iter().all(|o| *o == 0.0) && outer.iter().all(|o| *o > 0.98));
    }

    #[test]
    fn the_same_bits_on_any_number_of_threads() {
        let torus = surface("torus?major=9&minor=4&rotate=10,20,30");
        let on = |count: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
            pool.install(|| open(&torus)).into_iter().map(f32::to_bits).collect::<Vec<_>>()
        };
        assert_eq!(on(1), on(3));
    }
}
