//! How one voxel changes the Euler number of a solid.

/// The 26 cells around the middle of 3 x 3 x 3 voxels by which it meets others, as the voxels that meet
/// there: its faces, edges, corners. A cell has the sign of its dimension in the Euler number.
const CELLS: [(u32, i64); 26] = cells();

const fn cells() -> [(u32, i64); 26] {
    let mut cells = [(0, 0); 26];
    let mut number = 0;
    let mut direction = 0;
    while direction < 27 {
        if direction != 13 {
            cells[number] = cell(direction);
            number += 1;
        }
        direction += 1;
    }
    cells
}

/// The cell towards a neighbour: at the middle or one step in its direction, along each axis, lie the voxels
/// that share it.
const fn cell(direction: usize) -> (u32, i64) {
    let to = [direction % 3, direction / 3 % 3, direction / 9];
    let mut voxels = 0;
    let mut voxel = 0;
    while voxel < 27 {
        let at = [voxel % 3, voxel / 3 % 3, voxel / 9];
        let shares = (at[0] == 1 || at[0] == to[0])
            && (at[1] == 1 || at[1] == to[1])
            && (at[2] == 1 || at[2] == to[2]);
        if shares && voxel != 13 {
            voxels |= 1 << voxel;
        }
        voxel += 1;
    }
    let steps = to[0].abs_diff(1) + to[1].abs_diff(1) + to[2].abs_diff(1);
    // Faces count for, edges against, corners for, the voxel itself against.
    (voxels, if steps == 2 { -1 } else { 1 })
}

/// By how much the Euler number of the solid (26-connected: closed voxels) grows where a voxel is added to
/// those around it, a bit each, x fastest.
pub(super) fn euler_growth(around: u32) -> i64 {
    // A cell is new where none of the voxels that share it is there.
    CELLS.iter().filter(|(voxels, _)| around & voxels == 0).map(|(_, sign)| sign).sum::<i64>() - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::euler::EulerNumbers;
    use crate::volume::{Grid, Mask};
    use proptest::prelude::*;

    proptest! {
        /// The Euler numbers of 3 x 3 x 3 voxels with the middle and without.
        #[test]
        fn agrees_with_counting_twice(around in 0..1u32 << 27) {
            let euler = |bits: u32| {
                let grid = Grid::axis_aligned([3; 3], [1.0; 3]).unwrap();
                let mask = Mask::from_predicate(grid, |[x, y, z]| bits >> (9 * z + 3 * y + x) & 1 == 1);
                let mut numbers = EulerNumbers::default();
                numbers.add(&mask, &grid.index_box().grown([1; 3]));
                numbers.foreground_26
            };
            let middle = 1 << 13;
            let growth = euler(around | middle) - euler(around & !middle);
            prop_assert_eq!(euler_growth(around & !middle), growth);
        }
    }
}
