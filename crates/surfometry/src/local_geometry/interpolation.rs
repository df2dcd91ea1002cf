//! Derivatives off the grid from the voxels around.

use super::Jet;
use crate::embedding::JET_ORDERS;
use crate::tiling::{AxisWeights, Block};

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
            for (number, [ox, oy, oz]) in numbers.iter_mut().zip(JET_ORDERS) {
                *number += along_x[ox] * wy[oy] * wz[oz];
            }
        }
    }
    let scaled = |n: usize| {
        let powers = (0..3).map(|a| spacing[a].powi(JET_ORDERS[n][a] as i32)).product::<f64>();
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
    use crate::tiling::IndexBox;

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
