//! Surface integrals of a smooth implicit surface, to quadrature precision.
//!
//! A lattice of tetrahedra cuts the surface into triangles. Each flat triangle is mapped onto the true
//! surface along a field of directions that is shared along its edges, so the curved triangles cover the
//! surface once, and Gauss points on them converge like the tenth power of the lattice's spacing.

use super::{Shape, Truth};
use crate::local_geometry::Curvature;
use crate::space::{cross, dot};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Nodes and weights of the five-point Gauss-Legendre rule on 0..1 (exact to degree 9).
pub(crate) const GAUSS_5: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Refinements before giving up; each halves the lattice.
const REFINEMENTS: i32 = 3;

/// Cells of a lattice, and of those the ones that the surface cuts, beyond which it is not tried: some
/// fifteen seconds on two cores.
const MOST_CELLS: usize = 4_000_000;
const MOST_CUT_CELLS: usize = 200_000;

/// How far total K / 2 pi may be from an even integer, per unit of chi's size, for a quadrature to be
/// believed; it is the most sensitive of the integrals.
const GAUSS_BONNET_TOLERANCE: f64 = 1e-7;

type Vector = [f64; 3];

fn combine<const N: usize>(terms: [(f64, Vector); N]) -> Vector {
    std::array::from_fn(|a| terms.iter().map(|(factor, v)| factor * v[a]).sum())
}

/// V, A, M, total K, and how strongly the surface is curved.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sums {
    pub(crate) volume: f64,
    pub(crate) area: f64,
    pub(crate) mean: f64,
    pub(crate) gaussian: f64,
    /// Of the square of the larger principal curvature.
    pub(crate) larger_squared: f64,
}

impl Sums {
    /// Total K / 2 pi.
    fn euler(&self) -> f64 {
        self.gaussian / TAU
    }

    fn plus(self, other: Self) -> Self {
        Self {
            volume: self.volume + other.volume,
            area: self.area + other.area,
            mean: self.mean + other.mean,
            gaussian: self.gaussian + other.gaussian,
            larger_squared: self.larger_squared + other.larger_squared,
        }
    }
}

/// Exact integrals of a shape, from a lattice of spacing about `step` mm, refined until Gauss and Bonnet
/// agree.
pub(crate) fn integrate_surface<S: Shape + ?Sized>(shape: &S, step: f64) -> Option<Truth> {
    (0..=REFINEMENTS).find_map(|n| {
        let sums = on_lattice(shape, step * 0.5f64.powi(n))?;
        ((sums.euler() - even(&sums)).abs() <= GAUSS_BONNET_TOLERANCE * even(&sums).abs().max(1.0))
            .then(|| truth(&sums))
    })
}

/// The same until V, A and M change by less than a share `tolerance` from one lattice to the next: for shapes
/// with narrow blends, of which K takes very fine lattices.
pub(crate) fn integrate_until_steady<S: Shape + ?Sized>(
    shape: &S,
    step: f64,
    tolerance: f64,
) -> Option<Truth> {
    let mut before: Option<Sums> = None;
    for n in 0..=STEADY_REFINEMENTS {
        let sums = on_lattice(shape, step * STEADY_RATIO.powi(n))?;
        let steady = before.is_some_and(|old| {
            let pairs = [(old.volume, sums.volume), (old.area, sums.area), (old.mean, sums.mean)];
            pairs.into_iter().all(|(old, new)| (new - old).abs() <= tolerance * new.abs())
        });
        if steady && (sums.euler() - even(&sums)).abs() < STEADY_EULER {
            return Some(truth(&sums));
        }
        before = Some(sums);
    }
    None
}

/// How far total K / 2 pi of steady sums may be from an even integer.
const STEADY_EULER: f64 = 0.02;
/// From one lattice to the next: converging like the tenth power, the error falls 35 times, the cost doubles.
const STEADY_RATIO: f64 = 0.7;
const STEADY_REFINEMENTS: i32 = 5;

fn on_lattice<S: Shape + ?Sized>(shape: &S, step: f64) -> Option<Sums> {
    let lattice = Lattice::new(shape, step);
    (lattice.cells() <= MOST_CELLS && lattice.cut_cells() <= MOST_CUT_CELLS).then(|| lattice.sums())
}

fn even(sums: &Sums) -> f64 {
    2.0 * (sums.euler() / 2.0).round()
}

fn truth(sums: &Sums) -> Truth {
    Truth::new(sums.volume, sums.area, sums.mean, even(sums) as i64)
}

/// A cubic lattice around a shape.
pub(crate) struct Lattice<'a, S: Shape + ?Sized> {
    shape: &'a S,
    step: f64,
    cells: [usize; 3],
}

/// The eight corners of a cell, bit 0 of their number being x, and the values there.
type Cell = [(Vector, f64); 8];

impl<'a, S: Shape + ?Sized> Lattice<'a, S> {
    pub(crate) fn new(shape: &'a S, step: f64) -> Self {
        let cells = shape.half_extent().map(|h| (2.0 * (h + step) / step).ceil() as usize);
        Self { shape, step, cells }
    }

    fn cells(&self) -> usize {
        self.cells.iter().fold(1, |product, &n| product.saturating_mul(n))
    }

    fn corner(&self, index: [usize; 3]) -> Vector {
        std::array::from_fn(|a| (index[a] as f64 - 0.5 * self.cells[a] as f64) * self.step)
    }

    /// Calls `visit` with each cell of a layer that the surface cuts.
    fn for_each_cut_cell(&self, z: usize, mut visit: impl FnMut(Cell)) {
        let [nx, ny, _] = self.cells;
        let plane = |z: usize| -> Vec<f64> {
            let corners = (0..=ny).flat_map(|y| (0..=nx).map(move |x| [x, y, z]));
            corners.map(|index| self.shape.value(self.corner(index))).collect()
        };
        let planes = [plane(z), plane(z + 1)];
        for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))) {
            let value = |n: usize| planes[n >> 2][(y + (n >> 1 & 1)) * (nx + 1) + x + (n & 1)];
            let inside = (0..8).filter(|&n| value(n) < 0.0).count();
            if inside > 0 && inside < 8 {
                let corner = |n: usize| self.corner([x + (n & 1), y + (n >> 1 & 1), z + (n >> 2)]);
                visit(std::array::from_fn(|n| (corner(n), value(n))));
            }
        }
    }

    fn cut_cells(&self) -> usize {
        let count = |z| {
            let mut count = 0;
            self.for_each_cut_cell(z, |_| count += 1);
            count
        };
        (0..self.cells[2]).into_par_iter().map(count).sum()
    }

    /// The integrals over the surface. Layers are added in order, whichever thread did them.
    pub(crate) fn sums(&self) -> Sums {
        let layer = |z| {
            let mut sums = Sums::default();
            self.for_each_cut_cell(z, |cell| {
                for tetrahedron in TETRAHEDRA {
                    for triangle in triangles(self.shape, tetrahedron.map(|n| cell[n])) {
                        sums = sums.plus(curved_triangle(self.shape, triangle));
                    }
                }
            });
            sums
        };
        let layers: Vec<Sums> = (0..self.cells[2]).into_par_iter().map(layer).collect();
        layers.into_iter().fold(Sums::default(), Sums::plus)
    }
}

/// Kuhn's six tetrahedra of a cube around the diagonal 0-7; neighbouring cubes' faces match.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];

/// A point of the surface and the unit normal there.
type Vertex = (Vector, Vector);

fn triangles<S: Shape + ?Sized>(shape: &S, corners: [(Vector, f64); 4]) -> Vec<[Vertex; 3]> {
    let (inside, outside): (Vec<_>, Vec<_>) = corners.into_iter().partition(|c| c.1 < 0.0);
    let cut = |i: usize, o: usize| surface_vertex(shape, inside[i], outside[o]);
    match (inside.len(), outside.len()) {
        (1, 3) => vec![[cut(0, 0), cut(0, 1), cut(0, 2)]],
        (3, 1) => vec![[cut(0, 0), cut(1, 0), cut(2, 0)]],
        (2, 2) => {
            let quad = [cut(0, 0), cut(0, 1), cut(1, 1), cut(1, 0)];
            vec![[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
        }
        _ => Vec::new(),
    }
}

/// Where the surface crosses an edge: the Illinois variant of false position, which brackets the crossing and
/// gives the same point to all who share the edge.
fn surface_vertex<S: Shape + ?Sized>(shape: &S, inside: (Vector, f64), outside: (Vector, f64)) -> Vertex {
    let at = |t: f64| combine([(1.0 - t, inside.0), (t, outside.0)]);
    let (mut low, mut high) = ((0.0, inside.1), (1.0, outside.1));
    let mut crossing = 0.0;
    for _ in 0..40 {
        crossing = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
        let value = shape.value(at(crossing));
        if value.abs() < 1e-13 {
            break;
        }
        if value < 0.0 {
            low = (crossing, value);
            high.1 *= 0.5;
        } else {
            high = (crossing, value);
            low.1 *= 0.5;
        }
    }
    let point = at(crossing);
    let jet = shape.jet(point);
    (point, jet.gradient.map(|g| g / jet.gradient_magnitude()))
}

/// Integrals over the piece of surface above a flat triangle.
fn curved_triangle<S: Shape + ?Sized>(shape: &S, [a, b, c]: [Vertex; 3]) -> Sums {
    let minus = |p: Vector, q: Vector| combine([(1.0, p), (-1.0, q)]);
    let (side_b, side_c) = (minus(b.0, a.0), minus(c.0, a.0));
    let (turn_b, turn_c) = (minus(b.1, a.1), minus(c.1, a.1));
    let slope = dot(shape.jet(a.0).gradient, a.1);
    let mut sums = Sums::default();
    for (u, weight_u) in GAUSS_5 {
        for (v, weight_v) in GAUSS_5 {
            // Duffy's map of the square onto the triangle.
            let (s, t) = (u * (1.0 - v), v);
            let weight = weight_u * weight_v * (1.0 - v);
            let base = combine([(1.0, a.0), (s, side_b), (t, side_c)]);
            let direction = combine([(1.0, a.1), (s, turn_b), (t, turn_c)]);
            let lift = lift_to_surface(shape, base, direction, slope);
            let point = combine([(1.0, base), (lift, direction)]);
            let jet = shape.jet(point);
            let rate = dot(jet.gradient, direction);
            let tangent = |side: Vector, turn: Vector| {
                let moved = combine([(1.0, side), (lift, turn)]);
                combine([(1.0, moved), (-dot(jet.gradient, moved) / rate, direction)])
            };
            let normal = jet.gradient.map(|g| g / jet.gradient_magnitude());
            let across = cross(tangent(side_b, turn_b), tangent(side_c, turn_c));
            let area = weight * libm::sqrt(dot(across, across));
            if let Some(curvature) = Curvature::of(&jet) {
                sums = sums.plus(Sums {
                    volume: area * dot(point, normal) / 3.0,
                    area,
                    mean: area * curvature.mean_curvature,
                    gaussian: area * curvature.gaussian_curvature,
                    larger_squared: area * curvature.larger().powi(2),
                });
            }
        }
    }
    sums
}

/// The lift along a direction at which the surface is met, by secants from a first slope.
fn lift_to_surface<S: Shape + ?Sized>(shape: &S, base: Vector, direction: Vector, slope: f64) -> f64 {
    let value = |lift: f64| shape.value(combine([(1.0, base), (lift, direction)]));
    let (mut before, mut value_before) = (0.0, value(0.0));
    let mut lift = -value_before / slope;
    for _ in 0..12 {
        let here = value(lift);
        let step = here * (lift - before) / (here - value_before);
        // Equal values, at the limit of rounding, end the search too.
        if !step.is_finite() {
            break;
        }
        (before, value_before) = (lift, here);
        lift -= step;
        if step.abs() < 1e-13 {
            break;
        }
    }
    lift
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantoms::{Ball, Ellipsoid, MinimalSurface, Periodic, Torus};

    #[test]
    fn closed_forms_are_met() {
        let shapes: [(&dyn Shape, f64); 3] = [
            (&Ball { radius: 10.0 }, 2.0),
            (&Torus { major: 14.0, minor: 6.0 }, 1.2),
            (&Ellipsoid { radii: [10.0, 7.0, 5.0] }, 0.8),
        ];
        for (shape, step) in shapes {
            let sums = Lattice::new(shape, step).sums();
            let truth = shape.truth().unwrap();
            assert!(
                (sums.volume / truth.volume - 1.0).abs() < 1e-8,
                "V {}",
                sums.volume / truth.volume - 1.0
            );
            assert!(
                (sums.area / truth.surface_area - 1.0).abs() < 1e-8,
                "A {}",
                sums.area / truth.surface_area - 1.0
            );
            assert!((sums.mean / truth.total_mean_curvature - 1.0).abs() < 1e-8, "M");
            assert!((sums.gaussian / TAU - truth.euler_characteristic as f64).abs() < 1e-7, "chi");
        }
    }

    #[test]
    fn periodic_surfaces_are_integrated_to_1e_8() {
        for surface in [MinimalSurface::Gyroid, MinimalSurface::SchwarzP] {
            let shape = Periodic { surface, period: 40.0, size: 60.0 };
            let truth = shape.truth().expect("converges");
            // Another lattice, whose cells share no corner with the first one's.
            let finer = Lattice::new(&shape, 0.83).sums();
            assert!((finer.volume / truth.volume - 1.0).abs() < 1e-8);
            assert!((finer.area / truth.surface_area - 1.0).abs() < 1e-8);
            assert!((finer.mean / truth.total_mean_curvature - 1.0).abs() < 1e-7);
        }
    }
}
