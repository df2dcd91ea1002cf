//! Voxels that can change sides without a change of topology.

/// Of the 27 voxels around one, x fastest, a bit each: those of the first and of the last along x, y, z.
const FIRST: [u32; 3] = [0o111_111_111, 0o007_007_007, 0o000_000_777];
const LAST: [u32; 3] = [FIRST[0] << 2, FIRST[1] << 6, FIRST[2] << 18];
/// Bits from a voxel to the next along x, y, z.
const STEP: [u32; 3] = [1, 3, 9];
/// The middle.
const MIDDLE: u32 = 1 << 13;
/// The middle's neighbours by a face.
const SIX: u32 = 1 << 12 | 1 << 14 | 1 << 10 | 1 << 16 | 1 << 4 | 1 << 22;
/// The corners.
const CORNERS: u32 = (FIRST[0] | LAST[0]) & (FIRST[1] | LAST[1]) & (FIRST[2] | LAST[2]);
/// The middle's neighbours by a face or an edge.
const EIGHTEEN: u32 = 0o777_777_777 & !CORNERS & !MIDDLE;

/// Whether putting a voxel on the other side changes neither the object (26-connected) nor its background
/// (6-connected) topologically: it has exactly one component of the object around it, and exactly one of the
/// background beside it. A bit a voxel of the 27 around it, x fastest, says which are of the object.
///
/// # References
/// Bertrand and Malandain 1994, "A new characterization of three-dimensional simple points".
pub(super) fn is_simple(around: u32) -> bool {
    let inside = around & !MIDDLE;
    let outside = !around & EIGHTEEN;
    let beside = outside & SIX;
    inside != 0
        && beside != 0
        && beside & !reached(outside, lowest(beside), beside, face_neighbours) == 0
        && reached(inside, lowest(inside), inside, all_neighbours) == inside
}

fn lowest(set: u32) -> u32 {
    set & set.wrapping_neg()
}

/// The voxels of a set that are connected to one of its own, as many as it takes to have all that are wanted.
fn reached(set: u32, start: u32, wanted: u32, with_neighbours: impl Fn(u32) -> u32) -> u32 {
    let mut known = start;
    loop {
        let more = with_neighbours(known) & set;
        if more == known || wanted & !more == 0 {
            return more;
        }
        known = more;
    }
}

/// Voxels and those one step along an axis from them.
fn beside(set: u32, axis: usize) -> u32 {
    set | (set & !LAST[axis]) << STEP[axis] | (set & !FIRST[axis]) >> STEP[axis]
}

fn face_neighbours(set: u32) -> u32 {
    beside(set, 0) | beside(set, 1) | beside(set, 2)
}

fn all_neighbours(set: u32) -> u32 {
    beside(beside(beside(set, 0), 1), 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Components of some of the 27 that are neighbours up to so many steps along axes: slow and plain.
    fn components(set: u32, steps: usize) -> Vec<u32> {
        let place = |bit: usize| [bit % 3, bit / 3 % 3, bit / 9];
        let near = |a: usize, b: usize| {
            let apart: [usize; 3] = std::array::from_fn(|axis| place(a)[axis].abs_diff(place(b)[axis]));
            apart.iter().all(|&d| d < 2) && apart.iter().sum::<usize>() <= steps
        };
        let mut components: Vec<u32> = Vec::new();
        for bit in (0..27).filter(|bit| set >> bit & 1 == 1) {
            let touches =
                |component: &u32| (0..27).any(|other| component >> other & 1 == 1 && near(bit, other));
            let (touching, others): (Vec<u32>, Vec<u32>) = components.iter().partition(|c| touches(c));
            components = others;
            components.push(touching.iter().fold(1 << bit, |all, component| all | component));
        }
        components
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn agrees_with_counting_components(a in any::<u32>(), b in any::<u32>(), few in any::<bool>()) {
            let around = (if few { a & b } else { a | b }) & 0o777_777_777;
            let near = |steps: usize, bit: usize| {
                let apart: usize = [bit % 3, bit / 3 % 3, bit / 9].map(|v| v.abs_diff(1)).iter().sum();
                (1..=steps).contains(&apart)
            };
            let shell = |steps| (0..27).filter(|&bit| near(steps, bit)).fold(0u32, |set, bit| set | 1 << bit);
            let object = components(around & shell(3), 3).len();
            let background = components(!around & shell(2), 1);
            let beside = background.iter().filter(|&&component| component & shell(1) != 0).count();
            prop_assert_eq!(is_simple(around), object == 1 && beside == 1);
        }
    }
}
