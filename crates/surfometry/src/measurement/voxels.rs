//! Numbers that come from counting voxels.

use super::VoxelSummary;
use crate::tiling::IndexBox;
use crate::volume::{Grid, Mask, Spacing};
use serde::{Deserialize, Serialize};

/// Counts of an object's voxels. Sums of indices are whole numbers, so nothing is rounded before the last
/// step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct VoxelCounts {
    count: i128,
    /// Of twice the indices, and of its square and cube.
    sums: [i128; 3],
    squares: [i128; 3],
    cubes: [i128; 3],
    bounds: IndexBox,
    /// In the image's first and last slice of each axis.
    at_edge: [[u64; 2]; 3],
    /// Faces across each axis with the object on one side only.
    faces: [u64; 3],
}

impl Default for VoxelCounts {
    fn default() -> Self {
        Self {
            count: 0,
            sums: [0; 3],
            squares: [0; 3],
            cubes: [0; 3],
            bounds: IndexBox::EMPTY,
            at_edge: [[0; 2]; 3],
            faces: [0; 3],
        }
    }
}

impl VoxelCounts {
    /// Of an object's voxels in a box.
    pub(super) fn of(mask: &Mask, region: &IndexBox) -> Self {
        let mut counts = Self::default();
        let region = mask.bounds().intersection(region);
        let last = mask.grid().dimensions().map(|n| n as i64 - 1);
        for (y, z) in region.rows() {
            for (a, b) in mask.runs_within(y, z, (region.lower[0], region.upper[0])) {
                counts.add((a, b), y, z, last);
                counts.add_faces(mask, (a, b), y, z);
            }
        }
        counts
    }

    fn add(&mut self, (a, b): (i64, i64), y: i64, z: i64, last: [i64; 3]) {
        let length = i128::from(b - a);
        self.count += length;
        let below = |n: i64| {
            // Sums of x, x^2 and x^3 over 0 <= x < n, also of negative n.
            let n = i128::from(n);
            let first = n * (n - 1) / 2;
            [first, (n - 1) * n * (2 * n - 1) / 6, first * first]
        };
        let ([to, squares_to, cubes_to], [from, squares_from, cubes_from]) = (below(b), below(a));
        let along = [2 * (to - from), 4 * (squares_to - squares_from), 8 * (cubes_to - cubes_from)];
        let same = |at: i64| [1, 2, 3].map(|power| length * (2 * i128::from(at)).pow(power));
        for (axis, [sum, square, cube]) in [along, same(y), same(z)].into_iter().enumerate() {
            self.sums[axis] += sum;
            self.squares[axis] += square;
            self.cubes[axis] += cube;
        }
        for (axis, voxels, [first, end]) in [(0, 1, [a, b - 1]), (1, b - a, [y; 2]), (2, b - a, [z; 2])] {
            self.at_edge[axis][0] += if first == 0 { voxels as u64 } else { 0 };
            self.at_edge[axis][1] += if end == last[axis] { voxels as u64 } else { 0 };
        }
        self.bounds = self.bounds.hull(&IndexBox::new([a, y, z], [b, y + 1, z + 1]));
    }

    fn add_faces(&mut self, mask: &Mask, (a, b): (i64, i64), y: i64, z: i64) {
        let beside = |y, z| mask.runs_within(y, z, (a, b)).map(|(from, to)| (to - from) as u64).sum::<u64>();
        let both = 2 * (b - a) as u64;
        self.faces[0] += [a - 1, b].iter().filter(|&&x| !mask.get([x, y, z])).count() as u64;
        self.faces[1] += both - beside(y - 1, z) - beside(y + 1, z);
        self.faces[2] += both - beside(y, z - 1) - beside(y, z + 1);
    }

    /// Adds what was counted elsewhere.
    pub(super) fn merge(&mut self, other: &Self) {
        self.count += other.count;
        for (all, more) in
            [(&mut self.sums, other.sums), (&mut self.squares, other.squares), (&mut self.cubes, other.cubes)]
        {
            all.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        let edges = self.at_edge.as_flattened_mut().iter_mut();
        edges.zip(other.at_edge.as_flattened()).for_each(|(voxels, more)| *voxels += more);
        self.faces.iter_mut().zip(other.faces).for_each(|(faces, more)| *faces += more);
        self.bounds = self.bounds.hull(&other.bounds);
    }

    /// Whether counts that were read can be those of an image.
    pub(super) fn are_valid(&self, grid: &Grid) -> bool {
        grid.index_box().holds(&self.bounds) && (0..=grid.voxel_count() as i128).contains(&self.count)
    }

    /// How many copies of one part the object consists of, by its mirror planes across the axes and by axes
    /// that are alike: 48 for a ball whose centre is a voxel's centre, corner or the like. Mirrored objects
    /// have no odd moments about the middle of their box, and moments that are whole numbers tell that
    /// exactly.
    pub(super) fn symmetry(&self, spacing: Spacing) -> u32 {
        let central = |axis: usize| {
            let middle = i128::from(self.bounds.lower[axis] + self.bounds.upper[axis] - 1);
            let (n, s, q, c) = (self.count, self.sums[axis], self.squares[axis], self.cubes[axis]);
            let odd = [s - middle * n, c - 3 * middle * q + 3 * middle * middle * s - middle.pow(3) * n];
            (odd == [0; 2]).then_some(q - 2 * middle * s + middle * middle * n)
        };
        let squares: [Option<i128>; 3] = std::array::from_fn(central);
        let h = spacing.mm();
        let alike = |a: usize, b: usize| squares[a].is_some() && squares[a] == squares[b] && h[a] == h[b];
        let orders = match [alike(0, 1), alike(0, 2), alike(1, 2)].map(u32::from).iter().sum() {
            3 => 6,
            0 => 1,
            _ => 2,
        };
        orders << squares.iter().flatten().count()
    }

    /// Area of the voxels' faces on the image's first and last slice of each axis, mm^2: where the image cuts
    /// the object.
    pub(super) fn cut_areas(&self, grid: &Grid) -> [[f64; 2]; 3] {
        let areas = face_areas(grid);
        std::array::from_fn(|axis| self.at_edge[axis].map(|voxels| voxels as f64 * areas[axis]))
    }

    /// Share of the voxels' surface that lies where the image cuts the object.
    pub(super) fn cut_share(&self, grid: &Grid) -> f64 {
        let surface: f64 = face_areas(grid).iter().zip(self.faces).map(|(area, n)| area * n as f64).sum();
        self.cut_areas(grid).as_flattened().iter().sum::<f64>() / surface
    }

    pub(super) fn summary(&self, grid: &Grid) -> VoxelSummary {
        let centroid = self.sums.map(|doubled| doubled as f64 / (2 * self.count) as f64);
        VoxelSummary {
            count: self.count as u64,
            volume_mm3: self.count as f64 * grid.spacing().cell_volume(),
            centroid_mm: grid.affine().apply(centroid),
            cut_area_mm2: self.cut_areas(grid).as_flattened().iter().sum(),
            bounding_box: [self.bounds.lower, self.bounds.upper.map(|u| u - 1)],
        }
    }
}

/// Areas of a voxel's faces across each axis, mm^2.
fn face_areas(grid: &Grid) -> [f64; 3] {
    grid.spacing().mm().map(|spacing| grid.spacing().cell_volume() / spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_are_no_more_than_the_surface() {
        let grid = Grid::axis_aligned([9, 6, 4], [1.0, 2.0, 3.0]).unwrap();
        let share = |inside: fn([usize; 3]) -> bool| {
            let mask = Mask::from_predicate(grid, inside);
            let whole = VoxelCounts::of(&mask, &grid.index_box());
            let mut parts = VoxelCounts::default();
            for (from, to) in [(0, 4), (4, 9)] {
                parts.merge(&VoxelCounts::of(&mask, &IndexBox::new([from, 0, 0], [to, 6, 4])));
            }
            assert_eq!(parts, whole);
            whole.cut_share(&grid)
        };
        assert_eq!(share(|_| true), 1.0);
        // A voxel in a corner has half of its faces at the edge.
        assert_eq!(share(|i| i == [0; 3]), 0.5);
        // All faces of 108 voxels are bare; at the edge are 24 of 6 mm^2, 36 of 3 mm^2 and 54 of 2 mm^2.
        assert_eq!(share(|i| (i[0] + i[1] + i[2]) % 2 == 0), 360.0 / 2376.0);
    }
}
