//! Bits with amounts beside them.

use super::{Indicator, Row};
use crate::tiling::IndexBox;
use crate::volume::{Grid, Mask, Shared};
use std::sync::Arc;

/// A mask and, at some of its voxels, how far the indicator is off the bit there.
///
/// So little is held of an image that is 0 or 1 at most voxels: its bits, and sixteen bytes more for each of
/// the others.
#[derive(Debug, Clone)]
pub struct CorrectedMask {
    mask: Arc<Mask>,
    bounds: IndexBox,
    /// In order of z, y, x; one a voxel.
    corrections: Vec<Correction>,
    /// Number of the first at or above each slice of the bounds, and the end: most rows have none.
    slices: Vec<usize>,
}

/// A voxel and what is added to its bit.
type Correction = ([i32; 3], f32);

/// Memory order.
fn key(&([x, y, z], _): &Correction) -> [i32; 3] {
    [z, y, x]
}

impl CorrectedMask {
    /// A mask with what is added to its bits, in any order; amounts at the same voxel are added up.
    ///
    /// # Panics
    /// For a voxel outside the grid.
    pub fn new(mask: impl Shared<Mask>, corrections: impl IntoIterator<Item = ([usize; 3], f32)>) -> Self {
        let mask = mask.shared();
        let image = mask.grid().index_box();
        let placed = |(index, amount): ([usize; 3], f32)| {
            assert!(image.contains(index.map(|v| v as i64)), "voxel {index:?} lies outside the grid");
            (index.map(|v| v as i32), amount)
        };
        let mut corrections: Vec<Correction> = corrections.into_iter().map(placed).collect();
        corrections.sort_by_key(key);
        corrections.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            kept.1 += if same { next.1 } else { 0.0 };
            same
        });
        corrections.retain(|(_, amount)| *amount != 0.0);
        let voxels = corrections.iter().map(|(index, _)| IndexBox::voxel(index.map(i64::from)));
        let bounds = voxels.fold(mask.bounds(), |hull, voxel| hull.hull(&voxel));
        let before = |z: i64| corrections.partition_point(|(index, _)| i64::from(index[2]) < z);
        let slices = (bounds.lower[2]..=bounds.upper[2]).map(before).collect();
        Self { mask, bounds, corrections, slices }
    }

    /// The bits.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// The corrections of a row from x0 up to, not including, x1.
    fn in_row(&self, (x0, x1): (i64, i64), y: i64, z: i64) -> &[Correction] {
        if !(self.bounds.lower[2]..self.bounds.upper[2]).contains(&z) {
            return &[];
        }
        let number = (z - self.bounds.lower[2]) as usize;
        let slice = &self.corrections[self.slices[number]..self.slices[number + 1]];
        let before = |x: i64| {
            slice.partition_point(|&([at_x, at_y, _], _)| (i64::from(at_y), i64::from(at_x)) < (y, x))
        };
        let (from, to) = (before(x0), before(x1));
        &slice[from..to.max(from)]
    }
}

impl Indicator for CorrectedMask {
    fn grid(&self) -> &Grid {
        self.mask.grid()
    }

    fn bounds(&self) -> IndexBox {
        self.bounds
    }

    fn uniform_in(&self, region: &IndexBox) -> Option<bool> {
        let bit = self.mask.uniform_in(region)?;
        let near = region.intersection(&self.bounds);
        let none_in = |(y, z)| self.in_row((near.lower[0], near.upper[0]), y, z).is_empty();
        near.rows().all(none_in).then_some(bit)
    }

    fn read_row(&self, y: i64, z: i64, row: &mut Row) {
        self.mask.read_row(y, z, row);
        let (start, end) = row.span();
        for &([x, ..], amount) in self.in_row((start, end), y, z) {
            row.add_amount(i64::from(x), amount);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embedding::{Embedding, GaussianEmbedding, TRUNCATION};
    use crate::local_geometry::{Differentiation, GaussianDerivatives, MatchedDifferences};
    use crate::volume::ProbabilityImage;

    /// Half of a tilted slab's boundary voxels corrected, and the same as an image of floats.
    fn both() -> (CorrectedMask, ProbabilityImage) {
        let grid = Grid::axis_aligned([50, 40, 30], [1.0, 0.8, 1.3]).unwrap();
        let height = |[x, y, z]: [usize; 3]| 0.31 * x as f64 + 0.2 * y as f64 + z as f64 - 20.0;
        let mask = Mask::from_predicate(grid, |index| height(index) < 0.0);
        let mut corrections = Vec::new();
        let mut values = Vec::new();
        for number in 0..grid.voxel_count() {
            let index = grid.index_of(number);
            let bit = f32::from(u8::from(mask.get(index.map(|v| v as i64))));
            let exact = (0.5 - height(index)).clamp(0.0, 1.0) as f32;
            let wanted = if number % 2 == 0 { exact } else { bit };
            values.push(wanted);
            // In two parts, and from the last to the first.
            corrections.insert(0, (index, 0.25 * (wanted - bit)));
            corrections.insert(0, (index, 0.75 * (wanted - bit)));
        }
        (CorrectedMask::new(mask, corrections), ProbabilityImage::new(grid, values).unwrap())
    }

    /// The sum of the bits' row and of the corrections' taps is the convolution of the image that they make.
    #[test]
    fn is_blurred_as_the_dense_image() {
        let (sparse, dense) = both();
        let region = IndexBox::new([-9, -9, -9], [60, 50, 40]);
        for sigma in [1.1, 2.6] {
            let field = |indicator: &dyn Indicator| {
                GaussianEmbedding::new(indicator, sigma, 0.5, TRUNCATION).evaluate(&region, 0.5)
            };
            let (a, b) = (field(&sparse), field(&dense));
            let bits = field(sparse.mask());
            let apart =
                |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(apart(a.values(), b.values()) < 3e-7, "{}", apart(a.values(), b.values()));
            assert!(apart(a.values(), bits.values()) > 1e-3);
        }
    }

    /// Derivatives at voxels and at points too.
    #[test]
    fn is_differentiated_as_the_dense_image() {
        let (sparse, dense) = both();
        let points = [[20.0, 14.0, 11.0], [21.3, 15.0, 10.4], [30.7, 20.2, 6.9]];
        let numbers = |indicator: &dyn Indicator| {
            let embedding = || GaussianEmbedding::new(indicator, 2.4, 0.5, TRUNCATION);
            let tile = IndexBox::new([16, 8, 4], [32, 24, 12]);
            let convolved = GaussianDerivatives::new(embedding());
            let in_band = convolved.band(&tile, 0.2).into_iter().map(|voxel| voxel.jet);
            let at_points = convolved.jets(&points).into_iter();
            let between = MatchedDifferences::new(embedding()).jets(&points);
            let jets = in_band.chain(at_points).chain(between);
            jets.flat_map(|j| [vec![j.value], j.gradient.to_vec(), j.hessian.to_vec()].concat()).collect()
        };
        let (a, b): (Vec<f64>, Vec<f64>) = (numbers(&sparse), numbers(&dense));
        assert!(a.len() > 1000 && a.len() == b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 2e-6), "{a:?} {b:?}");
    }

    #[test]
    fn uniform_where_neither_bits_nor_corrections_change() {
        let grid = Grid::axis_aligned([20; 3], [1.0; 3]).unwrap();
        let mask = || Mask::from_predicate(grid, |[x, ..]| x < 10);
        let corrected =
            CorrectedMask::new(mask(), [([15, 10, 10], 0.5), ([3, 4, 5], -0.25), ([4, 4, 4], 0.0)]);
        let (ones, zeros) = (IndexBox::new([0; 3], [10, 20, 20]), IndexBox::new([10, 0, 0], [30, 20, 20]));
        assert_eq!((mask().uniform_in(&ones), mask().uniform_in(&zeros)), (Some(true), Some(false)));
        assert_eq!((corrected.uniform_in(&ones), corrected.uniform_in(&zeros)), (None, None));
        assert_eq!(corrected.uniform_in(&IndexBox::new([4, 0, 0], [10, 20, 20])), Some(true));
        assert_eq!(corrected.uniform_in(&IndexBox::new([0, 5, 0], [10, 20, 20])), Some(true));
        assert_eq!(corrected.uniform_in(&IndexBox::new([16, 0, 0], [30, 20, 20])), Some(false));
        assert_eq!(corrected.uniform_in(&IndexBox::new([10, 0, 11], [30, 20, 20])), Some(false));
        assert_eq!(corrected.bounds(), IndexBox::new([0; 3], [16, 20, 20]));
    }
}
