//! The voxels beside an object's boundary, and phi there.

use super::pair_kernel::PairKernel;
use super::voxel_list::VoxelList;
use crate::embedding::{Embedding, GaussianEmbedding};
use crate::tiling::{IndexBox, TILE};
use crate::volume::{Mask, ones};
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
        let mut phi = vec![0.0; voxels.len()];
        let embedding = GaussianEmbedding::corrected(mask, sigma, truncation);
        // Tiles that the boundary does not cross are not blurred.
        let crossed = |tile: &IndexBox| mask.uniform_in(&tile.grown([1; 3])).is_none();
        let tiles: Vec<IndexBox> = bounds.tiles(TILE).into_iter().filter(crossed).collect();
        let found: Vec<Vec<(usize, f32)>> = tiles
            .par_iter()
            .map(|tile| {
                let field = embedding.evaluate(tile, 0.5);
                let mut values = Vec::new();
                for (y, z) in tile.rows() {
                    let row = field.row(y, z);
                    let numbers = voxels.in_row((tile.lower[0], tile.upper[0]), y, z);
                    let at = |number: usize| {
                        (number, row[(i64::from(voxels.place(number)[0]) - tile.lower[0]) as usize])
                    };
                    values.extend(numbers.map(at));
                }
                values
            })
            .collect();
        for (number, value) in found.into_iter().flatten() {
            phi[number] = f64::from(value);
        }
        Self { voxels, inside, phi }
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

    /// Changes phi as a correction of a voxel by so much more lambda does.
    pub(super) fn add(&mut self, number: usize, lambda: f64, kernel: &PairKernel) {
        if lambda == 0.0 {
            return;
        }
        let amount = self.direction(number) * lambda;
        let phi = &mut self.phi;
        self.voxels.for_each_within(self.voxels.place(number), kernel.reach(), |other, distance| {
            phi[other] -= amount * kernel.at(distance);
        });
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
