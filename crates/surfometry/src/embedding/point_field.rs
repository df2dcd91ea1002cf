//! The blurred indicator and its derivatives at points near each other.

use super::Indicator;
use super::point_kernel::{AxisTaps, JET_ORDERS, PointDerivatives, PointKernel, PointMemory};
use super::separable::{Orders, Separable};
use crate::tiling::{AxisWeights, Block, IndexBox};

/// Sigma in spacings from which on the polynomial through six voxels an axis is right to 1e-5
/// (`tests/vertices.rs`).
const WIDE: f64 = 4.0;
/// Sigma in spacings below which a Gaussian's moments off the grid are not those on it (by 1e-3 here, by a
/// factor of two at 0.43).
const NARROW: f64 = 0.75;
/// Voxels that the polynomial needs on each side of those around its points.
const AROUND: i64 = 3;

/// One blur at points: along each axis convolved with kernels that are centred at each point, or interpolated between what is
/// convolved on the grid. That is where the blur is wide in voxels, which convolving pays for with each axis' sigma while nothing is
/// lost, and where it is narrower than a voxel, so that a Gaussian's samples depend on where between the voxels they are taken.
/// Thick slices are wide within and narrow across.
#[derive(Debug)]
pub(super) struct PointField {
    sigma: f64,
    interpolated: [bool; 3],
    on_grid: Separable,
    at_points: PointKernel,
}

impl PointField {
    pub(super) fn new(sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        let interpolated = spacing.map(|h| sigma > WIDE * h || sigma < NARROW * h);
        Self {
            sigma,
            interpolated,
            on_grid: Separable::along(interpolated, sigma, spacing, truncation),
            at_points: PointKernel::new(sigma, spacing, truncation),
        }
    }

    /// At fractional voxel indices, in mm.
    pub(super) fn derivatives(
        &self,
        indicator: &dyn Indicator,
        points: &[[f64; 3]],
    ) -> Vec<PointDerivatives> {
        if self.interpolated == [false; 3] {
            let mut memory = PointMemory::default();
            return points.iter().map(|&p| self.at_points.convolve(indicator, p, &mut memory)).collect();
        }
        let Some(hull) = IndexBox::around(points) else { return Vec::new() };
        let grids: Vec<Orders> = self.grids();
        let blocks = self.blocks(indicator, &hull, &grids);
        let block_of = JET_ORDERS.map(|orders| {
            let grid = self.on_the_grid(orders);
            &blocks[grids.iter().position(|&g| g == grid).expect("every grid is made")]
        });
        let mut axes: [AxisTaps; 3] = Default::default();
        points.iter().map(|&point| self.sums(&block_of, point, &mut axes)).collect()
    }

    /// Of a derivative's orders those along axes that are convolved on the grid.
    fn on_the_grid(&self, orders: Orders) -> Orders {
        std::array::from_fn(|a| if self.interpolated[a] { orders[a] } else { 0 })
    }

    /// All of which derivatives are made.
    fn grids(&self) -> Vec<Orders> {
        let mut grids = JET_ORDERS.map(|orders| self.on_the_grid(orders)).to_vec();
        grids.sort_unstable();
        grids.dedup();
        grids
    }

    /// Convolved on the box of some points and what these need around them.
    fn blocks(&self, indicator: &dyn Indicator, hull: &IndexBox, grids: &[Orders]) -> Vec<Block<f32>> {
        let reach =
            |a: usize| if self.interpolated[a] { AROUND } else { self.at_points.axes[a].radius() + 1 };
        let region = hull.grown([0, 1, 2].map(reach));
        let mut blocks = vec![Block::filled(region, 0.0f32); grids.len()];
        let slice = region.extent()[0] * region.extent()[1];
        self.on_grid.for_each_slice(indicator, &region, grids, |z, planes| {
            let start = (z - region.lower[2]) as usize * slice;
            for (block, plane) in blocks.iter_mut().zip(planes) {
                block.values_mut()[start..][..slice].copy_from_slice(plane);
            }
        });
        blocks
    }

    fn sums(
        &self,
        blocks: &[&Block<f32>; 10],
        point: [f64; 3],
        axes: &mut [AxisTaps; 3],
    ) -> PointDerivatives {
        let region = blocks[0].region();
        for (a, taps) in axes.iter_mut().enumerate() {
            if self.interpolated[a] {
                let polynomial = AxisWeights::at(point[a], region.lower[a], region.upper[a]);
                taps.first = polynomial.first;
                for order in &mut taps.orders {
                    order.clear();
                    order.extend(polynomial.weights.map(|[value, ..]| value));
                }
            } else {
                self.at_points.axes[a].taps_at(point[a], taps);
            }
        }
        let [x, y, z] = &*axes;
        std::array::from_fn(|n| {
            let (block, orders) = (blocks[n], JET_ORDERS[n]);
            let along_x = |y: i64, z: i64| {
                let row = &block.values()[block.offset([x.first, y, z])..];
                row.iter().zip(&x.orders[orders[0]]).map(|(&value, tap)| tap * f64::from(value)).sum::<f64>()
            };
            let along_y = |z: i64| {
                (y.first..).zip(&y.orders[orders[1]]).map(|(y, tap)| tap * along_x(y, z)).sum::<f64>()
            };
            let sum = (z.first..).zip(&z.orders[orders[2]]).map(|(z, tap)| tap * along_y(z)).sum::<f64>();
            sum / self.sigma.powi(self.on_the_grid(orders).iter().sum::<usize>() as i32)
        })
    }
}
