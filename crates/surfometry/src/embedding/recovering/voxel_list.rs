//! Voxels that are found by where they are.

use crate::tiling::IndexBox;

/// Edge of a brick, in voxels: some two of the neighbourhoods that are looked through.
const EDGE: i64 = 8;

/// Voxels in the order of the bricks of 8 x 8 x 8 that they lie in, and in memory order, x fastest, within each; with where
/// each brick begins. What lies around a voxel then stands together.
#[derive(Debug)]
pub(super) struct VoxelList {
    bricks: Bricks,
    places: Vec<[i32; 3]>,
    /// Number of the first of each brick, and the end.
    firsts: Vec<u32>,
}

impl VoxelList {
    /// A list of voxels of a box, in any order.
    pub(super) fn new(bounds: IndexBox, mut places: Vec<[i32; 3]>) -> Self {
        let bricks = Bricks::new(bounds);
        let brick = |place: &[i32; 3]| bricks.number(bricks.at(place.map(i64::from)));
        places.sort_unstable_by_key(|place| (brick(place), [place[2], place[1], place[0]]));
        let mut firsts = vec![0u32; bricks.count() + 1];
        for place in &places {
            firsts[brick(place) + 1] += 1;
        }
        for number in 1..firsts.len() {
            firsts[number] += firsts[number - 1];
        }
        Self { bricks, places, firsts }
    }

    pub(super) fn bounds(&self) -> IndexBox {
        self.bricks.bounds
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

    /// Numbers of the voxels of a box, ascending.
    pub(super) fn within(&self, part: &IndexBox) -> impl Iterator<Item = usize> + '_ {
        let part = part.intersection(&self.bounds());
        let bricks = self.bricks.of(&part);
        let first_of = |brick| self.firsts[self.bricks.number(brick)];
        // Bricks along x stand behind each other.
        let along_x = move |(y, z)| {
            first_of([bricks.lower[0], y, z])
                ..self.firsts[self.bricks.number([bricks.upper[0] - 1, y, z]) + 1]
        };
        let numbers = bricks.rows().flat_map(along_x).map(|number| number as usize);
        numbers.filter(move |&number| part.contains(self.places[number].map(i64::from)))
    }

    /// Visits, ascending, the voxels in the box of a reach around a place: number, and distance along each axis in voxels.
    pub(super) fn for_each_within(
        &self,
        place: [i32; 3],
        reach: [i64; 3],
        mut visit: impl FnMut(usize, [usize; 3]),
    ) {
        for number in self.within(&IndexBox::voxel(place.map(i64::from)).grown(reach)) {
            let other = self.places[number];
            visit(number, std::array::from_fn(|a| other[a].abs_diff(place[a]) as usize));
        }
    }
}

/// The bricks of 8 x 8 x 8 voxels of a box.
#[derive(Debug, Clone, Copy)]
struct Bricks {
    bounds: IndexBox,
    counts: [usize; 3],
}

impl Bricks {
    fn new(bounds: IndexBox) -> Self {
        Self { bounds, counts: bounds.extent().map(|voxels| voxels.div_ceil(EDGE as usize)) }
    }

    fn count(&self) -> usize {
        self.counts.iter().product()
    }

    /// The brick that a voxel of the box lies in.
    fn at(&self, place: [i64; 3]) -> [i64; 3] {
        std::array::from_fn(|a| (place[a] - self.bounds.lower[a]) / EDGE)
    }

    /// Those that a part of the box lies in.
    fn of(&self, part: &IndexBox) -> IndexBox {
        if part.is_empty() {
            return IndexBox::EMPTY;
        }
        IndexBox::new(self.at(part.lower), self.at(part.upper.map(|end| end - 1)).map(|last| last + 1))
    }

    fn number(&self, [x, y, z]: [i64; 3]) -> usize {
        (z as usize * self.counts[1] + y as usize) * self.counts[0] + x as usize
    }
}
