//! The solids between which an object's topology is compared.

use super::Object;
use super::scheme::{Scheme, with_scheme};
use crate::local_geometry::{Differentiation, FieldBlock, TileField};
use crate::tiling::{IndexBox, SparseField, SparseTile, TILE, WorkTime};
use crate::volume::{Mask, ones};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The solids inside levels of the field: 0, and both ends of the band where they are asked for. Of the field
/// itself only what lies between any two of them and the voxels is kept.
pub(super) struct LevelSets {
    pub(super) surface: Mask,
    pub(super) band: Option<BandEnds>,
    pub(super) phi: SparseField,
}

/// The solids inside the ends of a band.
pub(super) struct BandEnds {
    pub(super) inner: Mask,
    pub(super) outer: Mask,
    /// Where in the band the field's gradient, by central differences, is least, and what it is there.
    pub(super) weakest: Option<([i64; 3], f64)>,
}

/// What a walk over tiles needs to know, and the solids that it fills.
struct Walk<'a> {
    object: &'a Object,
    /// The voxels, on the solids' bounds.
    mask: Mask,
    /// Where there may be a band.
    limits: IndexBox,
    half_width: f64,
    /// Whether the ends of the band are wanted.
    band: bool,
    /// Inside the band's inner end, 0, the outer end; only that of 0 is filled where no band is wanted.
    solids: Mutex<[Mask; 3]>,
    most: usize,
    kept: AtomicUsize,
}

/// What is found in a tile: the field that is kept, and the least square of a gradient with its place along
/// z, y, x.
type TileFound = (SparseTile, Option<(f64, [i64; 3])>);

impl LevelSets {
    /// Of an object whose field is a blur; `None` where more than so many of the field's values would have to
    /// be kept, or it was stopped. In parallel over tiles.
    pub(super) fn of(object: &Object, band: bool, most: usize, time: &WorkTime) -> Option<Self> {
        let scheme = object.scheme()?;
        let half_width = object.delta().half_width();
        let limits = scheme.limits(half_width);
        let mut region = limits;
        region.lower[0] = region.lower[0].div_euclid(TILE[0]) * TILE[0];
        let solids = |wanted| {
            Mask::cleared(
                *object.grid(),
                if wanted { region } else { IndexBox { upper: region.lower, ..region } },
            )
        };
        let walk = Walk {
            object,
            mask: time.of(|| object.mask.on_bounds(region)),
            limits,
            half_width,
            band,
            solids: Mutex::new([solids(band), solids(true), solids(band)]),
            most,
            kept: AtomicUsize::new(0),
        };
        let tiles = limits.tiles(TILE);
        let found = tiles.par_iter().map(|tile| time.of(|| with_scheme!(&scheme, s => walk.tile(s, tile))));
        let found: Vec<TileFound> = found.collect();
        if walk.is_over() {
            return None;
        }
        let (tiles, weakest): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let weakest = weakest.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let [inner, surface, outer] = walk.solids.into_inner().unwrap_or_else(PoisonError::into_inner);
        let weakest = weakest.map(|(squared, [z, y, x])| ([x, y, z], squared.sqrt()));
        let band = band.then_some(BandEnds { inner, outer, weakest });
        Some(Self { surface, band, phi: SparseField::of_tiles(&limits, tiles) })
    }
}

impl Walk<'_> {
    /// Whether too much would have to be kept, or nobody wants to know any more.
    fn is_over(&self) -> bool {
        self.kept.load(Ordering::Relaxed) > self.most || self.object.setup.control.is_stopped()
    }

    fn tile<D: Differentiation>(&self, scheme: &D, tile: &IndexBox) -> TileFound {
        if self.is_over() {
            return (SparseTile::new(tile), None);
        }
        match scheme.tile_field(Vec::new(), tile, self.half_width) {
            TileField::Constant(phi) if phi < 0.0 => {
                let [width, height, depth] = tile.extent();
                let row = u64::MAX >> (TILE[0] as usize - width) << tile.lower[0].rem_euclid(TILE[0]);
                self.fill(tile, &vec![[row; 3]; height * depth]);
                (SparseTile::new(tile), None)
            }
            TileField::Constant(_) => (SparseTile::new(tile), None),
            TileField::Varying(field) => self.varying_tile::<D>(&field, tile),
        }
    }

    fn varying_tile<D: Differentiation>(&self, field: &FieldBlock<D>, tile: &IndexBox) -> TileFound {
        let value = |place: usize| -> f32 { field.values()[place].into() as f32 };
        let squared = |place: usize| self.squared_gradient(field.region(), value, place);
        let inner_voxels = self.limits.grown([-1; 3]);
        let first_bit = tile.lower[0].rem_euclid(TILE[0]);
        let (mut kept, mut weakest) = (SparseTile::new(tile), None);
        let mut solids = Vec::new();
        for (y, z) in tile.rows() {
            let start = field.offset([tile.lower[0], y, z]);
            let levels = [-self.half_width, 0.0, self.half_width].map(|level| {
                let below = |x: usize| u64::from(f64::from(value(start + x)) < level) << x;
                (0..tile.extent()[0]).fold(0, |word, x| word | below(x)) << first_bit
            });
            let [inner, surface, outer] = levels;
            let at = |bit: u32| start + bit as usize - first_bit as usize;
            let in_band = if self.band { outer & !inner } else { 0 };
            let marks = (self.mask.word([tile.lower[0], y, z]) ^ surface) | in_band;
            kept.push_row(marks, ones(marks).map(|bit| value(at(bit))));
            for bit in ones(in_band) {
                let voxel = [tile.lower[0] - first_bit + i64::from(bit), y, z];
                if f64::from(value(at(bit))).abs() < self.half_width && inner_voxels.contains(voxel) {
                    let squared = squared(at(bit));
                    if weakest.is_none_or(|(least, _)| squared < least) {
                        weakest = Some((squared, [z, y, voxel[0]]));
                    }
                }
            }
            solids.push(levels);
        }
        self.kept.fetch_add(kept.marked(), Ordering::Relaxed);
        self.fill(tile, &solids);
        (kept, weakest)
    }

    /// Square of the gradient by central differences at a place of a region.
    fn squared_gradient(&self, region: IndexBox, value: impl Fn(usize) -> f32, place: usize) -> f64 {
        let [nx, ny, _] = region.extent();
        let strides = [1, nx, nx * ny];
        let spacing = self.object.grid().spacing().mm();
        let slope =
            |a: usize| f64::from(value(place + strides[a]) - value(place - strides[a])) / (2.0 * spacing[a]);
        (0..3).map(|a| slope(a).powi(2)).sum()
    }

    /// Puts a tile's voxels inside the solids, row by row.
    fn fill(&self, tile: &IndexBox, rows: &[[u64; 3]]) {
        let mut solids = self.solids.lock().unwrap_or_else(PoisonError::into_inner);
        for ((y, z), words) in tile.rows().zip(rows) {
            for level in if self.band { 0..3 } else { 1..2 } {
                solids[level].set_word([tile.lower[0], y, z], words[level]);
            }
        }
    }
}
