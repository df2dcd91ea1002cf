//! Derivatives off the grid from the voxels around.

use super::jet::ORDERS;
use super::{Jet, MINIMUM_POINTS};
use crate::tiling::{Block, IndexBox};

/// The polynomial through six voxels of an axis: for each voxel, its weight in the value and the first two
/// derivatives, in units of 1/spacing^order.
struct AxisWeights {
    first: i64,
    weights: [[f64; 3]; MINIMUM_POINTS],
}

impl AxisWeights {
    /// At a fractional index on an axis whose values exist on `lower..upper`: the point in the middle, or
    /// nearer to the end where the field ends.
    fn at(position: f64, lower: i64, upper: i64) -> Self {
        let points = MINIMUM_POINTS as i64;
        let first = (position.floor() as i64 - points / 2 + 1).clamp(lower, upper - points);
        let x = position - first as f64;
        // Lagrange's polynomial, a factor at a time, with its derivatives by the product rule.
        let weights = |node: usize| {
            let (mut value, mut slope, mut bend) = (1.0, 0.0, 0.0);
            for other in (0..MINIMUM_POINTS).filter(|&other| other != node) {
                let scale = 1.0 / (node as f64 - other as f64);
                let factor = (x - other as f64) * scale;
                bend = bend * factor + 2.0 * slope * scale;
                slope = slope * factor + value * scale;
                value *= factor;
            }
            [value, slope, bend]
        };
        Self { first, weights: std::array::from_fn(weights) }
    }

    /// At a fractional index, along the three axes of a box.
    fn within(region: &IndexBox, point: [f64; 3]) -> [Self; 3] {
        std::array::from_fn(|a| Self::at(point[a], region.lower[a], region.upper[a]))
    }
}

/// Values at a fractional index of blocks of one box of at least six voxels a side.
pub(super) fn interpolated_values<const N: usize>(blocks: &[Block<f32>; N], point: [f64; 3]) -> [f64; N] {
    let [x, y, z] = AxisWeights::within(&blocks[0].region(), point);
    let mut values = [0.0; N];
    for (slice, wz) in (z.first..).zip(&z.weights) {
        for (row, wy) in (y.first..).zip(&y.weights) {
            let start = blocks[0].offset([x.first, row, slice]);
            let weight = wy[0] * wz[0];
            for (value, block) in values.iter_mut().zip(blocks) {
                let along = block.values()[start..].iter().zip(&x.weights);
                *value += weight * along.map(|(&v, w)| w[0] * f64::from(v)).sum::<f64>();
            }
        }
    }
    values
}

/// Value and derivatives, in mm along the image's axes, at a fractional index of a block of at least six
/// voxels a side.
pub(super) fn interpolated_jet<T: Copy + Into<f64>>(
    values: &Block<T>,
    point: [f64; 3],
    spacing: [f64; 3],
) -> Jet {
    let [x, y, z] = AxisWeights::within(&values.region(), point);
    let mut numbers = [0.0; 10];
    for (slice, wz) in (z.first..).zip(&z.weights) {
        for (row, wy) in (y.first..).zip(&y.weights) {
            let start = values.offset([x.first, row, slice]);
            let along_x = [0, 1, 2].map(|order| {
                values.values()[start..]
                    .iter()
                    .zip(&x.weights)
                    .map(|(&v, w)| w[order] * v.into())
                    .sum::<f64>()
            });
            for (number, [ox, oy, oz]) in numbers.iter_mut().zip(ORDERS) {
                *number += along_x[ox] * wy[oy] * wz[oz];
            }
        }
    }
    let scaled = |n: usize| {
        let powers = (0..3).map(|a| spacing[a].powi(ORDERS[n][a] as i32)).product::<f64>();
        numbers[n] / powers
    };
    Jet {
        value: numbers[0],
        gradient: std::array::from_fn(|n| scaled(n + 1)),
        hessian: std::array::from_fn(|n| scaled(n + 4)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact on polynomials up to degree five along each axis, in the middle and at the ends.
    #[test]
    fn polynomials_come_out_exactly() {
        let spacing = [0.5, 1.0, 2.0];
        let region = IndexBox::new([-3, 2, 0], [6, 10, 6]);
        let mut block = Block::filled(region, 0.0f64);
        let f = |[x, y, z]: [f64; 3]| x.powi(3) * y - 0.2 * y * y * z.powi(3) + 0.1 * x * z.powi(5) + 1.0;
        let mm = |p: [f64; 3]| std::array::from_fn(|a| p[a] * spacing[a]);
        for (j, k) in region.rows() {
            for (i, value) in (region.lower[0]..).zip(block.row_mut(j, k)) {
                *value = f(mm([i, j, k].map(|v| v as f64)));
            }
        }
        for point in [[0.3, 5.6, 2.2], [-2.9, 2.1, 4.9], [4.7, 8.8, 0.4]] {
            let jet = interpolated_jet(&block, point, spacing);
            let [x, y, z] = mm(point);
            let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{point:?}: {a} {b}");
            near(jet.value, f([x, y, z]));
            let gradient = [
                3.0 * x * x * y + 0.1 * z.powi(5),
                x.powi(3) - 0.4 * y * z.powi(3),
                -0.6 * y * y * z * z + 0.5 * x * z.powi(4),
            ];
            let hessian = [
                6.0 * x * y,
                -0.4 * z.powi(3),
                -1.2 * y * y * z + 2.0 * x * z.powi(3),
                3.0 * x * x,
                0.5 * z.powi(4),
                -1.2 * y * z * z,
            ];
            jet.gradient
                .into_iter()
                .zip(gradient)
                .chain(jet.hessian.into_iter().zip(hessian))
                .for_each(|(a, b)| near(a, b));
        }
    }
}
