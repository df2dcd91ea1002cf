//! Image axes that are not perpendicular.

use super::{Affine, Spacing};
use crate::space::dot;

/// Steps after which a matrix that is a degree from a rotation is one, to the last digits.
const STEPS: usize = 5;

/// How an image's axes differ from the perpendicular ones nearest to them, along which lengths, areas and curvature are taken.
///
/// Derivatives along the axes u of the image are G^-T times those in the world, G having the axes' directions for columns. Of G
/// = Q S, with S symmetric and near 1, Q has the perpendicular axes for columns, which no axis of the image is more than 0.7
/// degrees from, and S^-1 is what turns derivatives along the image's axes into those along these (a polar decomposition; Higham
/// 1986).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shear {
    /// The perpendicular axes, in the world.
    axes: [[f64; 3]; 3],
    /// S^-1.
    inverse: [[f64; 3]; 3],
}

impl Shear {
    /// Of the axes of an image, with its spacing.
    pub(super) fn of(affine: &Affine, spacing: Spacing) -> Self {
        let spacing = spacing.mm();
        let directions = affine.linear.map(|row| std::array::from_fn(|a| row[a] / spacing[a]));
        let directions = Affine { linear: directions, origin: [0.0; 3] };
        let mut axes = directions;
        for _ in 0..STEPS {
            let reciprocal = axes.reciprocal();
            axes.linear = std::array::from_fn(|w| {
                std::array::from_fn(|a| 0.5 * (axes.linear[w][a] + reciprocal[a][w]))
            });
        }
        let reciprocal = directions.reciprocal();
        let axes = [0, 1, 2].map(|a| axes.column(a));
        let inverse = axes.map(|axis| reciprocal.map(|row| dot(axis, row)));
        Self { axes, inverse }
    }

    /// The perpendicular axes, unit vectors of the world.
    pub(super) fn axes(&self) -> &[[f64; 3]; 3] {
        &self.axes
    }

    /// A gradient along the image's axes, 1/mm, along the perpendicular ones.
    #[inline]
    pub(crate) fn gradient(&self, gradient: [f64; 3]) -> [f64; 3] {
        self.inverse.map(|row| dot(row, gradient))
    }

    /// The same of second derivatives xx, yy, zz, xy, xz, yz.
    #[inline]
    pub(crate) fn hessian(&self, [xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 6] {
        // S^-1 is symmetric: its rows are its columns.
        let half = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| self.gradient(row));
        let at = |n: usize, m: usize| (0..3).map(|a| self.inverse[n][a] * half[a][m]).sum();
        [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(0, 2), at(1, 2)]
    }
}
