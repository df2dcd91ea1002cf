//! Boxes of voxel indices.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A half-open box of voxel indices, x first. Indices may be negative: a halo reaches beyond the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct IndexBox {
    /// First index along each axis.
    pub lower: [i64; 3],
    /// One past the last index along each axis.
    pub upper: [i64; 3],
}

impl IndexBox {
    /// All that indices reach.
    pub(crate) const EVERYTHING: Self = Self { lower: [i64::MIN; 3], upper: [i64::MAX; 3] };
}

/// As ranges of indices, their ends left out.
impl fmt::Display for IndexBox {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { lower: [x0, y0, z0], upper: [x1, y1, z1] } = self;
        write!(f, "x {x0}..{x1}, y {y0}..{y1}, z {z0}..{z1}")
    }
}

impl IndexBox {
    /// The box without voxels.
    pub const EMPTY: Self = Self { lower: [0; 3], upper: [0; 3] };

    /// A box; empty where an upper end does not exceed the lower.
    pub fn new(lower: [i64; 3], upper: [i64; 3]) -> Self {
        let full = (0..3).all(|a| lower[a] < upper[a]);
        if full { Self { lower, upper } } else { Self::EMPTY }
    }

    /// All indices of an image.
    pub fn from_dimensions(dimensions: [usize; 3]) -> Self {
        Self::new([0; 3], dimensions.map(|n| n as i64))
    }

    /// The box of one voxel.
    pub fn voxel(index: [i64; 3]) -> Self {
        Self::new(index, index.map(|i| i + 1))
    }

    /// The box of the voxels at or below fractional indices; `None` without any.
    pub(crate) fn around(points: &[[f64; 3]]) -> Option<Self> {
        let voxel = |point: &[f64; 3]| Self::voxel(point.map(|v| v.floor() as i64));
        points.iter().map(voxel).reduce(|hull, voxel| hull.hull(&voxel))
    }

    /// Whether it has no voxel.
    pub fn is_empty(&self) -> bool {
        *self == Self::EMPTY
    }

    /// Voxels along each axis.
    pub fn extent(&self) -> [usize; 3] {
        std::array::from_fn(|a| (self.upper[a] - self.lower[a]) as usize)
    }

    /// Number of voxels.
    pub fn voxels(&self) -> usize {
        self.extent().iter().product()
    }

    /// Whether an index lies in it.
    pub fn contains(&self, index: [i64; 3]) -> bool {
        (0..3).all(|a| (self.lower[a]..self.upper[a]).contains(&index[a]))
    }

    /// Whether it shares voxels, faces, edges or corners with another.
    pub(crate) fn is_near(&self, other: &Self) -> bool {
        (0..3).all(|a| self.lower[a] <= other.upper[a] && other.lower[a] <= self.upper[a])
    }

    /// Whether its ends are those of a box with voxels, as they may not be where it was read.
    pub(crate) fn has_voxels(&self) -> bool {
        (0..3).all(|a| self.lower[a] < self.upper[a])
    }

    /// The box with a halo on both sides of each axis; an empty box stays empty.
    #[must_use]
    pub fn grown(&self, halo: [i64; 3]) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::new(
            std::array::from_fn(|a| self.lower[a] - halo[a]),
            std::array::from_fn(|a| self.upper[a] + halo[a]),
        )
    }

    /// What two boxes share.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self::new(
            std::array::from_fn(|a| self.lower[a].max(other.lower[a])),
            std::array::from_fn(|a| self.upper[a].min(other.upper[a])),
        )
    }

    /// Whether every voxel of another lies in it.
    pub fn holds(&self, other: &Self) -> bool {
        self.intersection(other) == *other
    }

    /// What lies in it and not in another, as disjoint boxes.
    pub fn without(&self, other: &Self) -> Vec<Self> {
        let mut rest = *self;
        let mut parts = Vec::new();
        for axis in 0..3 {
            let (mut before, mut behind) = (rest, rest);
            before.upper[axis] = rest.upper[axis].min(other.lower[axis]);
            behind.lower[axis] = rest.lower[axis].max(other.upper[axis]);
            parts.extend([before, behind].map(|part| Self::new(part.lower, part.upper)));
            rest.lower[axis] = rest.lower[axis].max(other.lower[axis]);
            rest.upper[axis] = rest.upper[axis].min(other.upper[axis]);
            if rest.lower[axis] >= rest.upper[axis] {
                break;
            }
        }
        parts.retain(|part| !part.is_empty());
        parts
    }

    /// The smallest box around two.
    #[must_use]
    pub fn hull(&self, other: &Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => *other,
            (_, true) => *self,
            _ => Self::new(
                std::array::from_fn(|a| self.lower[a].min(other.lower[a])),
                std::array::from_fn(|a| self.upper[a].max(other.upper[a])),
            ),
        }
    }

    /// The (y, z) of every row, y fastest.
    pub fn rows(&self) -> impl Iterator<Item = (i64, i64)> + use<> {
        let Self { lower, upper } = *self;
        (lower[2]..upper[2]).flat_map(move |z| (lower[1]..upper[1]).map(move |y| (y, z)))
    }

    /// The box cut at multiples of the tiles' edges (image index 0 is such a multiple), in order of z, y, x.
    pub fn tiles(&self, edges: [i64; 3]) -> Vec<Self> {
        let cuts = |a: usize| {
            let edge = edges[a];
            let first = self.lower[a].div_euclid(edge);
            let last = (self.upper[a] - 1).div_euclid(edge);
            (first..=last).map(move |n| (n * edge, (n + 1) * edge)).collect::<Vec<_>>()
        };
        if self.is_empty() {
            return Vec::new();
        }
        let (xs, ys, zs) = (cuts(0), cuts(1), cuts(2));
        let mut tiles = Vec::with_capacity(xs.len() * ys.len() * zs.len());
        for z in &zs {
            for y in &ys {
                for x in &xs {
                    tiles.push(Self::new([x.0, y.0, z.0], [x.1, y.1, z.1]).intersection(self));
                }
            }
        }
        tiles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_once_and_start_at_multiples() {
        let whole = IndexBox::new([-70, 3, 64], [10, 130, 65]);
        let tiles = whole.tiles([64, 64, 32]);
        assert_eq!(tiles.iter().map(IndexBox::voxels).sum::<usize>(), whole.voxels());
        for (i, a) in tiles.iter().enumerate() {
            assert!(tiles[i + 1..].iter().all(|b| a.intersection(b).is_empty()));
            assert!((0..3).all(|k| a.lower[k] == whole.lower[k] || a.lower[k] % [64, 64, 32][k] == 0));
        }
        assert!(IndexBox::EMPTY.tiles([64; 3]).is_empty());
    }

    #[test]
    fn hull_and_intersection() {
        let (a, b) = (IndexBox::new([0; 3], [4; 3]), IndexBox::new([2; 3], [6; 3]));
        assert_eq!(a.hull(&b), IndexBox::new([0; 3], [6; 3]));
        assert_eq!(a.intersection(&b), IndexBox::new([2; 3], [4; 3]));
        assert_eq!(a.hull(&IndexBox::EMPTY), a);
        assert!(a.intersection(&IndexBox::new([5; 3], [6; 3])).is_empty());
        assert!(a.holds(&IndexBox::new([1; 3], [4; 3])) && !a.holds(&b));
        assert!(IndexBox::EMPTY.grown([3; 3]).is_empty());
    }

    #[test]
    fn what_is_left_is_disjoint_and_all() {
        let whole = IndexBox::new([0; 3], [5, 4, 3]);
        for hole in [[[1; 3], [2; 3]], [[-3, 1, 0], [9, 2, 3]], [[0; 3], [5, 4, 3]], [[7; 3], [8; 3]]] {
            let hole = IndexBox::new(hole[0], hole[1]);
            let parts = whole.without(&hole);
            for (y, z) in whole.rows() {
                for x in 0..5 {
                    let holding = parts.iter().filter(|part| part.contains([x, y, z])).count();
                    assert_eq!(holding, usize::from(!hole.contains([x, y, z])));
                }
            }
        }
        assert!(IndexBox::EMPTY.without(&whole).is_empty());
    }
}
