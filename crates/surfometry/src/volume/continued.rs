//! Objects beyond the edge of their image.

use super::Mask;
use crate::tiling::IndexBox;

impl Mask {
    /// An object and its mirror images in the faces of its image, in a box that may reach beyond them.
    pub(crate) fn continued(&self, region: &IndexBox) -> Self {
        let dimensions = self.grid().dimensions().map(|n| n as i64);
        let mirrored = |index: i64, a: usize| {
            let place = index.rem_euclid(2 * dimensions[a]);
            place.min(2 * dimensions[a] - 1 - place)
        };
        let mut whole = Self::cleared(*self.grid(), *region);
        for (y, z) in region.rows() {
            let (from_y, from_z) = (mirrored(y, 1), mirrored(z, 2));
            self.runs(from_y, from_z).for_each(|run| whole.set_run(run, y, z));
            for x in (region.lower[0]..0).chain(dimensions[0]..region.upper[0]) {
                if self.get([mirrored(x, 0), from_y, from_z]) {
                    whole.set_run((x, x + 1), y, z);
                }
            }
        }
        whole
    }

    /// The first or the last slice of the image along an axis, and `depth` slices in all; where the image cuts
    /// the object, the slices next to the cut.
    pub(crate) fn edge_slices(&self, axis: usize, upper: bool, depth: i64) -> IndexBox {
        let mut slices = self.bounds();
        let last = self.grid().dimensions()[axis] as i64;
        if upper {
            slices.lower[axis] = slices.lower[axis].max(last - depth);
        } else {
            slices.upper[axis] = slices.upper[axis].min(depth);
        }
        IndexBox::new(slices.lower, slices.upper)
    }
}
