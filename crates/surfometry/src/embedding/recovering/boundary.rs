//! The voxels beside an object's boundary, and phi there.

use super::voxel_list::VoxelList;
use crate::embedding::{
    CorrectedMask, EdgeProfile, Embedding, GaussianEmbedding, Indicator, Row, TRUNCATION_OF_BLUR,
};
use crate::tiling::{IndexBox, TILE};
use crate::volume::{Grid, Mask, ones};
use rayon::prelude::*;
use std::sync::Arc;

/// Voxels of the image with a neighbour on the other side by faces, and phi at each: 17 bytes a voxel.
///
/// Voxels beyond the image are nobody's: nothing is asked of them, and nothing there is corrected.
#[derive(Debug)]
pub(super) struct Boundary {
    mask: Arc<Mask>,
    sigma: f64,
    truncation: f64,
    voxels: VoxelList,
    inside: Vec<bool>,
    phi: Vec<f32>,
}

impl Boundary {
    /// With phi of the corrected embedding without corrections.
    pub(super) fn new(mask: &Arc<Mask>, sigma: f64, truncation: f64) -> Self {
        let voxels = VoxelList::new(mask.bounds().grown([1; 3]), beside(mask));
        let inside = |number| mask.get(voxels.place(number).map(i64::from));
        let inside = (0..voxels.len()).map(inside).collect();
        let phi = values(mask, &voxels, &GaussianEmbedding::corrected(&**mask, sigma, truncation));
        Self { mask: Arc::clone(mask), sigma, truncation, voxels, inside, phi }
    }

    /// How far each voxel is on the wrong side of a corrected blur of one voxel along every axis, in voxels.
    pub(super) fn fine_depths(&self) -> Vec<f64> {
        let by_voxels = ByVoxels::new(&self.mask);
        let embedding = GaussianEmbedding::corrected(&by_voxels, 1.0, TRUNCATION_OF_BLUR);
        let phi = values(&self.mask, &self.voxels, &embedding);
        let slope = EdgeProfile::corrected(1.0).slope(0.0);
        let depth =
            |(number, phi): (usize, &f32)| (self.direction(number) * f64::from(*phi)).max(0.0) / slope;
        phi.iter().enumerate().map(depth).collect()
    }

    pub(super) fn len(&self) -> usize {
        self.voxels.len()
    }

    pub(super) fn voxels(&self) -> &VoxelList {
        &self.voxels
    }

    pub(super) fn phi(&self, number: usize) -> f64 {
        f64::from(self.phi[number])
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
        (self.direction(number) * self.phi(number)).max(0.0)
    }

    /// Amounts to add to the mask's bits that lambdas of voxels stand for, in memory order.
    pub(super) fn amounts(&self, lambdas: impl Iterator<Item = (u32, f64)>) -> Vec<([usize; 3], f32)> {
        let amount = |(number, lambda): (u32, f64)| {
            let number = number as usize;
            (self.voxels.index(number), (self.direction(number) * lambda) as f32)
        };
        let mut amounts: Vec<_> = lambdas.filter(|&(_, lambda)| lambda > 0.0).map(amount).collect();
        amounts.sort_unstable_by_key(|&([x, y, z], _)| [z, y, x]);
        amounts
    }

    /// phi of the mask with such amounts: of the very blur that is to have the right signs.
    pub(super) fn blur(&mut self, amounts: Vec<([usize; 3], f32)>) {
        let corrected = CorrectedMask::new(&self.mask, amounts);
        let embedding = GaussianEmbedding::corrected(&corrected, self.sigma, self.truncation);
        self.phi = values(&self.mask, &self.voxels, &embedding);
    }
}

/// A field at voxels beside the boundary, tile by tile.
fn values(mask: &Mask, voxels: &VoxelList, embedding: &GaussianEmbedding<'_>) -> Vec<f32> {
    // Tiles that the boundary does not cross are not blurred.
    let crossed = |tile: &IndexBox| mask.uniform_in(&tile.grown([1; 3])).is_none();
    let tiles: Vec<IndexBox> = voxels.bounds().tiles(TILE).into_iter().filter(crossed).collect();
    let of_tile = |tile: &IndexBox| {
        let field = embedding.evaluate(tile, 0.5);
        let value = |number: usize| (number, field.get(voxels.place(number).map(i64::from)));
        voxels.within(tile).map(value).collect()
    };
    let found: Vec<Vec<(usize, f32)>> = tiles.par_iter().map(of_tile).collect();
    let mut values = vec![0.0; voxels.len()];
    for (number, value) in found.into_iter().flatten() {
        values[number] = value;
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

/// Those voxels. Rows are compared with their neighbours word by word.
fn beside(mask: &Mask) -> Vec<[i32; 3]> {
    let bounds = mask.bounds().grown([1; 3]);
    let image = mask.grid().index_box();
    let bits = mask.on_bounds(bounds);
    let mut places = Vec::new();
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
                }
            }
        }
    }
    places
}
