//! What part of space an image shows.

use super::{Affine, Grid};
use crate::tiling::IndexBox;
use std::fmt;

/// A box of an image's voxels, in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldOfView {
    affine: Affine,
    to_index: Affine,
    /// Indices at its ends, outer faces of voxels.
    ends: [[f64; 2]; 3],
}

impl FieldOfView {
    /// Of a box of voxels; `None` where all voxels lie in one place.
    pub fn new(grid: &Grid, voxels: &IndexBox) -> Option<Self> {
        let affine = *grid.affine();
        let ends = |a: usize| [voxels.lower[a] as f64 - 0.5, voxels.upper[a] as f64 - 0.5];
        Some(Self { affine, to_index: affine.inverted()?, ends: std::array::from_fn(ends) })
    }

    /// The same without so many voxels at the lower and the upper end of each axis.
    #[must_use]
    pub fn without(mut self, voxels: [[f64; 2]; 3]) -> Self {
        for ([low, high], [below, above]) in self.ends.iter_mut().zip(voxels) {
            (*low, *high) = (*low + below, *high - above);
        }
        self
    }

    /// Whether a point of the world, mm, lies in it.
    pub fn contains(&self, world: [f64; 3]) -> bool {
        let index = self.to_index.apply(world);
        self.ends.iter().zip(index).all(|([low, high], index)| (*low..=*high).contains(&index))
    }

    /// Whether both might have a point in common: their boxes along the world's axes do.
    pub fn may_meet(&self, other: &Self) -> bool {
        let (here, there) = (self.bounds(), other.bounds());
        (0..3).all(|w| here[w][0] <= there[w][1] && there[w][0] <= here[w][1])
    }

    /// From where to where it goes along each of the world's axes, mm.
    fn bounds(&self) -> [[f64; 2]; 3] {
        let corner = |n: usize| self.affine.apply(std::array::from_fn(|a| self.ends[a][n >> a & 1]));
        let corners: [[f64; 3]; 8] = std::array::from_fn(corner);
        std::array::from_fn(|w| {
            let along = corners.iter().map(|corner| corner[w]);
            [along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max)]
        })
    }
}

impl fmt::Display for FieldOfView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.bounds().map(|[low, high]| format!("{low:.1} to {high:.1}"));
        write!(f, "x {x}, y {y}, z {z} mm (RAS)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_of_voxels_end_it() {
        let affine =
            Affine { linear: [[0.0, -2.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 3.0]], origin: [10.0; 3] };
        let grid = Grid::new([4, 5, 6], affine).unwrap();
        let view = FieldOfView::new(&grid, &grid.index_box()).unwrap();
        assert_eq!(view.to_string(), "x 1.0 to 11.0, y 9.5 to 13.5, z 8.5 to 26.5 mm (RAS)");
        assert!(view.contains([1.1, 13.4, 26.4]) && !view.contains([0.9, 13.4, 26.4]));
        let inner = view.without([[0.0; 2], [0.0; 2], [1.0, 2.0]]);
        assert!(inner.contains([5.0, 10.0, 12.0]) && inner.contains([5.0, 10.0, 20.0]));
        assert!(!inner.contains([5.0, 10.0, 11.0]) && !inner.contains([5.0, 10.0, 21.0]));
        let far = Grid::new([4; 3], Affine { origin: [40.0; 3], ..affine }).unwrap();
        assert!(view.may_meet(&inner) && !view.may_meet(&FieldOfView::new(&far, &far.index_box()).unwrap()));
    }
}
