//! Index-to-world transform.

use serde::{Deserialize, Serialize};

/// How far a direction may be from unit length and count as rounded.
const ROUNDING: f64 = 1e-6;

/// Maps a voxel index (x, y, z) to world coordinates in mm: `linear * index + origin`.
///
/// World axes are RAS (x to the right, y to the front, z to the head), as in NIfTI; readers of LPS formats
/// (MetaImage, NRRD, DICOM) convert.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Affine {
    /// `linear[world axis][image axis]`, mm per voxel.
    pub linear: [[f64; 3]; 3],
    /// World position of voxel (0, 0, 0), mm.
    pub origin: [f64; 3],
}

impl Affine {
    /// Axes along the world's, voxel (0, 0, 0) at the world's origin.
    pub fn diagonal(spacing: [f64; 3]) -> Self {
        let [x, y, z] = spacing;
        Self { linear: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], origin: [0.0; 3] }
    }

    /// From direction vectors (one an image axis), spacing and origin. Lengths are the spacing's alone,
    /// whatever those of the directions are.
    pub fn from_directions(directions: [[f64; 3]; 3], spacing: [f64; 3], origin: [f64; 3]) -> Self {
        let directions = directions.map(unit);
        let entry = |world: usize, axis: usize| directions[axis][world] * spacing[axis];
        Self { linear: std::array::from_fn(|w| std::array::from_fn(|a| entry(w, a))), origin }
    }

    /// World coordinates in mm of a (fractional) voxel index.
    pub fn apply(&self, index: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|w| self.origin[w] + (0..3).map(|a| self.linear[w][a] * index[a]).sum::<f64>())
    }

    /// The way back, from the world to voxel indices; `None` where several indices lie in one place.
    pub fn inverted(&self) -> Option<Self> {
        let linear = inverse(self.linear)?;
        let back = |row: [f64; 3]| -(0..3).map(|w| row[w] * self.origin[w]).sum::<f64>();
        Some(Self { linear, origin: linear.map(back) })
    }

    /// Step in the world of one voxel along an image axis, mm.
    pub fn column(&self, axis: usize) -> [f64; 3] {
        std::array::from_fn(|w| self.linear[w][axis])
    }

    /// Lengths of the three columns: the voxel spacing, mm.
    pub fn column_lengths(&self) -> [f64; 3] {
        std::array::from_fn(|a| {
            let [x, y, z] = self.column(a);
            libm::sqrt(x * x + y * y + z * z)
        })
    }

    /// Cosine of the angle between two image axes.
    pub(crate) fn cosine(&self, first: usize, second: usize) -> f64 {
        let (lengths, a, b) = (self.column_lengths(), self.column(first), self.column(second));
        (0..3).map(|w| a[w] * b[w]).sum::<f64>() / (lengths[first] * lengths[second])
    }

    /// The same directions and origin with other spacings.
    #[must_use]
    pub fn with_spacing(&self, spacing: [f64; 3]) -> Self {
        let lengths = self.column_lengths();
        let scale = |a: usize| if lengths[a] > 0.0 { spacing[a] / lengths[a] } else { 1.0 };
        Self {
            linear: std::array::from_fn(|w| std::array::from_fn(|a| self.linear[w][a] * scale(a))),
            origin: self.origin,
        }
    }

    /// All lengths multiplied, as from metres to mm.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            linear: self.linear.map(|row| row.map(|v| v * factor)),
            origin: self.origin.map(|v| v * factor),
        }
    }

    /// World x and y turned round: LPS to RAS and back.
    #[must_use]
    pub fn with_lps_swapped(&self) -> Self {
        let flip = [-1.0, -1.0, 1.0];
        Self {
            linear: std::array::from_fn(|w| self.linear[w].map(|v| v * flip[w])),
            origin: std::array::from_fn(|w| self.origin[w] * flip[w]),
        }
    }

    /// Negative where the image axes form a left-handed system in the world.
    pub fn determinant(&self) -> f64 {
        let [a, b, c] = self.linear;
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    /// Rows of the inverse: one across the other two columns for each, whose product with its own is 1.
    pub(crate) fn reciprocal(&self) -> [[f64; 3]; 3] {
        let volume = self.determinant();
        [(1, 2), (2, 0), (0, 1)].map(|(first, second)| {
            let (a, b) = (self.column(first), self.column(second));
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            cross.map(|v| v / volume)
        })
    }

    /// The world axis that each image axis runs along best, each world axis being taken once.
    pub fn nearest_axes(&self) -> [usize; 3] {
        let lengths = self.column_lengths();
        let along =
            |a: usize, w: usize| if lengths[a] > 0.0 { self.linear[w][a].abs() / lengths[a] } else { 0.0 };
        let fit = |axes: &[usize; 3]| (0..3).map(|a| along(a, axes[a])).sum::<f64>();
        let all = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        all.into_iter()
            .reduce(|best, axes| if fit(&axes) > fit(&best) { axes } else { best })
            .unwrap_or([0, 1, 2])
    }

    /// The nearest anatomical axis codes, such as `RAS`: the way each image axis grows.
    pub fn axis_codes(&self) -> String {
        let world = self.nearest_axes();
        let letters = [['L', 'R'], ['P', 'A'], ['I', 'S']];
        (0..3).map(|a| letters[world[a]][usize::from(self.linear[world[a]][a] > 0.0)]).collect()
    }

    /// Whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.linear.iter().flatten().chain(&self.origin).all(|v| v.is_finite())
    }
}

/// A direction at unit length, as it is where it has that up to rounding; one of no length stays so.
fn unit(direction: [f64; 3]) -> [f64; 3] {
    let length = libm::sqrt(direction.iter().map(|v| v * v).sum());
    if length > 0.0 && (length - 1.0).abs() > ROUNDING { direction.map(|v| v / length) } else { direction }
}

/// Inverse of a 3 x 3 matrix by cofactors.
fn inverse(m: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cofactor = |r: usize, c: usize| {
        let [r1, r2, c1, c2] = [(r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3];
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * cofactor(0, c)).sum();
    let inverse: [[f64; 3]; 3] =
        std::array::from_fn(|r| std::array::from_fn(|c| cofactor(c, r) / determinant));
    inverse.iter().flatten().all(|v| v.is_finite()).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_the_spacings() {
        let twice = [[0.0, 2.0, 0.0], [-0.3, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let affine = Affine::from_directions(twice, [2.0, 3.0, 4.0], [0.0; 3]);
        assert_eq!(affine.column_lengths(), [2.0, 3.0, 4.0]);
        assert_eq!(affine.column(0), [0.0, 2.0, 0.0]);
        let none = Affine::from_directions([[0.0; 3]; 3], [1.0; 3], [0.0; 3]);
        assert_eq!(none.column_lengths(), [0.0; 3]);
    }

    #[test]
    fn the_way_back() {
        let turned = [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, -1.0]];
        let affine = Affine::from_directions(turned, [2.0, 3.0, 0.4], [10.0, -20.0, 30.0]);
        let back = affine.inverted().unwrap().apply(affine.apply([1.5, -2.0, 7.0]));
        assert!(back.iter().zip([1.5, -2.0, 7.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
        assert_eq!(Affine::diagonal([1.0, 0.0, 1.0]).inverted(), None);
    }

    #[test]
    fn directions_are_columns() {
        let directions = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let affine = Affine::from_directions(directions, [2.0, 3.0, 4.0], [10.0, 20.0, 30.0]);
        assert_eq!(affine.apply([1.0, 0.0, 0.0]), [10.0, 22.0, 30.0]);
        assert_eq!(affine.apply([0.0, 1.0, 1.0]), [7.0, 20.0, 34.0]);
        assert_eq!(affine.column_lengths(), [2.0, 3.0, 4.0]);
        assert_eq!(affine.axis_codes(), "ALS");
        // Turned by 45 degrees two axes are as near to x as to y, and no letter comes twice.
        let half = 0.5f64.sqrt();
        let turned = Affine::from_directions(
            [[half, half, 0.0], [-half, half, 0.0], [0.0, 0.0, 1.0]],
            [1.0; 3],
            [0.0; 3],
        );
        assert_eq!(turned.nearest_axes(), [0, 1, 2]);
        assert_eq!(turned.axis_codes(), "RAS");
        assert!(affine.determinant() > 0.0);
        assert_eq!(affine.with_lps_swapped().with_lps_swapped(), affine);
        assert_eq!(affine.with_spacing([1.0; 3]).column_lengths(), [1.0; 3]);
    }
}
