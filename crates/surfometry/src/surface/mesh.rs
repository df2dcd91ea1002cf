//! Triangle meshes.

use crate::space::{cross, dot, length, minus};
use std::collections::HashMap;

/// A triangle mesh with shared vertices, in world coordinates (RAS, mm), its triangles wound so that their
/// normals point outward, also where the image's affine mirrors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Positions, mm.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex numbers, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Corners of a triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [[f64; 3]; 3] {
        triangle.map(|v| self.vertices[v as usize])
    }

    /// Unit normal of a triangle, outward; zero where the triangle has no area.
    pub fn normal(&self, triangle: [u32; 3]) -> [f64; 3] {
        let [a, b, c] = self.corners(triangle);
        let normal = cross(minus(b, a), minus(c, a));
        let length = length(normal);
        if length > 0.0 { normal.map(|n| n / length) } else { [0.0; 3] }
    }

    /// Sum of the triangles' areas, mm^2.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|&t| triangle_area(self.corners(t))).sum()
    }

    /// Enclosed volume, mm^3: the sum of signed tetrahedra over the triangles (the divergence theorem).
    /// Meaningful for a closed mesh only.
    pub fn volume(&self) -> f64 {
        // From a vertex, not from the world's origin, which may lie far away.
        let Some(&origin) = self.vertices.first() else { return 0.0 };
        self.triangles.iter().map(|&t| tetrahedron_volume(self.corners(t).map(|c| minus(c, origin)))).sum()
    }

    /// V - E + F. Of the closed surface: ball 2, torus 0.
    pub fn euler_characteristic(&self) -> i64 {
        let edges = self.edge_uses().len();
        self.vertices.len() as i64 - edges as i64 + self.triangles.len() as i64
    }

    /// Whether every edge belongs to two triangles that pass through it in opposite directions: closed,
    /// without branches and consistently oriented.
    pub fn is_closed(&self) -> bool {
        self.edge_uses().values().all(|&[forward, backward]| (forward, backward) == (1, 1))
    }

    /// How often each edge, named by its vertices in ascending order, is passed upward and downward.
    pub(crate) fn edge_uses(&self) -> HashMap<(u32, u32), [u32; 2]> {
        let mut uses = HashMap::new();
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let counts: &mut [u32; 2] = uses.entry((from.min(to), from.max(to))).or_default();
                counts[usize::from(from > to)] += 1;
            }
        }
        uses
    }

    /// The integral of H over it, mm: half of length times angle, edge by edge (Steiner's formula for polyhedra); edges
    /// where the mesh is open have none.
    pub fn total_mean_curvature(&self) -> f64 {
        let mut sides: Vec<([u32; 2], bool, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (number, &[a, b, c]) in self.triangles.iter().enumerate() {
            sides.extend([[a, b], [b, c], [c, a]].map(|[from, to]| {
                let forward = from < to;
                (if forward { [from, to] } else { [to, from] }, forward, number as u32)
            }));
        }
        sides.sort_unstable();
        let normal = |triangle: u32| {
            let [a, b, c] = self.triangles[triangle as usize].map(|v| self.vertices[v as usize]);
            cross(minus(b, a), minus(c, a))
        };
        let bend = |pair: &[([u32; 2], bool, u32)]| match pair {
            [(edge, false, left), (_, true, right)] => {
                let [from, to] = edge.map(|v| self.vertices[v as usize]);
                let along = minus(to, from);
                let length = dot(along, along).sqrt();
                let (n, m) = (normal(*right), normal(*left));
                let angle = libm::atan2(dot(cross(n, m), along), length * dot(n, m));
                if angle.is_finite() { 0.5 * length * angle } else { 0.0 }
            }
            _ => 0.0,
        };
        sides.chunk_by(|a, b| a.0 == b.0).map(bend).sum()
    }

    /// A third of the area of the triangles around each vertex, mm^2: weights that sum to the mesh's area.
    pub fn vertex_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.vertices.len()];
        for &triangle in &self.triangles {
            let third = triangle_area(self.corners(triangle)) / 3.0;
            for v in triangle {
                areas[v as usize] += third;
            }
        }
        areas
    }

    /// Unit normals at the vertices: means of the triangles' around, weighted by area. Along x where they
    /// cancel.
    pub fn vertex_normals(&self) -> Vec<[f64; 3]> {
        let mut normals = vec![[0.0; 3]; self.vertices.len()];
        for &triangle in &self.triangles {
            let [a, b, c] = self.corners(triangle);
            let across = cross(minus(b, a), minus(c, a));
            for v in triangle {
                normals[v as usize] = std::array::from_fn(|i| normals[v as usize][i] + across[i]);
            }
        }
        let unit = |v: [f64; 3]| {
            let length = length(v);
            if length > 0.0 { v.map(|c| c / length) } else { [1.0, 0.0, 0.0] }
        };
        normals.into_iter().map(unit).collect()
    }
}

/// Area of a triangle.
pub(crate) fn triangle_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    0.5 * length(cross(minus(b, a), minus(c, a)))
}

/// Signed volume of the tetrahedron between a triangle and the origin, positive where the triangle faces away
/// from it.
pub(crate) fn tetrahedron_volume([a, b, c]: [[f64; 3]; 3]) -> f64 {
    dot(a, cross(b, c)) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_far_from_the_origin() {
        let at = |x: f64, y: f64, z: f64| [1e4 + x, y, z];
        let mesh = Mesh {
            vertices: vec![at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(0.0, 0.0, 1.0)],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        };
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-12);
        assert!((mesh.area() - 1.5 - 0.75f64.sqrt()).abs() < 1e-12);
        assert_eq!(mesh.normal([0, 2, 1]), [0.0, 0.0, -1.0]);
        assert_eq!(mesh.normal([0, 1, 1]), [0.0; 3]);
        assert!((mesh.vertex_areas().iter().sum::<f64>() - mesh.area()).abs() < 1e-12);
        assert_eq!(mesh.euler_characteristic(), 2);
        assert!(mesh.is_closed());
        let normal = mesh.vertex_normals()[0];
        assert!(normal.iter().all(|n| (n + 3f64.sqrt().recip()).abs() < 1e-12), "{normal:?}");
        let open = Mesh { triangles: mesh.triangles[1..].to_vec(), ..mesh.clone() };
        assert!(!open.is_closed());
        assert_eq!(open.euler_characteristic(), 1);
        let turned = Mesh { triangles: vec![[0, 1, 2], [0, 1, 3], [0, 3, 2], [1, 2, 3]], ..mesh };
        assert!(!turned.is_closed());
    }

    /// A box has its edges' lengths times pi / 4, whichever way its faces are cut into triangles; turned inside
    /// out, minus that.
    #[test]
    fn edges_have_total_mean_curvature() {
        let sides = [2.0, 3.0, 5.0];
        let corner = |n: u32| std::array::from_fn(|a| f64::from(n >> a & 1) * sides[a]);
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> =
            faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mesh = Mesh { vertices: (0..8).map(corner).collect(), triangles };
        assert!((mesh.volume() - 30.0).abs() < 1e-12 && mesh.is_closed());
        let expected = 4.0 * (2.0 + 3.0 + 5.0) * std::f64::consts::PI / 4.0;
        assert!((mesh.total_mean_curvature() - expected).abs() < 1e-12);
        let turned = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let hollow = Mesh { triangles: turned, ..mesh };
        assert!((hollow.total_mean_curvature() + expected).abs() < 1e-12);
    }
}
