//! A field between its voxels.

/// Cells along a brick's edge.
const BRICK: usize = 4;

/// Values at all voxels of a block, x fastest, and trilinear interpolation between them. Positions are voxel
/// indices.
pub(crate) struct DenseField<'a> {
    dimensions: [usize; 3],
    values: &'a [f32],
}

/// The cell of eight voxels around a position: where its first is stored, and the position's share of the way
/// to the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    first: usize,
    share: [f64; 3],
}

impl<'a> DenseField<'a> {
    /// Of `values` there must be one a voxel.
    pub(crate) fn new(dimensions: [usize; 3], values: &'a [f32]) -> Self {
        Self { dimensions, values }
    }

    /// The cell around a position; none outside the block.
    pub(crate) fn cell(&self, position: [f64; 3]) -> Option<Cell> {
        let [nx, ny, _] = self.dimensions;
        let mut index = [0; 3];
        let mut share = [0.0; 3];
        for a in 0..3 {
            let last = self.dimensions[a].checked_sub(2)?;
            if !(0.0..=(last + 1) as f64).contains(&position[a]) {
                return None;
            }
            index[a] = (position[a] as usize).min(last);
            share[a] = position[a] - index[a] as f64;
        }
        Some(Cell { first: (index[2] * ny + index[1]) * nx + index[0], share })
    }

    /// Interpolated value.
    pub(crate) fn at(&self, cell: &Cell) -> f64 {
        let [nx, ny, _] = self.dimensions;
        let mix = |low: f64, high: f64, share: f64| low + share * (high - low);
        let row = |voxel: usize| {
            let pair = &self.values[voxel..voxel + 2];
            mix(f64::from(pair[0]), f64::from(pair[1]), cell.share[0])
        };
        let plane = |voxel: usize| mix(row(voxel), row(voxel + nx), cell.share[1]);
        mix(plane(cell.first), plane(cell.first + nx * ny), cell.share[2])
    }

    /// Interpolated from those of the cell's voxels alone that are `valid`; none if none is.
    pub(crate) fn at_valid(&self, cell: &Cell, valid: impl Fn(usize) -> bool) -> Option<f64> {
        let [nx, ny, _] = self.dimensions;
        let (mut sum, mut total) = (0.0, 0.0);
        for up in (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2]) {
            let voxel = cell.first + (up[2] * ny + up[1]) * nx + up[0];
            if valid(voxel) {
                let along = |a: usize| if up[a] == 1 { cell.share[a] } else { 1.0 - cell.share[a] };
                let weight = along(0) * along(1) * along(2);
                sum += weight * f64::from(self.values[voxel]);
                total += weight;
            }
        }
        (total > 0.0 && sum.is_finite()).then_some(sum / total)
    }

    /// Central differences over two voxels of the interpolated field, per voxel: smooth across the faces of
    /// cells, which the interpolant's own derivative is not. One-sided at the block's rim.
    pub(crate) fn gradient(&self, position: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            let moved = |step: f64| {
                let mut p = position;
                p[a] = (p[a] + step).clamp(0.0, (self.dimensions[a] - 1) as f64);
                (p[a], self.cell(p).map_or(0.0, |c| self.at(&c)))
            };
            let ((from, low), (to, high)) = (moved(-1.0), moved(1.0));
            if to > from { (high - low) / (to - from) } else { 0.0 }
        })
    }
}

/// Which parts of a block hold nothing below a level, so that rays can pass them.
pub(crate) struct EmptyBricks {
    counts: [usize; 3],
    empty: Vec<bool>,
}

impl EmptyBricks {
    /// Of a block whose values below `level` matter.
    pub(crate) fn new(dimensions: [usize; 3], values: &[f32], level: f64) -> Self {
        let counts = dimensions.map(|n| n.saturating_sub(1).div_ceil(BRICK).max(1));
        let mut empty = vec![true; counts.iter().product()];
        let [nx, ny, _] = dimensions;
        for (voxel, _) in values.iter().enumerate().filter(|(_, v)| f64::from(**v) < level) {
            let index = [voxel % nx, voxel / nx % ny, voxel / (nx * ny)];
            // A voxel is a corner of the cells on both its sides.
            let range = |a: usize| index[a].saturating_sub(1) / BRICK..=(index[a] / BRICK).min(counts[a] - 1);
            for z in range(2) {
                for y in range(1) {
                    for x in range(0) {
                        empty[(z * counts[1] + y) * counts[0] + x] = false;
                    }
                }
            }
        }
        Self { counts, empty }
    }

    /// How many steps a ray may go on from a position within the block until it leaves a brick that holds
    /// nothing; 0 if the brick holds something.
    pub(crate) fn passable_steps(&self, position: [f64; 3], direction: [f64; 3]) -> i64 {
        let brick = |a: usize| (position[a].max(0.0) as usize / BRICK).min(self.counts[a] - 1);
        let [x, y, z] = [brick(0), brick(1), brick(2)];
        if !self.empty[(z * self.counts[1] + y) * self.counts[0] + x] {
            return 0;
        }
        let to_wall = |a: usize| {
            let wall = BRICK * (brick(a) + usize::from(direction[a] > 0.0));
            if direction[a] == 0.0 { f64::INFINITY } else { (wall as f64 - position[a]) / direction[a] }
        };
        let steps = to_wall(0).min(to_wall(1)).min(to_wall(2));
        if steps.is_finite() { libm::ceil(steps).max(1.0) as i64 } else { 1 }
    }
}
