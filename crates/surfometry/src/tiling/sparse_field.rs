//! Values at some voxels of a box.

use super::{IndexBox, TILE};

/// Values at the voxels of a box that are marked, tile by tile; memory is a bit a voxel and what the marked
/// ones take.
#[derive(Debug)]
pub struct SparseField {
    region: IndexBox,
    /// Number of the first tile along each axis, and how many there are along x and y.
    first: [i64; 3],
    tiles_along: [usize; 2],
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
        let tiles_along = [0, 1].map(|a| (last(a) - first[a] + 1) as usize);
        Self { region: *region, first, tiles_along, tiles }
    }

    /// The value at a marked voxel; infinity elsewhere.
    pub fn get(&self, voxel: [i64; 3]) -> f32 {
        if !self.region.contains(voxel) {
            return f32::INFINITY;
        }
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

    /// Adds the next row: a bit for each marked voxel, the first at a multiple of 64 along x, and the values
    /// at them.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marked_voxels_have_their_values() {
        let region = IndexBox::new([-70, 3, 120], [75, 70, 140]);
        let marked = |[x, y, z]: [i64; 3]| (x + 2 * y + 5 * z).rem_euclid(7) < 3;
        let value = |[x, y, z]: [i64; 3]| (x + 1000 * y + 100_000 * z) as f32;
        let tile = |tile: IndexBox| {
            let mut values = SparseTile::new(&tile);
            for (y, z) in tile.rows() {
                let row: Vec<i64> = (tile.lower[0]..tile.upper[0]).filter(|&x| marked([x, y, z])).collect();
                let marks = row.iter().fold(0, |bits, x| bits | 1 << x.rem_euclid(TILE[0]));
                values.push_row(marks, row.into_iter().map(|x| value([x, y, z])));
            }
            values
        };
        let field = SparseField::of_tiles(&region, region.tiles(TILE).into_iter().map(tile).collect());
        let around = region.grown([2; 3]);
        for (y, z) in around.rows() {
            for x in around.lower[0]..around.upper[0] {
                let expected = if region.contains([x, y, z]) && marked([x, y, z]) {
                    value([x, y, z])
                } else {
                    f32::INFINITY
                };
                assert_eq!(field.get([x, y, z]), expected);
            }
        }
    }
}
