//! Choices, checked and filled in for a grid.

use super::{Clip, Measurement};
use crate::accuracy::{
    auto_sigma, auto_thickness, auto_thickness_of_blur, epsilon_of_blur, thickness_of_blur,
};
use crate::choice::choices;
use crate::embedding::{EdgeProfile, TRUNCATION, TRUNCATION_OF_BLUR};
use crate::integrals::{QuadratureRule, Smearing};
use crate::local_geometry::MatchedDifferences;
use crate::text::number;
use crate::tiling::IndexBox;
use crate::volume::{Spacing, VolumeError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How an object becomes a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EmbeddingKind {
    /// The blurred indicator (the paper).
    #[default]
    Gaussian,
    /// The blurred indicator without the leading shift of its surface: curvature and position of the original
    /// object.
    Corrected,
    /// The same of the mask with sparse corrections, so that every voxel whose sign the blur would lose is on its side again:
    /// thin parts and detail of the original object ([`Recovery`](crate::embedding::Recovery)).
    Recovering,
    /// Signed distance to the voxel faces (the baseline that the paper rejects).
    Distance,
    /// Signed distance that is 0 on the object's boundary voxels, as ITK's: half a voxel inside.
    DistanceToVoxels,
    /// The blurred values of a soft segmentation.
    Probability,
    /// The input is the field.
    Given,
}

choices!(EmbeddingKind, "embedding": {
    Gaussian = "gaussian": "The blurred mask (the paper)",
    Corrected = "corrected": "Two blurs combined so that the surface does not move: local curvature of the original object",
    Recovering = "recovering": "The corrected blur of the mask with few corrections, so that it gives every voxel back: thin parts and detail",
    Distance = "distance": "Signed distance to the voxel faces: the baseline that the paper rejects",
    DistanceToVoxels = "distance-to-voxels": "Signed distance that is zero on the boundary voxels, as ITK's: its surface lies half a voxel inside",
    Probability = "probability": "The input is a soft segmentation, values from 0 to 1, which is blurred",
    Given = "given": "The input is a field phi, negative inside",
});

impl EmbeddingKind {
    /// Whether the field is made by blurring.
    pub fn is_blur(self) -> bool {
        matches!(self, Self::Gaussian | Self::Corrected | Self::Recovering | Self::Probability)
    }

    /// Whether the input is an image of labels, not of values that are one object.
    pub fn is_of_labels(self) -> bool {
        !matches!(self, Self::Probability | Self::Given)
    }

    /// Whether the field is a distance to the mask.
    pub(super) fn is_distance(self) -> bool {
        matches!(self, Self::Distance | Self::DistanceToVoxels)
    }

    /// Whether the blur's leading shift is taken off.
    pub(super) fn is_corrected(self) -> bool {
        matches!(self, Self::Corrected | Self::Recovering)
    }

    /// A flat edge after the blur of an embedding that has one.
    pub(super) fn profile(self, sigma: f64) -> EdgeProfile {
        match self {
            Self::Corrected | Self::Recovering => EdgeProfile::corrected(sigma),
            _ => EdgeProfile::blurred(sigma),
        }
    }
}

/// What lies beyond the edge of a field that is given, so that what the edge cuts is closed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Padding {
    /// The field's own largest value: the background of a blur, 0.5 at level 0.5, or a positive distance.
    Highest,
    /// A positive number, in units of the field.
    Constant(f64),
}

impl Padding {
    pub(super) fn of(self, highest: f64) -> f64 {
        match self {
            Self::Highest => highest,
            Self::Constant(value) => value,
        }
    }
}

/// How the field is differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivatives {
    /// Convolution with derivatives of the Gaussian.
    Gaussian,
    /// Differences matched to the blur's spectrum: the same to 2e-4 in area from sigma = 1.75 voxels on,
    /// several times faster.
    Matched,
    /// Fourth-order differences (the paper).
    FiniteDifference,
}

choices!(Derivatives, "kind of derivatives": {
    Gaussian = "gaussian": "Convolution with derivatives of the Gaussian",
    Matched = "matched": "Differences matched to the blur: the same from sigma = 1.75 voxels on, faster",
    FiniteDifference = "finite-difference": "Fourth-order differences, as in the paper",
});

/// Why a measurement cannot start.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// A parameter out of its range.
    #[error("{name} is {}: it must be {range}", number(*.value))]
    OutOfRange {
        /// Parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Where it must lie.
        range: &'static str,
    },
    /// Parameters that exclude each other.
    #[error("{0}")]
    Conflict(&'static str),
    /// The band would weigh all of space.
    #[error(
        "the band is too wide: epsilon is {}, but at level {} the blurred field is flat from {} on; choose a smaller thickness or \
         epsilon, a larger sigma or a level nearer 0.5",
        number(*.epsilon), number(*.level), number(*.saturation)
    )]
    BandTooWide {
        /// T.
        level: f64,
        /// eps.
        epsilon: f64,
        /// Smallest |phi| far from the surface.
        saturation: f64,
    },
    /// A blur or band so wide, in voxels, that its neighbourhood does not fit in memory.
    #[error(
        "{name} {} mm is {} voxels of {} mm, more than the {most:.0} that can be handled: choose a smaller {name}, or check the spacing",
        number(*.value), number(.voxels.round()), number(*.spacing)
    )]
    TooWide {
        /// Parameter.
        name: &'static str,
        /// Its value, mm.
        value: f64,
        /// The same in voxels.
        voxels: f64,
        /// Smallest spacing, mm.
        spacing: f64,
        /// The most voxels.
        most: f64,
    },
    /// A field too small for shifted differences.
    #[error("the field has {voxels} voxels along axis {axis}; fourth-order differences need at least 6")]
    FieldTooSmall {
        /// Axis.
        axis: usize,
        /// Its voxels.
        voxels: usize,
    },
    /// A field without a gradient at its zero level.
    #[error(
        "the field has no slope where it changes sign, so a thickness has no meaning; give epsilon in the field's units"
    )]
    FlatField,
    /// A band that a given field does not leave.
    #[error(
        "the band is too wide: epsilon is {}, but the field is nowhere above {}, so that all of the background would count; choose a \
         smaller thickness or epsilon",
        number(*.epsilon), number(*.highest)
    )]
    BandAboveField {
        /// eps.
        epsilon: f64,
        /// Largest phi.
        highest: f64,
    },
    /// A box whose voxels do not tell what is to be summed over it.
    #[error(
        "the labels of {given} are given, but what the box adds depends on those of {needed}: give each box the voxels around it too"
    )]
    BoxWithoutHalo {
        /// What is needed.
        needed: IndexBox,
        /// What is there.
        given: IndexBox,
    },
    /// Boxes that do not make up their image.
    #[error(
        "{voxels} voxels of the image were not measured, first of all those of {first}: merge the values of all its boxes"
    )]
    MissingBoxes {
        /// A box that is missing.
        first: IndexBox,
        /// Voxels that are missing in all.
        voxels: usize,
    },
    /// The object or image itself.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

/// The choices that a result was made with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Embedding.
    pub embedding: EmbeddingKind,
    /// Derivatives.
    pub derivatives: Derivatives,
    /// Quadrature.
    pub quadrature: QuadratureRule,
    /// Delta.
    pub delta: Smearing,
    /// Blur, mm; `None` without one.
    pub sigma_mm: Option<f64>,
    /// Band thickness across a flat surface, mm; what eps stands for, where that was given instead.
    pub thickness_mm: f64,
    /// Level T; `None` without a blur.
    pub level: Option<f64>,
    /// Half-width of the delta in units of phi.
    pub epsilon: f64,
    /// What was done where the edge of the image cuts an object.
    pub clip: Clip,
    /// What lies beyond the edge of a given field, in its units; `None` where it ends there, and without one.
    pub padding: Option<f64>,
}

impl Measurement {
    /// Whether objects must be known as wholes before anything can be summed over them.
    pub(super) fn needs_whole_objects(&self) -> bool {
        self.clip == Clip::Exclude || self.embedding == EmbeddingKind::Recovering
    }
}

impl Parameters {
    pub(crate) fn resolve(m: &Measurement, spacing: Spacing) -> Result<Self, MeasureError> {
        m.check()?;
        match m.embedding {
            kind if kind.is_blur() => Self::of_blur(m, spacing),
            kind => Ok(Self::without_blur(m, spacing, kind)),
        }
    }

    fn of_blur(m: &Measurement, spacing: Spacing) -> Result<Self, MeasureError> {
        let sigma = m.sigma.unwrap_or_else(|| auto_sigma(spacing));
        let level = m.level.unwrap_or(0.5);
        let saturation = saturation_at(level);
        let profile = m.embedding.profile(sigma);
        // Where eps is no value of the profile, the check below says so.
        let thickness_of = |epsilon: f64| thickness_of_blur(&profile, epsilon);
        let given = m.thickness.or_else(|| m.epsilon.map(thickness_of));
        let thickness = given.unwrap_or_else(|| auto_thickness_of_blur(spacing, &profile, saturation));
        let epsilon = m.epsilon.unwrap_or_else(|| epsilon_of_blur(&profile, thickness));
        // The corrected profile comes down again: a thickness beyond its first way to 1/2 stands for no band.
        if epsilon >= saturation || thickness > thickness_of(saturation) {
            return Err(MeasureError::BandTooWide { level, epsilon, saturation });
        }
        Ok(Self {
            embedding: m.embedding,
            derivatives: derivatives_of_blur(m, sigma, spacing)?,
            quadrature: m.quadrature,
            delta: m.delta,
            sigma_mm: Some(sigma),
            thickness_mm: thickness,
            level: Some(level),
            epsilon,
            clip: m.clip,
            padding: None,
        })
    }

    fn without_blur(m: &Measurement, spacing: Spacing, embedding: EmbeddingKind) -> Self {
        // Of a distance, whose slope is 1; a given field's follows from its slope.
        let given = m.thickness.or_else(|| m.epsilon.map(|epsilon| 2.0 * epsilon));
        let thickness = given.unwrap_or_else(|| auto_thickness(spacing));
        Self {
            embedding,
            derivatives: Derivatives::FiniteDifference,
            quadrature: m.quadrature,
            delta: m.delta,
            sigma_mm: None,
            thickness_mm: thickness,
            level: None,
            epsilon: thickness / 2.0,
            clip: m.clip,
            padding: None,
        }
    }

    /// Refuses a length of more than `most` voxels of the smallest spacing.
    pub(crate) fn check_reach(
        name: &'static str,
        value: f64,
        most: f64,
        spacing: Spacing,
    ) -> Result<(), MeasureError> {
        let spacing = spacing.smallest();
        let voxels = value / spacing;
        if voxels > most { Err(MeasureError::TooWide { name, value, voxels, spacing, most }) } else { Ok(()) }
    }

    /// The level T, or what stands for it where there is no blur.
    pub(super) fn level_or_half(&self) -> f64 {
        self.level.unwrap_or(0.5)
    }

    /// Smallest |phi| far from the surface.
    pub(crate) fn saturation(&self) -> f64 {
        self.level.map_or(f64::INFINITY, saturation_at)
    }

    /// The blur whose shift is to be compensated, 0 where it is taken off already; `None` where that is not
    /// defined.
    pub(super) fn compensable_sigma(&self) -> Option<f64> {
        let sigma = self.sigma_mm.filter(|_| self.level == Some(0.5))?;
        Some(if self.embedding.is_corrected() { 0.0 } else { sigma })
    }

    /// The blur of which each vertex is told how far it has moved.
    pub(super) fn shift_sigma(&self) -> Option<f64> {
        self.compensable_sigma().filter(|&sigma| sigma > 0.0)
    }

    /// The same with the blur alone.
    pub(super) fn uncorrected(self) -> Self {
        Self { embedding: EmbeddingKind::Gaussian, ..self }
    }

    /// A flat edge as the embedding has it; `None` without a blur.
    pub(super) fn profile(&self) -> Option<EdgeProfile> {
        self.sigma_mm.map(|sigma| self.embedding.profile(sigma))
    }
}

impl Measurement {
    /// Refuses what contradicts itself, whatever is measured.
    ///
    /// # Errors
    /// [`MeasureError`].
    pub fn check(&self) -> Result<(), MeasureError> {
        let padding = match self.padding {
            Some(Padding::Constant(value)) => Some(value),
            _ => None,
        };
        for (name, value) in [
            ("sigma", self.sigma),
            ("thickness", self.thickness),
            ("epsilon", self.epsilon),
            ("padding", padding),
        ] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(MeasureError::OutOfRange { name, value, range: "positive and finite" });
            }
        }
        if let Some(value) = self.level.filter(|level| !(*level > 0.0 && *level < 1.0)) {
            return Err(MeasureError::OutOfRange { name: "level", value, range: "between 0 and 1" });
        }
        if self.embedding.is_blur() {
            self.check_epsilon()?;
        }
        let of_blur = matches!(self.derivatives, Some(Derivatives::Gaussian | Derivatives::Matched));
        let conflict = |text| Err(MeasureError::Conflict(text));
        match self.embedding {
            _ if self.thickness.is_some() && self.epsilon.is_some() => {
                conflict("thickness and epsilon say the same thing: give one of them")
            }
            kind if kind != EmbeddingKind::Given && self.padding.is_some() => conflict(
                "padding closes a field that is given; masks and soft segmentations have background beyond their edge: leave it out",
            ),
            EmbeddingKind::Recovering if self.clip == Clip::Exclude => conflict(
                "the recovering embedding corrects voxels within the image alone: leave the cuts closed, or use the corrected embedding",
            ),
            kind if kind.is_corrected() && self.level.is_some_and(|level| level != 0.5) => conflict(
                "the corrected embedding takes the shift off that a surface at level 0.5 has: leave the level at 0.5",
            ),
            kind if kind.is_blur() => Ok(()),
            // The paper's blur is passed over where there is none.
            _ if self.level.is_some() || self.sigma.is_some() && !self.paper => conflict(
                "sigma and level belong to the embeddings that blur (gaussian, corrected, recovering, probability): leave them out",
            ),
            _ if self.clip == Clip::Exclude => conflict(
                "to leave the cuts out needs a field that is smooth across them: use the Gaussian or the corrected \
                 embedding",
            ),
            _ if of_blur => conflict(
                "Gaussian and matched derivatives belong to the embeddings that blur (gaussian, corrected, recovering, probability); the distance \
                 and given embeddings are differentiated by finite differences",
            ),
            _ => Ok(()),
        }
    }

    /// Where kernels end, in sigma, with these derivatives.
    pub(crate) fn truncation_with(&self, derivatives: Derivatives) -> f64 {
        self.truncation.unwrap_or(match derivatives {
            Derivatives::Matched => TRUNCATION_OF_BLUR,
            Derivatives::Gaussian | Derivatives::FiniteDifference => TRUNCATION,
        })
    }

    /// Refuses a band that no blur's field leaves, whatever sigma is.
    fn check_epsilon(&self) -> Result<(), MeasureError> {
        let level = self.level.unwrap_or(0.5);
        let saturation = saturation_at(level);
        match self.epsilon.filter(|&epsilon| epsilon >= saturation) {
            Some(epsilon) => Err(MeasureError::BandTooWide { level, epsilon, saturation }),
            None => Ok(()),
        }
    }
}

/// What was asked for; else matched differences wherever they equal Gaussian derivatives.
fn derivatives_of_blur(m: &Measurement, sigma: f64, spacing: Spacing) -> Result<Derivatives, MeasureError> {
    let valid = MatchedDifferences::are_valid(sigma, spacing.mm());
    match m.derivatives {
        Some(Derivatives::Matched) if !valid => Err(MeasureError::Conflict(
            "matched differences need a sigma of 1.75 to 8 voxels along every axis; use Gaussian derivatives, or another sigma",
        )),
        Some(chosen) => Ok(chosen),
        None if valid => Ok(Derivatives::Matched),
        None => Ok(Derivatives::Gaussian),
    }
}

/// Smallest |phi| far from the surface of a blurred indicator at a level.
fn saturation_at(level: f64) -> f64 {
    level.min(1.0 - level)
}
