//! Voxels that are found by where they are.

use crate::tiling::IndexBox;

/// Voxels in memory order, x fastest, with where each row begins.
#[derive(Debug)]
pub(super) struct VoxelList {
    bounds: IndexBox,
    places: Vec<[i32; 3]>,
    /// One a row of the bounds, and the end.
    rows: Vec<u32>,
}

impl VoxelList {
    /// A list of voxels of a box, which come in memory order.
    pub(super) fn new(bounds: IndexBox, places: Vec<[i32; 3]>) -> Self {
        let [_, ny, nz] = bounds.extent();
        let mut rows = vec![0u32; ny * nz + 1];
        for place in &places {
            rows[row_number(&bounds, i64::from(place[1]), i64::from(place[2])) + 1] += 1;
        }
        for row in 1..rows.len() {
            rows[row] += rows[row - 1];
        }
        Self { bounds, places, rows }
    }

    pub(super) fn bounds(&self) -> IndexBox {
        self.bounds
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    pub(super) fn place(&self, number: usize) -> [i32; 3] {
        self.places[number]
    }

    /// Of a voxel of the image.
    pub(super) fn index(&self, number: usize) -> [usize; 3] {
        self.places[number].map(|v| v as usize)
    }

    /// Numbers of the voxels of a row from x0 up to, not including, x1.
    pub(super) fn in_row(&self, (x0, x1): (i64, i64), y: i64, z: i64) -> std::ops::Range<usize> {
        let row = row_number(&self.bounds, y, z);
        let (first, end) = (self.rows[row] as usize, self.rows[row + 1] as usize);
        // Most rows have none.
        if first == end {
            return first..end;
        }
        let row = &self.places[first..end];
        let before = |x: i64| first + row.partition_point(|place| i64::from(place[0]) < x);
        before(x0)..before(x1)
    }

    /// Visits, in memory order, the voxels of a part of the bounds in the box of a reach around a place:
    /// number, and distance along each axis in voxels.
    pub(super) fn for_each_within(
        &self,
        place: [i32; 3],
        reach: [i64; 3],
        part: &IndexBox,
        mut visit: impl FnMut(usize, [usize; 3]),
    ) {
        let around = IndexBox::voxel(place.map(i64::from)).grown(reach).intersection(part);
        for (y, z) in around.rows() {
            for number in self.in_row((around.lower[0], around.upper[0]), y, z) {
                let other = self.places[number];
                visit(number, std::array::from_fn(|a| other[a].abs_diff(place[a]) as usize));
            }
        }
    }
}

fn row_number(bounds: &IndexBox, y: i64, z: i64) -> usize {
    ((z - bounds.lower[2]) * (bounds.upper[1] - bounds.lower[1]) + y - bounds.lower[1]) as usize
}
