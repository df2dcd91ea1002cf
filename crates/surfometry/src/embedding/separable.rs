//! Convolution of an indicator with products of one-dimensional Gaussian kernels, a box at a time.

use super::kernel::{CumulativeKernel, GaussianKernel};
use super::{Indicator, Row};
use crate::tiling::IndexBox;

/// Derivative orders along x, y, z.
pub(crate) type Orders = [usize; 3];

/// Kernels of all derivative orders along the three axes of a grid.
#[derive(Debug)]
pub(crate) struct Separable {
    x: [CumulativeKernel; 3],
    /// f32 taps along y (0) and z (1), by order.
    taps: [[Vec<f32>; 3]; 2],
    halo: [i64; 3],
}

/// The slices that a box's convolution needs, convolved along x and y, one stack for each pair of orders.
struct XyStack {
    first_slice: i64,
    slices: Vec<Vec<f32>>,
}

impl Separable {
    /// Kernels in units of sigma, so that f32 holds them whatever the unit of length: an n-th derivative
    /// comes out multiplied by sigma^n.
    pub(crate) fn new(sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        Self::along([true; 3], sigma, spacing, truncation)
    }

    /// The same along some axes; along the others, of which there are no derivatives then, nothing is done.
    pub(super) fn along(axes: [bool; 3], sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        let kernel = |axis: usize, order: usize| {
            if axes[axis] {
                GaussianKernel::new(1.0, spacing[axis] / sigma, order, truncation).taps().to_vec()
            } else {
                vec![f64::from(u8::from(order == 0))]
            }
        };
        let taps =
            |axis: usize| [0, 1, 2].map(|order| kernel(axis, order).iter().map(|&t| t as f32).collect());
        Self {
            x: [0, 1, 2].map(|order| CumulativeKernel::new(&kernel(0, order), order)),
            taps: [taps(1), taps(2)],
            halo: [0, 1, 2].map(|axis| kernel(axis, 0).len() as i64 / 2),
        }
    }

    /// Convolves an indicator on a box with the kernels of each of `orders`; `visit` gets each slice z in
    /// turn with one plane of values (x fastest) for each of the orders.
    pub(crate) fn for_each_slice(
        &self,
        indicator: &dyn Indicator,
        region: &IndexBox,
        orders: &[Orders],
        mut visit: impl FnMut(i64, &[Vec<f32>]),
    ) {
        let mut pairs: Vec<[usize; 2]> = orders.iter().map(|o| [o[0], o[1]]).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let stacks = self.xy_stacks(indicator, region, &pairs);
        let stack_of =
            |o: &Orders| pairs.iter().position(|p| *p == [o[0], o[1]]).expect("every pair is listed");
        let [nx, ny, _] = region.extent();
        let mut planes = vec![vec![0.0f32; nx * ny]; orders.len()];
        for z in region.lower[2]..region.upper[2] {
            for (plane, order) in planes.iter_mut().zip(orders) {
                let stack = &stacks[stack_of(order)];
                let slices = |offset: i64| stack.slice(z - offset);
                accumulate(plane, &self.taps[1][order[2]], slices);
            }
            visit(z, &planes);
        }
    }

    fn xy_stacks(&self, indicator: &dyn Indicator, region: &IndexBox, pairs: &[[usize; 2]]) -> Vec<XyStack> {
        let needed = region.grown(self.halo).intersection(&indicator.bounds());
        let mut stacks: Vec<XyStack> =
            pairs.iter().map(|_| XyStack { first_slice: needed.lower[2], slices: Vec::new() }).collect();
        let orders_x = pairs.last().map_or(0, |pair| pair[0]);
        for z in needed.lower[2]..needed.upper[2] {
            let rows: Vec<_> = (0..=orders_x).map(|order| self.x_pass(indicator, region, order, z)).collect();
            for (stack, [order_x, order_y]) in stacks.iter_mut().zip(pairs) {
                stack.slices.push(self.y_pass(&rows[*order_x], region, *order_y));
            }
        }
        stacks
    }

    /// Rows y - halo .. y + halo of slice z convolved along x; empty where a row holds nothing within reach.
    fn x_pass(&self, indicator: &dyn Indicator, region: &IndexBox, order: usize, z: i64) -> Vec<Vec<f32>> {
        let (x0, nx) = (region.lower[0], region.extent()[0]);
        let kernel = &self.x[order];
        let span = (x0 - kernel.radius(), x0 + nx as i64 + kernel.radius());
        let (mut sums, mut row) = (vec![0.0; nx], Row::default());
        let rows = (region.lower[1] - self.halo[1])..(region.upper[1] + self.halo[1]);
        rows.map(|y| {
            row.clear(span);
            indicator.read_row(y, z, &mut row);
            if row.uniform() == Some(false) {
                return Vec::new();
            }
            sums.fill(0.0);
            row.runs().for_each(|run| kernel.add_run(&mut sums, x0, run, 1.0));
            for (x, &amount) in (span.0..).zip(row.amounts()).filter(|(_, amount)| **amount != 0.0) {
                kernel.add_run(&mut sums, x0, (x, x + 1), f64::from(amount));
            }
            sums.iter().map(|&v| v as f32).collect()
        })
        .collect()
    }

    fn y_pass(&self, rows: &[Vec<f32>], region: &IndexBox, order: usize) -> Vec<f32> {
        let nx = region.extent()[0];
        let mut plane = vec![0.0; nx * region.extent()[1]];
        for (number, out) in plane.chunks_mut(nx).enumerate() {
            let row = |offset: i64| rows[(number as i64 + self.halo[1] - offset) as usize].as_slice();
            accumulate(out, &self.taps[0][order], row);
        }
        plane
    }
}

impl XyStack {
    /// Slice z, empty where the indicator has none.
    fn slice(&self, z: i64) -> &[f32] {
        let number = z - self.first_slice;
        usize::try_from(number).ok().and_then(|n| self.slices.get(n)).map_or(&[], Vec::as_slice)
    }
}

/// out = sum over offsets of tap(offset) * input(offset), an empty input being zero.
fn accumulate<'a>(out: &mut [f32], taps: &[f32], input: impl Fn(i64) -> &'a [f32]) {
    out.fill(0.0);
    let radius = (taps.len() / 2) as i64;
    for (offset, &tap) in (-radius..=radius).zip(taps) {
        for (o, i) in out.iter_mut().zip(input(offset)) {
            *o += tap * i;
        }
    }
}
