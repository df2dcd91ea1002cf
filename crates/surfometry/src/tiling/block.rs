//! Values on an index box.

use super::IndexBox;

/// One value at every voxel of a box, x fastest.
#[derive(Debug, Clone)]
pub struct Block<T> {
    region: IndexBox,
    values: Vec<T>,
}

impl<T: Copy> Block<T> {
    /// A block of one value.
    pub fn filled(region: IndexBox, value: T) -> Self {
        Self { region, values: vec![value; region.voxels()] }
    }

    /// A block in memory that was used before, with whatever values that holds and `value` beyond them: all
    /// are to be written.
    pub fn reusing(mut storage: Vec<T>, region: IndexBox, value: T) -> Self {
        storage.resize(region.voxels(), value);
        Self { region, values: storage }
    }

    /// Its memory, to be used again.
    pub fn into_storage(self) -> Vec<T> {
        self.values
    }

    /// Its box.
    pub fn region(&self) -> IndexBox {
        self.region
    }

    /// All values, x fastest.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Position of an index in [`Block::values`].
    pub fn offset(&self, index: [i64; 3]) -> usize {
        let [nx, ny, _] = self.region.extent();
        let [x, y, z]: [usize; 3] = std::array::from_fn(|a| (index[a] - self.region.lower[a]) as usize);
        (z * ny + y) * nx + x
    }

    /// Value at an index of the box.
    pub fn get(&self, index: [i64; 3]) -> T {
        self.values[self.offset(index)]
    }

    /// The row of values at y, z.
    pub fn row(&self, y: i64, z: i64) -> &[T] {
        let start = self.offset([self.region.lower[0], y, z]);
        &self.values[start..][..self.region.extent()[0]]
    }

    /// The row of values at y, z, to be written.
    pub fn row_mut(&mut self, y: i64, z: i64) -> &mut [T] {
        let start = self.offset([self.region.lower[0], y, z]);
        let length = self.region.extent()[0];
        &mut self.values[start..][..length]
    }

    /// All values, to be written, x fastest.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }
}
