//! Objects that their embedding gives back: corrections between the mask and its blur, and what is measured then.

use super::setup::Setup;
use super::{MeasureError, SurfaceValues};
use crate::accuracy::{ErrorModel, Flag, FlagCode, SHARED, left_of_terraces, of_average};
use crate::embedding::{CorrectedMask, Corrections, Price, Recovery};
use crate::surface::{Creases, Spectrum, Surface, VertexGeometry};
use crate::volume::{Grid, Mask, Spacing};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// How far beyond the centres of voxels that were lost the surface is asked to lie, at most, in geometric mean spacings: on thin
/// parts it passes by the outermost centres otherwise (`experiments/recovering_embedding`).
const MARGIN: f64 = 0.1;

/// What corrections did to give an object back.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RecoverySummary {
    /// Voxels beside the boundary, by faces.
    pub beside: u64,
    /// Those of them that the corrected blur puts on the wrong side.
    pub violated: u64,
    /// Voxels that are corrected.
    pub corrected: u64,
    /// Those that are on the wrong side still.
    pub left: u64,
    /// Those that are not corrected because they look like noise.
    pub refused: u64,
    /// Level of noise of the mask: rms depth of violations that nothing around them speaks for, in geometric mean spacings.
    pub noise: f64,
    /// Whether that is so high that what stands alone was left to the blur.
    pub noisy: bool,
}

/// The same with the surface that came of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recovered {
    pub(super) summary: RecoverySummary,
    surface: Option<Mesh>,
    /// How the mesh lies in the grid: variance of V, mm^6, by its spectrum.
    pub(super) variance_of_volume: f64,
}

/// What a shift of the grid does to an object as a whole, standard deviations.
#[derive(Debug, Clone, Copy)]
pub(super) struct SamplingNoise {
    /// Of V, by its curved surface, mm^3.
    pub(super) curved: f64,
    /// Of V beyond that and faces, because the surface lies so in the grid: of straight tubes along it each slice is off by as much.
    pub(super) beyond: f64,
    /// Of V, by flat faces along the grid, mm^3, and of A, mm^2.
    pub(super) of_faces: f64,
    pub(super) faces_of_area: f64,
}

impl SamplingNoise {
    /// Of V, mm^3, by all but faces, which moves the surface as a whole.
    pub(super) fn moved(&self) -> f64 {
        libm::hypot(self.curved, self.beyond)
    }
}

/// What the mesh of phi = 0 has, mm.
#[derive(Debug, Clone, Copy)]
struct Mesh {
    volume: f64,
    area: f64,
    total_mean_curvature: f64,
    euler_characteristic: f64,
    /// Integral of |H|: what M's error is measured by, for M may cancel.
    absolute_mean_curvature: f64,
    /// Area that turns within [`SHARP`] geometric mean spacings, which may have been an edge, and its integral of |H|.
    sharp_area: f64,
    sharp_mean_curvature: f64,
    /// Area that turns within [`CREASE`].
    creased_area: f64,
    /// What rounding may have taken where flat faces meet.
    creases: Creases,
}

/// The corrections of an object's mask.
pub(super) fn recovered(setup: &Setup, mask: &Arc<Mask>) -> (CorrectedMask, RecoverySummary) {
    let sigma = setup.parameters.sigma_mm.unwrap_or_default();
    let recovery =
        Recovery { sigma, truncation: setup.truncation(), price: Price::FromEvidence, margin: MARGIN };
    let found = recovery.corrections(mask);
    let summary = RecoverySummary::of(&found);
    let corrected = CorrectedMask::new(mask, found.amounts);
    (corrected, summary)
}

impl RecoverySummary {
    fn of(found: &Corrections) -> Self {
        Self {
            beside: found.beside,
            violated: found.violated,
            corrected: found.amounts.len() as u64,
            left: found.left,
            refused: found.refused,
            noise: found.noise[0],
            noisy: found.noisy,
        }
    }

    /// Share of the voxels beside the boundary that the blur alone would lose.
    fn share(&self) -> f64 {
        if self.beside == 0 { 0.0 } else { self.violated as f64 / self.beside as f64 }
    }

    /// By how much the count of voxels scatters more than of a smooth body: up to three times of straight tubes along the grid,
    /// half as much of bent ones.
    pub(super) fn thinness(&self) -> f64 {
        1.0 + 2.0 * self.share().sqrt()
    }

    /// What noise may have done to V, for an area.
    pub(super) fn noise_of_volume(&self, area: f64, spacing: Spacing) -> f64 {
        OF_NOISE_IN_VOLUME * self.noise * area * spacing.geometric_mean()
    }

    pub(super) fn flag(&self) -> Option<Flag> {
        let message = format!(
            "the mask is noisy: {} of the {} voxels beside its boundary stand alone on the wrong side of a smooth surface (level {:.3} of a voxel); they \
             are left to the blur, and detail of their size is not told from them; the numbers stand, with longer errors; clean the mask where such \
             voxels are slips",
            self.refused, self.beside, self.noise
        );
        self.noisy.then(|| Flag::new(FlagCode::NoisyMask, message))
    }
}

/// What a random pose does to A and M, as shares of A and of the integral of |H|, and what else corrections leave: in units of
/// the root of the share that the blur would lose, of A; of that share, of M.
const POSES: [f64; 2] = [0.0045, 0.006];
const LEFT: [f64; 2] = [0.018, 0.10];
/// Shares of what the shift to the voxels' volume changes that may be wrong: parts of an object are short of it by more or less.
const OF_SHIFT: [f64; 2] = [0.4, 0.3];
/// Share of that shift's area that goes too far, in units of the share that the blur would lose: thin parts are short of
/// volume at their ends, too.
const TOO_FAR: f64 = 1.7;
/// Shares of A and of the integral of |H| that noise may have added or taken, in units of its level; and where nothing tells
/// noise from the shape, in units of the square of the share that turns as sharply ([`SHARP`]): 1 of thin tubes, of which 1 %
/// of flipped voxels make A 2 to 4 % larger.
const OF_NOISE: f64 = 0.3;
const UNSEEN: f64 = 0.02;
/// The same of V, in units of the level of noise times A and a spacing.
const OF_NOISE_IN_VOLUME: f64 = 0.2;
/// Radius of curvature, in geometric mean spacings, below which a rounded edge and a thin part are not told apart.
const SHARP: f64 = 2.2;
/// Shares of such area that may be missing, and of its integral of |H|, where the rest is not sharp: where rods stand on a
/// body, or holes go into it, a rounded foot stands for a crease.
const OF_EDGES: [f64; 2] = [0.03, 0.04];
/// The same radius of a crease: of smooth bodies, even of thin ones, little is so sharp.
const CREASE: f64 = 1.5;
/// Share of creased area that may be missing on a body that is not sharp elsewhere, as at edges of curved faces.
const OF_CREASES: f64 = 0.33;
/// What is given back of the area that plain edges may have lost, and by how much of what all edges may have lost A may be
/// wrong: a rounded edge of a mask may be one of the object.
const GIVEN_BACK: f64 = 0.25;
const OF_LOST: f64 = 0.55;
/// Share of rounded area that may be edges of small faces by which A may be short: on a large body, and what is added to it in
/// units of the share that is sharp; M may be short of the integral of |H| by somewhat more, as at tips.
const OF_SUSPECTED: [f64; 2] = [0.25, 0.5];
const MEAN_SUSPECTED: f64 = 1.2;
/// What is given back of such area where hollows or the grid tell that it is edges; what is, and by how much that may be wrong,
/// where flat faces along the grid meet, which lie between voxels so that none tells of an edge, and of what acute edges may
/// have lost.
const TOLD: f64 = 0.15;
const GRIDDED: [f64; 2] = [0.12, 0.12];
const ACUTE: [f64; 2] = [0.1, 0.4];
/// Share by which A may be short of the voxels' faces of what looks like a box along the grid, and M, in the same units.
const OF_BOX: f64 = 0.5;
/// Share of the integral of |H| that M may be short of where edges that voxels speak for meet, as at the tip of a cone, in units
/// of the share of A that they have lost.
const MEAN_OVERSHOT: f64 = 0.6;
/// What M is given back there, as a share of what A is.
const MEAN_GIVEN_BACK: f64 = 0.7;
/// Share of the integral of |H| over hollow creases that M may be wrong by: the feet of rods, the bottoms of holes.
const OF_HOLLOW: f64 = 0.45;
/// What is missing there, of A in units of such area and of the integral of |H| in units of the share of such area; both in
/// units of the share that the blur would lose.
const EDGES_LOST: [f64; 2] = [0.45, 0.3];
/// Furthest shift, in geometric mean spacings.
const FURTHEST: f64 = 0.5;

/// The widest blur, in geometric mean spacings, that an object is given back from: detail is a few of them wide, and wider
/// blurs of long voxels take minutes (found by fuzz/).
const MOST_SIGMA: f64 = 12.0;

/// Refuses what would take too long to be given back.
pub(super) fn check_recoverable(setup: &Setup) -> Result<(), MeasureError> {
    let spacing = setup.grid.spacing().geometric_mean();
    let value = setup.parameters.sigma_mm.unwrap_or_default();
    let voxels = value / spacing;
    if voxels > MOST_SIGMA {
        return Err(MeasureError::TooWide { name: "sigma", value, voxels, spacing, most: MOST_SIGMA });
    }
    Ok(())
}

impl Recovered {
    /// By the mesh of phi = 0: a band is wider than thin parts.
    pub(super) fn new(
        summary: RecoverySummary,
        surface: &Surface,
        grid: &Grid,
        errors: Option<ErrorModel>,
    ) -> Self {
        let spacing = grid.spacing();
        let mesh = &surface.mesh;
        let areas = mesh.vertex_areas();
        let area: f64 = areas.iter().sum();
        let sharpest = 1.0 / (SHARP * spacing.geometric_mean());
        let vertices = || areas.iter().zip(&surface.vertices);
        let curvature = vertices().map(|(a, v)| a * v.curvature.mean_curvature.abs());
        let sharp = vertices().filter(|(_, v)| v.curvature.larger() > sharpest);
        let of_sharp = |(a, v): (&f64, &VertexGeometry)| {
            let creased = v.curvature.larger() > SHARP / CREASE * sharpest;
            [*a, a * v.curvature.mean_curvature.abs(), if creased { *a } else { 0.0 }]
        };
        let [sharp_area, sharp_mean_curvature, creased_area] =
            sharp.map(of_sharp).fold([0.0; 3], |sum, one| std::array::from_fn(|n| sum[n] + one[n]));
        let surface = Mesh {
            volume: mesh.volume(),
            area,
            total_mean_curvature: mesh.total_mean_curvature(),
            euler_characteristic: mesh.euler_characteristic() as f64,
            absolute_mean_curvature: curvature.sum(),
            sharp_area,
            sharp_mean_curvature,
            creased_area,
            creases: Creases::of(surface, &areas, grid),
        };
        Self {
            summary,
            surface: (area > 0.0).then_some(surface),
            variance_of_volume: errors
                .map_or(0.0, |errors| errors.variance_of_volume(&Spectrum::of_mesh(mesh, grid))),
        }
    }

    /// Area of the faces along the grid, by axis, mm^2.
    pub(super) fn faces(&self) -> [f64; 3] {
        self.surface.map(|mesh| mesh.creases.faces).unwrap_or_default()
    }

    /// A, M and M / A of the object, and their standard errors: of the surface parallel to the mesh that has the voxels' volume.
    /// On thin parts phi = 0 passes by the outermost centres, and so too far in. `lost_still` are the area and the integral of H of
    /// what phi has on the wrong side in spite of corrections.
    pub(super) fn results(
        &self,
        volume: f64,
        spacing: Spacing,
        sigma: f64,
        noise: SamplingNoise,
        lost_still: [f64; 2],
    ) -> Option<[SurfaceValues; 2]> {
        let mesh = self.surface?;
        let most = FURTHEST * spacing.geometric_mean();
        let shift = ((volume - mesh.volume) / mesh.area).clamp(-most, most);
        // Steiner's formulas.
        let gaussian = TAU * mesh.euler_characteristic;
        let [of_area, of_mean] =
            [2.0 * mesh.total_mean_curvature * shift + gaussian * shift * shift, gaussian * shift];
        let lost = self.summary.share();
        let edges = mesh.edges();
        let given_back = mesh.given_back();
        let area = mesh.area
            + of_area * (1.0 - TOO_FAR * lost).max(0.0)
            + EDGES_LOST[0] * lost * edges
            + given_back[0];
        let of_edge = EDGES_LOST[1] * lost * edges / mesh.area * mesh.absolute_mean_curvature;
        let mean = mesh.total_mean_curvature + of_mean + of_edge + given_back[1];
        // A surface that voxels happen to make larger is a parallel one, too.
        let too_large = noise.moved() / mesh.area;
        let sampled = [2.0 * mesh.total_mean_curvature * too_large, gaussian * too_large];
        let terraces = left_of_terraces(spacing, sigma);
        let of_pose = self.errors_of_pose(&mesh, [of_area, of_mean], sampled, terraces);
        let [edges_of_area, edges_of_mean] = mesh.errors_of_edges();
        // What was taken for noise is left to the blur, and not missing.
        let [left_of_area, left_of_mean] = if self.summary.noisy { [0.0; 2] } else { lost_still };
        let of_lost = [
            of_all(&[edges_of_area, noise.faces_of_area, left_of_area]),
            libm::hypot(edges_of_mean, left_of_mean),
        ];
        let [area_error, mean_error] = [0, 1].map(|n| libm::hypot(of_pose[n], of_lost[n]));
        // What edges and detail lose of A says nothing of M.
        let average_error =
            libm::hypot(of_average([area, mean], of_pose, SHARED), of_average([area, mean], of_lost, 0.0));
        let of = |area, mean, average| SurfaceValues {
            surface_area_mm2: Some(area),
            total_mean_curvature_mm: Some(mean),
            average_mean_curvature_per_mm: Some(average),
            ..SurfaceValues::default()
        };
        Some([of(area, mean, mean / area), of(area_error, mean_error, average_error)])
    }

    /// Errors of A and M that hang on where the object lies in the grid, on noise and on the shift, by what the shift changes,
    /// what sampling does to them and what terraces leave.
    fn errors_of_pose(
        &self,
        mesh: &Mesh,
        shift: [f64; 2],
        sampled: [f64; 2],
        terraces: [f64; 2],
    ) -> [f64; 2] {
        let lost = self.summary.share();
        let sharp = mesh.sharp_share();
        let unseen = libm::hypot(OF_NOISE * self.summary.noise, UNSEEN * sharp * sharp);
        let left = [LEFT[0] * lost.sqrt(), LEFT[1] * lost];
        let whole = [mesh.area, mesh.absolute_mean_curvature];
        [0, 1].map(|n| {
            let share = of_all(&[POSES[n], left[n], unseen, terraces[n]]);
            of_all(&[whole[n] * share, OF_SHIFT[n] * shift[n], sampled[n]])
        })
    }
}

impl Mesh {
    fn sharp_share(&self) -> f64 {
        self.sharp_area / self.area
    }

    /// Sharp area that may be edges: where all of it turns so, as of a tube, none is.
    fn edges(&self) -> f64 {
        self.sharp_area * (1.0 - self.sharp_share())
    }

    /// What is given back of A and M where edges were rounded.
    fn given_back(&self) -> [f64; 2] {
        let Creases { plain_area, acute_area, told_area, gridded_area, .. } = self.creases;
        let of_small = TOLD * told_area + GRIDDED[0] * gridded_area;
        let per_area = self.absolute_mean_curvature / self.area;
        [of_small + GIVEN_BACK * plain_area + ACUTE[0] * acute_area, MEAN_GIVEN_BACK * of_small * per_area]
    }

    /// Errors of A and M by edges that a rounded surface may stand for.
    fn errors_of_edges(&self) -> [f64; 2] {
        let rest = 1.0 - self.sharp_share();
        let Creases {
            lost_area, overshot_area, acute_area, suspected_area, gridded_area, boxed_area, ..
        } = self.creases;
        let per_area = self.absolute_mean_curvature / self.area;
        let suspected = (OF_SUSPECTED[0] + OF_SUSPECTED[1] * self.sharp_share()) * suspected_area;
        [
            of_all(&[
                OF_EDGES[0] * self.sharp_area * rest,
                OF_CREASES * self.creased_area * rest.powi(5),
                OF_LOST * lost_area,
                suspected,
                GRIDDED[1] * gridded_area,
                OF_BOX * boxed_area,
                ACUTE[1] * acute_area,
            ]),
            of_all(&[
                OF_EDGES[1] * self.sharp_mean_curvature * rest,
                OF_HOLLOW * self.creases.hollow_mean_curvature,
                MEAN_SUSPECTED * suspected * per_area,
                GRIDDED[1] * gridded_area * per_area,
                OF_BOX * boxed_area * per_area,
                ACUTE[1] * acute_area * per_area,
                MEAN_OVERSHOT * overshot_area * per_area,
            ]),
        ]
    }
}

/// What independent causes add up to.
fn of_all(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |all, &one| libm::hypot(all, one))
}
