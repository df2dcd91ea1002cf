//! Meshes as pixels.
//!
//! A z-buffer of our own: the renderers that are kept (`wgpu`, `three-d`) need a GPU or a window system, and
//! their pixels differ from driver to driver. What a figure needs is small: one mesh, colours at vertices, a
//! parallel projection. Rows are drawn in bands in parallel; within a band triangles come in their order and
//! the first of equally near ones stays, so the bits do not depend on the number of threads.

use rayon::prelude::*;

use super::camera::Camera;
use super::raster::{Background, Light, LinearTable, Raster};
use super::shading::{brightness, dimmed};
use crate::space::{cross, minus};
use crate::surface::Mesh;

/// Samples along each side of a pixel.
const SAMPLES: usize = 3;
/// Rows of pixels in a band.
const BAND: usize = 16;
/// No triangle.
const NONE: u32 = u32::MAX;

/// A coloured surface.
#[derive(Debug, Clone, Copy)]
pub struct ColoredSurface<'a> {
    /// The triangles. Those with a missing or non-finite corner are not drawn.
    pub mesh: &'a Mesh,
    /// sRGB at the vertices; mid-grey where there is none.
    pub colors: &'a [[u8; 3]],
    /// Outward normals at the vertices (RAS); where there are none (`&[]`) triangles are shaded flat.
    pub normals: &'a [[f64; 3]],
    /// Share of the sky that each vertex sees; 1 where there is none (`&[]`).
    pub openness: &'a [f32],
}

/// Draws a surface: hidden parts removed, colours and normals interpolated, nine samples a pixel averaged in
/// linear light. Both sides of a triangle are drawn.
pub fn render_surface(surface: &ColoredSurface, camera: &Camera, background: Background) -> Raster {
    let [width, height] = camera.size;
    let scene = Scene::new(surface, camera);
    let bands: Vec<Vec<u8>> = scene
        .by_band()
        .par_iter()
        .enumerate()
        .map(|(n, list)| scene.draw_band(n, list, background))
        .collect();
    Raster { width, height, rgba: bands.concat() }
}

struct Scene<'a> {
    surface: &'a ColoredSurface<'a>,
    camera: &'a Camera,
    linear: LinearTable,
    /// Vertices in samples (x, y) and mm (depth).
    points: Vec<[f64; 3]>,
}

/// Samples of one band: which triangle is seen.
struct Band {
    first_row: usize,
    rows: usize,
    width: usize,
    depth: Vec<f64>,
    triangle: Vec<u32>,
}

impl<'a> Scene<'a> {
    fn new(surface: &'a ColoredSurface, camera: &'a Camera) -> Self {
        let project = |v: &[f64; 3]| {
            let [x, y, depth] = camera.project(*v);
            [x * SAMPLES as f64, y * SAMPLES as f64, depth]
        };
        let points = surface.mesh.vertices.par_iter().map(project).collect();
        Self { surface, camera, linear: LinearTable::new(), points }
    }

    /// Corners of a triangle in samples, if it can be drawn.
    fn corners(&self, number: u32) -> Option<[[f64; 3]; 3]> {
        let [a, b, c] =
            self.surface.mesh.triangles[number as usize].map(|v| self.points.get(v as usize).copied());
        let corners = [a?, b?, c?];
        corners.iter().flatten().all(|v| v.is_finite()).then_some(corners)
    }

    /// The triangles that reach into each band, in their order.
    fn by_band(&self) -> Vec<Vec<u32>> {
        let mut bands = vec![Vec::new(); self.camera.size[1].div_ceil(BAND)];
        for number in 0..self.surface.mesh.triangles.len() as u32 {
            let Some(corners) = self.corners(number) else { continue };
            let (first, end) = covered(corners.map(|c| c[1]), self.camera.size[1] * SAMPLES);
            if first < end {
                let edge = BAND * SAMPLES;
                bands[first / edge..=(end - 1) / edge].iter_mut().for_each(|list| list.push(number));
            }
        }
        bands
    }

    fn draw_band(&self, number: usize, triangles: &[u32], background: Background) -> Vec<u8> {
        let [width, height] = self.camera.size;
        let rows = BAND.min(height - number * BAND);
        let mut band = Band::new(number * BAND * SAMPLES, rows * SAMPLES, width * SAMPLES);
        for &triangle in triangles {
            if let Some(corners) = self.corners(triangle) {
                band.draw(triangle, corners);
            }
        }
        let pixels = (0..rows).flat_map(|y| (0..width).map(move |x| [x, y]));
        pixels.flat_map(|pixel| self.pixel(&band, pixel).on(background)).collect()
    }

    /// Mean of a pixel's samples. Those of one triangle are shaded once, at their middle: within a pixel only
    /// edges matter.
    fn pixel(&self, band: &Band, [x, y]: [usize; 2]) -> Light {
        let mut parts = [(NONE, 0u32, [0.0; 2]); SAMPLES * SAMPLES];
        for row in y * SAMPLES..(y + 1) * SAMPLES {
            for column in x * SAMPLES..(x + 1) * SAMPLES {
                let triangle = band.triangle[row * band.width + column];
                let known = parts.iter_mut().find(|p| p.0 == triangle || p.1 == 0);
                if let Some((name, count, sum)) = known.filter(|_| triangle != NONE) {
                    let at = [column as f64 + 0.5, (band.first_row + row) as f64 + 0.5];
                    (*name, *count, *sum) = (triangle, *count + 1, [sum[0] + at[0], sum[1] + at[1]]);
                }
            }
        }
        let mut light = Light::default();
        for (triangle, count, sum) in parts.into_iter().take_while(|p| p.1 > 0) {
            let at = sum.map(|s| s / f64::from(count));
            light.add(self.light(triangle, at), count as f32 / (SAMPLES * SAMPLES) as f32);
        }
        light
    }

    /// Light from a place of a triangle.
    fn light(&self, triangle: u32, at: [f64; 2]) -> [f32; 3] {
        let Some(corners) = self.corners(triangle) else { return [0.0; 3] };
        let area = doubled_area(corners);
        let weights = weights(corners, at).map(|w| w / area);
        let vertices = self.surface.mesh.triangles[triangle as usize].map(|v| v as usize);
        let (mut rgb, mut open) = ([0.0; 3], 0.0);
        for (vertex, weight) in vertices.into_iter().zip(weights) {
            open += weight as f32 * self.surface.openness.get(vertex).copied().unwrap_or(1.0);
            let color = self.linear.light(self.surface.colors.get(vertex).copied().unwrap_or([160; 3]));
            rgb = std::array::from_fn(|i| rgb[i] + weight as f32 * color[i]);
        }
        // Rows count downward, so a triangle that faces the viewer has a negative area.
        let side = if area < 0.0 { 1.0 } else { -1.0 };
        let normal = self.normal(vertices, weights);
        let shade = brightness(self.camera.basis.coordinates(normal).map(|v| (side * v) as f32));
        rgb.map(|c| c.max(0.0) * shade * dimmed(open))
    }

    fn normal(&self, vertices: [usize; 3], weights: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = vertices.map(|v| self.surface.normals.get(v));
        if let (Some(a), Some(b), Some(c)) = (a, b, c) {
            return std::array::from_fn(|i| weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i]);
        }
        let [a, b, c] = vertices.map(|v| self.surface.mesh.vertices[v]);
        cross(minus(b, a), minus(c, a))
    }
}

impl Band {
    fn new(first_row: usize, rows: usize, width: usize) -> Self {
        let samples = rows * width;
        Self {
            first_row,
            rows,
            width,
            depth: vec![f64::NEG_INFINITY; samples],
            triangle: vec![NONE; samples],
        }
    }

    /// Enters a triangle wherever it is nearer than what is there.
    fn draw(&mut self, number: u32, corners: [[f64; 3]; 3]) {
        let area = doubled_area(corners);
        if area == 0.0 {
            return;
        }
        let per_area = 1.0 / area;
        let (left, right) = covered(corners.map(|c| c[0]), self.width);
        let (top, bottom) = covered(corners.map(|c| c[1] - self.first_row as f64), self.rows);
        for row in top..bottom {
            for column in left..right {
                let at = [column as f64 + 0.5, (self.first_row + row) as f64 + 0.5];
                let [a, b, c] = weights(corners, at).map(|w| w * per_area);
                if a < 0.0 || b < 0.0 || c < 0.0 {
                    continue;
                }
                let depth = a * corners[0][2] + b * corners[1][2] + c * corners[2][2];
                let sample = row * self.width + column;
                if depth > self.depth[sample] {
                    (self.depth[sample], self.triangle[sample]) = (depth, number);
                }
            }
        }
    }
}

/// Samples, whose centres lie at halves, between the least and the largest of three coordinates.
fn covered([a, b, c]: [f64; 3], count: usize) -> (usize, usize) {
    let clamped = |v: f64| v.clamp(0.0, count as f64) as usize;
    (clamped(libm::ceil(a.min(b).min(c) - 0.5)), clamped(libm::floor(a.max(b).max(c) + 0.5)))
}

fn doubled_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Doubled areas opposite to each corner: barycentric coordinates up to the triangle's own. An edge shared by
/// two triangles gives the same number to both up to its sign, so no sample falls between them.
fn weights([a, b, c]: [[f64; 3]; 3], at: [f64; 2]) -> [f64; 3] {
    let side = |p: [f64; 3], q: [f64; 3]| {
        let (p, q, sign) = if (p[0], p[1]) <= (q[0], q[1]) { (p, q, 1.0) } else { (q, p, -1.0) };
        sign * ((q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]))
    };
    [side(b, c), side(c, a), side(a, b)]
}
