//! Warnings that travel with a result.

use crate::volume::Spacing;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What can be doubtful about a result; each is explained in docs/flags.md.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
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
    /// The image's axes are not perpendicular.
    ShearedGrid,
    /// The band reaches where the blurred field saturates.
    ThicknessAboveBlur,
    /// The Gauss-Bonnet characteristic is far from an even integer.
    EulerNotInteger,
    /// The mesh of the blurred surface has another Euler characteristic than the voxels; without a mesh, Gauss and Bonnet's is near
    /// another even integer.
    EulerDiffersFromVoxels,
    /// The object is cut so that nothing of it is left between the cuts.
    NothingBetweenCuts,
    /// The blur removed the object.
    SurfaceVanished,
    /// No voxel lies in the band.
    EmptyBand,
    /// The band is thicker than the object.
    ThicknessAboveObject,
    /// The band's area is not the mesh's.
    BandDiffersFromMesh,
    /// Compensation gave what the voxels contradict.
    CompensationFailed,
    /// Parts of the object are thinner than about 3 sigma.
    ThinForSigma,
    /// Gaps between parts of the object are narrower than about 2.4 sigma.
    NarrowGap,
    /// The blur took detail away, or filled gaps, for good.
    DetailLost,
    /// The mask has voxels that look like noise.
    NoisyMask,
    /// The standard error of the area is more than 2 % of it.
    LargeError,
    /// Compensation is not defined for these parameters.
    CompensationUndefined,
    /// The distance embedding is quantised: its curvature is noise.
    DistanceQuantised,
    /// A noticeable share of the surface lies flat along the grid.
    FlatFaces,
    /// The band of a corrected embedding is too thick for its blur.
    CorrectedBand,
    /// The gradient collapses at band voxels.
    VanishingGradient,
    /// The edges of a soft segmentation are softer than voxels make them.
    SofterThanVoxels,
    /// The surface leaves a given field through the image's edge.
    SurfaceLeavesField,
    /// The phantom's exact integrals could not be had.
    TruthNotConverged,
    /// The header names two different spacings.
    SpacingConflict,
    /// The file holds more than its header needs.
    SurplusData,
    /// The image has so many values, so mixed, that they are more likely grey values than labels.
    GreyValues,
    /// An image beside the input does not tell all of the object, or is doubtful itself.
    ImageBeside,
    /// The surface that is mapped at scales of its own is not quite the one that was measured.
    MapDiffersFromObject,
    /// Pieces beside the largest were left out, as was asked.
    PiecesDropped,
    /// Cavities were filled, as was asked.
    CavitiesFilled,
}

impl fmt::Display for FlagCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// A warning: a code for machines and a sentence for people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
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

/// Spacing ratio above which slices count as thick.
const THICK_SLICE_RATIO: f64 = 1.8;

/// The warning of slices that are much thicker than the pixels are wide.
pub(crate) fn thick_slices(spacing: Spacing) -> Option<Flag> {
    let (smallest, largest) = (spacing.smallest(), spacing.largest());
    // A hair of room for spacings that went through f32.
    let thick = THICK_SLICE_RATIO * smallest < largest * (1.0 - 1e-5);
    thick.then(|| {
        Flag::new(
            FlagCode::ThickSlices,
            format!(
                "the largest spacing is {:.2} times the smallest: the mask is stair-stepped along one axis, which no smoothing at this scale \
                 removes; the numbers stand, with longer errors, and maps of curvature show the steps; only thinner slices tell more",
                largest / smallest
            ),
        )
    })
}

/// A place in the world, to a tenth of a voxel.
pub(crate) fn place_text(position_mm: [f64; 3], finest_mm: f64) -> String {
    let decimals = decimals_for(finest_mm);
    let [x, y, z] = position_mm.map(|v| format!("{v:.decimals$}"));
    format!("({x}, {y}, {z}) mm")
}

/// A length or an area with so many decimals, or four significant digits where these would leave fewer.
pub(crate) fn mm_text(length: f64, decimals: usize) -> String {
    format!("{length:.*}", if length < 0.1 { decimals_for(length) + 2 } else { decimals })
}

/// Decimals that tell tenths of a voxel apart.
pub(crate) fn decimals_for(finest_mm: f64) -> usize {
    (1.0 - libm::floor(libm::log10(finest_mm))).clamp(0.0, 9.0) as usize
}
