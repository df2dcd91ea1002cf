//! Voxels that an embedding does not give back.
//!
//! The paper asks of an embedding that theta(-phi) = I. A blur moves the surface by sigma^2 H, which
//! compensation undoes, and rounds the voxels' corners; what lies on the wrong side of phi = 0 further than
//! both explain is detail that is lost, or a gap that is filled, and no compensation brings it back.

use super::warnings::RECOVER;
use crate::accuracy::{Flag, FlagCode, place_text};
use crate::integrals::Band;
use crate::local_geometry::{BandVoxels, Curvature, Differentiation, FieldBlock, Jet, TileField};
use crate::tiling::IndexBox;
use crate::volume::{Grid, Mask, Spacing};
use serde::{Deserialize, Serialize};

/// What an embedding takes from an object, and what it adds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Detail {
    pub(super) lost: WrongVoxels,
    pub(super) filled: WrongVoxels,
}

/// Voxels on the wrong side of the surface.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct WrongVoxels {
    pub(super) voxels: u64,
    /// Faces across x, y, z between them and voxels of the other kind.
    faces: [u64; 3],
    /// |phi| and place of the one furthest from its side, the first along x, y, z of equals.
    deepest: Option<(f64, [i64; 3])>,
    /// Where they are, in no order, where that is asked.
    #[serde(skip)]
    places: Vec<[i64; 3]>,
}

/// Voxels that an object's field puts on the wrong side of its surface, further than its shift and half a voxel explain, in
/// order of x, y, z.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WrongSides {
    /// The object's, outside the surface: parts that are lost.
    pub lost: Vec<[i64; 3]>,
    /// The background's, inside the surface: gaps that are filled.
    pub filled: Vec<[i64; 3]>,
}

/// By how much the curvature at a voxel may differ from that of the surface that the blur moved.
const SHIFTS: f64 = 1.5;

impl WrongVoxels {
    fn merge(&mut self, other: &Self) {
        self.voxels += other.voxels;
        self.faces.iter_mut().zip(other.faces).for_each(|(faces, more)| *faces += more);
        self.deepen(other.deepest);
        self.places.extend_from_slice(&other.places);
    }

    fn sorted_places(mut self) -> Vec<[i64; 3]> {
        self.places.sort_unstable();
        self.places
    }

    fn deepen(&mut self, other: Option<(f64, [i64; 3])>) {
        let order = |a: &(f64, [i64; 3]), b: &(f64, [i64; 3])| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1));
        self.deepest = self.deepest.into_iter().chain(other).max_by(order);
    }

    /// Their surface, about: two thirds of their faces', as on the mean over directions.
    pub(super) fn area(&self, spacing: Spacing) -> f64 {
        let faces = self.faces.iter().zip(spacing.mm());
        faces.map(|(&faces, h)| faces as f64 * spacing.cell_volume() / h).sum::<f64>() * 2.0 / 3.0
    }

    /// Their integral of H, about, in magnitude: that of rods, A^2 / 4 V.
    pub(super) fn total_mean_curvature(&self, spacing: Spacing) -> f64 {
        if self.voxels == 0 {
            return 0.0;
        }
        self.area(spacing).powi(2) / (4.0 * self.voxels as f64 * spacing.cell_volume())
    }
}

impl Detail {
    #[must_use]
    pub(super) fn merged(mut self, other: &Self) -> Self {
        self.lost.merge(&other.lost);
        self.filled.merge(&other.filled);
        self
    }

    /// Where, if the watch took that down.
    pub(super) fn places(self) -> WrongSides {
        WrongSides { lost: self.lost.sorted_places(), filled: self.filled.sorted_places() }
    }

    /// Surface that is lost with them, about, mm^2.
    pub(super) fn area(&self, spacing: Spacing) -> f64 {
        self.lost.area(spacing) + self.filled.area(spacing)
    }

    /// Integral of H that is lost with them, about, in magnitude, mm.
    pub(super) fn total_mean_curvature(&self, spacing: Spacing) -> f64 {
        self.lost.total_mean_curvature(spacing) + self.filled.total_mean_curvature(spacing)
    }
}

/// Share of an object's surface from which on lost detail is told of.
const TOLD: f64 = 0.005;

impl Detail {
    /// A warning where more of a surface than counts is lost, by a blur or by what recovers what one loses.
    pub(super) fn flag(&self, surface_area: f64, grid: &Grid, recovered: bool) -> Option<Flag> {
        let spacing = grid.spacing();
        let share = self.area(spacing) / surface_area;
        if share < TOLD {
            return None;
        }
        let side = |voxels: &WrongVoxels, what: &str| {
            let at = grid.affine().apply(voxels.deepest?.1.map(|v| v as f64));
            let place = place_text(at, spacing.smallest());
            let plural = if voxels.voxels == 1 { "" } else { "s" };
            Some(format!("{} voxel{plural} {what}, the deepest at {place}", voxels.voxels))
        };
        let sides = [side(&self.lost, "lost"), side(&self.filled, "of gaps filled")];
        let sides: Vec<String> = sides.into_iter().flatten().collect();
        let (what, cure) = if recovered {
            ("the recovering embedding", "only a finer scan tells more")
        } else {
            ("the blur", RECOVER)
        };
        let message = format!(
            "{what} does not give the object back: {}, about {:.1} % of its surface; no compensation brings that back, and the errors of area and \
             curvature are as large; {cure}",
            sides.join(", "),
            100.0 * share
        );
        Some(Flag::new(FlagCode::DetailLost, message))
    }
}

/// Compares a field with the voxels that it was made of.
#[derive(Clone, Copy)]
pub(super) struct Watch<'a> {
    mask: &'a Mask,
    /// The voxels that are compared.
    owned: IndexBox,
    spacing: Spacing,
    /// Of the blur that moved the surface by sigma^2 H, mm.
    shift_sigma: f64,
    /// |phi| beyond which there is no band.
    half_width: f64,
    /// Whether the places of wrong voxels are wanted.
    places: bool,
}

impl Watch<'_> {
    /// The same, which also takes down where wrong voxels are.
    pub(super) fn with_places(self) -> Self {
        Self { places: true, ..self }
    }

    pub(super) fn new<'a>(
        mask: &'a Mask,
        owned: IndexBox,
        spacing: Spacing,
        shift_sigma: f64,
        band: &Band,
    ) -> Watch<'a> {
        Watch { mask, owned, spacing, shift_sigma, half_width: band.delta().half_width(), places: false }
    }

    /// What lies outside the box of the walk, where phi is known to be beyond the band.
    pub(super) fn outside(&self, walked: &IndexBox) -> Detail {
        let mut detail = Detail::default();
        let region = self.owned.intersection(&self.mask.bounds());
        for (y, z) in region.rows() {
            for (a, b) in self.mask.runs_within(y, z, (region.lower[0], region.upper[0])) {
                let outside = (a..b).map(|x| [x, y, z]).filter(|voxel| !walked.contains(*voxel));
                outside.for_each(|voxel| self.add(&mut detail, voxel, self.half_width));
            }
        }
        detail
    }

    /// What is wrong in a tile beyond the band.
    pub(super) fn beyond_band<D: Differentiation + ?Sized>(
        &self,
        field: &TileField<D>,
        tile: &IndexBox,
    ) -> Detail {
        let mut detail = Detail::default();
        let tile = tile.intersection(&self.owned);
        match field {
            TileField::Constant(phi) => {
                if self.mask.uniform_in(&tile) != Some(*phi < 0.0) {
                    let outside = *phi >= 0.0;
                    for (y, z) in tile.rows() {
                        let wrong = (tile.lower[0]..tile.upper[0]).map(|x| [x, y, z]);
                        wrong
                            .filter(|voxel| self.mask.get(*voxel) == outside)
                            .for_each(|voxel| self.add(&mut detail, voxel, self.half_width));
                    }
                }
            }
            TileField::Varying(field) => self.beyond_band_of::<D>(field, &tile, &mut detail),
        }
        detail
    }

    fn beyond_band_of<D: Differentiation + ?Sized>(
        &self,
        field: &FieldBlock<D>,
        tile: &IndexBox,
        detail: &mut Detail,
    ) {
        for (y, z) in tile.rows() {
            let start = field.offset([tile.lower[0], y, z]);
            let row = &field.values()[start..][..tile.extent()[0]];
            let place = |x: i64| (x - tile.lower[0]) as usize;
            let mut wrong = |from: i64, to: i64, side: f64| {
                let is_wrong = |value: f64| side * value > self.half_width;
                let part = &row[place(from)..place(to)];
                if part.iter().map(|&value| u32::from(is_wrong(value.into()))).sum::<u32>() > 0 {
                    let voxels = (from..to).zip(part).filter(|(_, value)| is_wrong((**value).into()));
                    voxels.for_each(|(x, _)| self.add(detail, [x, y, z], self.half_width));
                }
            };
            let mut background = tile.lower[0];
            for (a, b) in self.mask.runs_within(y, z, (tile.lower[0], tile.upper[0])) {
                wrong(background, a, -1.0);
                wrong(a, b, 1.0);
                background = b;
            }
            wrong(background, tile.upper[0], -1.0);
        }
    }

    /// What is wrong among the voxels of the band.
    pub(super) fn in_band(&self, voxels: &BandVoxels, detail: &mut Detail) {
        let wrong = |(index, value): &([i64; 3], f64)| (*value < 0.0) != self.mask.get(*index);
        let values = voxels.column(0).iter().copied();
        let pairs = voxels.indices().zip(values).enumerate();
        for (number, (index, _)) in pairs.filter(|(_, pair)| wrong(pair)) {
            if self.owned.contains(index) {
                self.judge(detail, index, &voxels.jet(number));
            }
        }
    }

    /// A voxel on the wrong side: half a voxel beyond what the blur's shift explains it is lost or filled.
    fn judge(&self, detail: &mut Detail, index: [i64; 3], jet: &Jet) {
        let Some(curvature) = Curvature::of(jet) else { return self.add(detail, index, jet.value.abs()) };
        let gradient = jet.gradient_magnitude();
        let shift = self.shift_sigma.powi(2) * curvature.mean_curvature.abs();
        let sides = jet.gradient.iter().zip(self.spacing.mm());
        let voxel: f64 = sides.map(|(slope, h)| 0.5 * h * (slope / gradient).abs()).sum();
        let depth = jet.value.abs();
        if depth > gradient * (SHIFTS * shift + voxel) {
            self.add(detail, index, depth);
        }
    }

    fn add(&self, detail: &mut Detail, voxel: [i64; 3], depth: f64) {
        let inside = self.mask.get(voxel);
        let side = if inside { &mut detail.lost } else { &mut detail.filled };
        side.voxels += 1;
        for (axis, faces) in side.faces.iter_mut().enumerate() {
            for step in [-1, 1] {
                let mut neighbour = voxel;
                neighbour[axis] += step;
                *faces += u64::from(self.mask.get(neighbour) != inside);
            }
        }
        side.deepen(Some((depth, voxel)));
        if self.places {
            side.places.push(voxel);
        }
    }
}
