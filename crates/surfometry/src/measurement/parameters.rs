//! Choices, checked and filled in for a grid.

use super::Measurement;
use crate::accuracy::{auto_sigma, auto_thickness, epsilon_of_blur};
use crate::integrals::{QuadratureRule, Smearing};
use crate::volume::{Spacing, VolumeError};
use serde::Serialize;
use thiserror::Error;

/// How an object becomes a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EmbeddingKind {
    /// The blurred indicator (the paper).
    #[default]
    Gaussian,
    /// Signed distance to the voxel faces (the baseline that the paper rejects).
    Distance,
    /// The input is the field.
    Given,
}

/// How the field is differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Derivatives {
    /// Convolution with derivatives of the Gaussian.
    Gaussian,
    /// Fourth-order differences (the paper).
    FiniteDifference,
}

/// Why a measurement cannot start.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// A parameter out of its range.
    #[error("{name} is {value}: it must be {range}")]
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
        "thickness {thickness} mm at level {level} gives epsilon {epsilon:.4}, but the blurred field saturates at \
         {saturation:.4}: choose a smaller --thickness, a larger --sigma or a --level nearer 0.5"
    )]
    BandTooWide {
        /// t, mm.
        thickness: f64,
        /// T.
        level: f64,
        /// eps.
        epsilon: f64,
        /// Smallest |phi| far from the surface.
        saturation: f64,
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
        "the field has no slope where it changes sign, so a thickness has no meaning; give --epsilon in the field's units"
    )]
    FlatField,
    /// The object or image itself.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

/// The choices that a result was made with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    /// Band thickness, mm; `None` where eps was given instead.
    pub thickness_mm: Option<f64>,
    /// Level T; `None` without a blur.
    pub level: Option<f64>,
    /// Half-width of the delta in units of phi.
    pub epsilon: f64,
}

impl Parameters {
    pub(super) fn resolve(m: &Measurement, spacing: Spacing) -> Result<Self, MeasureError> {
        for (name, value) in [("sigma", m.sigma), ("thickness", m.thickness), ("epsilon", m.epsilon)] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(MeasureError::OutOfRange { name, value, range: "positive and finite" });
            }
        }
        if !(m.level > 0.0 && m.level < 1.0) {
            return Err(MeasureError::OutOfRange { name: "level", value: m.level, range: "between 0 and 1" });
        }
        if m.thickness.is_some() && m.epsilon.is_some() {
            return Err(MeasureError::Conflict("thickness and epsilon say the same thing: give one of them"));
        }
        match m.embedding {
            EmbeddingKind::Gaussian => Self::of_blur(m, spacing),
            kind => Self::without_blur(m, spacing, kind),
        }
    }

    fn of_blur(m: &Measurement, spacing: Spacing) -> Result<Self, MeasureError> {
        let sigma = m.sigma.unwrap_or_else(|| auto_sigma(spacing));
        let thickness = m.thickness.unwrap_or_else(|| auto_thickness(spacing));
        let parameters = Self {
            embedding: EmbeddingKind::Gaussian,
            derivatives: m.derivatives.unwrap_or(Derivatives::Gaussian),
            quadrature: m.quadrature,
            delta: m.delta,
            sigma_mm: Some(sigma),
            thickness_mm: m.epsilon.is_none().then_some(thickness),
            level: Some(m.level),
            epsilon: m.epsilon.unwrap_or_else(|| epsilon_of_blur(sigma, thickness)),
        };
        let (epsilon, saturation) = (parameters.epsilon, parameters.saturation());
        if epsilon >= saturation {
            return Err(MeasureError::BandTooWide { thickness, level: m.level, epsilon, saturation });
        }
        Ok(parameters)
    }

    fn without_blur(
        m: &Measurement,
        spacing: Spacing,
        embedding: EmbeddingKind,
    ) -> Result<Self, MeasureError> {
        if m.derivatives == Some(Derivatives::Gaussian) {
            return Err(MeasureError::Conflict(
                "Gaussian derivatives belong to the Gaussian embedding; the distance and given embeddings are \
                 differentiated by finite differences",
            ));
        }
        let thickness = m.thickness.unwrap_or_else(|| auto_thickness(spacing));
        Ok(Self {
            embedding,
            derivatives: Derivatives::FiniteDifference,
            quadrature: m.quadrature,
            delta: m.delta,
            sigma_mm: None,
            thickness_mm: m.epsilon.is_none().then_some(thickness),
            level: None,
            // Of a distance; a given field's follows from its slope.
            epsilon: m.epsilon.unwrap_or(thickness / 2.0),
        })
    }

    /// Smallest |phi| far from the surface.
    pub(super) fn saturation(&self) -> f64 {
        self.level.map_or(f64::INFINITY, |level| level.min(1.0 - level))
    }

    /// sigma where compensation is defined: the Gaussian embedding at level 0.5.
    pub(super) fn compensable_sigma(&self) -> Option<f64> {
        self.sigma_mm.filter(|_| self.level == Some(0.5))
    }
}
