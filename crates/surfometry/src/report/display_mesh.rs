//! A surface of fewer triangles, for display.
//!
//! Vertices of a cell that face the same way become one: the one nearest to their mean (Rossignac and Borrel 1993). So
//! what is shown are vertices of the surface with their own values, and both sides of a thin wall stay apart. Of
//! crates, `meshopt` is C++, and others keep no vertices.

use crate::space::minus;
use crate::surface::Surface;
use rayon::prelude::*;

/// Some of a surface's vertices, and triangles between them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DisplayMesh {
    /// Numbers of the surface's vertices, ascending.
    pub(super) vertices: Vec<u32>,
    /// Numbers in `vertices`.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Triangles a square of a cell's edge of surface; it is some more where that is rough.
const TRIANGLES_OF_CELL: f64 = 2.6;
/// How much larger cells become where too many triangles are left.
const LARGER: f64 = 1.2;

impl DisplayMesh {
    /// At most so many triangles of a surface; all where it has no more.
    pub(super) fn of(surface: &Surface, most: usize) -> Self {
        let mesh = &surface.mesh;
        if mesh.triangles.len() <= most {
            let vertices = (0..mesh.vertices.len() as u32).collect();
            return Self { vertices, triangles: mesh.triangles.clone() };
        }
        let mut edge = (TRIANGLES_OF_CELL * mesh.area() / most.max(1) as f64).sqrt();
        let largest = mesh.area().sqrt();
        while edge < largest {
            let clustered = Self::clustered(surface, edge);
            if clustered.triangles.len() <= most {
                return clustered;
            }
            edge *= LARGER;
        }
        // So few show nothing.
        Self::of_used(Vec::new())
    }

    fn clustered(surface: &Surface, edge: f64) -> Self {
        let mesh = &surface.mesh;
        let key = |number: usize| {
            let cell = mesh.vertices[number].map(|v| libm::floor(v / edge) as i64);
            (cell, facing(surface.vertices[number].normal), number as u32)
        };
        let mut keys: Vec<_> = (0..mesh.vertices.len()).into_par_iter().map(key).collect();
        keys.par_sort_unstable();
        // Of each vertex, the one that stands for its cluster.
        let mut stands_for = vec![0u32; mesh.vertices.len()];
        for cluster in keys.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let members = || cluster.iter().map(|(.., number)| *number);
            let mean: [f64; 3] = std::array::from_fn(|a| {
                members().map(|n| mesh.vertices[n as usize][a]).sum::<f64>() / cluster.len() as f64
            });
            let distance =
                |n: u32| minus(mesh.vertices[n as usize], mean).into_iter().map(|d| d * d).sum::<f64>();
            let middle = members().min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or_default();
            members().for_each(|n| stands_for[n as usize] = middle);
        }
        let mut triangles: Vec<[u32; 3]> = mesh
            .triangles
            .iter()
            .map(|triangle| triangle.map(|v| stands_for[v as usize]))
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .map(turned)
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        Self::of_used(triangles)
    }

    /// Without the vertices that no triangle has.
    fn of_used(mut triangles: Vec<[u32; 3]>) -> Self {
        let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let place = |v: u32| vertices.binary_search(&v).map_or(0, |place| place as u32);
        for triangle in &mut triangles {
            *triangle = triangle.map(place);
        }
        Self { vertices, triangles }
    }
}

/// The same triangle, its smallest vertex first.
fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    }
}

/// Which of the six sides of a cube a normal leaves through.
fn facing(normal: [f64; 3]) -> u8 {
    let axis = (1..3).fold(0, |most, a| if normal[a].abs() > normal[most].abs() { a } else { most });
    2 * axis as u8 + u8::from(normal[axis] > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Measurement;
    use crate::phantoms::Phantom;
    use crate::surface::Mesh;

    fn surface(spec: &str) -> Surface {
        let mask = Phantom::from_spec(spec).unwrap().labels().unwrap().mask(1);
        Measurement::default().prepare(mask).unwrap().surface()
    }

    #[test]
    fn a_torus_keeps_its_shape_in_a_tenth_of_its_triangles() {
        let surface = surface("torus?major=14&minor=6&spacing=1,0.8,1.2&rotate=20,30,40&shift=0.3,0.1,0.2");
        let all = surface.mesh.triangles.len();
        let few = DisplayMesh::of(&surface, all / 10);
        assert!(few.triangles.len() <= all / 10 && few.triangles.len() > all / 25, "{}", few.triangles.len());
        let vertices = few.vertices.iter().map(|&v| surface.mesh.vertices[v as usize]).collect();
        let mesh = Mesh { vertices, triangles: few.triangles };
        let exact = 2.0 * std::f64::consts::PI.powi(2) * 14.0 * 36.0;
        // Its corners lie on the torus, so it lies within: 15 % less where cells are a third of the tube.
        assert!((0.8..1.0).contains(&(mesh.volume() / exact)), "{}", mesh.volume() / exact);
        let normals = mesh.vertex_normals();
        let along =
            |(normal, &v): (&[f64; 3], &u32)| crate::space::dot(*normal, surface.vertices[v as usize].normal);
        let turned = normals.iter().zip(&few.vertices).filter(|pair| along(*pair) < 0.5).count();
        assert!(turned * 50 < normals.len(), "{turned} of {}", normals.len());
    }

    #[test]
    fn a_small_surface_is_left_as_it_is() {
        let surface = surface("ball?radius=5");
        let same = DisplayMesh::of(&surface, surface.mesh.triangles.len());
        assert_eq!(same.triangles, surface.mesh.triangles);
        assert_eq!(same.vertices.len(), surface.mesh.vertices.len());
        assert!(DisplayMesh::of(&surface, 0).triangles.is_empty());
    }
}
