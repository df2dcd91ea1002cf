//! A field between its voxels.

/// Cells along a brick's edge.
const BRICK: usize = 8;

/// Values at all voxels of a block, x fastest, and trilinear interpolation between them. Positions are voxel indices.
pub(crate) struct DenseField<'a> {
    dimensions: [usize; 3],
    values: &'a [f32],
}

/// The eight voxels around a position: where they are stored and their weights.
pub(crate) type Corners = [(usize, f64); 8];

impl<'a> DenseField<'a> {
    /// Of `values` there must be one a voxel.
    pub(crate) fn new(dimensions: [usize; 3], values: &'a [f32]) -> Self {
        Self { dimensions, values }
    }

    /// The voxels around a position; none outside the block.
    pub(crate) fn corners(&self, position: [f64; 3]) -> Option<Corners> {
        let [nx, ny, _] = self.dimensions;
        let mut cell = [0; 3];
        let mut share = [0.0; 3];
        for a in 0..3 {
            let last = self.dimensions[a].checked_sub(2)?;
            if !(0.0..=(last + 1) as f64).contains(&position[a]) {
                return None;
            }
            cell[a] = (position[a] as usize).min(last);
            share[a] = position[a] - cell[a] as f64;
        }
        let first = (cell[2] * ny + cell[1]) * nx + cell[0];
        Some(std::array::from_fn(|i| {
            let up = [i & 1, i >> 1 & 1, i >> 2];
            let weight = |a: usize| if up[a] == 1 { share[a] } else { 1.0 - share[a] };
            (first + (up[2] * ny + up[1]) * nx + up[0], weight(0) * weight(1) * weight(2))
        }))
    }

    /// Interpolated value.
    pub(crate) fn at(&self, corners: &Corners) -> f64 {
        corners.iter().map(|(voxel, weight)| weight * f64::from(self.values[*voxel])).sum()
    }

    /// Interpolated from those corners alone that are `valid`; none if none is.
    pub(crate) fn at_valid(&self, corners: &Corners, valid: impl Fn(usize) -> bool) -> Option<f64> {
        let (mut sum, mut total) = (0.0, 0.0);
        for (voxel, weight) in corners.iter().filter(|c| valid(c.0)) {
            sum += weight * f64::from(self.values[*voxel]);
            total += weight;
        }
        (total > 0.0 && sum.is_finite()).then_some(sum / total)
    }

    /// Central differences over two voxels of the interpolated field, per voxel: smooth across the faces of cells, which
    /// the interpolant's own derivative is not. One-sided at the block's rim.
    pub(crate) fn gradient(&self, position: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            let moved = |step: f64| {
                let mut p = position;
                p[a] = (p[a] + step).clamp(0.0, (self.dimensions[a] - 1) as f64);
                (p[a], self.corners(p).map_or(0.0, |c| self.at(&c)))
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

    /// Whether nothing is near a position within the block.
    pub(crate) fn is_empty(&self, position: [f64; 3]) -> bool {
        let [x, y, z]: [usize; 3] =
            std::array::from_fn(|a| (position[a].max(0.0) as usize / BRICK).min(self.counts[a] - 1));
        self.empty[(z * self.counts[1] + y) * self.counts[0] + x]
    }
}
