//! A scalar field on a grid: an embedding that the user made.

use super::samples::for_samples;
use super::{Grid, Mask, Samples, Scalar, SlabReader, VolumeError};

/// Largest size of a value: squares and products of derivatives, which are taken in single precision first,
/// must stay finite.
pub(crate) const LARGEST: f64 = 1e30;

/// A field phi on a grid, negative inside.
#[derive(Debug, Clone)]
pub struct FieldImage {
    grid: Grid,
    values: FieldValues,
}

/// Field values in single or double precision, as they came.
#[derive(Debug, Clone)]
#[allow(missing_docs)]
pub enum FieldValues {
    F32(Vec<f32>),
    F64(Vec<f64>),
}

impl FieldImage {
    /// Takes a field's values, x fastest.
    ///
    /// # Errors
    /// [`VolumeError`] where the number of values is not the grid's, or a value is not finite or beyond 1e30.
    pub fn new(grid: Grid, values: FieldValues) -> Result<Self, VolumeError> {
        let (found, expected) = (values.len(), grid.voxel_count());
        if found != expected {
            return Err(VolumeError::Incomplete { found, expected });
        }
        for i in 0..found {
            let (index, value) = (grid.index_of(i), values.get(i));
            if !value.is_finite() {
                return Err(VolumeError::NotFinite { index, value });
            }
            if value.abs() > LARGEST {
                return Err(VolumeError::HugeValue { index, value });
            }
        }
        Ok(Self { grid, values })
    }

    /// Reads a field from its slabs; double precision is kept, everything else becomes f32.
    ///
    /// # Errors
    /// The source's own, and those of [`FieldImage::new`].
    pub fn from_slabs<R: SlabReader>(reader: &mut R) -> Result<Self, R::Error> {
        let values = FieldValues::from_slabs(reader)?;
        Ok(Self::new(*reader.grid(), values)?)
    }

    /// The field's lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Values, x fastest.
    pub fn values(&self) -> &FieldValues {
        &self.values
    }

    /// The lattice and the values.
    pub(crate) fn into_parts(self) -> (Grid, FieldValues) {
        (self.grid, self.values)
    }

    /// The voxels with phi < 0.
    pub fn inside(&self) -> Mask {
        let [nx, ny, _] = self.grid.dimensions();
        Mask::from_predicate(self.grid, |[x, y, z]| self.values.get((z * ny + y) * nx + x) < 0.0)
    }
}

impl FieldValues {
    /// Reads values, whatever they are; double precision is kept, everything else becomes f32.
    pub(crate) fn from_slabs<R: SlabReader>(reader: &mut R) -> Result<Self, R::Error> {
        let grid = *reader.grid();
        let too_large = |_| VolumeError::TooLarge { dimensions: grid.dimensions() };
        let mut values = FieldValues::F32(Vec::new());
        while let Some(slab) = reader.next_slab()? {
            match (&mut values, &slab.samples) {
                (FieldValues::F64(all), samples) => {
                    for_samples!(samples, v => all.extend(v.iter().map(|v| v.to_f64())));
                }
                (FieldValues::F32(all), Samples::F64(v)) if all.is_empty() => {
                    let mut doubles = Vec::new();
                    doubles.try_reserve_exact(grid.voxel_count()).map_err(too_large)?;
                    doubles.extend_from_slice(v);
                    values = FieldValues::F64(doubles);
                }
                (FieldValues::F32(all), samples) => {
                    all.try_reserve_exact(grid.voxel_count().saturating_sub(all.len())).map_err(too_large)?;
                    for_samples!(samples, v => all.extend(v.iter().map(|v| v.to_f64() as f32)));
                }
            }
        }
        Ok(values)
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The largest value.
    pub(crate) fn highest(&self) -> f64 {
        (0..self.len()).map(|offset| self.get(offset)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The n-th value in memory.
    pub fn get(&self, offset: usize) -> f64 {
        match self {
            Self::F32(v) => f64::from(v[offset]),
            Self::F64(v) => v[offset],
        }
    }
}
