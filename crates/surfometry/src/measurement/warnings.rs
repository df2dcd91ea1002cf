//! Which warnings follow from the numbers.

use super::EmbeddingKind;
use crate::accuracy::{Flag, FlagCode, mm_text, place_text, thick_slices};
use crate::integrals::Integrals;
use crate::surface::SurfaceSummary;
use crate::volume::Spacing;

/// A narrow place, and how much of the band lies in such.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NarrowPlace {
    /// Share of the band's voxels.
    pub(super) share: f64,
    /// The narrowest, in the world (RAS), mm.
    pub(super) position_mm: [f64; 3],
}

/// What flags are raised from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Evidence {
    /// Voxel spacing.
    pub(super) spacing: Spacing,
    /// How the object became a field.
    pub(super) embedding: EmbeddingKind,
    /// Whether the voxels are corrected, so that thin parts are there.
    pub(super) recovering: bool,
    /// Blur in mm, for the Gaussian embedding.
    pub(super) sigma: Option<f64>,
    /// Band thickness in mm.
    pub(super) thickness: f64,
    /// Half-width eps of the delta.
    pub(super) epsilon: f64,
    /// Smallest |phi| at which the field saturates.
    pub(super) saturation: f64,
    /// Volume by counting voxels, or by adding up what a soft segmentation says of them, mm^3.
    pub(super) voxel_volume: f64,
    /// Exact Euler characteristic of the voxels' surface.
    pub(super) voxel_euler: i64,
    /// Where the object, and where the gaps in it, are so narrow that the blurred edges of both sides meet in
    /// the band.
    pub(super) narrow: [Option<NarrowPlace>; 2],
    /// Of a surface that is open where the image cuts the object, the curvature of its boundary
    /// (Gauss-Bonnet).
    pub(super) boundary_curvature: Option<f64>,
    /// Volume for the original object, mm^3.
    pub(super) compensated_volume: Option<f64>,
    /// The plain integrals; `None` where nothing is inside the level set.
    pub(super) plain: Option<Integrals>,
    /// The surface as a mesh, where there is one.
    pub(super) mesh: Option<SurfaceSummary>,
}

/// Largest distance of chi from an even integer that passes.
const EULER_TOLERANCE: f64 = 0.15;
/// Thickness in units of the largest spacing below which the delta is undersampled.
const SAMPLED_THICKNESS: f64 = 2.5;
/// Thickness in units of sigma below which parts of an object suffer.
const THIN: f64 = 3.0;
/// Relative difference of compensated and counted volume that says the blur took parts away for good.
const VOLUME_TOLERANCE: f64 = 0.03;
/// Relative difference of compensated and counted volume beyond which compensation has failed.
const FAILED_VOLUME: f64 = 0.25;
/// Relative difference of the band's and the mesh's area from which the band averages over more than one
/// surface. On smooth shapes of 10 voxels' radius it is 0.3 %, of 5 voxels 3.6 %.
const MESH_TOLERANCE: f64 = 0.05;
/// Share of the area along the grid from which on flat faces are told of. The terraces at the poles of a ball
/// are up to 1.5 % after the plain blur, and 2.5 % in the corrected embedding at sigma = 2 voxels.
const FLAT_SHARE: f64 = 0.03;
/// The same of the recovering embedding, which keeps the terraces of what is nearly flat: thick slices have up to 0.4, boxes along the grid 0.53 and more.
pub(super) const FLAT_SHARE_RECOVERED: f64 = 0.5;
/// Thickness in units of sigma beyond which the corrected embedding's integrals are biased (at 2.5 by 12 % in
/// V).
const CORRECTED_THICKNESS: f64 = 1.6;
/// Share of the band's voxels in narrow places from which on they are told of.
const NARROW_SHARE: f64 = 0.005;
/// Least sigma, in largest spacings, at which narrow places can be told from steps between slices.
const NARROW_SIGMA: f64 = 1.2;
/// Share of the saturation from which on the band is said to leave the blurred edge.
const SATURATED_SHARE: f64 = 0.98;

/// What helps where a blur took something away.
pub(super) const RECOVER: &str = "the recovering embedding keeps it, which a measurement that is free to choose takes by itself unless its numbers would be less certain";
/// Voxels below which an object has no shape to speak of: such are not measured again either.
const FEW_VOXELS: f64 = 30.0;
/// Sigma in voxels beyond which it was chosen for another spacing, as the paper's in mm.
const WIDE_BLUR: f64 = 4.0;

/// The warnings that follow from the numbers.
pub(super) fn raise_flags(e: &Evidence) -> Vec<Flag> {
    let rules = [grid_flags, band_flags, topology_flags, shape_flags];
    rules.iter().flat_map(|rule| rule(e)).collect()
}

fn grid_flags(e: &Evidence) -> Vec<Flag> {
    let mut flags = Vec::new();
    let largest = e.spacing.largest();
    // A hair of room for spacings that went through f32.
    let below = |a: f64, b: f64| a < b * (1.0 - 1e-5);
    if let Some(sigma) = e.sigma.filter(|&s| below(s, largest)) {
        flags.push(Flag::new(
            FlagCode::SigmaBelowSpacing,
            format!(
                "sigma {} mm is less than the largest spacing {} mm: the blur is undersampled along that axis, so area, curvature and chi carry grid noise",
                mm_text(sigma, 4),
                mm_text(largest, 4)
            ),
        ));
    }
    let sampled = SAMPLED_THICKNESS * largest;
    // Of a recovered object nothing is summed over a band.
    if below(e.thickness, sampled) && !e.recovering {
        let cure = match e.sigma {
            // A band of 4.5 sigma reaches the flat ends of the blurred edge.
            Some(sigma) if sampled > 4.45 * sigma => {
                format!("sigma {} mm or more, and an automatic thickness", mm_text(largest, 3))
            }
            _ => format!("a thickness of {} mm", mm_text(sampled, 4)),
        };
        let message = format!(
            "the band is {} mm thick, less than 2.5 x the largest spacing: the delta is undersampled, area and chi are \
             unreliable; use {cure}",
            mm_text(e.thickness, 4)
        );
        flags.push(Flag::new(FlagCode::ThicknessBelowSpacing, message));
    }
    flags.extend(thick_slices(e.spacing));
    flags
}

/// Where more than some share of a surface lies along the grid: faces by axis and all of the area, mm^2.
pub(super) fn flat_faces(faces: [f64; 3], area: f64, least: f64) -> Option<Flag> {
    let flat = faces.iter().sum::<f64>() / area;
    let message = || {
        format!(
            "{:.1} % of the surface lies flat along the voxels, as where an image or a cut ends the object: where such a face is, is known to a \
             part of a voxel only (it is in the standard errors), and it adds a rim of curvature",
            100.0 * flat
        )
    };
    (flat > least).then(|| Flag::new(FlagCode::FlatFaces, message()))
}

fn band_flags(e: &Evidence) -> Vec<Flag> {
    if e.recovering {
        return Vec::new();
    }
    if e.plain.is_none() && e.boundary_curvature.is_some() && e.voxel_volume == 0.0 {
        let message = "no voxel of the object lies 3 sigma away from the faces that cut it, so there is nothing to measure between them; use \
                       a flat cap, or a smaller sigma";
        return vec![Flag::new(FlagCode::NothingBetweenCuts, message)];
    }
    if e.plain.is_none() {
        return vec![Flag::new(FlagCode::SurfaceVanished, e.vanished())];
    }
    let Some(plain) = e.with_surface() else {
        let message = if e.sigma.is_some() {
            "no voxel with a normal lies in the band, so the surface integrals are null: band or blur are too thin for this grid; use a \
             larger sigma, and an automatic thickness"
        } else {
            "no voxel with a normal lies in the band, so the surface integrals are null: the band is too thin for this grid, or the field \
             jumps over it; use an automatic thickness, and a field that is smooth at its zero level"
        };
        return vec![Flag::new(FlagCode::EmptyBand, message)];
    };
    let mut flags = Vec::new();
    if e.epsilon >= SATURATED_SHARE * e.saturation {
        let message =
            "the band reaches where the blurred edge is flat; use a smaller thickness or a larger sigma";
        flags.push(Flag::new(FlagCode::ThicknessAboveBlur, message));
    }
    let mean_thickness = 2.0 * plain.volume.min(e.voxel_volume) / plain.surface.area;
    if e.thickness > mean_thickness {
        let message = format!(
            "the band is {} mm thick, more than the object's mean thickness 2 V / A = {} mm: volume and \
             area average over it; use a smaller thickness or a finer image",
            mm_text(e.thickness, 4),
            mm_text(mean_thickness, 4)
        );
        flags.push(Flag::new(FlagCode::ThicknessAboveObject, message));
    }
    flags.extend(mesh_flag(e, &plain));
    if e.embedding.is_corrected() && e.sigma.is_some_and(|sigma| e.thickness > CORRECTED_THICKNESS * sigma) {
        let message = format!(
            "the band is {} mm thick, more than 1.6 sigma, where the corrected field is no longer steep: its integrals are biased; use \
             the Gaussian embedding, whose numbers have no such limit, or a larger sigma",
            mm_text(e.thickness, 4)
        );
        flags.push(Flag::new(FlagCode::CorrectedBand, message));
    }
    flags.extend(e.sigma.and_then(|_| flat_faces(plain.faces, plain.surface.area, FLAT_SHARE)));
    if plain.voxels_without_normal > 0 {
        let message = format!(
            "the gradient collapses at {} voxel(s) of the band (less than 5 % of a flat surface's), as half-way through thin \
             parts; they are left out of the surface integrals",
            plain.voxels_without_normal
        );
        flags.push(Flag::new(FlagCode::VanishingGradient, message));
    }
    flags
}

/// Where the band is sampled well, it and the mesh can only differ because it covers more than one surface.
/// (An open mesh of a given field ends at voxel centres, and the band at their faces.)
fn mesh_flag(e: &Evidence, plain: &Integrals) -> Option<Flag> {
    let mesh = e.mesh?;
    let (inside, sampled) =
        (mesh.volume?, e.thickness >= SAMPLED_THICKNESS * e.spacing.largest() * (1.0 - 1e-5));
    let (area, volume) = (plain.surface.area / mesh.area - 1.0, plain.volume / inside - 1.0);
    let differs = area.abs() > MESH_TOLERANCE || volume.abs() > 2.0 * MESH_TOLERANCE;
    let message = format!(
        "the band gives {:+.1} % in area and {:+.1} % in volume against the surface as a mesh ({:.6} mm2, {inside:.6} mm3): parts \
         are thin or tightly curved against the band; leave out a sigma that was chosen, or take a finer image",
        100.0 * area,
        100.0 * volume,
        mesh.area
    );
    (e.sigma.is_some() && sampled && differs).then(|| Flag::new(FlagCode::BandDiffersFromMesh, message))
}

fn topology_flags(e: &Evidence) -> Vec<Flag> {
    let Some(plain) = e.with_surface() else { return Vec::new() };
    let chi = plain.surface.total_gaussian_curvature / std::f64::consts::TAU;
    if let Some(boundary) = e.boundary_curvature {
        return open_topology_flags(e, chi + boundary / std::f64::consts::TAU);
    }
    let voxels = e.voxel_euler;
    let mesh = e.mesh.map_or_else(String::new, |m| format!(" and the mesh's {}", m.euler_characteristic()));
    if e.embedding.is_distance() {
        let message = format!(
            "distances between voxels are quantised, so curvature from them is noise and the Euler characteristic \
             {chi:.1} meaningless (the voxels' is {voxels}{mesh}); use the Gaussian embedding"
        );
        return vec![Flag::new(FlagCode::DistanceQuantised, message)];
    }
    // Adding 0 turns -0 into 0.
    let even = 2.0 * (chi / 2.0).round() + 0.0;
    // The band of a recovered object is wider than what was recovered, and none of its numbers comes from it.
    let near = (chi - even).abs() <= EULER_TOLERANCE || e.recovering;
    let mut flags = Vec::new();
    if !near {
        let message = format!(
            "the Euler characteristic {chi:.3} is not near an even integer (a closed surface's is even): grid noise, \
             or the topology changes inside the band; the voxels' is {voxels}{mesh}"
        );
        flags.push(Flag::new(FlagCode::EulerNotInteger, message));
    }
    let of_mesh = e.mesh.map(|mesh| mesh.euler_characteristic());
    if let Some(of_mesh) = of_mesh.filter(|of_mesh| *of_mesh != voxels) {
        let message = if e.embedding == EmbeddingKind::Given {
            format!(
                "the Euler characteristic of the field's zero level is {of_mesh}, that of the voxels inside it {voxels}: between voxels the \
                 field joins or parts what their corners and edges do not"
            )
        } else {
            format!(
                "the Euler characteristic of the blurred surface is {of_mesh}, the voxels' {voxels}: the blur closed or opened handles, \
                 cavities or bridges"
            )
        };
        flags.push(Flag::new(FlagCode::EulerDiffersFromVoxels, message));
    } else if near && even != voxels as f64 && !e.recovering {
        let message = format!(
            "the Euler characteristic is near {even}, the voxels' is {voxels}{mesh}: noise that lies near an even number, as where the grid \
             is coarse for sigma or the object thin"
        );
        flags.push(Flag::new(FlagCode::EulerDiffersFromVoxels, message));
    }
    flags
}

/// Of an open surface, whose Euler characteristic is any whole number; the voxels have none that compares.
fn open_topology_flags(e: &Evidence, chi: f64) -> Vec<Flag> {
    let Some(mesh) = e.mesh.map(|mesh| mesh.euler_characteristic()) else { return Vec::new() };
    if (chi - mesh as f64).abs() <= EULER_TOLERANCE {
        return Vec::new();
    }
    let message = format!(
        "the Euler characteristic {chi:.3} of the open surface, its boundary included, is not the mesh's {mesh}: grid noise, the topology \
         changes inside the band, or the surface touches a cut"
    );
    vec![Flag::new(FlagCode::EulerNotInteger, message)]
}

fn shape_flags(e: &Evidence) -> Vec<Flag> {
    let (Some(sigma), Some(plain)) = (e.sigma, e.with_surface()) else { return Vec::new() };
    let mut flags = Vec::new();
    if e.recovering {
        return flags;
    }
    let (thickness, thin) = (2.0 * plain.volume / plain.surface.area, THIN * sigma);
    let off = e.compensated_volume.map_or(0.0, |v| v / e.voxel_volume - 1.0);
    let (least, cure) = (mm_text(thin, 3), e.cure_of_blur());
    if thickness < thin {
        let thickness = mm_text(thickness, 3);
        let message = format!(
            "the mean thickness 2 V / A = {thickness} mm is below 3 sigma = {least} mm: compensation is incomplete and \
             thin parts may be gone; {cure}"
        );
        flags.push(Flag::new(FlagCode::ThinForSigma, message));
    } else if off.abs() > VOLUME_TOLERANCE {
        let message = format!(
            "the original's volume is {:+.1} % off the voxels': parts thinner than about 3 sigma = {least} mm are \
             affected; {cure}",
            100.0 * off
        );
        flags.push(Flag::new(FlagCode::ThinForSigma, message));
    }
    flags.extend(narrow_flags(e, sigma, &flags));
    if e.compensation_failed() {
        let message = format!(
            "the blur took {:.0} % of the volume away and the original's volume would be {:+.0} % off the voxels', so the original's numbers are \
             null: sigma is too large for this object, and what is gone cannot be compensated; {cure}",
            100.0 * (1.0 - plain.volume / e.voxel_volume),
            100.0 * off
        );
        flags.push(Flag::new(FlagCode::CompensationFailed, message));
    }
    flags
}

/// Of parts and gaps in which the edges of both sides meet; parts only where nothing else was said of them.
fn narrow_flags(e: &Evidence, sigma: f64, so_far: &[Flag]) -> Vec<Flag> {
    // The steps between slices that sigma does not smooth look the same.
    if sigma < NARROW_SIGMA * e.spacing.largest() {
        return Vec::new();
    }
    let told = so_far.iter().any(|flag| flag.code == FlagCode::ThinForSigma);
    let [part, gap] = e.narrow.map(|place| place.filter(|place| place.share > NARROW_SHARE));
    let about = |place: NarrowPlace| {
        format!(
            "less than about 2.4 sigma = {} mm wide ({:.1} % of the band, the narrowest at {})",
            mm_text(2.4 * sigma, 3),
            100.0 * place.share,
            place_text(place.position_mm, e.spacing.smallest())
        )
    };
    let thin = part.filter(|_| !told).map(|place| {
        let message = format!(
            "parts are {}: the blur thins or removes them and compensation is incomplete there; {}",
            about(place),
            e.cure_of_blur()
        );
        Flag::new(FlagCode::ThinForSigma, message)
    });
    let narrow = gap.map(|place| {
        let message = format!(
            "gaps are {}: the blur fills them in part and compensation is incomplete there; {}",
            about(place),
            e.cure_of_blur()
        );
        Flag::new(FlagCode::NarrowGap, message)
    });
    thin.into_iter().chain(narrow).collect()
}

impl Evidence {
    /// The plain integrals where there is a surface.
    fn with_surface(&self) -> Option<Integrals> {
        self.plain.filter(Integrals::has_surface)
    }

    /// What helps where the blur took something away. A smaller sigma would leave the voxels' stairs in the numbers.
    fn cure_of_blur(&self) -> &'static str {
        match self.embedding {
            EmbeddingKind::Gaussian | EmbeddingKind::Corrected if self.boundary_curvature.is_none() => {
                RECOVER
            }
            _ => "use a smaller sigma",
        }
    }

    /// What is said of an object without a surface.
    fn vanished(&self) -> String {
        let voxels = self.voxel_volume / self.spacing.cell_volume();
        if voxels < FEW_VOXELS {
            return format!(
                "nothing is left inside the level set, so the integrals are null: an object of fewer than {FEW_VOXELS} voxels (this one \
                 has {voxels:.0}) has no surface that can be measured at this spacing; scan finer"
            );
        }
        let wide = self.sigma.map(|sigma| (sigma, sigma / self.spacing.geometric_mean()));
        let wide = wide.filter(|(_, wide)| *wide > WIDE_BLUR).map_or_else(String::new, |(sigma, wide)| {
            format!(" (sigma is {} mm, {wide:.0} voxels wide)", mm_text(sigma, 4))
        });
        format!(
            "nothing is left inside the level set at this sigma and level{wide}, so the integrals are null; {}",
            self.cure_of_blur()
        )
    }

    /// Whether compensation gave a volume that the voxels contradict.
    pub(super) fn compensation_failed(&self) -> bool {
        self.compensated_volume.is_some_and(|v| (v / self.voxel_volume - 1.0).abs() > FAILED_VOLUME)
    }
}
