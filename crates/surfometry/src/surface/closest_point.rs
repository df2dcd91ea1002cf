//! The point of a mesh that is closest to another point.

use super::mesh::Mesh;
use crate::space::{dot, minus};
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// The triangles of a mesh, by where they lie.
pub(super) struct ClosestPoints<'a>(RTree<Triangle<'a>>);

/// A point of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClosestPoint {
    /// Numbers of the triangle's corners.
    pub(super) corners: [u32; 3],
    /// Their weights, which add up to 1.
    pub(super) weights: [f64; 3],
}

impl<'a> ClosestPoints<'a> {
    pub(super) fn new(mesh: &'a Mesh) -> Self {
        let triangle = |corners: &[u32; 3]| Triangle { mesh, corners: *corners };
        Self(RTree::bulk_load(mesh.triangles.iter().map(triangle).collect()))
    }

    /// Of all points of the mesh the one closest to another; `None` where there are no triangles.
    pub(super) fn to(&self, point: [f64; 3]) -> Option<ClosestPoint> {
        let triangle = self.0.nearest_neighbor(point)?;
        Some(ClosestPoint { corners: triangle.corners, weights: weights(triangle.places(), point) })
    }
}

impl ClosestPoint {
    /// Between the values of the corners.
    pub(super) fn between(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.corners.iter().zip(self.weights).map(|(&corner, weight)| weight * value(corner as usize)).sum()
    }

    /// The same of vectors.
    pub(super) fn vector_between(&self, vector: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.between(|corner| vector(corner)[axis]))
    }

    /// The corner that weighs most.
    pub(super) fn nearest_corner(&self) -> usize {
        let [a, b, c] = self.weights;
        let most = if a >= b && a >= c { 0 } else { 1 + usize::from(c > b) };
        self.corners[most] as usize
    }
}

struct Triangle<'a> {
    mesh: &'a Mesh,
    corners: [u32; 3],
}

impl Triangle<'_> {
    fn places(&self) -> [[f64; 3]; 3] {
        self.mesh.corners(self.corners)
    }
}

impl RTreeObject for Triangle<'_> {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.places())
    }
}

impl PointDistance for Triangle<'_> {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let places = self.places();
        let weights = weights(places, *point);
        let apart: [f64; 3] =
            std::array::from_fn(|a| (0..3).map(|n| weights[n] * places[n][a]).sum::<f64>() - point[a]);
        dot(apart, apart)
    }
}

/// Weights of a triangle's corners in its point that is closest to another: by the corner, side or face that this lies over
/// (Ericson, Real-Time Collision Detection, 5.1.5).
fn weights([a, b, c]: [[f64; 3]; 3], point: [f64; 3]) -> [f64; 3] {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let seen = |from: [f64; 3]| {
        let to = minus(point, from);
        [dot(ab, to), dot(ac, to)]
    };
    let [[d1, d2], [d3, d4], [d5, d6]] = [seen(a), seen(b), seen(c)];
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let of_c = d1 * d4 - d3 * d2;
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = share(d1, d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let of_b = d5 * d2 - d1 * d6;
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = share(d2, d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let of_a = d3 * d6 - d5 * d4;
    if of_a <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = share(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let whole = of_a + of_b + of_c;
    let (v, w) = (share(of_b, whole), share(of_c, whole));
    [1.0 - v - w, v, w]
}

/// 0 of nothing, as where corners coincide.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: usize = 40;
    use crate::space::length;
    use proptest::prelude::*;

    fn points(count: usize) -> impl Strategy<Value = Vec<[f64; 3]>> {
        prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), count)
    }

    proptest! {
        /// No point of a fine lattice on any triangle is closer, and one of them is nearly as close.
        #[test]
        fn nothing_is_closer(vertices in points(30), point in prop::array::uniform3(-1.5..1.5f64)) {
            let triangles = (0..10).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
            let mesh = Mesh { vertices, triangles };
            let found = ClosestPoints::new(&mesh).to(point).unwrap();
            let distance = length(minus(found.vector_between(|corner| mesh.vertices[corner]), point));
            prop_assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            prop_assert!(found.weights.iter().all(|w| (-1e-12..=1.0 + 1e-12).contains(w)));
            let mut least = f64::INFINITY;
            for &triangle in &mesh.triangles {
                let [a, b, c] = mesh.corners(triangle);
                for i in 0..=STEPS {
                    for j in 0..=STEPS - i {
                        let [v, w] = [i, j].map(|n| n as f64 / STEPS as f64);
                        let place = std::array::from_fn(|x| (1.0 - v - w) * a[x] + v * b[x] + w * c[x]);
                        least = least.min(length(minus(place, point)));
                    }
                }
            }
            prop_assert!(distance <= least + 1e-12, "{distance} {least}");
            // A lattice's next node is at most a fortieth of two sides away.
            prop_assert!(least <= distance + 0.2, "{distance} {least}");
        }
    }

    /// Corners that coincide are a side, or a point.
    #[test]
    fn triangles_without_area_have_points_too() {
        let (a, c) = ([0.0; 3], [0.0, 0.0, 2.0]);
        for places in [[a, a, c], [a, c, c], [a, a, a], [a, c, [0.0, 0.0, 1.0]]] {
            let found = weights(places, [1.0, 0.5, 0.5]);
            assert!(found.iter().all(|w| w.is_finite()) && (found.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }
}
