//! Voxels that can change sides without a change of topology.

use crate::volume::Mask;

/// The bit of the middle voxel among the 27 around it, x fastest.
const MIDDLE: usize = 13;

/// By voxel of the 27, those of the 27 that share a face, an edge or a corner with it.
const TOUCHING: [u32; 27] = neighbours(3);
/// By voxel of the 27, those that share a face with it.
const BESIDE: [u32; 27] = neighbours(1);
/// The middle's neighbours by a face or an edge.
const EIGHTEEN: u32 = around_middle(2);
/// The middle's neighbours by a face.
const SIX: u32 = BESIDE[MIDDLE];

/// By voxel of the 27, the others that are at most one step along each axis and `most` steps in all away.
const fn neighbours(most: usize) -> [u32; 27] {
    let mut table = [0; 27];
    let mut a = 0usize;
    while a < 27 {
        let mut b = 0usize;
        while b < 27 {
            let steps = [(a % 3).abs_diff(b % 3), (a / 3 % 3).abs_diff(b / 3 % 3), (a / 9).abs_diff(b / 9)];
            let near = steps[0] < 2 && steps[1] < 2 && steps[2] < 2;
            if a != b && near && steps[0] + steps[1] + steps[2] <= most {
                table[a] |= 1 << b;
            }
            b += 1;
        }
        a += 1;
    }
    table
}

const fn around_middle(most: usize) -> u32 {
    neighbours(most)[MIDDLE]
}

/// Whether putting a voxel on the other side changes neither the object (26-connected) nor its background (6-connected) topologically:
/// it has exactly one component of the object around it, and exactly one of the background beside it.
///
/// # References
/// Bertrand and Malandain 1994, "A new characterization of three-dimensional simple points".
pub(super) fn is_simple(mask: &Mask, [x, y, z]: [i64; 3]) -> bool {
    let mut inside = 0u32;
    for bit in 0..27i64 {
        let voxel = [x + bit % 3 - 1, y + bit / 3 % 3 - 1, z + bit / 9 - 1];
        inside |= u32::from(mask.get(voxel)) << bit;
    }
    inside &= !(1 << MIDDLE);
    let outside = !inside & EIGHTEEN;
    let beside = outside & SIX;
    inside != 0
        && beside != 0
        && reached(inside, inside & inside.wrapping_neg(), &TOUCHING) == inside
        && beside & !reached(outside, beside & beside.wrapping_neg(), &BESIDE) == 0
}

/// The voxels of a set that are connected to one of its own.
fn reached(set: u32, start: u32, neighbours: &[u32; 27]) -> u32 {
    let (mut known, mut new) = (start, start);
    while new != 0 {
        let voxel = new.trailing_zeros() as usize;
        new &= new - 1;
        let more = neighbours[voxel] & set & !known;
        known |= more;
        new |= more;
    }
    known
}
