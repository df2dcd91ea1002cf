//! The blurred indicator and its derivatives at a point off the grid.

use super::kernel::{CumulativeKernel, Samples, WHOLE};
use super::separable::Orders;
use super::{Indicator, Row};

/// Derivative orders along x, y, z of a jet's ten numbers: the value, the gradient, the Hessian.
pub(crate) const JET_ORDERS: [Orders; 10] = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 1, 0],
    [1, 0, 1],
    [0, 1, 1],
];

/// The blurred indicator's numbers at a point, in the order of [`JET_ORDERS`].
pub(crate) type PointDerivatives = [f64; 10];

/// Taps of orders 0 to 2 around a fractional position on one axis.
#[derive(Debug, Default)]
pub(super) struct AxisTaps {
    /// Voxel of the first tap.
    pub(super) first: i64,
    pub(super) orders: [Vec<f64>; 3],
    /// Positions and values of the Gaussian.
    bell: Vec<(f64, f64)>,
}

/// Memory that one point after the other is convolved in.
#[derive(Debug, Default)]
pub(super) struct PointMemory {
    axes: [AxisTaps; 3],
    sums: [CumulativeKernel; 3],
    voxels: Row,
}

/// What does not depend on the position: the Gaussian at whole steps from it, and its moments before the cut.
#[derive(Debug)]
pub(super) struct AxisBell {
    spacing: f64,
    sigma: f64,
    bell: Vec<f64>,
    variance: f64,
    /// [`Samples::bend`].
    bend: f64,
}

impl AxisBell {
    fn new(sigma: f64, spacing: f64, truncation: f64) -> Self {
        let whole = Samples::new(sigma, spacing, truncation.max(WHOLE));
        let Samples { bell, .. } = Samples::new(sigma, spacing, truncation);
        Self { spacing, sigma, bell, variance: whole.moment(2), bend: whole.bend() }
    }

    /// Taps on each side of the one next to a position.
    pub(super) fn radius(&self) -> i64 {
        self.bell.len() as i64 / 2
    }

    /// Normalised as the kernels of the grid are ([`GaussianKernel`](super::GaussianKernel)), and equal to
    /// them at a voxel.
    pub(super) fn taps_at(&self, position: f64, AxisTaps { first, orders, bell: taps }: &mut AxisTaps) {
        let centre = position.round();
        let offset = position - centre;
        let radius = self.radius();
        // exp(-(d - f)^2 h^2 / 2 sigma^2) = bell(d) q^d up to a factor that normalising takes off.
        let q = libm::exp(offset * (self.spacing / self.sigma).powi(2));
        let mut growth = libm::pow(q, -radius as f64);
        taps.clear();
        for (d, bell) in (-radius..=radius).zip(&self.bell) {
            taps.push(((d as f64 - offset) * self.spacing, bell * growth));
            growth *= q;
        }
        let sum: f64 = taps.iter().map(|t| t.1).sum();
        for tap in &mut *taps {
            tap.1 /= sum;
        }
        let mean: f64 = taps.iter().map(|(u, g)| u * g).sum();
        let square: f64 = taps.iter().map(|(u, g)| u * u * g).sum();
        *first = centre as i64 - radius;
        let weights: [&dyn Fn(f64) -> f64; 3] =
            [&|_| 1.0, &|u| (u - mean) / self.variance, &|u| (u * u - square) * self.bend];
        for (order, weight) in orders.iter_mut().zip(weights) {
            order.clear();
            order.extend(taps.iter().map(|&(u, g)| weight(u) * g));
        }
    }
}

/// Convolves an indicator with the products of Gaussian derivatives, centred at any point.
#[derive(Debug)]
pub(super) struct PointKernel {
    pub(super) axes: [AxisBell; 3],
}

impl PointKernel {
    pub(super) fn new(sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        Self { axes: spacing.map(|h| AxisBell::new(sigma, h, truncation)) }
    }

    /// The blurred indicator and its derivatives, in mm, at a fractional voxel index.
    pub(super) fn convolve(
        &self,
        indicator: &dyn Indicator,
        point: [f64; 3],
        PointMemory { axes, sums, voxels }: &mut PointMemory,
    ) -> PointDerivatives {
        for ((axis, taps), position) in self.axes.iter().zip(&mut *axes).zip(point) {
            axis.taps_at(position, taps);
        }
        let [x, y, z] = axes;
        for (order, (sum, taps)) in sums.iter_mut().zip(&x.orders).enumerate() {
            sum.set_taps(taps, order);
        }
        let span = (x.first, x.first + x.orders[0].len() as i64);
        let mut total = [0.0; 10];
        for (row_z, slice) in (z.first..).zip(0..z.orders[0].len()) {
            // By order along x and y: 00, 10, 20, 01, 11, 02.
            let mut plane = [0.0; 6];
            for (row_y, line) in (y.first..).zip(0..y.orders[0].len()) {
                let mut row = [0.0; 3];
                voxels.clear(span);
                indicator.read_row(row_y, row_z, voxels);
                for (from, to) in voxels.runs() {
                    for (value, sum) in row.iter_mut().zip(&*sums) {
                        *value += sum.between(from - x.first, to - x.first);
                    }
                }
                for (value, taps) in row.iter_mut().zip(&x.orders) {
                    for (&amount, tap) in voxels.amounts().iter().zip(taps) {
                        *value += f64::from(amount) * tap;
                    }
                }
                let [y0, y1, y2] = [0, 1, 2].map(|order| y.orders[order][line]);
                let terms = [row[0] * y0, row[1] * y0, row[2] * y0, row[0] * y1, row[1] * y1, row[0] * y2];
                plane.iter_mut().zip(terms).for_each(|(p, term)| *p += term);
            }
            let [z0, z1, z2] = [0, 1, 2].map(|order| z.orders[order][slice]);
            let [p00, p10, p20, p01, p11, p02] = plane;
            let terms = [
                p00 * z0,
                p10 * z0,
                p01 * z0,
                p00 * z1,
                p20 * z0,
                p02 * z0,
                p00 * z2,
                p11 * z0,
                p10 * z1,
                p01 * z1,
            ];
            total.iter_mut().zip(terms).for_each(|(t, term)| *t += term);
        }
        total
    }
}
