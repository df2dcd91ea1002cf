//! A field that the user brings.

use super::Embedding;
use crate::tiling::{Block, IndexBox};
use crate::volume::{FieldImage, FieldValues};

/// The field itself; it ends at the image's edge.
impl Embedding for &FieldImage {
    type Value = f64;

    fn support(&self, _half_width: f64) -> IndexBox {
        self.grid().index_box()
    }

    fn halo(&self, _half_width: f64) -> [i64; 3] {
        [0; 3]
    }

    fn available(&self, region: &IndexBox) -> IndexBox {
        region.intersection(&self.grid().index_box())
    }

    fn evaluate_in(&self, storage: Vec<f64>, region: &IndexBox, _half_width: f64) -> Block<f64> {
        let [nx, ny, _] = self.grid().dimensions();
        let mut phi = Block::reusing(storage, *region, 0.0);
        for (y, z) in region.rows() {
            let start = (z as usize * ny + y as usize) * nx + region.lower[0] as usize;
            let row = phi.row_mut(y, z);
            match self.values() {
                FieldValues::F32(v) => row.iter_mut().zip(&v[start..]).for_each(|(p, &v)| *p = f64::from(v)),
                FieldValues::F64(v) => row.iter_mut().zip(&v[start..]).for_each(|(p, &v)| *p = v),
            }
        }
        phi
    }

    fn constant_on(&self, _region: &IndexBox, _half_width: f64) -> Option<f64> {
        None
    }
}
