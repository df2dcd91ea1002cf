//! Warnings that travel with a result.

use crate::volume::Spacing;
use serde::Serialize;
use std::fmt;

/// What can be doubtful about a result; each is explained in docs/flags.md.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum FlagCode {
    /// Fields of the record that this version leaves null.
    NotComputed,
    /// The object has voxels in the image's first or last slice of an axis.
    TouchesBorder,
    /// sigma is below the largest spacing.
    SigmaBelowSpacing,
    /// t is below 2.5 times the largest spacing.
    ThicknessBelowSpacing,
    /// The largest spacing is more than 1.8 times the smallest.
    ThickSlices,
    /// The band reaches where the blurred field saturates.
    ThicknessAboveBlur,
    /// The Gauss-Bonnet characteristic is far from an even integer.
    EulerNotInteger,
    /// The Gauss-Bonnet characteristic is near another even integer than the voxels'.
    EulerDiffersFromVoxels,
    /// The blur removed the object.
    SurfaceVanished,
    /// Parts of the object are thinner than about 3 sigma.
    ThinForSigma,
    /// Compensation is not defined for these parameters.
    CompensationUndefined,
    /// The distance embedding is quantised: its curvature is noise.
    DistanceQuantised,
    /// The gradient vanishes at band voxels.
    VanishingGradient,
    /// The surface leaves a given field through the image's edge.
    SurfaceLeavesField,
    /// The phantom's exact integrals could not be had.
    TruthNotConverged,
    /// The header names two different spacings.
    SpacingConflict,
}

impl fmt::Display for FlagCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// A warning: a code for machines and a sentence for people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Flag {
    /// Which.
    pub code: FlagCode,
    /// What was seen and what to do.
    pub message: String,
}

impl Flag {
    /// A flag.
    pub fn new(code: FlagCode, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }
}

/// What flags are raised from.
#[derive(Debug, Clone, Copy)]
pub struct Evidence {
    /// Voxel spacing.
    pub spacing: Spacing,
    /// Whether the embedding is the distance.
    pub distance: bool,
    /// Blur in mm, for the Gaussian embedding.
    pub sigma: Option<f64>,
    /// Band thickness in mm, where known.
    pub thickness: Option<f64>,
    /// Half-width eps of the delta.
    pub epsilon: f64,
    /// Smallest |phi| at which the field saturates.
    pub saturation: f64,
    /// Volume by counting voxels, mm^3.
    pub voxel_volume: f64,
    /// Exact Euler characteristic of the voxels' surface.
    pub voxel_euler: i64,
    /// Volume for the original object, mm^3.
    pub compensated_volume: Option<f64>,
    /// Plain volume, area, Euler characteristic; `None` if the surface vanished.
    pub plain: Option<(f64, f64, f64)>,
    /// Band voxels without a normal.
    pub voxels_without_normal: u64,
}

/// Largest distance of chi from an even integer that passes.
const EULER_TOLERANCE: f64 = 0.25;
/// Spacing ratio above which slices count as thick.
const THICK_SLICE_RATIO: f64 = 1.8;
/// Thickness in units of the largest spacing below which the delta is undersampled.
const SAMPLED_THICKNESS: f64 = 2.5;
/// Thickness in units of sigma below which parts of an object suffer.
const THIN: f64 = 3.0;
/// Relative difference of compensated and counted volume that says the blur took parts away for good.
const VOLUME_TOLERANCE: f64 = 0.03;
/// Share of the saturation from which on the band is said to leave the blurred edge.
const SATURATED_SHARE: f64 = 0.98;

/// The warnings that follow from the numbers.
pub fn raise_flags(e: &Evidence) -> Vec<Flag> {
    let rules = [grid_flags, band_flags, topology_flags, shape_flags];
    rules.iter().flat_map(|rule| rule(e)).collect()
}

fn grid_flags(e: &Evidence) -> Vec<Flag> {
    let mut flags = Vec::new();
    let (smallest, largest) = (e.spacing.smallest(), e.spacing.largest());
    // A hair of room for spacings that went through f32.
    let below = |a: f64, b: f64| a < b * (1.0 - 1e-5);
    if let Some(sigma) = e.sigma.filter(|&s| below(s, largest)) {
        flags.push(Flag::new(
            FlagCode::SigmaBelowSpacing,
            format!("sigma {sigma:.4} mm is less than the largest spacing {largest:.4} mm: the blur is undersampled along that axis, so area, curvature and chi carry grid noise"),
        ));
    }
    if let Some(thickness) = e.thickness.filter(|&t| below(t, SAMPLED_THICKNESS * largest)) {
        flags.push(Flag::new(
            FlagCode::ThicknessBelowSpacing,
            format!("thickness {thickness:.4} mm is less than 2.5 x the largest spacing ({:.4} mm): the delta is undersampled, area and chi are unreliable; use --thickness auto", SAMPLED_THICKNESS * largest),
        ));
    }
    if below(THICK_SLICE_RATIO * smallest, largest) {
        flags.push(Flag::new(
            FlagCode::ThickSlices,
            format!("the largest spacing is {:.2} times the smallest: the mask is stair-stepped along one axis, which no smoothing at this scale removes", largest / smallest),
        ));
    }
    flags
}

fn band_flags(e: &Evidence) -> Vec<Flag> {
    let mut flags = Vec::new();
    if e.epsilon >= SATURATED_SHARE * e.saturation {
        flags.push(Flag::new(
            FlagCode::ThicknessAboveBlur,
            "the band reaches where the blurred edge is flat; choose a smaller --thickness or a larger --sigma".to_owned(),
        ));
    }
    if e.voxels_without_normal > 0 {
        flags.push(Flag::new(
            FlagCode::VanishingGradient,
            format!(
                "the gradient vanishes at {} voxels of the band, which are left out of the surface integrals",
                e.voxels_without_normal
            ),
        ));
    }
    flags
}

fn topology_flags(e: &Evidence) -> Vec<Flag> {
    let Some((_, _, chi)) = e.plain else { return Vec::new() };
    let voxels = e.voxel_euler;
    if e.distance {
        let message = format!(
            "distances between voxels are quantised, so curvature from them is noise and the Euler characteristic \
             {chi:.1} meaningless (the voxels' is {voxels}); use --embedding gaussian"
        );
        return vec![Flag::new(FlagCode::DistanceQuantised, message)];
    }
    // Adding 0 turns -0 into 0.
    let even = 2.0 * (chi / 2.0).round() + 0.0;
    if (chi - even).abs() > EULER_TOLERANCE {
        let message = format!(
            "the Euler characteristic {chi:.3} is not near an even integer (a closed surface's is even): grid noise, \
             or the topology changes inside the band; the voxels' is {voxels}"
        );
        return vec![Flag::new(FlagCode::EulerNotInteger, message)];
    }
    if even != voxels as f64 {
        let message = format!(
            "the smooth surface has Euler characteristic {even}, the voxels' surface {voxels}: handles, cavities or \
             bridges differ, mostly small ones that the blur closed or opened"
        );
        return vec![Flag::new(FlagCode::EulerDiffersFromVoxels, message)];
    }
    Vec::new()
}

fn shape_flags(e: &Evidence) -> Vec<Flag> {
    let (Some(sigma), Some((volume, area, _))) = (e.sigma, e.plain) else { return Vec::new() };
    let thickness = 2.0 * volume / area;
    let lost = e.compensated_volume.map(|v| v / e.voxel_volume - 1.0);
    if thickness < THIN * sigma {
        vec![Flag::new(
            FlagCode::ThinForSigma,
            format!(
                "the mean thickness 2 V / A = {thickness:.3} mm is below 3 sigma = {:.3} mm: compensation is incomplete and thin parts may be gone; use a smaller --sigma",
                THIN * sigma
            ),
        )]
    } else if let Some(lost) = lost.filter(|l| l.abs() > VOLUME_TOLERANCE) {
        vec![Flag::new(
            FlagCode::ThinForSigma,
            format!(
                "the compensated volume is {:+.1} % off the voxels': parts thinner than about 3 sigma = {:.3} mm are affected; use a smaller --sigma",
                100.0 * lost,
                THIN * sigma
            ),
        )]
    } else {
        Vec::new()
    }
}
