//! Local quantities on the image's own grid.

use super::Object;
use super::scheme::{Scheme, with_scheme};
use crate::choice::choices;
use crate::embedding::EdgeProfile;
use crate::local_geometry::{BandVoxel, Differentiation, TileField};
use crate::tiling::{Block, IndexBox, TILE};
use rayon::prelude::*;

/// What a voxel map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VoxelQuantity {
    /// H of the level set through a band voxel, 1/mm; 0 outside the band.
    MeanCurvature,
    /// K of the level set through a band voxel, 1/mm^2; 0 outside the band.
    GaussianCurvature,
    /// Area of surface a volume of voxel, delta(phi) |grad phi|, 1/mm: summed over voxels times their volume
    /// it gives the surface area, weighted by H the total mean curvature.
    Delta,
    /// The embedding; a distance only near the surface, where it is needed: it is cut off a few voxels away.
    Phi,
    /// 1 in the band, 0 outside, and where the gradient has collapsed.
    Band,
}

impl VoxelQuantity {
    /// Unit, empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::MeanCurvature | Self::Delta => "1/mm",
            Self::GaussianCurvature => "1/mm^2",
            Self::Phi | Self::Band => "",
        }
    }

    /// Whether it is known in the band only.
    pub fn is_curvature(self) -> bool {
        matches!(self, Self::MeanCurvature | Self::GaussianCurvature)
    }

    /// Name with unit, as arrays of the contract are named.
    pub fn name(self) -> &'static str {
        match self {
            Self::MeanCurvature => "mean_curvature_per_mm",
            Self::GaussianCurvature => "gaussian_curvature_per_mm2",
            Self::Delta => "delta_per_mm",
            Self::Phi => "phi",
            Self::Band => "band",
        }
    }
}

choices!(VoxelQuantity, "voxel quantity": {
    MeanCurvature = "mean-curvature": "H in the band, 1/mm",
    GaussianCurvature = "gaussian-curvature": "K in the band, 1/mm^2",
    Delta = "delta": "surface area a volume, 1/mm: its sum times a voxel's volume is the area, of one object's own map",
    Phi = "phi": "the embedding",
    Band = "band": "1 in the band, 0 outside",
});

/// What a voxel map has where curvature is not known: outside the band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Outside {
    /// 0, which viewers take for nothing.
    #[default]
    Zero,
    /// Not a number, which no mean takes for a value.
    Nan,
}

choices!(Outside, "value outside": {
    Zero = "0": "0, which viewers take for nothing",
    Nan = "nan": "not a number, which no mean takes for a value",
});

impl Outside {
    /// The value.
    pub fn value(self) -> f32 {
        match self {
            Self::Zero => 0.0,
            Self::Nan => f32::NAN,
        }
    }
}

impl Object {
    /// A box of the image outside which phi is not negative.
    pub fn inside_region(&self) -> IndexBox {
        let profile = self.setup.parameters.profile();
        let sigmas = profile.iter().flat_map(EdgeProfile::terms).map(|(_, sigma)| *sigma);
        let widest = sigmas.fold(0.0, f64::max);
        let reach_mm = self.setup.truncation() * widest;
        let reach = self.grid().spacing().mm().map(|h| 1 + libm::ceil(reach_mm / h) as i64);
        self.mask.bounds().grown(reach).intersection(&self.grid().index_box())
    }

    /// A quantity on a box of voxels, such as the whole image
    /// ([`Grid::index_box`](crate::volume::Grid::index_box)), which may reach beyond it unless the field is
    /// given; `None` where the blur is known to leave nothing, so that there was no need to make a field. In
    /// parallel over tiles; the same for any number of threads.
    pub fn voxel_map(&self, quantity: VoxelQuantity, region: &IndexBox) -> Option<Block<f32>> {
        self.voxel_map_on(quantity, region, 0.0)
    }

    /// The same with a value of the caller's where curvature is not known: outside the band, and where the gradient
    /// has collapsed. What is known everywhere (the embedding, the band, and delta, which is 0 outside it) stays.
    pub fn voxel_map_on(
        &self,
        quantity: VoxelQuantity,
        region: &IndexBox,
        outside: f32,
    ) -> Option<Block<f32>> {
        let mut map = Block::filled(*region, outside);
        self.visit_voxel_maps(
            [quantity],
            region,
            outside,
            |_| true,
            |tile, [part]| {
                for ((y, z), row) in tile.rows().zip(part.values().chunks(tile.extent()[0])) {
                    let start = map.offset([tile.lower[0], y, z]);
                    map.values_mut()[start..][..row.len()].copy_from_slice(row);
                }
            },
        )?;
        Some(map)
    }

    /// Quantities of one field, in those tiles of a box that are wanted, one tile after the other; with a value where
    /// they are not known, as in [`voxel_map_on`](Self::voxel_map_on).
    pub(crate) fn visit_voxel_maps<const N: usize>(
        &self,
        quantities: [VoxelQuantity; N],
        region: &IndexBox,
        outside: f32,
        is_wanted: impl Fn(&IndexBox) -> bool,
        mut visit: impl FnMut(&IndexBox, [Block<f32>; N]),
    ) -> Option<()> {
        let scheme = self.scheme()?;
        let tiles: Vec<IndexBox> = region.tiles(TILE).into_iter().filter(is_wanted).collect();
        let values =
            |tile: &IndexBox| with_scheme!(&scheme, s => self.tile_values(s, tile, quantities, outside));
        // A few tiles at a time, so that no second copy of the image is needed.
        for batch in tiles.chunks(8 * rayon::current_num_threads()) {
            let parts: Vec<[Block<f32>; N]> = batch.par_iter().map(values).collect();
            batch.iter().zip(parts).for_each(|(tile, parts)| visit(tile, parts));
        }
        Some(())
    }

    fn tile_values<D: Differentiation, const N: usize>(
        &self,
        scheme: &D,
        tile: &IndexBox,
        quantities: [VoxelQuantity; N],
        outside: f32,
    ) -> [Block<f32>; N] {
        let half_width = self.setup.band.delta().half_width();
        let value = |quantity: VoxelQuantity| if quantity.is_curvature() { outside } else { 0.0 };
        let mut maps = quantities.map(|quantity| Block::filled(*tile, value(quantity)));
        if self.setup.control.is_stopped() {
            return maps;
        }
        match scheme.tile_field(Vec::new(), tile, half_width) {
            TileField::Constant(phi) => {
                let maps = maps.iter_mut().zip(quantities).filter(|(_, q)| *q == VoxelQuantity::Phi);
                maps.for_each(|(map, _)| map.values_mut().fill(phi as f32));
            }
            TileField::Varying(field) => {
                for (map, _) in maps.iter_mut().zip(quantities).filter(|(_, q)| *q == VoxelQuantity::Phi) {
                    for (row, (y, z)) in map.values_mut().chunks_mut(tile.extent()[0]).zip(tile.rows()) {
                        let phi = &field.values()[field.offset([tile.lower[0], y, z])..];
                        row.iter_mut().zip(phi).for_each(|(value, &phi)| *value = phi.into() as f32);
                    }
                }
                if quantities.iter().any(|quantity| *quantity != VoxelQuantity::Phi) {
                    scheme.visit_band(&field, tile, half_width, &mut |band| {
                        band.iter().for_each(|voxel| self.tell_band_voxel(&voxel, &mut maps, quantities));
                    });
                }
            }
        }
        maps
    }

    fn tell_band_voxel<const N: usize>(
        &self,
        voxel: &BandVoxel,
        maps: &mut [Block<f32>; N],
        quantities: [VoxelQuantity; N],
    ) {
        // Where the gradient has collapsed integrals leave a voxel out.
        let Some((density, curvature)) = self.setup.band.element(&voxel.jet) else { return };
        for (map, quantity) in maps.iter_mut().zip(quantities) {
            let value = match quantity {
                VoxelQuantity::MeanCurvature => curvature.mean_curvature,
                VoxelQuantity::GaussianCurvature => curvature.gaussian_curvature,
                VoxelQuantity::Delta => density,
                VoxelQuantity::Band => 1.0,
                VoxelQuantity::Phi => continue,
            };
            let place = map.offset(voxel.index);
            map.values_mut()[place] = value as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::{Derivatives, Measurement};
    use crate::volume::{Grid, LabelImage};

    /// Where the level is low the surface lies far outside the mask: at 1e-4 of a plane by 3.7 sigma.
    #[test]
    fn all_that_is_inside_is_in_the_region() {
        let (size, spacing) = ([46, 50, 34], [1.0, 0.9, 1.5]);
        let grid = Grid::axis_aligned(size, spacing).unwrap();
        let all = grid.index_box();
        let square = |[x, y, z]: [i64; 3]| -> f64 {
            let from = [x as f64 - 22.8, y as f64 - 25.1, z as f64 - 16.7];
            from.iter().zip(spacing).map(|(d, h)| (d * h).powi(2)).sum()
        };
        let places = || all.rows().flat_map(|(y, z)| (0..size[0] as i64).map(move |x| [x, y, z]));
        let voxels: Vec<u8> = places().map(|at| u8::from(square(at) < 36.0)).collect();
        let mask = LabelImage::from_voxels(grid, &voxels).unwrap().mask(1);
        for derivatives in [Derivatives::Gaussian, Derivatives::Matched] {
            let choices = Measurement::default().sigma_mm(3.0).level(1e-4).derivatives(derivatives);
            let object = choices.prepare(mask.clone()).unwrap();
            let (region, phi) = (object.inside_region(), object.voxel_map(VoxelQuantity::Phi, &all).unwrap());
            let inside: Vec<[i64; 3]> = places().filter(|&at| phi.get(at) < 0.0).collect();
            assert!(inside.iter().any(|&at| square(at) > 12.0f64.powi(2)));
            assert!(inside.into_iter().all(|at| region.contains(at)));
        }
    }
}
