//! A soft segmentation: for each voxel, how much of it belongs to the object.

use super::samples::for_samples;
use super::{Grid, Mask, Scalar, SlabReader, VolumeError};
use crate::tiling::IndexBox;

/// A soft segmentation of one object: a value from 0 to 1 at each voxel, the share of it that the object
/// fills or the probability that it belongs to the object. Beyond the image it is 0.
///
/// Values are held in single precision, of the bounding box of those that are not 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbabilityImage {
    grid: Grid,
    bounds: IndexBox,
    values: Vec<f32>,
}

/// How far beyond 0 and 1 a value may be: arithmetic in single precision leaves as much.
pub(crate) const TOLERANCE: f64 = 1e-6;

impl ProbabilityImage {
    /// Takes values, x fastest. Those beyond 0 or 1 by no more than rounding leaves are taken for 0 and 1.
    ///
    /// # Errors
    /// [`VolumeError`] where the number of values is not the grid's, or a value is not finite or does not lie
    /// between 0 and 1.
    pub fn new(grid: Grid, mut values: Vec<f32>) -> Result<Self, VolumeError> {
        for (offset, value) in values.iter_mut().enumerate() {
            *value = checked(&grid, offset, f64::from(*value))?;
        }
        Self::of_checked(grid, values)
    }

    /// Reads an image of any type from its slabs.
    ///
    /// # Errors
    /// The source's own, and those of [`ProbabilityImage::new`].
    pub fn from_slabs<R: SlabReader>(reader: &mut R) -> Result<Self, R::Error> {
        let grid = *reader.grid();
        let too_large = |_| VolumeError::TooLarge { dimensions: grid.dimensions() };
        let mut values: Vec<f32> = Vec::new();
        while let Some(slab) = reader.next_slab()? {
            values.try_reserve_exact(grid.voxel_count().saturating_sub(values.len())).map_err(too_large)?;
            for_samples!(&slab.samples, samples => {
                for value in samples {
                    values.push(checked(&grid, values.len(), value.to_f64())?);
                }
            });
        }
        Ok(Self::of_checked(grid, values)?)
    }

    fn of_checked(grid: Grid, values: Vec<f32>) -> Result<Self, VolumeError> {
        let (found, expected) = (values.len(), grid.voxel_count());
        if found != expected {
            return Err(VolumeError::Incomplete { found, expected });
        }
        let whole = Self { grid, bounds: grid.index_box(), values };
        let occupied = |row: &[f32]| {
            let first = row.iter().position(|&v| v != 0.0)?;
            let last = row.iter().rposition(|&v| v != 0.0)?;
            Some((first as i64, last as i64 + 1))
        };
        let rows = whole.bounds.rows().filter_map(|(y, z)| {
            let (start, end) = occupied(whole.row(y, z))?;
            Some(IndexBox::new([start, y, z], [end, y + 1, z + 1]))
        });
        let bounds = rows.fold(IndexBox::EMPTY, |hull, row| hull.hull(&row));
        if bounds == whole.bounds {
            return Ok(whole);
        }
        let (first, width) = (bounds.lower[0] as usize, bounds.extent()[0]);
        let cropped = bounds.rows().flat_map(|(y, z)| &whole.row(y, z)[first..][..width]).copied().collect();
        Ok(Self { grid, bounds, values: cropped })
    }

    /// The image's lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Box outside which all values are 0, in image indices.
    pub fn bounds(&self) -> IndexBox {
        self.bounds
    }

    /// The largest value.
    pub fn highest(&self) -> f64 {
        self.values.iter().fold(0.0, |highest: f64, &v| highest.max(f64::from(v)))
    }

    /// The voxels whose values exceed a level: those where phi, the level less the value, is negative.
    pub fn above(&self, level: f64) -> Mask {
        let mut mask = Mask::cleared(self.grid, self.bounds);
        let mut bounds = IndexBox::EMPTY;
        for (y, z) in self.bounds.rows() {
            for (x, &value) in (self.bounds.lower[0]..).zip(self.row(y, z)) {
                if f64::from(value) > level {
                    mask.set([x, y, z], true);
                    bounds = bounds.hull(&IndexBox::voxel([x, y, z]));
                }
            }
        }
        mask.on_bounds(bounds)
    }

    /// The sum over the voxels of a function of their values that is 0 at 0.
    pub(crate) fn sum(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.values.iter().map(|&value| of(f64::from(value))).sum()
    }

    /// Values of the row at y, z of the bounds, from their lower x on; empty outside.
    pub(crate) fn row(&self, y: i64, z: i64) -> &[f32] {
        let IndexBox { lower: [_, y0, z0], upper: [_, y1, z1] } = self.bounds;
        if y < y0 || y >= y1 || z < z0 || z >= z1 {
            return &[];
        }
        let width = self.bounds.extent()[0];
        &self.values[((z - z0) * (y1 - y0) + (y - y0)) as usize * width..][..width]
    }
}

/// A value as it is held.
fn checked(grid: &Grid, offset: usize, value: f64) -> Result<f32, VolumeError> {
    if (-TOLERANCE..=1.0 + TOLERANCE).contains(&value) {
        return Ok(value.clamp(0.0, 1.0) as f32);
    }
    let (found, expected) = (offset + 1, grid.voxel_count());
    if found > expected {
        return Err(VolumeError::Incomplete { found, expected });
    }
    Err(VolumeError::NotAProbability { index: grid.index_of(offset), value })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::axis_aligned([4, 3, 2], [1.0; 3]).unwrap()
    }

    #[test]
    fn is_cropped_to_what_is_not_zero() {
        let mut values = vec![0.0; 24];
        (values[5], values[18], values[19]) = (0.75, 1.0, 0.25);
        let image = ProbabilityImage::new(grid(), values).unwrap();
        assert_eq!(image.bounds(), IndexBox::new([1, 1, 0], [4, 2, 2]));
        assert_eq!(image.row(1, 0), [0.75, 0.0, 0.0]);
        assert_eq!(image.row(1, 1), [0.0, 1.0, 0.25]);
        assert!(image.row(0, 0).is_empty());
        assert_eq!((image.highest(), image.sum(|p| p)), (1.0, 2.0));
        let mask = image.above(0.25);
        assert_eq!((mask.voxels(), mask.bounds()), (2, IndexBox::new([1, 1, 0], [3, 2, 2])));
        let nothing = ProbabilityImage::new(grid(), vec![0.0; 24]).unwrap();
        assert!(nothing.bounds().is_empty() && nothing.above(0.5).is_empty());
    }

    #[test]
    fn what_is_no_probability_is_refused_with_its_place() {
        let with = |value: f32| {
            let mut values = vec![0.5; 24];
            values[17] = value;
            ProbabilityImage::new(grid(), values)
        };
        for value in [f32::NAN, f32::INFINITY, -0.25, 1.0625, 255.0] {
            let message = with(value).unwrap_err().to_string();
            assert!(message.contains("[1, 1, 1]") && message.contains(&value.to_string()), "{message}");
        }
        // What rounding leaves is taken for what it was.
        assert_eq!(with(1.0 + 5e-7).unwrap().highest(), 1.0);
        assert_eq!(with(-5e-7).unwrap().row(1, 1)[1], 0.0);
        let short = ProbabilityImage::new(grid(), vec![0.5; 23]);
        assert!(matches!(short, Err(VolumeError::Incomplete { found: 23, expected: 24 })));
    }
}
