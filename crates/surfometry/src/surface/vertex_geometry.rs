//! The geometry of the level set at a vertex, from the field's derivatives there.

use super::{LocalQuantity, VertexArray, VertexChange, VertexValues};
use crate::Choice;
use crate::accuracy::CurvatureErrors;
use crate::local_geometry::{Curvature, Jet};
use crate::space::{cross, dot, unit};
use std::f64::consts::FRAC_2_PI;

/// What is known at a vertex; vectors are unit vectors of the world (RAS).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexGeometry {
    /// grad phi / |grad phi|, outward; where the gradient has collapsed, the mean normal of the triangles
    /// around.
    pub normal: [f64; 3],
    /// H and K; 0 where the gradient has collapsed.
    pub curvature: Curvature,
    /// Direction of k1, the larger principal curvature. Its sign has no meaning, and at an umbilic nor has it
    /// itself.
    pub direction_1: [f64; 3],
    /// Direction of k2.
    pub direction_2: [f64; 3],
    /// How far the blur moved the surface here, mm, positive outward: about -sigma^2 H. `None` where that is
    /// not defined.
    pub displacement: Option<f64>,
    /// Standard errors of its curvature, where the embedding has a model of them: the corrected one.
    pub errors: Option<CurvatureErrors>,
    /// Blur at which curvature was taken, mm, where each vertex has its own.
    pub curvature_sigma: Option<f32>,
    /// What a later surface is like where it is closest; `None` where there is none.
    pub change: Option<VertexChange>,
    /// Whether the field has a gradient that a surface would have. Where it has collapsed, as half-way
    /// through parts that the blur nearly removed, curvature says nothing, and distributions leave the vertex
    /// out.
    pub has_normal: bool,
}

/// An array of vectors: name and value.
type DirectionArray = (&'static str, fn(&VertexGeometry) -> [f64; 3]);

const DIRECTION_ARRAYS: [DirectionArray; 3] =
    [("normal", |g| g.normal), ("direction_1", |g| g.direction_1), ("direction_2", |g| g.direction_2)];

const SIGMA_ARRAY: &str = "curvature_sigma_mm";

/// Columns that a table of vertices begins with.
#[cfg(feature = "io")]
const PLACE_COLUMNS: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// An array of standard errors of changes to a later surface: name and value.
type ChangeErrorArray = (&'static str, fn(&VertexChange) -> Option<f32>);

const CHANGE_ERROR_ARRAYS: [ChangeErrorArray; 2] = [
    ("distance_mm_standard_error", |c| c.distance_error),
    ("mean_curvature_change_per_mm_standard_error", |c| c.mean_curvature_error),
];

#[cfg(feature = "io")]
impl VertexArray {
    /// Whether an array that surfaces have, or a column of it in a table, is called so.
    pub(crate) fn is_own_name(name: &str) -> bool {
        let column = ["_x", "_y", "_z"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name);
        LocalQuantity::ALL.iter().any(|quantity| name == quantity.name())
            || DIRECTION_ARRAYS.iter().any(|(array, _)| column == *array)
            || CHANGE_ERROR_ARRAYS.iter().any(|(array, _)| name == *array)
            || name == SIGMA_ARRAY
            || PLACE_COLUMNS.contains(&name)
    }
}

impl VertexGeometry {
    /// From the field's derivatives along perpendicular axes (`Grid::axes`), and the curvature that follows from them.
    pub(super) fn of(
        jet: &Jet,
        curvature: Curvature,
        displacement: Option<f64>,
        axes: &[[f64; 3]; 3],
    ) -> Self {
        let magnitude = jet.gradient_magnitude();
        let normal = jet.gradient.map(|g| g / magnitude);
        let [direction_1, direction_2] = principal_directions(jet, normal);
        let world = |v: [f64; 3]| std::array::from_fn(|w| (0..3).map(|a| axes[a][w] * v[a]).sum());
        Self {
            normal: world(normal),
            curvature,
            direction_1: world(direction_1),
            direction_2: world(direction_2),
            displacement,
            errors: None,
            curvature_sigma: None,
            change: None,
            has_normal: true,
        }
    }

    /// Where the gradient has collapsed: flat, with a normal from elsewhere.
    pub(super) fn collapsed(normal: [f64; 3], displacement: Option<f64>) -> Self {
        let direction_1 = tangent(normal);
        let curvature = Curvature { mean_curvature: 0.0, gaussian_curvature: 0.0 };
        let direction_2 = cross(normal, direction_1);
        Self {
            normal,
            curvature,
            direction_1,
            direction_2,
            displacement,
            errors: None,
            curvature_sigma: None,
            change: None,
            has_normal: false,
        }
    }

    /// Named columns of many vertices. A number that any vertex lacks is left out.
    pub fn arrays(vertices: &[Self]) -> Vec<VertexArray> {
        let vector = |(name, value): DirectionArray| VertexArray {
            name: name.into(),
            values: VertexValues::Vector(vertices.iter().map(value).collect()),
        };
        let scalar = |quantity: LocalQuantity| {
            let values = VertexValues::Scalar(quantity.of_all(vertices)?);
            Some(VertexArray { name: quantity.name().into(), values })
        };
        let [normal, directions @ ..] = DIRECTION_ARRAYS.map(vector);
        let mut arrays: Vec<VertexArray> = LocalQuantity::ALL.iter().copied().filter_map(scalar).collect();
        // In the contract's order: H, K, k1, k2, then directions; standard errors last.
        arrays.splice(4..4, directions);
        arrays.insert(0, normal);
        let known = |name: &'static str, value: &dyn Fn(&Self) -> Option<f32>| {
            let values: Option<Vec<f64>> = vertices.iter().map(|v| value(v).map(f64::from)).collect();
            let values = values.filter(|values| !values.is_empty())?;
            Some(VertexArray { name: name.into(), values: VertexValues::Scalar(values) })
        };
        let errors = CHANGE_ERROR_ARRAYS.into_iter();
        arrays.extend(errors.filter_map(|(name, error)| known(name, &|v| error(v.change.as_ref()?))));
        arrays.extend(known(SIGMA_ARRAY, &|v| v.curvature_sigma));
        arrays
    }
}

/// Unit eigenvectors of the Hessian in the tangent plane, of the larger eigenvalue first.
///
/// There, the Hessian over |grad phi| is the derivative of the normal, whose eigenvalues are k1 and k2. In a
/// basis u, v of the plane it is a symmetric 2 x 2 matrix, whose axes stand at half the angle of (a - c, 2
/// b).
fn principal_directions(jet: &Jet, normal: [f64; 3]) -> [[f64; 3]; 2] {
    let [xx, yy, zz, xy, xz, yz] = jet.hessian;
    let hessian = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let u = tangent(normal);
    let v = cross(normal, u);
    let along = |p: [f64; 3], q: [f64; 3]| dot(p, hessian.map(|row| dot(row, q)));
    let angle = 0.5 * libm::atan2(2.0 * along(u, v), along(u, u) - along(v, v));
    let (sin, cos) = libm::sincos(angle);
    let first: [f64; 3] = std::array::from_fn(|i| cos * u[i] + sin * v[i]);
    [first, cross(normal, first)]
}

/// A unit vector across a normal.
fn tangent(normal: [f64; 3]) -> [f64; 3] {
    // The axis that the normal is farthest from gives one without cancellation.
    let farthest = (0..3).fold(0, |best, a| if normal[a].abs() < normal[best].abs() { a } else { best });
    let mut axis = [0.0; 3];
    axis[farthest] = 1.0;
    unit(cross(normal, axis))
}

impl Curvature {
    /// Koenderink and van Doorn's shape index, 2/pi atan((k1 + k2) / (k1 - k2)): 1 on a ball, 0.5 on a
    /// cylinder, 0 on a symmetric saddle, -0.5 in a groove, -1 in a hollow; 0 on a plane, which has none.
    pub fn shape_index(&self) -> f64 {
        let [k1, k2] = self.principal();
        FRAC_2_PI * libm::atan2(k1 + k2, k1 - k2)
    }

    /// Koenderink and van Doorn's curvedness, sqrt((k1^2 + k2^2) / 2), 1/mm: 1/R on a ball.
    pub fn curvedness(&self) -> f64 {
        let [k1, k2] = self.principal();
        libm::sqrt(0.5 * (k1 * k1 + k2 * k2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;

    fn curvature(k1: f64, k2: f64) -> Curvature {
        Curvature { mean_curvature: 0.5 * (k1 + k2), gaussian_curvature: k1 * k2 }
    }

    #[test]
    fn shape_index_and_curvedness_of_known_shapes() {
        let cases =
            [(2.0, 2.0, 1.0), (2.0, 0.0, 0.5), (1.0, -1.0, 0.0), (0.0, -3.0, -0.5), (-1.0, -1.0, -1.0)];
        for (k1, k2, index) in cases {
            let c = curvature(k1, k2);
            assert!((c.shape_index() - index).abs() < 1e-7, "{k1} {k2}: {}", c.shape_index());
            assert!((c.curvedness() - k1.hypot(k2) / 2f64.sqrt()).abs() < 1e-7);
        }
        assert_eq!(curvature(0.0, 0.0).shape_index(), 0.0);
    }

    /// A cylinder of radius 2 about a slanted axis: k1 = 1/2 runs round it, k2 = 0 along it.
    #[test]
    fn directions_of_a_slanted_cylinder() {
        let axis = unit([1.0, 2.0, -0.5]);
        let point = {
            let p = [0.3, 0.7, 1.9];
            let along = dot(p, axis);
            let radial = unit(std::array::from_fn(|i| p[i] - along * axis[i]));
            radial.map(|v| 2.0 * v)
        };
        // phi = (distance from the axis)^2 / 4 - 1 has the Hessian (1 - a a^T) / 2.
        let second = |i: usize, j: usize| 0.5 * (f64::from(u8::from(i == j)) - axis[i] * axis[j]);
        let hessian = [second(0, 0), second(1, 1), second(2, 2), second(0, 1), second(0, 2), second(1, 2)];
        let jet = Jet { value: 0.0, gradient: point.map(|p| 0.5 * p), hessian };
        let grid = Grid::axis_aligned([4; 3], [1.0; 3]).unwrap();
        let geometry = VertexGeometry::of(&jet, Curvature::of(&jet).unwrap(), None, &grid.axes());
        let [k1, k2] = geometry.curvature.principal();
        assert!((k1 - 0.5).abs() < 1e-12 && k2.abs() < 1e-12);
        assert!((dot(geometry.direction_2, axis).abs() - 1.0).abs() < 1e-12);
        assert!(dot(geometry.direction_1, axis).abs() < 1e-12);
        assert!(dot(geometry.direction_1, geometry.normal).abs() < 1e-12);
        assert!((dot(geometry.normal, point) - 2.0).abs() < 1e-12);
    }
}
