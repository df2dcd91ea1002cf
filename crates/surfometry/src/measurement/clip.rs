//! Objects that the image cuts.

use super::scheme::{Scheme, with_scheme};
use super::setup::Setup;
use super::{MeasureError, Measurement};
use crate::choice::choices;
use crate::integrals::Band;
use crate::local_geometry::{BandVoxel, Differentiation};
use crate::tiling::IndexBox;
use crate::volume::Mask;
use serde::{Deserialize, Serialize};

/// What becomes of an object where the edge of the image cuts it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Clip {
    /// It is closed there with a flat cap, as the paper does: volume, area and curvature are those of a
    /// closed object.
    #[default]
    Cap,
    /// The cut face and its rim are left out: volume, area and curvature are those between the cuts, of a
    /// surface that is open there.
    Exclude,
}

choices!(Clip, "clip": {
    Cap = "cap": "Closed with a flat cap, which counts",
    Exclude = "exclude": "Measured between sections 3 sigma inside the cuts",
});

/// How far from a cut the measured part ends, in units of sigma. What the mirror image gets wrong weighs g(3)
/// = 0.4 % there.
pub(super) const RIM: f64 = 3.0;
/// How far an object is continued beyond the image, in units of the widest blur: further than its kernel reaches (5 at most by
/// default, and what is cut off beyond 6 is 1e-9).
const CONTINUED: f64 = 6.0;

/// An object that the image cuts, continued beyond it, and the part of it that is measured.
#[derive(Debug, Clone)]
pub(super) struct CutObject {
    /// The object with its mirror image beyond each face that cuts it.
    pub(super) continued: Mask,
    pub(super) part: MeasuredPart,
}

/// The part of an image in which an object is measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeasuredPart {
    pub(super) region: IndexBox,
    /// By axis, whether the lower and the upper end of the region cut the object.
    cuts: [[bool; 2]; 3],
    pub(super) rim_mm: f64,
    pub(super) voxels: u64,
    pub(super) section_area_mm2: f64,
}

/// Where an object that the image cuts was measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ClipSummary {
    /// What was done where the image cuts the object.
    pub mode: Clip,
    /// How far from the cut faces the measured part ends at least, mm.
    pub rim_mm: f64,
    /// First and last voxel index (x, y, z) of the measured part, both inclusive.
    pub region: [[i64; 3]; 2],
    /// Volume of the object's voxels there, mm^3.
    pub voxel_volume_mm3: f64,
    /// Area of the sections in which the part ends, by counting voxels on both sides, mm^2.
    pub section_area_mm2: f64,
    /// Integral of the geodesic curvature along the open surface's boundary, corners included: with the
    /// integral of K it makes 2 pi chi.
    pub boundary_curvature: f64,
}

impl Measurement {
    /// What is to be measured in place of an object that its image cuts; `None` where no face does, or
    /// [`Clip::Cap`] closes it.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, or an embedding without a blur.
    pub(super) fn cut(&self, mask: &Mask) -> Result<Option<CutObject>, MeasureError> {
        if self.clip == Clip::Cap || !mask.touches_border() {
            return Ok(None);
        }
        let setup = Setup::of_masks(self, *mask.grid())?;
        Scheme::check_reach(&setup)?;
        let profile = setup.parameters.profile().ok_or(MeasureError::Conflict(
            "to leave the cuts out needs a field that is smooth across them: use the Gaussian or the corrected embedding",
        ))?;
        let widest = profile.terms().iter().fold(0.0, |widest: f64, (_, sigma)| widest.max(*sigma));
        let spacing = mask.grid().spacing().mm();
        let voxels = |length: f64| spacing.map(|h| libm::ceil(length / h) as i64);
        let (image, bounds) = (mask.grid().index_box(), mask.bounds());
        let cuts: [[bool; 2]; 3] =
            std::array::from_fn(|a| [bounds.lower[a] == image.lower[a], bounds.upper[a] == image.upper[a]]);
        let moved = |by: [i64; 3]| {
            let inside = |cut: bool, a: usize| if cut { by[a] } else { 0 };
            IndexBox::new(
                std::array::from_fn(|a| image.lower[a] + inside(cuts[a][0], a)),
                std::array::from_fn(|a| image.upper[a] - inside(cuts[a][1], a)),
            )
        };
        let rim_mm = RIM * setup.parameters.sigma_mm.unwrap_or_default();
        let region = moved(voxels(rim_mm));
        let continued = mask.continued(&moved(voxels(CONTINUED * widest).map(|n| -n)));
        let part = MeasuredPart {
            region,
            cuts,
            rim_mm,
            voxels: mask.on_bounds(region).voxels(),
            section_area_mm2: section_area(mask, &region, cuts),
        };
        Ok(Some(CutObject { continued, part }))
    }
}

/// The two slices of voxels at either side of a region's end.
fn around_end(region: &IndexBox, axis: usize, upper: bool) -> IndexBox {
    let end = if upper { region.upper[axis] } else { region.lower[axis] };
    let mut slices = *region;
    slices.lower[axis] = end - 1;
    slices.upper[axis] = end + 1;
    slices
}

/// The ends of a region that cut the object.
fn ends(cuts: [[bool; 2]; 3]) -> impl Iterator<Item = (usize, bool)> {
    let all = (0..3).flat_map(|axis| [false, true].map(move |upper| (axis, upper)));
    all.filter(move |&(axis, upper)| cuts[axis][usize::from(upper)])
}

fn section_area(mask: &Mask, region: &IndexBox, cuts: [[bool; 2]; 3]) -> f64 {
    let spacing = mask.grid().spacing();
    let area = |(axis, upper): (usize, bool)| {
        let voxels = mask.on_bounds(around_end(region, axis, upper)).voxels();
        0.5 * voxels as f64 * spacing.cell_volume() / spacing.mm()[axis]
    };
    if region.is_empty() { 0.0 } else { ends(cuts).map(area).sum() }
}

/// What the open surface's boundary adds.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BoundaryTerms {
    /// Integral of the geodesic curvature, corners included.
    pub(super) curvature: f64,
    /// Integral of H times the normal's slope against the cut: by how much the area between the cuts grows
    /// where the surface moves out by H.
    pub(super) area: f64,
    /// The same of H^2, for M.
    pub(super) total_mean_curvature: f64,
    /// Length of the boundary, mm.
    pub(super) length: f64,
}

impl MeasuredPart {
    pub(super) fn summary(&self, cell_volume: f64, boundary: &BoundaryTerms) -> ClipSummary {
        ClipSummary {
            mode: Clip::Exclude,
            rim_mm: self.rim_mm,
            region: [self.region.lower, self.region.upper.map(|u| u - 1)],
            voxel_volume_mm3: self.voxels as f64 * cell_volume,
            section_area_mm2: self.section_area_mm2,
            boundary_curvature: boundary.curvature,
        }
    }

    /// Sums along the boundary: the same delta in the planes that end the part, and on the lines in which two
    /// of them meet.
    pub(super) fn boundary(&self, scheme: &Scheme, setup: &Setup) -> BoundaryTerms {
        with_scheme!(scheme, s => self.boundary_in(s, setup))
    }

    fn boundary_in<D: Differentiation>(&self, scheme: &D, setup: &Setup) -> BoundaryTerms {
        let spacing = setup.grid.spacing().mm();
        let half_width = setup.band.delta().half_width();
        let mut terms = BoundaryTerms::default();
        for (axis, upper) in ends(self.cuts) {
            let inward = if upper { -1.0 } else { 1.0 };
            let cell = 0.5 * spacing[(axis + 1) % 3] * spacing[(axis + 2) % 3];
            for voxel in band_of(scheme, &around_end(&self.region, axis, upper), half_width) {
                terms.add_in_plane(&voxel, &setup.band, axis, inward, cell);
            }
        }
        for (a, a_upper) in ends(self.cuts) {
            for (b, b_upper) in ends(self.cuts).filter(|&(b, _)| b > a) {
                let line = around_end(&around_end(&self.region, a, a_upper), b, b_upper);
                let cell = 0.25 * spacing[3 - a - b];
                for voxel in band_of(scheme, &line, half_width) {
                    terms.add_on_line(&voxel, &setup.band, [(a, a_upper), (b, b_upper)], cell);
                }
            }
        }
        terms
    }
}

fn band_of<D: Differentiation>(scheme: &D, region: &IndexBox, half_width: f64) -> Vec<BandVoxel> {
    region.tiles(crate::tiling::TILE).iter().flat_map(|tile| scheme.band(tile, half_width)).collect()
}

impl BoundaryTerms {
    /// Geodesic curvature of a plane section: its own curvature times the surface normal's component into the
    /// part. (Upper half of a ball, cut at angle theta from its pole: cot(theta).)
    fn add_in_plane(&mut self, voxel: &BandVoxel, band: &Band, axis: usize, inward: f64, cell: f64) {
        let Some((density, curvature)) = band.element(&voxel.jet) else { return };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let gradient = voxel.jet.gradient;
        let mixed = |a: usize, b: usize| match (a.min(b), a.max(b)) {
            (0, 1) => voxel.jet.hessian[3],
            (0, 2) => voxel.jet.hessian[4],
            _ => voxel.jet.hessian[5],
        };
        let (square, length) =
            (gradient[u] * gradient[u] + gradient[v] * gradient[v], voxel.jet.gradient_magnitude());
        let slope = inward * gradient[axis] / length;
        // Times |grad phi| in the plane, which turns delta into length: where the plane touches the surface,
        // both are 0.
        let bending = (voxel.jet.hessian[u] * gradient[v] * gradient[v]
            - 2.0 * gradient[u] * gradient[v] * mixed(u, v)
            + voxel.jet.hessian[v] * gradient[u] * gradient[u])
            / square;
        self.length += cell * band.delta().delta(voxel.jet.value) * square.sqrt();
        if bending.is_finite() {
            self.curvature += cell * band.delta().delta(voxel.jet.value) * bending * slope;
        }
        self.area += cell * density * curvature.mean_curvature * slope;
        self.total_mean_curvature +=
            cell * density * curvature.mean_curvature * curvature.mean_curvature * slope;
    }

    /// Where the boundary turns from one plane into another: the exterior angle within the surface.
    fn add_on_line(&mut self, voxel: &BandVoxel, band: &Band, planes: [(usize, bool); 2], cell: f64) {
        let Some((density, _)) = band.element(&voxel.jet) else { return };
        let normal = voxel.jet.gradient.map(|g| g / voxel.jet.gradient_magnitude());
        let [a, b] = planes.map(|(axis, upper)| if upper { -normal[axis] } else { normal[axis] });
        let along = normal[3 - planes[0].0 - planes[1].0].abs();
        let cosine = a * b / libm::sqrt((1.0 - a * a) * (1.0 - b * b));
        if cosine.is_finite() {
            let exterior = std::f64::consts::PI - libm::acos(cosine.clamp(-1.0, 1.0));
            self.curvature += cell * density * along * exterior;
        }
    }
}
