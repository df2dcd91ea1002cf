//! Curvature from the change of area when a surface is moved along its normals (Hildebrand and Rüegsegger
//! 1997).

use crate::surface::Mesh;

/// dA/dr at r = 0, which is 2 M: from the areas at `step` mm outside and inside (`central`), or at `step`
/// outside and 0, as the paper has it. The latter is too large by `step` times the integral of K. Neither
/// holds where a surface turns within `step`.
pub fn area_derivative(mesh: &Mesh, step: f64, central: bool) -> f64 {
    let normals = mesh.vertex_normals();
    let moved = |distance: f64| {
        let moved = |(v, n): (&[f64; 3], &[f64; 3])| std::array::from_fn(|a| v[a] + distance * n[a]);
        let vertices = mesh.vertices.iter().zip(&normals).map(moved).collect();
        Mesh { vertices, triangles: mesh.triangles.clone() }.area()
    };
    if central { (moved(step) - moved(-step)) / (2.0 * step) } else { (moved(step) - mesh.area()) / step }
}

/// 6 V (dA / dr) / A^2: 0 of plates, 3 of rods, 4 of balls; negative where concave parts prevail, where it
/// says little (Salmon et al. 2015).
pub fn structure_model_index(volume: f64, area: f64, area_derivative: f64) -> f64 {
    6.0 * volume * area_derivative / (area * area)
}
