//! Options of a measurement, as typed, and what they mean.

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use surfometry::integrals::{QuadratureRule, Smearing};
use surfometry::measurement::{Derivatives, EmbeddingKind, Measurement};
use surfometry::runs::InputOptions;
use surfometry::volume::{LabelSelection, Spacing};

/// A length in mm, or `auto`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Length {
    Auto,
    Mm(f64),
}

impl Length {
    fn mm(self) -> Option<f64> {
        match self {
            Self::Auto => None,
            Self::Mm(mm) => Some(mm),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum EmbeddingOption {
    /// The blurred mask
    Gaussian,
    /// Signed distance to the voxel faces: the baseline that the paper rejects
    Distance,
    /// The input is a field phi, negative inside
    Given,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DerivativesOption {
    /// Convolution with derivatives of the Gaussian
    Gaussian,
    /// Differences matched to the blur: the same from sigma = 1.75 voxels on, faster
    Matched,
    /// Fourth-order differences, as in the paper
    FiniteDifference,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum QuadratureOption {
    Sum,
    Simpson,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DeltaOption {
    Sine,
    Tanh,
}

/// How and what to measure.
#[derive(Debug, Args)]
pub(crate) struct MeasureOptions {
    /// Labels: `all`, `N`, `N,M` (two objects) or `N+M` (one object of two labels)
    #[arg(long, default_value = "all", allow_hyphen_values = true)]
    label: LabelSelection,
    /// Blur in mm [default: auto = 2 x the geometric mean of the spacings]
    #[arg(long, value_name = "MM|auto", value_parser = length, allow_hyphen_values = true)]
    sigma: Option<Length>,
    /// Thickness of the band in mm [default: auto = 2.5 x the largest spacing]
    #[arg(long, value_name = "MM|auto", value_parser = length, allow_hyphen_values = true)]
    thickness: Option<Length>,
    /// Half-width of the delta in units of the field, instead of a thickness
    #[arg(long, conflicts_with = "thickness", value_parser = positive, allow_hyphen_values = true)]
    epsilon: Option<f64>,
    /// Level of the blurred mask that is the surface [default: 0.5]
    #[arg(long, value_parser = fraction, allow_hyphen_values = true)]
    level: Option<f64>,
    /// How an object becomes a field
    #[arg(long, value_enum, default_value = "gaussian")]
    embedding: EmbeddingOption,
    /// How the field is differentiated [default: matched where sigma is 1.75 to 8 voxels, else gaussian; finite-difference without a blur]
    #[arg(long, value_enum)]
    derivatives: Option<DerivativesOption>,
    /// How voxels are summed [default: sum]
    #[arg(long, value_enum)]
    quadrature: Option<QuadratureOption>,
    /// Profile of the delta [default: sine]
    #[arg(long, value_enum)]
    delta: Option<DeltaOption>,
    /// The paper's choices: finite-difference, simpson, sigma 2, thickness 2.5; options given beside it win
    #[arg(long)]
    paper: bool,
    /// Voxel spacing in mm, fastest axis first: replaces the file's, or supplies what it lacks
    #[arg(long, value_name = "X,Y,Z", value_parser = spacing, allow_hyphen_values = true)]
    spacing: Option<Spacing>,
}

impl MeasureOptions {
    /// The measurement that the options describe.
    pub(crate) fn measurement(&self) -> Result<Measurement> {
        let blurred = self.embedding == EmbeddingOption::Gaussian;
        if !blurred && (self.sigma.is_some() || self.level.is_some()) {
            bail!("--sigma and --level belong to --embedding gaussian: leave them out");
        }
        if !blurred && self.derivatives == Some(DerivativesOption::Gaussian) {
            bail!("--derivatives gaussian belongs to --embedding gaussian: leave it out");
        }
        let mut m = if self.paper { Measurement::paper() } else { Measurement::default() };
        m = m.embedding(match self.embedding {
            EmbeddingOption::Gaussian => EmbeddingKind::Gaussian,
            EmbeddingOption::Distance => EmbeddingKind::Distance,
            EmbeddingOption::Given => EmbeddingKind::Given,
        });
        if let Some(sigma) = self.sigma {
            m = m.sigma_mm(sigma.mm());
        }
        if let Some(thickness) = self.thickness {
            m = m.thickness_mm(thickness.mm());
        }
        if let Some(epsilon) = self.epsilon {
            m = m.thickness_mm(None).epsilon(epsilon);
        }
        if let Some(level) = self.level {
            m = m.level(level);
        }
        if let Some(derivatives) = self.derivatives {
            m = m.derivatives(match derivatives {
                DerivativesOption::Gaussian => Derivatives::Gaussian,
                DerivativesOption::FiniteDifference => Derivatives::FiniteDifference,
                DerivativesOption::Matched => Derivatives::Matched,
            });
        }
        if let Some(quadrature) = self.quadrature {
            m = m.quadrature(match quadrature {
                QuadratureOption::Sum => QuadratureRule::Sum,
                QuadratureOption::Simpson => QuadratureRule::Simpson,
            });
        }
        if let Some(delta) = self.delta {
            m = m.delta(match delta {
                DeltaOption::Sine => Smearing::Sine,
                DeltaOption::Tanh => Smearing::Tanh,
            });
        }
        Ok(m)
    }

    /// What is asked of each input.
    pub(crate) fn inputs(&self) -> InputOptions {
        InputOptions { labels: self.label.clone(), spacing: self.spacing.map(|s| s.mm()) }
    }

    /// Whether sigma follows each image's spacing.
    pub(crate) fn sigma_is_automatic(&self) -> bool {
        let explicit = matches!(self.sigma, Some(Length::Mm(_)));
        self.embedding == EmbeddingOption::Gaussian && !explicit && !(self.paper && self.sigma.is_none())
    }
}

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is not a number"))
}

pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("it must be positive and finite".to_owned())
    }
}

fn fraction(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err("it must lie between 0 and 1".to_owned()) }
}

fn length(text: &str) -> Result<Length, String> {
    if text == "auto" { Ok(Length::Auto) } else { positive(text).map(Length::Mm) }
}

pub(crate) fn spacing(text: &str) -> Result<Spacing, String> {
    let parts = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let mm: [f64; 3] =
        parts.try_into().map_err(|_| "write three numbers, X,Y,Z in mm, fastest axis first".to_owned())?;
    Spacing::new(mm).map_err(|e| e.to_string())
}
