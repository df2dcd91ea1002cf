//! Options of a measurement, as typed, and what they mean.

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use surfometry::integrals::{QuadratureRule, Smearing};
use surfometry::measurement::{Clip, CurvatureScale, Derivatives, EmbeddingKind, Measurement};
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
    /// Two blurs combined so that the surface does not move: local curvature of the original object
    Corrected,
    /// Signed distance to the voxel faces: the baseline that the paper rejects
    Distance,
    /// Signed distance that is zero on the boundary voxels, as ITK's: its surface lies half a voxel inside
    DistanceToVoxels,
    /// The input is a field phi, negative inside
    Given,
}

impl EmbeddingOption {
    fn is_blur(self) -> bool {
        matches!(self, Self::Gaussian | Self::Corrected)
    }
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
    Table,
    Json,
    Csv,
}

/// Where results go, in which form.
#[derive(Debug, Args)]
pub(crate) struct OutputOptions {
    /// Form of the results [default: what the ending of -o FILE says, .json or .csv; else table]
    #[arg(long, value_enum)]
    format: Option<OutputFormat>,
    /// File to write instead of stdout; written whole or not at all
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl OutputOptions {
    pub(crate) fn path(&self) -> Option<&Path> {
        self.output.as_deref()
    }

    pub(crate) fn format(&self) -> OutputFormat {
        let ending = self.path().and_then(Path::extension).map(OsStr::to_ascii_lowercase);
        self.format.unwrap_or_else(|| match ending.as_ref().and_then(|e| e.to_str()) {
            Some("json") => OutputFormat::Json,
            Some("csv") => OutputFormat::Csv,
            _ => OutputFormat::Table,
        })
    }
}

/// At which scale surfaces are mapped.
#[derive(Debug, Args)]
pub(crate) struct CurvatureOptions {
    /// Map the surface and its curvature in the corrected embedding, as those of the original object, at this blur in mm; auto = what suits the object's
    /// curvature and the spacing. Integrals keep --sigma [default: the surface as measured]
    #[arg(long, value_name = "MM|auto", value_parser = length, allow_hyphen_values = true)]
    curvature_sigma: Option<Length>,
}

impl CurvatureOptions {
    pub(crate) fn scale(&self) -> CurvatureScale {
        match self.curvature_sigma {
            None => CurvatureScale::AsMeasured,
            Some(Length::Auto) => CurvatureScale::Auto,
            Some(Length::Mm(sigma)) => CurvatureScale::Mm(sigma),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ClipOption {
    Cap,
    Exclude,
}

/// Which objects of an input, and how far its voxels are apart.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct InputSelection {
    /// Labels: `all`, `N`, `N,M` (two objects) or `N+M` (one object of two labels)
    #[arg(long, default_value = "all", allow_hyphen_values = true)]
    label: LabelSelection,
    /// Voxel spacing in mm, fastest axis first: replaces the file's, or supplies what it lacks
    #[arg(long, value_name = "X,Y,Z", value_parser = spacing, allow_hyphen_values = true)]
    spacing: Option<Spacing>,
}

impl InputSelection {
    pub(crate) fn inputs(&self) -> InputOptions {
        let (labels, spacing) = (self.label.clone(), self.spacing.map(|s| s.mm()));
        InputOptions { labels, spacing, ..InputOptions::default() }
    }
}

/// How and what to measure.
#[derive(Debug, Args)]
pub(crate) struct MeasureOptions {
    #[command(flatten)]
    selection: InputSelection,
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
    /// What becomes of objects that the edge of the image cuts: closed with a flat cap, or measured between sections 3 sigma from the cuts
    #[arg(long, value_enum, default_value = "cap")]
    clip: ClipOption,
    /// The paper's choices: finite-difference, simpson, sigma 2, thickness 2.5; options given beside it win
    #[arg(long)]
    paper: bool,
}

impl MeasureOptions {
    /// The measurement that the options describe.
    pub(crate) fn measurement(&self) -> Result<Measurement> {
        let blurred = self.embedding.is_blur();
        if !blurred && (self.sigma.is_some() || self.level.is_some()) {
            bail!("--sigma and --level belong to --embedding gaussian and corrected: leave them out");
        }
        if !blurred && self.clip == ClipOption::Exclude {
            bail!(
                "--clip exclude needs a field that is smooth across the cut: use --embedding gaussian or corrected"
            );
        }
        if !blurred && self.derivatives == Some(DerivativesOption::Gaussian) {
            bail!("--derivatives gaussian belongs to --embedding gaussian and corrected: leave it out");
        }
        let mut m = if self.paper { Measurement::paper() } else { Measurement::default() };
        m = m.embedding(match self.embedding {
            EmbeddingOption::Gaussian => EmbeddingKind::Gaussian,
            EmbeddingOption::Corrected => EmbeddingKind::Corrected,
            EmbeddingOption::Distance => EmbeddingKind::Distance,
            EmbeddingOption::DistanceToVoxels => EmbeddingKind::DistanceToVoxels,
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
        Ok(m.clip(match self.clip {
            ClipOption::Cap => Clip::Cap,
            ClipOption::Exclude => Clip::Exclude,
        }))
    }

    /// Whether a length or level was given.
    pub(crate) fn gives(&self, name: &str) -> bool {
        match name {
            "sigma" => self.sigma.is_some(),
            "thickness" => self.thickness.is_some() || self.epsilon.is_some(),
            _ => self.level.is_some(),
        }
    }

    /// What is asked of each input.
    pub(crate) fn inputs(&self, curvature: CurvatureScale) -> InputOptions {
        InputOptions { curvature, ..self.selection.inputs() }
    }

    /// Whether sigma follows each image's spacing.
    pub(crate) fn sigma_is_automatic(&self) -> bool {
        let explicit = matches!(self.sigma, Some(Length::Mm(_)));
        self.embedding.is_blur() && !explicit && !(self.paper && self.sigma.is_none())
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
