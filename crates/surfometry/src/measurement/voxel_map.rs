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
        let scheme = self.scheme()?;
        let outside = if quantity.is_curvature() { outside } else { 0.0 };
        let mut map = Block::filled(*region, outside);
        let values =
            |tile: &IndexBox| with_scheme!(&scheme, s => self.tile_values(s, tile, (quantity, outside)));
        // A few tiles at a time, so that no second copy of the image is needed.
        for batch in region.tiles(TILE).chunks(8 * rayon::current_num_threads()) {
            let parts: Vec<Vec<f32>> = batch.par_iter().map(values).collect();
            for (tile, part) in batch.iter().zip(parts) {
                for ((y, z), row) in tile.rows().zip(part.chunks(tile.extent()[0])) {
                    let start = map.offset([tile.lower[0], y, z]);
                    map.values_mut()[start..][..row.len()].copy_from_slice(row);
                }
            }
        }
        Some(map)
    }

    fn tile_values<D: Differentiation>(
        &self,
        scheme: &D,
        tile: &IndexBox,
        (quantity, outside): (VoxelQuantity, f32),
    ) -> Vec<f32> {
        let half_width = self.setup.band.delta().half_width();
        let all = IndexBox::new([0; 3], tile.extent().map(|n| n as i64));
        let mut values = Block::filled(all, outside);
        if self.setup.control.is_stopped() {
            return values.into_storage();
        }
        match (scheme.tile_field(Vec::new(), tile, half_width), quantity) {
            (TileField::Constant(phi), VoxelQuantity::Phi) => values.values_mut().fill(phi as f32),
            (TileField::Constant(_), _) => {}
            (TileField::Varying(field), VoxelQuantity::Phi) => {
                for (row, (y, z)) in values.values_mut().chunks_mut(tile.extent()[0]).zip(tile.rows()) {
                    let start = field.offset([tile.lower[0], y, z]);
                    row.iter_mut().zip(&field.values()[start..]).for_each(|(v, &phi)| *v = phi.into() as f32);
                }
            }
            (TileField::Varying(field), quantity) => {
                scheme.visit_band(&field, tile, half_width, &mut |band| {
                    for voxel in band.iter() {
                        let place: [i64; 3] = std::array::from_fn(|a| voxel.index[a] - tile.lower[a]);
                        let place = values.offset(place);
                        if let Some(value) = self.band_value(&voxel, quantity) {
                            values.values_mut()[place] = value as f32;
                        }
                    }
                });
            }
        }
        values.into_storage()
    }

    /// Of a voxel of the band; `None` where the gradient has collapsed, which integrals leave out.
    fn band_value(&self, voxel: &BandVoxel, quantity: VoxelQuantity) -> Option<f64> {
        let (density, curvature) = self.setup.band.element(&voxel.jet)?;
        Some(match quantity {
            VoxelQuantity::MeanCurvature => curvature.mean_curvature,
            VoxelQuantity::GaussianCurvature => curvature.gaussian_curvature,
            VoxelQuantity::Delta => density,
            VoxelQuantity::Phi | VoxelQuantity::Band => 1.0,
        })
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
