//! A field that the user brings, closed where its image cuts it.

use super::Embedding;
use crate::tiling::{Block, IndexBox};
use crate::volume::FieldImage;

/// Over how many voxels the rim of a cap is rounded. A crease has no second derivatives: unrounded, chi of a
/// ball that is cut is off by 1.9; rounded so, by 0.03, with V, A and M within 0.5 % (`tests/given_fields.rs`);
/// over three voxels A loses 2 %.
const ROUNDED_VOXELS: f64 = 1.5;

/// A field that goes on beyond its image's edge: it rises there, with the slope it has at its surface, to a
/// constant. What the image cuts is closed by a flat cap on the outer faces of the last voxels, where the cap of
/// a mask lies.
///
/// The constant alone (Besler et al.) would jump over the band, and the cap would be missing in every integral.
#[derive(Debug)]
pub struct ClosedField<'a> {
    field: &'a FieldImage,
    background: f64,
    slope: f64,
}

impl<'a> ClosedField<'a> {
    /// A field with `background`, positive, beyond its edge, to which it rises by `slope` a mm.
    pub fn new(field: &'a FieldImage, background: f64, slope: f64) -> Self {
        Self { field, background, slope }
    }

    /// How far each index of a range lies outside the image along an axis, as a value of the field.
    fn rise(&self, axis: usize, range: std::ops::Range<i64>) -> Vec<f64> {
        let grid = self.field.grid();
        let (last, h) = (grid.dimensions()[axis] as f64 - 1.0, grid.spacing().mm()[axis]);
        let outside = |index: i64| (-0.5 - index as f64).max(index as f64 - last - 0.5);
        range.map(|index| (self.slope * h * outside(index)).min(self.background)).collect()
    }
}

/// The larger of two values, with the crease between them rounded over `width`.
fn rounded_max(a: f64, b: f64, width: f64) -> f64 {
    let near = (width - (a - b).abs()).max(0.0);
    a.max(b) + near * near / (4.0 * width)
}

impl Embedding for ClosedField<'_> {
    type Value = f64;

    fn support(&self, half_width: f64) -> IndexBox {
        let grid = self.field.grid();
        let voxels = |h: f64| (half_width.min(self.background) / (self.slope * h)).ceil() as i64 + 1;
        grid.index_box().grown(grid.spacing().mm().map(voxels))
    }

    fn halo(&self, _half_width: f64) -> [i64; 3] {
        [0; 3]
    }

    fn evaluate_in(&self, storage: Vec<f64>, region: &IndexBox, _half_width: f64) -> Block<f64> {
        let grid = self.field.grid();
        let [nx, ny, nz] = grid.dimensions().map(|n| n as i64);
        let width = ROUNDED_VOXELS * grid.spacing().geometric_mean() * self.slope;
        let rises: [Vec<f64>; 3] =
            std::array::from_fn(|axis| self.rise(axis, region.lower[axis]..region.upper[axis]));
        let mut phi = Block::reusing(storage, *region, 0.0);
        for (y, z) in region.rows() {
            let start = z.clamp(0, nz - 1) * ny + y.clamp(0, ny - 1);
            let beyond = [(1, y), (2, z)].map(|(axis, at)| rises[axis][(at - region.lower[axis]) as usize]);
            let places = (region.lower[0]..region.upper[0]).zip(&rises[0]);
            for (value, (x, &rise)) in phi.row_mut(y, z).iter_mut().zip(places) {
                let inner = self.field.values().get((start * nx + x.clamp(0, nx - 1)) as usize);
                let closed = |phi: f64, rise: f64| rounded_max(phi, rise, width);
                *value = beyond.into_iter().fold(closed(inner, rise), closed);
            }
        }
        phi
    }

    fn constant_on(&self, _region: &IndexBox, _half_width: f64) -> Option<f64> {
        None
    }
}
