//! How much of the sky each place of a surface sees.
//!
//! By shadow maps: points all over the surface are entered into maps of what is nearest, seen from directions all
//! around, and a vertex sees those directions from which nothing is in front of it. That is the same from every
//! viewpoint, smooth over the surface, and needs no random numbers. Directions are looked at in parallel and added in
//! their order, so the bits do not depend on the number of threads.

use rayon::prelude::*;

use super::view::Basis;
use crate::space::{cross, dot, length, minus, sphere, unit};
use crate::surface::Mesh;

/// Directions, evenly spread.
const DIRECTIONS: usize = 64;
/// Directions at a time, of which a bit a vertex is kept.
const TOGETHER: usize = 8;
/// Most texels along the surface's largest extent in a shadow map.
const TEXELS: f64 = 640.0;
/// By how many texels a vertex is lifted off its own surface: a point's depth stands for the texels beside its own,
/// up to 2.1 texels away, too.
const LIFT: f64 = 2.5;
/// Most parts into which a triangle's sides are divided.
const MOST_PARTS: f64 = 64.0;

/// Share of the sky above each vertex, by the cosine to its normal, that no part of the surface hides: 1 on a
/// convex body, little deep in a network. 1 for all without a normal each.
pub(crate) fn openness(mesh: &Mesh, normals: &[[f64; 3]]) -> Vec<f32> {
    let vertices = &mesh.vertices;
    let Some(texel) = texel(mesh).filter(|_| normals.len() == vertices.len()) else {
        return vec![1.0; vertices.len()];
    };
    let points = points(mesh, texel);
    let lifted: Vec<[f64; 3]> = vertices
        .iter()
        .zip(normals)
        .map(|(vertex, normal)| std::array::from_fn(|i| vertex[i] + LIFT * texel * normal[i]))
        .collect();
    let mut seen = vec![[0.0f32; 2]; vertices.len()];
    let directions: Vec<[f64; 3]> = sphere(DIRECTIONS).collect();
    for some in directions.chunks(TOGETHER) {
        let lit = |&toward: &[f64; 3]| -> Vec<bool> {
            let map = ShadowMap::of(&points, toward, texel);
            lifted.iter().map(|point| map.sees(*point)).collect()
        };
        let lit: Vec<Vec<bool>> = some.par_iter().map(lit).collect();
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

/// Corners of the triangles that can be seen.
fn corners(mesh: &Mesh) -> impl Iterator<Item = [[f64; 3]; 3]> + '_ {
    mesh.triangles.iter().filter_map(|triangle| {
        let [a, b, c] = triangle.map(|v| mesh.vertices.get(v as usize).copied());
        let corners = [a?, b?, c?];
        corners.iter().flatten().all(|v| v.is_finite()).then_some(corners)
    })
}

/// Size of a texel, mm: the triangles' mean side, so that most are one point each. `None` without any.
fn texel(mesh: &Mesh) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0u64);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for [a, b, c] in corners(mesh) {
        sum += length(minus(a, b)) + length(minus(b, c)) + length(minus(c, a));
        count += 3;
        low = std::array::from_fn(|i| low[i].min(a[i]).min(b[i]).min(c[i]));
        high = std::array::from_fn(|i| high[i].max(a[i]).max(b[i]).max(c[i]));
    }
    let texel = (sum / count as f64).max(length(minus(high, low)) / TEXELS);
    (texel.is_finite() && texel > 0.0).then_some(texel)
}

/// Points on the surface, none of which is farther than a texel from one of them: the middle of each triangle, or of
/// parts of it where it is large. All of a triangle is within its longest side over sqrt 3 of its middle.
fn points(mesh: &Mesh, texel: f64) -> Vec<[f64; 3]> {
    let mut points = Vec::with_capacity(mesh.triangles.len());
    for [a, b, c] in corners(mesh) {
        let [ab, ac] = [minus(b, a), minus(c, a)];
        let longest = [ab, ac, minus(c, b)].map(length).into_iter().fold(0.0, f64::max);
        let reach = longest / libm::sqrt(3.0);
        let parts = libm::ceil(reach / texel).clamp(1.0, MOST_PARTS) as usize;
        for (i, j) in (0..parts).flat_map(|i| (0..parts - i).map(move |j| (i, j))) {
            let [u, v] = [i, j].map(|n| (n as f64 + 1.0 / 3.0) / parts as f64);
            points.push(std::array::from_fn(|x| a[x] + u * ab[x] + v * ac[x]));
        }
    }
    points
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
    fn of(points: &[[f64; 3]], toward: [f64; 3], mm_per_texel: f64) -> Self {
        let aside = if toward[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let right = unit(cross(aside, toward));
        let basis = Basis { right, up: cross(toward, right), toward };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let seen: Vec<[f64; 3]> = points.iter().map(|point| basis.coordinates(*point)).collect();
        for [x, y, _] in &seen {
            low = [low[0].min(*x), low[1].min(*y)];
            high = [high[0].max(*x), high[1].max(*y)];
        }
        // A rim, which has its share of the points beside it.
        let corner = low.map(|v| v - 1.5 * mm_per_texel);
        let size = [0, 1].map(|a| ((high[a] - corner[a]) / mm_per_texel) as usize + 3);
        let depth = vec![f32::NEG_INFINITY; size[0] * size[1]];
        let mut map = Self { basis, corner, mm_per_texel, size, depth };
        for point in seen {
            map.enter(point);
        }
        map
    }

    /// Texels along right and up.
    fn place(&self, [x, y, _]: [f64; 3]) -> [f64; 2] {
        [(x - self.corner[0]) / self.mm_per_texel, (y - self.corner[1]) / self.mm_per_texel]
    }

    /// A point's depth, in its texel and those around.
    fn enter(&mut self, point: [f64; 3]) {
        let [column, row] = self.place(point).map(|v| v as usize);
        for row in row - 1..=row + 1 {
            let start = row * self.size[0] + column;
            for texel in &mut self.depth[start - 1..=start + 1] {
                *texel = texel.max(point[2] as f32);
            }
        }
    }

    /// Whether nothing is before a point.
    fn sees(&self, point: [f64; 3]) -> bool {
        let point = self.basis.coordinates(point);
        let ([x, y], depth) = (self.place(point), point[2]);
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
        // Its own texels shade it by 2 % where it is curved most.
        assert!(least > 0.97, "{least}");
    }

    /// The rim of a torus' hole sees the sky on one side of the tube's opposite wall only; from its outside, all.
    #[test]
    fn a_hole_sees_less_and_a_cavity_nothing() {
        let torus = surface("torus?major=12&minor=5&rotate=10,20,30");
        let open_there = open(&torus);
        let outward = |v: &crate::surface::VertexGeometry| v.curvature.gaussian_curvature > 0.008;
        let within = |v: &crate::surface::VertexGeometry| v.curvature.gaussian_curvature < -0.015;
        let mean = |of: &dyn Fn(&crate::surface::VertexGeometry) -> bool| {
            let kept: Vec<f32> =
                torus.vertices.iter().zip(&open_there).filter(|(v, _)| of(v)).map(|(_, o)| *o).collect();
            assert!(kept.len() > 100);
            kept.iter().sum::<f32>() / kept.len() as f32
        };
        assert!(mean(&outward) > 0.96 && mean(&within) < 0.9, "{} {}", mean(&outward), mean(&within));
        let shell = surface("shell?radius=14&inner=8");
        let (inner, outer): (Vec<f32>, Vec<f32>) = {
            let [mut inner, mut outer] = [Vec::new(), Vec::new()];
            for (vertex, open) in shell.vertices.iter().zip(open(&shell)) {
                if vertex.curvature.mean_curvature < 0.0 { &mut inner } else { &mut outer }.push(open);
            }
            (inner, outer)
        };
        assert!(inner.iter().all(|o| *o < 0.02) && outer.iter().all(|o| *o > 0.96));
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
