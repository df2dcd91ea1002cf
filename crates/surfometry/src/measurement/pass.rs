//! One walk over an object's tiles for everything that is summed over them.

use super::detail::{Detail, Watch};
use super::ripples::{CurvatureTile, Ripples};
use crate::Control;
use crate::integrals::{Band, BandGeometry, Observer, Partial, Quadrature};
use crate::local_geometry::{BandVoxels, Differentiation, FieldValue, TileField};
use crate::surface::{Spectrum, SurfaceSums, TileMesh, cell_limits};
use crate::tiling::{IndexBox, Pool, TILE};
use crate::volume::Spacing;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// What the tiles of an object add up to, in any order. Equal sums may have taken different times.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct ObjectSums {
    pub(super) integrals: Partial,
    pub(super) surface: SurfaceSums,
    pub(super) detail: Detail,
    pub(super) ripples: Ripples,
    #[serde(default)]
    pub(super) spectrum: Spectrum,
    pub(super) times: StageTimes,
}

/// Time in each stage, summed over threads.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct StageTimes {
    pub(super) embed: Duration,
    pub(super) derive: Duration,
    pub(super) integrate: Duration,
    pub(super) surface: Duration,
}

impl PartialEq for ObjectSums {
    fn eq(&self, other: &Self) -> bool {
        (&self.integrals, &self.surface, &self.detail, &self.ripples, &self.spectrum)
            == (&other.integrals, &other.surface, &other.detail, &other.ripples, &other.spectrum)
    }
}

impl ObjectSums {
    #[must_use]
    pub(super) fn merged(self, other: &Self) -> Self {
        Self {
            integrals: self.integrals.merged(&other.integrals),
            surface: self.surface.merged(&other.surface),
            detail: self.detail.merged(&other.detail),
            ripples: self.ripples.merged(&other.ripples),
            spectrum: self.spectrum.merged(&other.spectrum),
            times: self.times.merged(&other.times),
        }
    }
}

impl StageTimes {
    /// The part of a walk's time that its integrals took.
    pub(super) fn share_of_integrals(&self, walk: Duration) -> Duration {
        let integrals = self.embed + self.derive + self.integrate;
        let all = (integrals + self.surface).as_secs_f64();
        if all > 0.0 { walk.mul_f64(integrals.as_secs_f64() / all) } else { walk }
    }

    fn merged(&self, other: &Self) -> Self {
        Self {
            embed: self.embed.saturating_add(other.embed),
            derive: self.derive.saturating_add(other.derive),
            integrate: self.integrate.saturating_add(other.integrate),
            surface: self.surface.saturating_add(other.surface),
        }
    }
}

/// What a walk needs to know.
pub(super) struct Pass<'a> {
    pub(super) band: &'a Band,
    pub(super) quadrature: &'a Quadrature,
    pub(super) spacing: Spacing,
    /// Whether the mesh is wanted beside the integrals.
    pub(super) with_surface: bool,
    /// Whether there is a model of errors that asks for ripples.
    pub(super) with_ripples: bool,
    /// Whether there is one that asks how the mesh lies in the grid.
    pub(super) with_spectrum: bool,
    /// The part that is summed over, where it is not all.
    pub(super) region: Option<IndexBox>,
    /// Where the tiles begin that are wanted; all where `None`.
    pub(super) tiles: Option<IndexBox>,
    /// What the field is compared with, of voxels.
    pub(super) watch: Option<Watch<'a>>,
    /// Who may stop it; the sums are not to be used then.
    pub(super) control: &'a Control,
}

impl Pass<'_> {
    /// Sums over the tiles in parallel; the same bits for any number of threads.
    pub(super) fn sums<D: Differentiation>(&self, scheme: &D) -> ObjectSums {
        let limits = cell_limits(scheme.embedding(), self.band.delta().half_width());
        let limits = self.region.map_or(limits, |region| limits.intersection(&region));
        let storage = Pool::<Vec<FieldValue<D>>>::default();
        let part = |tile: &IndexBox| storage.with(|memory| self.tile(scheme, tile, &limits, memory));
        let wanted = |tile: &IndexBox| self.tiles.is_none_or(|region| region.contains(tile.lower));
        let mut tiles = limits.tiles(TILE);
        tiles.retain(wanted);
        let sums = tiles.par_iter().map(part).reduce(ObjectSums::default, |a, b| a.merged(&b));
        let detail = self.watch.map(|watch| watch.outside(&limits)).unwrap_or_default();
        ObjectSums { detail: sums.detail.merged(&detail), ..sums }
    }

    fn tile<D: Differentiation>(
        &self,
        scheme: &D,
        tile: &IndexBox,
        limits: &IndexBox,
        memory: &mut Vec<FieldValue<D>>,
    ) -> ObjectSums {
        if self.control.is_stopped() {
            return ObjectSums::default();
        }
        let start = Instant::now();
        let field = scheme.tile_field(std::mem::take(memory), tile, self.band.delta().half_width());
        let embedded = Instant::now();
        let mut summing = Duration::ZERO;
        let mut detail = self.watch.map(|watch| watch.beyond_band(&field, tile)).unwrap_or_default();
        let mut curvature = CurvatureTile::new(*tile, self.spacing);
        let look = &mut |voxels: &BandVoxels, geometry: &BandGeometry| {
            if self.with_ripples {
                curvature.add(voxels, geometry);
            }
            if let Some(watch) = &self.watch {
                watch.in_band(voxels, &mut detail);
            }
        };
        let integrals = Partial::of_tile(
            scheme,
            &field,
            tile,
            self.band,
            self.quadrature,
            Observer { look, summing: &mut summing },
        );
        let differentiated = Instant::now();
        let ripples = curvature.ripples();
        let integrated = Instant::now();
        summing += integrated - differentiated;
        let (mut surface, mut spectrum) = <(SurfaceSums, Spectrum)>::default();
        if let TileField::Varying(field) = field {
            if self.with_surface {
                let mesh = TileMesh::of(&field, tile, limits);
                surface = SurfaceSums::of_tile(&mesh, self.spacing.mm());
                if self.with_spectrum {
                    spectrum = Spectrum::of_tile(&mesh, self.spacing);
                }
            }
            *memory = field.into_storage();
        }
        let times = StageTimes {
            embed: embedded - start,
            derive: (integrated - embedded).saturating_sub(summing),
            integrate: summing,
            surface: integrated.elapsed(),
        };
        ObjectSums { integrals, surface, detail, ripples, spectrum, times }
    }
}
