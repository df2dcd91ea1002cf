//! Values at some voxels of a box.

use super::{IndexBox, TILE};

/// Values at the voxels of a box that are marked, tile by tile; memory is a bit a voxel and what the marked ones take.
#[derive(Debug)]
pub struct SparseField {
    /// Number of the first tile along each axis, and how many there are.
    first: [i64; 3],
    tiles_along: [usize; 3],
    tiles: Vec<SparseTile>,
}

/// The marked voxels of a tile, which is not wider than a word has bits.
#[derive(Debug)]
pub struct SparseTile {
    region: IndexBox,
    /// By row, the marked voxels, and where their values begin.
    rows: Vec<(u64, u32)>,
    values: Vec<f32>,
}

const _: () = assert!(TILE[0] == u64::BITS as i64, "a tile's row is a word");

impl SparseField {
    /// Of the tiles of a box, in their order.
    pub fn of_tiles(region: &IndexBox, tiles: Vec<SparseTile>) -> Self {
        let first = std::array::from_fn(|a| region.lower[a].div_euclid(TILE[a]));
        let last = |a: usize| (region.upper[a] - 1).div_euclid(TILE[a]);
        Self { first, tiles_along: std::array::from_fn(|a| (last(a) - first[a] + 1) as usize), tiles }
    }

    /// The value at a marked voxel; infinity elsewhere.
    pub fn get(&self, voxel: [i64; 3]) -> f32 {
        let [x, y, z]: [usize; 3] =
            std::array::from_fn(|a| (voxel[a].div_euclid(TILE[a]) - self.first[a]) as usize);
        let number = (z * self.tiles_along[1] + y) * self.tiles_along[0] + x;
        self.tiles[number].get(voxel)
    }
}

impl SparseTile {
    /// A tile without marked voxels yet.
    pub fn new(region: &IndexBox) -> Self {
        Self { region: *region, rows: Vec::new(), values: Vec::new() }
    }

    /// Adds the next row: a bit for each marked voxel, the first at a multiple of 64 along x, and the values at them.
    pub fn push_row(&mut self, marks: u64, values: impl Iterator<Item = f32>) {
        self.rows.push((marks, self.values.len() as u32));
        self.values.extend(values);
    }

    /// How many are marked.
    pub fn marked(&self) -> usize {
        self.values.len()
    }

    fn get(&self, [x, y, z]: [i64; 3]) -> f32 {
        let rows_a_slice = self.region.extent()[1];
        let row = (z - self.region.lower[2]) as usize * rows_a_slice + (y - self.region.lower[1]) as usize;
        let Some(&(marks, start)) = self.rows.get(row) else { return f32::INFINITY };
        let bit = x.rem_euclid(TILE[0]);
        if marks >> bit & 1 == 0 {
            return f32::INFINITY;
        }
        let before = (marks & ((1 << bit) - 1)).count_ones();
        self.values[(start + before) as usize]
    }
}
