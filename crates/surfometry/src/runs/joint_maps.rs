//! Voxel maps of all objects of an image, in one image each.

use super::{InputObject, RunError};
use crate::measurement::{Outside, VoxelQuantity};
use crate::tiling::{Block, IndexBox};
use crate::volume::Grid;

/// A map a quantity in which every object has its place.
///
/// Where the bands of several objects meet, a voxel has the value of the object whose own voxel it is, else of
/// the one whose surface is nearest: the embedding in units of its band's half-width is least. Of equals the
/// first stays. The embedding has the lowest value of all, as `embed` has it.
#[derive(Debug)]
pub(super) struct JointMaps {
    quantities: Vec<VoxelQuantity>,
    outside: Outside,
    maps: Option<Maps>,
}

#[derive(Debug)]
struct Maps {
    grid: Grid,
    /// A map a quantity.
    values: Vec<Vec<f32>>,
    /// How near the object is that each voxel shows: less is nearer. Empty where only the embedding is wanted.
    ranks: Vec<f32>,
}

/// Rank of an object's own voxels in its band.
const OWN: f32 = -1.0;

/// A quantity, and its value at every voxel of an image.
pub(super) type NamedMap = (VoxelQuantity, Vec<f32>);

impl JointMaps {
    pub(super) fn new(quantities: &[VoxelQuantity], outside: Outside) -> Self {
        Self { quantities: quantities.to_vec(), outside, maps: None }
    }

    /// Gives an object its place.
    pub(super) fn add(&mut self, object: &InputObject) -> Result<(), RunError> {
        let source = object.local();
        let region = self.region(object);
        let map = |quantity: VoxelQuantity| {
            source.voxel_map_on(quantity, &region, self.outside.value()).ok_or(RunError::NoSurface)
        };
        let (phi, band) = (map(VoxelQuantity::Phi)?, map(VoxelQuantity::Band)?);
        let half_width = source.delta().half_width() as f32;
        let (quantities, outside) = (&self.quantities, self.outside);
        let maps = self.maps.get_or_insert_with(|| Maps::new(*source.grid(), quantities, outside));
        let nearer = maps.claimed(&region, |index| match (band.get(index) > 0.0, source.mask().get(index)) {
            (false, _) => f32::INFINITY,
            (true, true) => OWN,
            (true, false) => phi.get(index).abs() / half_width,
        });
        for (number, &quantity) in quantities.iter().enumerate() {
            match quantity {
                VoxelQuantity::Phi => maps.lower(number, &phi),
                VoxelQuantity::Band => maps.place(number, &band, &nearer),
                _ => maps.place(number, &map(quantity)?, &nearer),
            }
        }
        Ok(())
    }

    /// The maps with their lattice; `None` where no object has a place.
    pub(super) fn finish(self) -> Option<(Grid, Vec<NamedMap>)> {
        let Maps { grid, values, .. } = self.maps?;
        Some((grid, self.quantities.into_iter().zip(values).collect()))
    }

    /// Where an object's band may be. Its embedding is everywhere.
    fn region(&self, object: &InputObject) -> IndexBox {
        let source = object.local();
        let (all, parameters) = (source.grid().index_box(), source.parameters());
        if self.quantities.contains(&VoxelQuantity::Phi) || !parameters.embedding.is_blur() {
            return all;
        }
        let reach = source.grid().spacing().mm().map(|h| libm::ceil(parameters.thickness_mm / h) as i64);
        source.inside_region().grown(reach).intersection(&all)
    }
}

impl Maps {
    fn new(grid: Grid, quantities: &[VoxelQuantity], outside: Outside) -> Self {
        let voxels = grid.voxel_count();
        let map = |quantity: &VoxelQuantity| match quantity {
            VoxelQuantity::Phi => vec![f32::INFINITY; voxels],
            quantity if quantity.is_curvature() => vec![outside.value(); voxels],
            _ => vec![0.0; voxels],
        };
        let ranked = quantities.iter().any(|quantity| *quantity != VoxelQuantity::Phi);
        let ranks = if ranked { vec![f32::INFINITY; voxels] } else { Vec::new() };
        Self { grid, values: quantities.iter().map(map).collect(), ranks }
    }

    fn offset(&self, [x, y, z]: [i64; 3]) -> usize {
        let [nx, ny, _] = self.grid.dimensions();
        (z as usize * ny + y as usize) * nx + x as usize
    }

    /// The voxels of a region that an object has from now on, in their order: those where its rank is lower than
    /// any before.
    fn claimed(&mut self, region: &IndexBox, rank: impl Fn([i64; 3]) -> f32) -> Vec<[i64; 3]> {
        let mut claimed = Vec::new();
        if self.ranks.is_empty() {
            return claimed;
        }
        for (y, z) in region.rows() {
            for x in region.lower[0]..region.upper[0] {
                let (index, offset) = ([x, y, z], self.offset([x, y, z]));
                let rank = rank(index);
                if rank < self.ranks[offset] {
                    self.ranks[offset] = rank;
                    claimed.push(index);
                }
            }
        }
        claimed
    }

    fn place(&mut self, number: usize, map: &Block<f32>, voxels: &[[i64; 3]]) {
        for &index in voxels {
            let offset = self.offset(index);
            self.values[number][offset] = map.get(index);
        }
    }

    /// Of a map of the whole image.
    fn lower(&mut self, number: usize, phi: &Block<f32>) {
        for (value, &phi) in self.values[number].iter_mut().zip(phi.values()) {
            *value = value.min(phi);
        }
    }
}
