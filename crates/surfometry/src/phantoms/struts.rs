//! Networks of struts.

use super::curved_triangles::integrate_until_steady;
use super::jet_arithmetic::{Smooth, smooth_minimum};
use super::{Shape, Truth, value_and_jet};

/// Straight tubes with round ends that blend where they meet: branching vessels, trabecular networks. The integrals are
/// those of the surface that the formula describes, by quadrature.
#[derive(Debug, Clone, PartialEq)]
pub struct Struts {
    /// Ends of each axis, mm.
    axes: Vec<[[f64; 3]; 2]>,
    radius: f64,
    /// Width over which tubes blend, mm.
    blend: f64,
}

/// Width of the blend, spacing of the first lattice for integrals, in radii, and what is steady there.
const BLEND: f64 = 0.3;
const STEP: f64 = 0.4;
const TOLERANCE: f64 = 3e-4;

impl Struts {
    fn new(axes: Vec<[[f64; 3]; 2]>, radius: f64) -> Self {
        Self { axes, radius, blend: BLEND * radius }
    }

    /// A tree: a trunk of 16 radii that forks, and one of its two branches again.
    pub fn tree(radius: f64) -> Self {
        let nodes = [
            [0.0, 0.0, -16.0],
            [0.0, 0.0, 0.0],
            [7.0, 2.0, 9.0],
            [-6.0, 1.0, 12.0],
            [12.0, -2.0, 17.0],
            [5.0, 7.0, 17.0],
        ];
        let axes = [(0, 1), (1, 2), (1, 3), (2, 4), (2, 5)];
        let place = |n: usize| nodes[n].map(|v: f64| v * radius);
        Self::new(axes.map(|(a, b)| [place(a), place(b)]).to_vec(), radius)
    }

    /// A cubic lattice of so many cells along each axis, its nodes some distance apart, mm.
    pub fn lattice(radius: f64, pitch: f64, cells: u32) -> Self {
        let half = 0.5 * f64::from(cells) * pitch;
        let places: Vec<f64> = (0..=cells).map(|n| f64::from(n) * pitch - half).collect();
        let mut axes = Vec::new();
        for &a in &places {
            for &b in &places {
                axes.push([[-half, a, b], [half, a, b]]);
                axes.push([[b, -half, a], [b, half, a]]);
                axes.push([[a, b, -half], [a, b, half]]);
            }
        }
        Self::new(axes, radius)
    }

    fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let tubes = self.axes.iter().map(|ends| tube(p, ends, self.radius));
        tubes.reduce(|all, one| smooth_minimum(all, one, self.blend)).expect("a network has struts")
    }
}

/// Of a tube: about the distance near its surface.
fn tube<T: Smooth>(p: [T; 3], [start, end]: &[[f64; 3]; 2], radius: f64) -> T {
    let along: [f64; 3] = std::array::from_fn(|a| end[a] - start[a]);
    let length = along.iter().map(|v| v * v).sum::<f64>();
    let off: [T; 3] = std::array::from_fn(|a| p[a] + -start[a]);
    let share = (off[0] * along[0] + off[1] * along[1] + off[2] * along[2]) * (1.0 / length);
    let share = match share.value() {
        ..0.0 => share * 0.0,
        1.0.. => share * 0.0 + 1.0,
        _ => share,
    };
    let off: [T; 3] = std::array::from_fn(|a| off[a] - share * along[a]);
    (off[0].square() + off[1].square() + off[2].square() + -radius * radius) * (0.5 / radius)
}

impl Shape for Struts {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        integrate_until_steady(self, STEP * self.radius, TOLERANCE)
    }

    fn half_extent(&self) -> [f64; 3] {
        let reach = |a: usize| self.axes.iter().flatten().map(|end| end[a].abs()).fold(0.0, f64::max);
        std::array::from_fn(|a| reach(a) + self.radius + self.blend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One strut is a capsule; networks have the topology that they are drawn with.
    #[test]
    fn struts_are_tubes_and_networks_have_handles() {
        let one = Struts::new(vec![[[0.0, 0.0, -5.0], [0.0, 0.0, 5.0]]], 2.0).truth().unwrap();
        let capsule = crate::phantoms::Capsule { radius: 2.0, length: 10.0 }.truth().unwrap();
        assert!((one.surface_area / capsule.surface_area - 1.0).abs() < 1e-3);
        assert!((one.total_mean_curvature / capsule.total_mean_curvature - 1.0).abs() < 1e-3);
        assert_eq!(Struts::tree(1.0).truth().unwrap().euler_characteristic, 2);
        // A cube's edges and no more: 8 nodes, 12 struts, 5 handles.
        assert_eq!(Struts::lattice(1.0, 8.0, 1).truth().unwrap().euler_characteristic, 2 - 2 * 5);
    }
}
