//! The voxels beside an object's boundary, and phi there.

use super::pair_kernel::PairKernel;
use super::voxel_list::VoxelList;
use crate::embedding::{EdgeProfile, Embedding, GaussianEmbedding, Indicator, Row, TRUNCATION_OF_BLUR};
use crate::tiling::{IndexBox, TILE};
use crate::volume::{Grid, Mask, ones};
use rayon::prelude::*;

/// Voxels of the image with a neighbour on the other side by faces, and phi at each: 25 bytes a voxel.
///
/// Voxels beyond the image are nobody's: nothing is asked of them, and nothing there is corrected.
#[derive(Debug)]
pub(super) struct Boundary {
    voxels: VoxelList,
    inside: Vec<bool>,
    phi: Vec<f64>,
}

impl Boundary {
    /// With phi of the corrected embedding without corrections.
    pub(super) fn new(mask: &Mask, sigma: f64, truncation: f64) -> Self {
        let (places, inside) = beside(mask);
        let bounds = mask.bounds().grown([1; 3]);
        let voxels = VoxelList::new(bounds, places);
        let phi = values(mask, &voxels, &GaussianEmbedding::corrected(mask, sigma, truncation));
        Self { voxels, inside, phi }
    }

    /// How far each voxel is on the wrong side of a corrected blur of one voxel along every axis, in voxels.
    pub(super) fn fine_depths(&self, mask: &Mask) -> Vec<f64> {
        let by_voxels = ByVoxels::new(mask);
        let embedding = GaussianEmbedding::corrected(&by_voxels, 1.0, TRUNCATION_OF_BLUR);
        let mut depths = values(mask, &self.voxels, &embedding);
        let slope = EdgeProfile::corrected(1.0).slope(0.0);
        for (number, depth) in depths.iter_mut().enumerate() {
            *depth = (self.direction(number) * *depth).max(0.0) / slope;
        }
        depths
    }

    pub(super) fn len(&self) -> usize {
        self.voxels.len()
    }

    pub(super) fn voxels(&self) -> &VoxelList {
        &self.voxels
    }

    pub(super) fn phi(&self, number: usize) -> f64 {
        self.phi[number]
    }

    pub(super) fn inside(&self, number: usize) -> bool {
        self.inside[number]
    }

    /// Which way a correction of a voxel changes the indicator: 1 inside, -1 outside.
    pub(super) fn direction(&self, number: usize) -> f64 {
        if self.inside[number] { 1.0 } else { -1.0 }
    }

    /// Whether a voxel is on the wrong side of phi = 0.
    pub(super) fn is_wrong(&self, number: usize) -> bool {
        (self.phi[number] < 0.0) != self.inside[number]
    }

    /// Numbers of those that are, ascending.
    pub(super) fn wrong(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|&number| self.is_wrong(number))
    }

    /// How far phi is on the wrong side.
    pub(super) fn depth(&self, number: usize) -> f64 {
        (self.direction(number) * self.phi[number]).max(0.0)
    }

    /// Changes phi as corrections of voxels by so much more lambda do. Slabs are brought up to date beside
    /// each other, and in each the corrections in their order: the same bits always.
    pub(super) fn add(&mut self, changes: &[(u32, f64)], kernel: &PairKernel) {
        let Self { voxels, inside, phi } = self;
        let mut slabs = Vec::new();
        let (mut first, mut rest) = (0, phi.as_mut_slice());
        let [_, y1, z1] = voxels.bounds().upper;
        for z in (voxels.bounds().lower[2]..z1).step_by(SLAB) {
            let slab = voxels.bounds().intersection(&IndexBox {
                lower: [i64::MIN, i64::MIN, z],
                upper: [i64::MAX, i64::MAX, z + SLAB as i64],
            });
            let end = voxels.in_row((slab.upper[0], slab.upper[0]), y1 - 1, slab.upper[2] - 1).end;
            let (own, others) = std::mem::take(&mut rest).split_at_mut(end - first);
            slabs.push((slab, first, own));
            (first, rest) = (end, others);
        }
        slabs.into_par_iter().for_each(|(slab, first, phi)| {
            for &(number, lambda) in changes {
                let place = voxels.place(number as usize);
                let amount = if inside[number as usize] { lambda } else { -lambda };
                voxels.for_each_within(place, kernel.reach(), &slab, |other, distance| {
                    phi[other - first] -= amount * kernel.at(distance);
                });
            }
        });
    }
}

/// Slices that are brought up to date together.
const SLAB: usize = 16;

/// A field at voxels beside the boundary, tile by tile.
fn values(mask: &Mask, voxels: &VoxelList, embedding: &GaussianEmbedding<'_>) -> Vec<f64> {
    // Tiles that the boundary does not cross are not blurred.
    let crossed = |tile: &IndexBox| mask.uniform_in(&tile.grown([1; 3])).is_none();
    let tiles: Vec<IndexBox> = voxels.bounds().tiles(TILE).into_iter().filter(crossed).collect();
    let of_tile = |tile: &IndexBox| {
        let field = embedding.evaluate(tile, 0.5);
        let mut found = Vec::new();
        for (y, z) in tile.rows() {
            let row = field.row(y, z);
            let numbers = voxels.in_row((tile.lower[0], tile.upper[0]), y, z);
            let x = |number: usize| (i64::from(voxels.place(number)[0]) - tile.lower[0]) as usize;
            found.extend(numbers.map(|number| (number, row[x(number)])));
        }
        found
    };
    let found: Vec<Vec<(usize, f32)>> = tiles.par_iter().map(of_tile).collect();
    let mut values = vec![0.0; voxels.len()];
    for (number, value) in found.into_iter().flatten() {
        values[number] = f64::from(value);
    }
    values
}

/// A mask whose voxels are cubes of one: blurred by numbers of voxels, whatever its spacing.
#[derive(Debug)]
struct ByVoxels<'a> {
    mask: &'a Mask,
    grid: Grid,
}

impl<'a> ByVoxels<'a> {
    fn new(mask: &'a Mask) -> Self {
        let grid = *mask.grid();
        Self { mask, grid: Grid::axis_aligned(grid.dimensions(), [1.0; 3]).unwrap_or(grid) }
    }
}

impl Indicator for ByVoxels<'_> {
    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn bounds(&self) -> IndexBox {
        self.mask.bounds()
    }

    fn uniform_in(&self, region: &IndexBox) -> Option<bool> {
        self.mask.uniform_in(region)
    }

    fn read_row(&self, y: i64, z: i64, row: &mut Row) {
        self.mask.read_row(y, z, row);
    }
}

/// Those voxels in memory order, and which are inside. Rows are compared with their neighbours word by word.
fn beside(mask: &Mask) -> (Vec<[i32; 3]>, Vec<bool>) {
    let bounds = mask.bounds().grown([1; 3]);
    let image = mask.grid().index_box();
    let bits = mask.on_bounds(bounds);
    let (mut places, mut inside) = (Vec::new(), Vec::new());
    for (y, z) in bounds.rows() {
        let row = bits.row(y, z);
        let others = [(y - 1, z), (y + 1, z), (y, z - 1), (y, z + 1)].map(|(y, z)| bits.row(y, z));
        for (n, &word) in row.iter().enumerate() {
            let of = |row: &[u64], n: usize| row.get(n).copied().unwrap_or(0);
            let before = if n == 0 { 0 } else { row[n - 1] };
            let shifted = [word << 1 | before >> 63, word >> 1 | of(row, n + 1) << 63];
            let across = shifted.into_iter().chain(others.map(|other| of(other, n)));
            let differing = across.fold(0, |differing, other| differing | (word ^ other));
            for bit in ones(differing) {
                let x = bounds.lower[0] + (n * 64) as i64 + i64::from(bit);
                if image.contains([x, y, z]) {
                    places.push([x as i32, y as i32, z as i32]);
                    inside.push(word >> bit & 1 == 1);
                }
            }
        }
    }
    (places, inside)
}
