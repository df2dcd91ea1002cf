//! Between voxels, from those around.

use super::IndexBox;

const POINTS: usize = 6;

/// The polynomial through six voxels of an axis: for each voxel, its weight in the value and the first two
/// derivatives, in units of 1/spacing^order.
pub(crate) struct AxisWeights {
    pub(crate) first: i64,
    pub(crate) weights: [[f64; 3]; POINTS],
}

impl AxisWeights {
    /// At a fractional index on an axis whose values exist on `lower..upper`: the point in the middle, or
    /// nearer to the end where the field ends.
    pub(crate) fn at(position: f64, lower: i64, upper: i64) -> Self {
        let points = POINTS as i64;
        let first = (position.floor() as i64 - points / 2 + 1).clamp(lower, upper - points);
        let x = position - first as f64;
        // Lagrange's polynomial, a factor at a time, with its derivatives by the product rule.
        let weights = |node: usize| {
            let (mut value, mut slope, mut bend) = (1.0, 0.0, 0.0);
            for other in (0..POINTS).filter(|&other| other != node) {
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
    pub(crate) fn within(region: &IndexBox, point: [f64; 3]) -> [Self; 3] {
        std::array::from_fn(|a| Self::at(point[a], region.lower[a], region.upper[a]))
    }
}
