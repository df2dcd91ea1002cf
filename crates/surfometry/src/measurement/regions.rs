//! An object's numbers by the regions of another image.

use super::object::{Content, Object};
use super::region_values::{Whole, shared};
use super::scheme::{Scheme, with_scheme};
use super::setup::Setup;
use super::{Measured, SurfaceValues};
use crate::integrals::Partial;
use crate::local_geometry::{BandVoxel, Differentiation};
use crate::tiling::{IndexBox, TILE};
use crate::volume::{Affine, FieldOfView, Grid, LabelImage, LabelTable, Shared, VolumeError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// Regions of space: the labels of an image with a lattice of its own. A point belongs to the region of the nearest voxel;
/// where that has no label, and outside the image, to region 0. The surface of an object, which lies half a voxel beside its
/// voxels, belongs where the nearest of them does, unless another of the object's regions is there.
#[derive(Debug, Clone)]
pub struct Regions {
    image: Arc<LabelImage>,
    names: LabelTable,
    to_index: Affine,
}

/// The part of an object in one region. The parts of an object add up to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RegionPart {
    /// Label of the region; 0 of what lies in none.
    pub region: i64,
    /// Its name, where it has one.
    pub name: Option<String>,
    /// The object's voxels there.
    pub voxels: u64,
    /// Area in which the part meets the object's other parts, by faces of voxels, mm^2.
    pub border_area_mm2: f64,
    /// The numbers of the part of the surface that the object's describe.
    #[serde(flatten)]
    pub values: SurfaceValues,
    /// Their standard errors, which hold where the border lies as well.
    pub standard_error: SurfaceValues,
    /// Of the blurred surface.
    pub blurred: SurfaceValues,
}

impl Regions {
    /// Of a label image, and what its labels are called.
    ///
    /// # Errors
    /// [`VolumeError`] of an image whose voxels lie in one place.
    pub fn new(image: impl Shared<LabelImage>, names: LabelTable) -> Result<Self, VolumeError> {
        let image = image.shared();
        let to_index = image.grid().affine().inverted().ok_or(VolumeError::NonFiniteAffine)?;
        Ok(Self { image, names, to_index })
    }

    /// The region of a point of the world, mm.
    pub fn at(&self, world: [f64; 3]) -> i64 {
        let index = self.to_index.apply(world).map(|v| libm::floor(v + 0.5));
        let dimensions = self.image.grid().dimensions();
        if (0..3).all(|a| index[a] >= 0.0 && index[a] < dimensions[a] as f64) {
            self.image.get(index.map(|v| v as usize))
        } else {
            0
        }
    }

    /// The lattice.
    pub fn grid(&self) -> &Grid {
        self.image.grid()
    }

    /// Where there is any region.
    pub fn place(&self) -> Option<FieldOfView> {
        let bounds = self.image.summaries().iter().map(|summary| summary.bounds);
        FieldOfView::new(self.grid(), &bounds.fold(IndexBox::EMPTY, |all, some| all.hull(&some)))
    }

    /// A region's name.
    pub fn name(&self, region: i64) -> Option<String> {
        self.names.get(region)?.name.clone()
    }

    fn labels(&self) -> Vec<i64> {
        let mut labels: Vec<i64> = self.image.summaries().iter().map(|s| s.label).chain([0]).collect();
        labels.sort_unstable();
        labels.dedup();
        labels
    }
}

/// Sigma of the wider blur that tells what a blur carries across borders, in sigmas.
pub(super) const WIDER: f64 = SQRT_2;

/// What is summed over a part.
#[derive(Debug, Clone, Default)]
pub(super) struct PartSums {
    pub(super) integrals: Partial,
    pub(super) voxels: u64,
    pub(super) border: Border,
    /// The same integrals at a wider blur ([`WIDER`]), where there is one.
    pub(super) at_wider_blur: Option<Partial>,
}

/// Where a part meets the object's others.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Border {
    /// Faces of the object's voxels there, by axis.
    pub(super) faces: [u64; 3],
    /// Length on the surface times 1, |H|, |K|, by faces of band voxels: mm, 1, 1/mm; and by axis, which bounds it from
    /// above.
    pub(super) lengths: [[f64; 3]; 3],
}

impl PartSums {
    fn merge(&mut self, other: &Self) {
        self.integrals = std::mem::take(&mut self.integrals).merged(&other.integrals);
        self.voxels += other.voxels;
        for axis in 0..3 {
            self.border.faces[axis] += other.border.faces[axis];
            for n in 0..3 {
                self.border.lengths[axis][n] += other.border.lengths[axis][n];
            }
        }
    }
}

/// By number of the region.
type Sums = BTreeMap<u32, PartSums>;

fn merged(mut all: Sums, some: &Sums) -> Sums {
    for (region, sums) in some {
        all.entry(*region).or_default().merge(sums);
    }
    all
}

impl Object {
    /// Its parts, in order of region; what of it lies in none is one, too. `measured` are its numbers.
    pub fn regions(&self, measured: &Measured, regions: &Regions) -> Vec<RegionPart> {
        let labels = regions.labels();
        let membership = self.membership(regions);
        let number =
            |index: [i64; 3]| labels.binary_search(&membership.of_voxel(index)).unwrap_or_default() as u32;
        let mut sums = merged(self.voxels_by_region(&number), &self.integrals_by_region(&number));
        let mut wider =
            self.at_wider_blur().map(|object| object.integrals_by_region(&number)).unwrap_or_default();
        for (region, part) in &mut sums {
            part.at_wider_blur = wider.remove(region).map(|part| part.integrals);
        }
        let whole = Whole { object: self, measured, region_spacing: regions.grid().spacing() };
        let parts = shared(&whole, &sums.values().collect::<Vec<_>>());
        let faces = self.grid().spacing();
        let part = |((number, sums), values): ((&u32, &PartSums), [SurfaceValues; 3])| {
            let region = labels[*number as usize];
            let [values, standard_error, blurred] = values;
            let area = |a: usize| sums.border.faces[a] as f64 * faces.cell_volume() / faces.mm()[a];
            RegionPart {
                region,
                name: regions.name(region),
                voxels: sums.voxels,
                border_area_mm2: (0..3).map(area).sum(),
                values,
                standard_error,
                blurred,
            }
        };
        sums.iter().zip(parts).map(part).collect()
    }

    /// The same voxels, corrections and all, at a wider blur; `None` where there is no blur.
    fn at_wider_blur(&self) -> Option<Self> {
        let measurement = self.setup.measurement.sigma_mm(WIDER * self.setup.parameters.sigma_mm?);
        let setup = match &self.content {
            Content::Mask(_) | Content::Corrected(..) => Setup::of_masks(&measurement, *self.grid()),
            Content::Probability(image) => Setup::of_probability(&measurement, image),
            Content::Nothing | Content::Field(_) => return None,
        };
        let setup = Setup { control: self.setup.control.clone(), ..setup.ok()? };
        Some(Self { setup, ..self.clone() })
    }

    /// Sums over the tiles of a box, as far as the object is measured, each in one order.
    fn summed(&self, limits: &IndexBox, of_tile: &(dyn Fn(&IndexBox) -> Sums + Sync)) -> Sums {
        let tiles = limits.intersection(&self.region().unwrap_or(IndexBox::EVERYTHING)).tiles(TILE);
        let unless_stopped =
            |tile: &IndexBox| if self.setup.control.is_stopped() { Sums::new() } else { of_tile(tile) };
        // In their order: lengths of borders are rounded.
        let found: Vec<Sums> = tiles.par_iter().map(unless_stopped).collect();
        found.iter().fold(Sums::new(), merged)
    }

    fn integrals_by_region(&self, number: &(dyn Fn([i64; 3]) -> u32 + Sync)) -> Sums {
        let Some(scheme) = self.scheme() else { return Sums::new() };
        let limits = scheme.limits(self.delta().half_width());
        self.summed(&limits, &|tile| with_scheme!(&scheme, s => self.integrals_of_tile(s, tile, number)))
    }

    fn integrals_of_tile<D: Differentiation>(
        &self,
        scheme: &D,
        tile: &IndexBox,
        number: &dyn Fn([i64; 3]) -> u32,
    ) -> Sums {
        let (band, spacing) = (&self.setup.band, self.grid().spacing());
        let field = scheme.tile_field(Vec::new(), tile, band.delta().half_width());
        let mut lengths: BTreeMap<u32, [[f64; 3]; 3]> = BTreeMap::new();
        let mut look = |region: u32, voxel: &BandVoxel| {
            let Some((density, curvature)) = band.element(&voxel.jet) else { return };
            let [h, k] = [curvature.mean_curvature.abs(), curvature.gaussian_curvature.abs()];
            for axis in 0..3 {
                let beyond = neighbours(voxel.index, axis).filter(|&index| number(index) != region).count();
                if beyond > 0 {
                    let length = beyond as f64 * density * spacing.cell_volume() / spacing.mm()[axis];
                    let all = &mut lengths.entry(region).or_default()[axis];
                    [1.0, h, k].iter().zip(all).for_each(|(factor, sum)| *sum += factor * length);
                }
            }
        };
        let parts = Partial::of_tile_by_part(
            scheme,
            &field,
            tile,
            band,
            &self.setup.quadrature,
            &|index| Some(number(index)),
            &mut look,
        );
        let of_part = |(region, integrals)| (region, PartSums { integrals, ..PartSums::default() });
        let mut sums: Sums = parts.into_iter().map(of_part).collect();
        for (region, lengths) in lengths {
            sums.entry(region).or_default().border.lengths = lengths;
        }
        sums
    }

    fn voxels_by_region(&self, number: &(dyn Fn([i64; 3]) -> u32 + Sync)) -> Sums {
        self.summed(&self.mask.bounds(), &|tile| self.voxels_of_tile(tile, number))
    }

    fn voxels_of_tile(&self, tile: &IndexBox, number: &dyn Fn([i64; 3]) -> u32) -> Sums {
        let mut sums = Sums::new();
        for (y, z) in tile.rows() {
            for (start, end) in self.mask.runs_within(y, z, (tile.lower[0], tile.upper[0])) {
                for x in start..end {
                    let region = number([x, y, z]);
                    let part = sums.entry(region).or_default();
                    part.voxels += 1;
                    for axis in 0..3 {
                        let meets = |index: &[i64; 3]| self.mask.get(*index) && number(*index) != region;
                        part.border.faces[axis] += neighbours([x, y, z], axis).filter(meets).count() as u64;
                    }
                }
            }
        }
        sums
    }
}

/// The two neighbours of a voxel along an axis.
fn neighbours(index: [i64; 3], axis: usize) -> impl Iterator<Item = [i64; 3]> {
    [-1, 1].into_iter().map(move |step| {
        let mut to = index;
        to[axis] += step;
        to
    })
}
