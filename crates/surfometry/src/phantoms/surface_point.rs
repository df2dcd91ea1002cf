//! The point of a phantom's surface beside any point.

use super::Phantom;
use super::curved_triangles::Lattice;
use crate::local_geometry::Curvature;
use crate::space::{dot, minus, unit};

/// Where the exact surface is near a point of the world, and how it is curved there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// How far the point that was asked for lies outside the surface, along its normal, mm; negative inside.
    pub distance: f64,
    /// H and K of the surface.
    pub curvature: Curvature,
}

/// Most steps towards the foot of the normal; each leaves less than half of the way.
const STEPS: usize = 40;
/// A step so small, in units of the way to the surface and of the shape's size, ends the search.
const SMALL: f64 = 1e-7;
/// Share of the way along the surface that a step takes: all of it overshoots where the surface is curved
/// towards the point.
const DAMPING: f64 = 0.7;
/// Cells across the smallest half-extent of the lattice that the mean curvature of a shape is taken on.
const CELLS: f64 = 16.0;

impl Phantom {
    /// The surface beside a world point that lies nearer to it than its radius of curvature; `None` where no
    /// normal leads there.
    pub fn surface_point(&self, world: [f64; 3]) -> Option<SurfacePoint> {
        let start = self.pose().to_shape(world);
        let small = SMALL * self.shape().half_extent().into_iter().fold(0.0, f64::max);
        let mut foot = start;
        for _ in 0..STEPS {
            let jet = self.shape().jet(foot);
            let (offset, normal) = (minus(start, foot), unit(jet.gradient));
            let along = dot(offset, normal);
            let down = jet.value / jet.gradient_magnitude();
            let step: [f64; 3] =
                std::array::from_fn(|a| DAMPING * (offset[a] - along * normal[a]) - down * normal[a]);
            foot = std::array::from_fn(|a| foot[a] + step[a]);
            if dot(step, step) < small * small {
                break;
            }
        }
        let jet = self.shape().jet(foot);
        let distance = dot(minus(start, foot), unit(jet.gradient));
        let curvature = Curvature::of(&jet)?;
        distance.is_finite().then_some(SurfacePoint { distance, curvature })
    }

    /// 1 / R of the whole surface: the root of the mean over the surface of the square of the larger
    /// principal curvature, 1/mm.
    pub fn rms_curvature(&self) -> f64 {
        let smallest = self.shape().half_extent().into_iter().fold(f64::INFINITY, f64::min);
        let sums = Lattice::new(self.shape(), smallest / CELLS).sums();
        (sums.larger_squared / sums.area).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantoms::{Ball, Pose, Torus};

    #[test]
    fn beside_a_torus_that_is_turned() {
        let pose = Pose::new([20.0, -35.0, 50.0], [1.0, 2.0, 3.0]);
        let phantom = Phantom::new(Torus { major: 30.0, minor: 10.0 }, pose, [1.0; 3]).unwrap();
        // A point outside the outer equator, then one inside the tube beside the inner one, turned into the
        // world by brute force.
        for (target, distance, curvature) in
            [([41.5, 0.0, 0.0], 1.5, [0.1, 1.0 / 40.0]), ([0.0, 20.7, 0.0], -0.7, [0.1, -1.0 / 20.0])]
        {
            let world: [f64; 3] = std::array::from_fn(|a| {
                let mut unit = [0.0; 3];
                unit[a] = 1.0;
                let column = minus(pose.to_shape(unit), pose.to_shape([0.0; 3]));
                pose.shift()[a] + dot(column, target)
            });
            let point = phantom.surface_point(world).unwrap();
            assert!((point.distance - distance).abs() < 1e-6, "{point:?}");
            assert!(
                (point.curvature.gaussian_curvature - curvature[0] * curvature[1]).abs() < 1e-8,
                "{point:?}"
            );
            assert!((point.curvature.mean_curvature - 0.5 * (curvature[0] + curvature[1])).abs() < 1e-8);
        }
        let ball = Phantom::new(Ball { radius: 7.0 }, pose, [1.0; 3]).unwrap();
        assert!((ball.rms_curvature() - 1.0 / 7.0).abs() < 1e-9);
    }
}
