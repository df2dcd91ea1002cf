//! The image's own slices, as radiologists look at them.

use crate::tiling::IndexBox;
use crate::volume::Grid;

/// Of a world axis: the name of the slices across it, and the directions at their left, right, bottom and
/// top, as radiologists look at them.
const PLANES: [(&str, [char; 4]); 3] =
    [("Sagittal", ['A', 'P', 'I', 'S']), ("Coronal", ['R', 'L', 'I', 'S']), ("Axial", ['R', 'L', 'P', 'A'])];

/// Cosine of the angle to a world axis, 5 degrees, beyond which a slice is called oblique.
const NEARLY: f64 = 0.9962;

/// Those slices of an image that lie most nearly across a world axis, within a box: u runs to the right of the
/// picture, v upward.
#[derive(Debug, Clone)]
pub(crate) struct ImageSlices {
    /// Such as `Axial`, or `Near Axial`.
    pub(crate) name: String,
    /// Directions at the left, right, bottom and top.
    pub(crate) letters: [char; 4],
    /// The image axis that the slices lie across.
    pub(crate) axis: usize,
    /// The image axes along u and v, and whether they grow the other way.
    sides: [(usize, bool); 2],
    spacing: [f64; 3],
    within: IndexBox,
}

impl ImageSlices {
    /// Across a world axis.
    pub(crate) fn across(grid: &Grid, world: usize, within: IndexBox) -> Self {
        let affine = grid.affine();
        let axes = affine.nearest_axes();
        let image_axis = |w: usize| axes.iter().position(|&a| a == w).unwrap_or(w);
        let (plane, letters) = PLANES[world];
        let axis = image_axis(world);
        let spacing = grid.spacing().mm();
        // Slices are the image's own: of an oblique one they only come near the body's planes.
        let straight = affine.linear[world][axis].abs() > NEARLY * spacing[axis];
        let sides = [letters[1], letters[3]].map(|letter| {
            let (w, grows_positive) = world_direction(letter);
            let axis = image_axis(w);
            (axis, (affine.linear[w][axis] > 0.0) != grows_positive)
        });
        let name = format!("{}{plane}", if straight { "" } else { "Near " });
        Self { name, letters, axis, sides, spacing, within }
    }

    /// Voxels along u and v.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.sides.map(|(axis, _)| self.within.extent()[axis])
    }

    /// Spacing along u and v, mm.
    pub(crate) fn spacing(&self) -> [f64; 2] {
        self.sides.map(|(axis, _)| self.spacing[axis])
    }

    /// The voxels of a slice, as a box.
    pub(crate) fn region(&self, slice: i64) -> IndexBox {
        let mut region = self.within;
        (region.lower[self.axis], region.upper[self.axis]) = (slice, slice + 1);
        region
    }

    /// The voxel of a slice at places along u and v.
    pub(crate) fn voxel(&self, slice: i64, place: [usize; 2]) -> [i64; 3] {
        let mut voxel = self.region(slice).lower;
        for ((axis, reversed), i) in self.sides.into_iter().zip(place) {
            voxel[axis] = if reversed {
                self.within.upper[axis] - 1 - i as i64
            } else {
                self.within.lower[axis] + i as i64
            };
        }
        voxel
    }

    /// The places of a voxel along u and v.
    pub(crate) fn place(&self, voxel: [i64; 3]) -> [usize; 2] {
        let Self { sides, within, .. } = self;
        sides.map(|(axis, reversed)| {
            let from = if reversed {
                within.upper[axis] - 1 - voxel[axis]
            } else {
                voxel[axis] - within.lower[axis]
            };
            from.max(0) as usize
        })
    }

    /// The voxels of a slice, u fastest.
    pub(crate) fn voxels(&self, slice: i64) -> impl Iterator<Item = [i64; 3]> + '_ {
        let [width, height] = self.size();
        (0..width * height).map(move |n| self.voxel(slice, [n % width, n / width]))
    }
}

/// The world axis that an anatomical letter lies on, and whether at its positive end.
fn world_direction(letter: char) -> (usize, bool) {
    match letter {
        'R' => (0, true),
        'L' => (0, false),
        'A' => (1, true),
        'P' => (1, false),
        'S' => (2, true),
        _ => (2, false),
    }
}
