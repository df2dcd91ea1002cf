//! What a tile adds to the integrals of an object's parts.

use super::partial::{BandSums, Weights};
use super::{Band, Partial, Quadrature};
use crate::local_geometry::{BandVoxel, BandVoxels, Differentiation, TileField};
use crate::tiling::IndexBox;
use crate::vectors;
use fearless_simd::dispatch;
use std::collections::BTreeMap;

impl Partial {
    /// As [`Partial::of_tile`], each voxel for the part that it belongs to; what belongs to none is left out. The parts add
    /// up to the whole, but for how their sums are rounded. The voxels of the band are shown to an observer.
    #[expect(clippy::too_many_arguments, reason = "those of `of_tile`, and which part and who looks")]
    pub fn of_tile_by_part<D: Differentiation + ?Sized>(
        scheme: &D,
        field: &TileField<D>,
        tile: &IndexBox,
        band: &Band,
        quadrature: &Quadrature,
        part_of: &dyn Fn([i64; 3]) -> Option<u32>,
        look: &mut dyn FnMut(u32, &BandVoxel),
    ) -> BTreeMap<u32, Self> {
        let weights = Weights::new(quadrature, *tile);
        let half_width = band.delta().half_width();
        let mut beyond: BTreeMap<u32, (u64, f64)> = BTreeMap::new();
        let mut add_inside = |index: [i64; 3], phi: f64| {
            let Some(part) = (phi < 0.0).then(|| part_of(index)).flatten() else { return };
            let (count, volume) = beyond.entry(part).or_default();
            *count += 1;
            *volume += if phi < -half_width { weights.at(index) } else { 0.0 };
        };
        let indices = || {
            let row = |(y, z): (i64, i64)| (tile.lower[0]..tile.upper[0]).map(move |x| [x, y, z]);
            tile.rows().flat_map(row)
        };
        let mut voxels: BTreeMap<u32, Vec<BandVoxel>> = BTreeMap::new();
        match field {
            TileField::Constant(phi) if *phi >= 0.0 => {}
            TileField::Constant(_) => indices().for_each(|index| add_inside(index, f64::NEG_INFINITY)),
            TileField::Varying(field) => {
                indices().for_each(|index| add_inside(index, field.get(index).into()));
                scheme.visit_band(field, tile, half_width, &mut |band| {
                    for voxel in band.iter() {
                        if let Some(part) = part_of(voxel.index) {
                            look(part, &voxel);
                            voxels.entry(part).or_default().push(voxel);
                        }
                    }
                });
            }
        }
        let mut parts: BTreeMap<u32, Self> = BTreeMap::new();
        for (part, (count, volume)) in beyond {
            let partial = parts.entry(part).or_default();
            partial.inside_voxels += count;
            partial.add_sums(volume, &BandSums::default());
        }
        for (part, voxels) in voxels {
            let mut sums = BandSums::default();
            let add = &mut |voxels: &BandVoxels| {
                dispatch!(vectors::level(), _simd => sums.add(voxels, band, &weights));
            };
            BandVoxels::hand_on(voxels, add);
            parts.entry(part).or_default().add_sums(0.0, &sums);
        }
        parts
    }
}
