//! Options of a measurement, as typed, and what they mean.

use crate::values::{number, one_of, positive};
use anyhow::Result;
use clap::{Args, ValueEnum};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use surfometry::Measurement;
use surfometry::inputs::OpenOptions;
use surfometry::integrals::{QuadratureRule, Smearing};
use surfometry::measurement::{Clip, CurvatureScale, Derivatives, EmbeddingKind, Padding};
use surfometry::runs::{LabelScales, Plan, SweptParameter};
use surfometry::volume::{LabelGroup, LabelSelection, Spacing};

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

/// A length for all objects, lengths of labels of their own, or both: `2,20=1.5,21=auto`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LengthByLabel {
    of_all: Option<Length>,
    of_labels: Vec<(LabelGroup, Length)>,
}

impl LengthByLabel {
    fn own(&self) -> Vec<(LabelGroup, Option<f64>)> {
        self.of_labels.iter().map(|(label, length)| (label.clone(), length.mm())).collect()
    }
}

impl FromStr for LengthByLabel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut lengths = Self { of_all: None, of_labels: Vec::new() };
        for part in text.split(',') {
            match part.split_once('=') {
                None if lengths.of_all.is_some() => {
                    return Err("one length is for all labels; write the others as LABEL=MM".to_owned());
                }
                None => lengths.of_all = Some(length(part)?),
                Some((label, mm)) => {
                    let label = one_label(label)?;
                    if lengths.of_labels.iter().any(|(known, _)| known.is_same(&label)) {
                        return Err(format!("label {label} has two lengths"));
                    }
                    lengths.of_labels.push((label, length(mm)?));
                }
            }
        }
        Ok(lengths)
    }
}

/// `N`, or `N+M` of united labels.
fn one_label(text: &str) -> Result<LabelGroup, String> {
    match text.parse::<LabelSelection>().map_err(|error| error.to_string())? {
        LabelSelection::Groups(groups) if groups.len() == 1 => Ok(groups[0].clone()),
        _ => Err(format!("`{text}`: name one label, or united ones as 1+2")),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
    Table,
    Json,
    /// A line of JSON a result
    Jsonl,
    Csv,
}

/// Where results go, in which form.
#[derive(Debug, Args)]
pub(crate) struct OutputOptions {
    /// Form of the results [default: what the ending of -o FILE says, .json, .jsonl or .csv; else table]
    #[arg(long, value_enum)]
    format: Option<OutputFormat>,
    /// File to write instead of stdout; written whole or not at all
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl OutputOptions {
    /// The file; `None` for stdout, which `-` names as well.
    pub(crate) fn path(&self) -> Option<&Path> {
        self.output.as_deref().filter(|path| *path != Path::new("-"))
    }

    pub(crate) fn format(&self) -> OutputFormat {
        let ending = self.path().and_then(Path::extension).map(OsStr::to_ascii_lowercase);
        self.format.unwrap_or_else(|| match ending.as_ref().and_then(|e| e.to_str()) {
            Some("json") => OutputFormat::Json,
            Some("jsonl") => OutputFormat::Jsonl,
            Some("csv") => OutputFormat::Csv,
            _ => OutputFormat::Table,
        })
    }
}

/// At which scale surfaces are mapped.
#[derive(Debug, Args)]
pub(crate) struct CurvatureOptions {
    /// Map the surface and its curvature in the corrected embedding, as those of the original object, at this
    /// blur in mm; auto = what suits the object's curvature and the spacing; local = what suits each vertex, in
    /// the embedding that gives the object back. Integrals keep --sigma [default:
    /// the surface as measured]
    #[arg(long, value_name = "MM|auto|local", value_parser = scale, allow_hyphen_values = true)]
    curvature_sigma: Option<CurvatureScale>,
}

impl CurvatureOptions {
    pub(crate) fn scale(&self) -> CurvatureScale {
        self.curvature_sigma.unwrap_or_default()
    }
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
    /// A plan that asks for these objects.
    pub(crate) fn plan(&self) -> Plan {
        let open = OpenOptions { spacing: self.spacing.map(|s| s.mm()) };
        Plan { labels: self.label.clone(), open, ..Plan::default() }
    }
}

/// How and what to measure.
#[derive(Debug, Args)]
pub(crate) struct MeasureOptions {
    #[command(flatten)]
    selection: InputSelection,
    /// Blur in mm [default: auto = 2 x the geometric mean of the spacings]; LABEL=MM is that of a label, as 2,20=1.5,21=auto
    #[arg(long, value_name = "MM|auto|LABEL=MM,..", allow_hyphen_values = true)]
    sigma: Option<LengthByLabel>,
    /// Thickness of the band in mm [default: auto = 2.5 x the largest spacing]; by label as --sigma
    #[arg(long, value_name = "MM|auto|LABEL=MM,..", allow_hyphen_values = true)]
    thickness: Option<LengthByLabel>,
    /// Half-width of the delta in units of the field, instead of a thickness
    #[arg(long, conflicts_with = "thickness", value_parser = positive, allow_hyphen_values = true)]
    epsilon: Option<f64>,
    /// Level of the blurred mask that is the surface [default: 0.5]
    #[arg(long, value_parser = fraction, allow_hyphen_values = true)]
    level: Option<f64>,
    /// How an object becomes a field [default: gaussian; of an object of which that loses detail, in `measure`
    /// and `report`, recovering where its errors are smaller, unless other choices are made]
    #[arg(long, value_parser = one_of::<EmbeddingKind>())]
    embedding: Option<EmbeddingKind>,
    /// How the field is differentiated [default: matched where sigma is 1.75 to 8 voxels, else gaussian;
    /// finite-difference without a blur]
    #[arg(long, value_parser = one_of::<Derivatives>())]
    derivatives: Option<Derivatives>,
    /// How voxels are summed [default: sum]
    #[arg(long, value_parser = one_of::<QuadratureRule>())]
    quadrature: Option<QuadratureRule>,
    /// Profile of the delta [default: sine]
    #[arg(long, value_parser = one_of::<Smearing>())]
    delta: Option<Smearing>,
    /// What becomes of objects that the edge of the image cuts: closed with a flat cap, or measured between
    /// sections 3 sigma from the cuts
    #[arg(long, default_value = "cap", value_parser = one_of::<Clip>())]
    clip: Clip,
    /// Closes a given field where its edge cuts the object: beyond it the field rises to this positive number in
    /// its own units, `auto` to its largest value [default: the surface is left open there]
    #[arg(long, value_name = "VALUE|auto", value_parser = padding, allow_hyphen_values = true)]
    padding: Option<Padding>,
    /// The paper's choices: finite-difference, simpson, sigma 2, thickness 2.5; options given beside it win
    #[arg(long)]
    paper: bool,
}

impl MeasureOptions {
    /// The plan that the options describe, checked.
    pub(crate) fn plan(&self, curvature: CurvatureScale) -> Result<Plan> {
        let recover = self.embedding.is_none();
        let own =
            |lengths: &Option<LengthByLabel>| lengths.as_ref().map_or_else(Vec::new, LengthByLabel::own);
        let scales = LabelScales { sigma_mm: own(&self.sigma), thickness_mm: own(&self.thickness) };
        let measurement = self.measurement();
        let plan = Plan { measurement, scales, curvature, recover, ..self.selection.plan() };
        plan.check()?;
        if let LabelSelection::Groups(objects) = &plan.labels {
            plan.scales.check(objects)?;
        }
        Ok(plan)
    }

    fn measurement(&self) -> Measurement {
        let mut m = if self.paper { Measurement::paper() } else { Measurement::default() };
        m = m.embedding(self.embedding.unwrap_or_default()).clip(self.clip).padding(self.padding);
        if let Some(sigma) = self.sigma.as_ref().and_then(|lengths| lengths.of_all) {
            m = m.sigma_mm(sigma.mm());
        }
        if let Some(thickness) = self.thickness.as_ref().and_then(|lengths| lengths.of_all) {
            m = m.thickness_mm(thickness.mm());
        }
        if let Some(epsilon) = self.epsilon {
            m = m.thickness_mm(None).epsilon(epsilon);
        }
        if let Some(level) = self.level {
            m = m.level(level);
        }
        if let Some(derivatives) = self.derivatives {
            m = m.derivatives(derivatives);
        }
        if let Some(quadrature) = self.quadrature {
            m = m.quadrature(quadrature);
        }
        if let Some(delta) = self.delta {
            m = m.delta(delta);
        }
        m
    }

    /// Whether a parameter that is to be swept was given.
    pub(crate) fn gives(&self, parameter: SweptParameter) -> bool {
        match parameter {
            SweptParameter::Sigma => self.sigma.is_some(),
            SweptParameter::Thickness => self.thickness.is_some() || self.epsilon.is_some(),
            SweptParameter::Level => self.level.is_some(),
        }
    }

    /// Whether sigma follows each image's spacing.
    pub(crate) fn sigma_is_automatic(&self) -> bool {
        let is_explicit =
            |s: &LengthByLabel| matches!(s.of_all, Some(Length::Mm(_))) || !s.of_labels.is_empty();
        let explicit = self.sigma.as_ref().is_some_and(is_explicit);
        self.embedding.unwrap_or_default().is_blur() && !explicit && !(self.paper && self.sigma.is_none())
    }
}

fn fraction(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err("it must lie between 0 and 1".to_owned()) }
}

fn length(text: &str) -> Result<Length, String> {
    if text == "auto" { Ok(Length::Auto) } else { positive(text).map(Length::Mm) }
}

fn padding(text: &str) -> Result<Padding, String> {
    if text == "auto" { Ok(Padding::Highest) } else { positive(text).map(Padding::Constant) }
}

pub(crate) fn scale(text: &str) -> Result<CurvatureScale, String> {
    match text {
        "auto" => Ok(CurvatureScale::Auto),
        "local" => Ok(CurvatureScale::Local),
        _ => positive(text).map(CurvatureScale::Mm),
    }
}

pub(crate) fn spacing(text: &str) -> Result<Spacing, String> {
    let parts = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let mm: [f64; 3] =
        parts.try_into().map_err(|_| "write three numbers, X,Y,Z in mm, fastest axis first".to_owned())?;
    Spacing::new(mm).map_err(|e| e.to_string())
}

/// Values from one to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    first: f64,
    last: f64,
    count: u32,
}

/// Most values of a sweep.
const MOST_VALUES: u32 = 1000;

impl std::str::FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!("`{text}`: write FROM:TO:COUNT, two positive numbers and a count of 2 to {MOST_VALUES}")
        };
        let [first, last, count] = text.split(':').collect::<Vec<_>>().try_into().map_err(|_| wrong())?;
        let number =
            |part: &str| part.parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0).ok_or_else(wrong);
        let count = count.parse().ok().filter(|n| (2..=MOST_VALUES).contains(n)).ok_or_else(wrong)?;
        Ok(Range { first: number(first)?, last: number(last)?, count })
    }
}

impl Range {
    pub(crate) fn values(&self, log: bool) -> Vec<f64> {
        let share = |n: u32| f64::from(n) / f64::from(self.count - 1);
        let value = |t: f64| {
            if log {
                self.first * (self.last / self.first).powf(t)
            } else {
                self.first + t * (self.last - self.first)
            }
        };
        (0..self.count).map(|n| value(share(n))).collect()
    }
}
