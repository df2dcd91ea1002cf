//! A box of an image as the topology of its voxels is counted in it.

use crate::tiling::IndexBox;

/// A box, and where it lies in its image.
///
/// Two voxels that touch lie within one step of the lesser of their indices along each axis. So a box knows
/// of all that begins in it if it also sees one more slice behind its upper ends: the first slice of its
/// neighbours. Where the image ends, a rim of background belongs to the box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    image: IndexBox,
    region: IndexBox,
}

/// A rectangle of voxels in a plane across an axis: its ends along the two other axes, the lesser of them
/// first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rectangle(pub(super) [[i64; 2]; 2]);

/// The two axes of a plane across one, in ascending order.
pub(super) fn axes_across(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}

impl Frame {
    pub(super) fn new(image: &IndexBox, region: &IndexBox) -> Self {
        Self { image: *image, region: *region }
    }

    /// Whether the image ends with the box: at its lower (0) or its upper end (1) along an axis.
    pub(super) fn is_outer(&self, axis: usize, side: usize) -> bool {
        match side {
            0 => self.region.lower[axis] == self.image.lower[axis],
            _ => self.region.upper[axis] == self.image.upper[axis],
        }
    }

    /// Whether the image ends with the box anywhere.
    pub(super) fn touches_outside(&self) -> bool {
        (0..3).any(|axis| self.is_outer(axis, 0) || self.is_outer(axis, 1))
    }

    /// The box with its part of the rim around the image.
    pub(super) fn owned(&self) -> IndexBox {
        let rim = |axis, side| i64::from(self.is_outer(axis, side));
        IndexBox::new(
            std::array::from_fn(|a| self.region.lower[a] - rim(a, 0)),
            std::array::from_fn(|a| self.region.upper[a] + rim(a, 1)),
        )
    }

    /// All that the box sees.
    pub(super) fn seen(&self) -> IndexBox {
        let owned = self.owned();
        IndexBox::new(owned.lower, owned.upper.map(|u| u + 1)).intersection(&self.image.grown([1; 3]))
    }

    /// The first and the last slice that the box sees along an axis, which it has in common with its
    /// neighbours; `None` where the image ends.
    pub(super) fn face(&self, axis: usize, side: usize) -> Option<i64> {
        let slice = if side == 0 { self.region.lower[axis] } else { self.region.upper[axis] };
        (!self.is_outer(axis, side)).then_some(slice)
    }

    /// What the box sees of a slice across an axis.
    pub(super) fn rectangle(&self, axis: usize) -> Rectangle {
        let seen = self.seen();
        Rectangle(axes_across(axis).map(|a| [seen.lower[a], seen.upper[a]]))
    }
}

impl Rectangle {
    /// Voxels along its axes.
    pub(super) fn extent(&self) -> [u32; 2] {
        self.0.map(|[lower, upper]| (upper - lower) as u32)
    }
}
