//! Options of a measurement, as typed, and what they mean.

use crate::output::say;
use crate::values::one_of;
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use surfometry::inputs::{Preparation, Threshold};
use surfometry::integrals::{QuadratureRule, Smearing};
use surfometry::io::{RawLayout, ReadError, read_label_names_warning};
use surfometry::measurement::{Clip, CurvatureScale, Derivatives, EmbeddingKind, Padding};
use surfometry::runs::words::{curvature_scale, fraction, padding, positive, spacing};
use surfometry::runs::{Choices, DocumentForm, Lengths, MapStyle, Plan, SelectionWords, SweptParameter};
use surfometry::volume::{LabelTable, Spacing};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
    Table,
    Json,
    /// A line of JSON a result
    Jsonl,
    Csv,
}

/// Endings of files that take a table for people.
const TEXTS: [&str; 4] = ["txt", "text", "log", "md"];

/// Where results go, in which form.
#[derive(Debug, Args)]
#[command(next_help_heading = "Results")]
pub(crate) struct OutputOptions {
    /// Form of the results [default: what the ending of -o FILE says, .json, .jsonl or .csv; else table, of .txt or no ending]
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

    /// Refuses, before anything is measured, a file whose name says another form than it would have.
    pub(crate) fn check(&self) -> Result<()> {
        let Some(path) = self.path().filter(|_| self.format.is_none()) else { return Ok(()) };
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if !ending.is_empty() && DocumentForm::of_path(path).is_none() && !TEXTS.contains(&ending.as_str()) {
            bail!(
                "{}: no results are written as .{ending}; name the file .csv, .json or .jsonl, or .txt for the table that is \
                 printed, or say --format",
                path.display()
            );
        }
        Ok(())
    }

    pub(crate) fn format(&self) -> OutputFormat {
        self.format.unwrap_or_else(|| match self.path().and_then(DocumentForm::of_path) {
            Some(DocumentForm::Json) => OutputFormat::Json,
            Some(DocumentForm::JsonLines) => OutputFormat::Jsonl,
            Some(DocumentForm::Csv) => OutputFormat::Csv,
            None => OutputFormat::Table,
        })
    }
}

/// At which scale surfaces are mapped.
#[derive(Debug, Args)]
#[command(next_help_heading = "Method")]
pub(crate) struct CurvatureOptions {
    /// Map the surface and its curvature in the corrected embedding, as those of the original object, at this
    /// blur in mm; auto = local = what suits each vertex, in the embedding that gives the object back; object = one
    /// that suits the object as a whole, faster. Integrals keep --sigma [default: the surface as measured; of pictures
    /// of surfaces alone and of pages of eight objects or fewer, without a choice of sigma or embedding: auto]
    #[arg(long, value_name = "MM|auto|local|object", value_parser = curvature_scale, allow_hyphen_values = true)]
    curvature_sigma: Option<CurvatureScale>,
}

impl CurvatureOptions {
    pub(crate) fn scale(&self) -> CurvatureScale {
        self.curvature_sigma.unwrap_or_default()
    }

    pub(crate) fn asked(&self) -> Option<CurvatureScale> {
        self.curvature_sigma
    }
}

/// What labels are called.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Objects")]
pub(crate) struct NameOptions {
    /// Names of labels, which win over the input's own: nnU-Net's dataset.json, any JSON, CSV or TSV of labels and names, a
    /// table of FreeSurfer, 3D Slicer or ITK-SNAP
    #[arg(long, value_name = "FILE", value_parser = label_names)]
    names: Option<NamesFile>,
}

/// A table of names, and the file that it was read from.
#[derive(Debug, Clone)]
struct NamesFile {
    file: String,
    table: LabelTable,
}

impl NameOptions {
    pub(crate) fn table(&self) -> LabelTable {
        self.names.as_ref().map(|names| names.table.clone()).unwrap_or_default()
    }
}

fn label_names(path: &str) -> Result<NamesFile, ReadError> {
    Ok(NamesFile { file: path.to_owned(), table: read_label_names_warning(path, say)? })
}

/// What a file does not say of its voxels, or not right.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Voxels")]
pub(crate) struct LatticeOptions {
    /// Voxel spacing in mm, fastest axis first: replaces the file's, or supplies what it lacks
    #[arg(long, value_name = "X,Y,Z", value_parser = spacing, allow_hyphen_values = true)]
    pub(crate) spacing: Option<Spacing>,
    /// Image files have no header: voxels along x, y, z (x is the fastest) and their type, as 80x50x83:uint16; then
    /// :big for big-endian numbers, :N for N bytes in front
    #[arg(long, value_name = "XxYxZ:TYPE")]
    pub(crate) raw: Option<RawLayout>,
}

/// Which objects of an input, and how far its voxels are apart.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Objects")]
pub(crate) struct InputSelection {
    /// Labels: `all`, `N`, `N,M` (two objects), `N-M` (each from N to M) or `N+M` (one object of two labels), by number or by
    /// name, as `liver,spleen`; a name with a comma or a plus sign stands in quotes of its own. May be repeated [default: all]
    #[arg(long, value_name = "LABEL", allow_hyphen_values = true)]
    label: Vec<SelectionWords>,
    #[command(flatten)]
    names: NameOptions,
    #[command(flatten)]
    lattice: LatticeOptions,
    #[command(flatten)]
    preparation: PreparationOptions,
}

impl InputSelection {
    /// A plan that asks for these objects.
    ///
    /// # Errors
    /// As of [`Choices::plan`].
    pub(crate) fn plan(&self) -> Result<Plan> {
        Ok(self.choices().plan(CurvatureScale::AsMeasured)?)
    }

    /// All files that are read for some inputs, which no output may replace: the inputs, the names of their labels, and more.
    pub(crate) fn files_read<'a>(
        &self,
        inputs: &[String],
        more: impl IntoIterator<Item = &'a str>,
    ) -> Vec<String> {
        let names = self.names.names.iter().map(|names| names.file.clone());
        let others = names.chain(more.into_iter().map(str::to_owned));
        inputs.iter().cloned().chain(others).collect()
    }

    fn choices(&self) -> Choices {
        let labels = self.label.iter().cloned().reduce(SelectionWords::and).unwrap_or_default();
        let names = self.names.table();
        let preparation = self.preparation.chosen();
        let LatticeOptions { spacing, raw } = self.lattice;
        Choices { labels, names, spacing, preparation, raw, ..Choices::default() }
    }
}

/// What is done to the voxels before.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Voxels")]
pub(crate) struct PreparationOptions {
    /// Grey values that are the object: LOW..HIGH, LOW.. or ..HIGH, both ends inside; it becomes label 1, all else background
    #[arg(long, value_name = "LOW..HIGH", allow_hyphen_values = true)]
    threshold: Option<Threshold>,
    /// Leaves only the largest 26-connected piece of each label
    #[arg(long)]
    largest_component: bool,
    /// Fills background that a label encloses: no way over voxels' faces leads from it to the edge of the image. After
    /// --largest-component
    #[arg(long)]
    fill_cavities: bool,
}

impl PreparationOptions {
    fn chosen(self) -> Preparation {
        let Self { threshold, largest_component, fill_cavities } = self;
        Preparation { threshold, largest_component, fill_cavities }
    }
}

/// How and what to measure.
#[derive(Debug, Args)]
pub(crate) struct MeasureOptions {
    #[command(flatten)]
    selection: InputSelection,
    /// Blur in mm [default: auto = 2 x the geometric mean of the spacings]; LABEL=MM is that of a label, as 2,20=1.5,21=auto
    #[arg(long, help_heading = "Method", value_name = "MM|auto|LABEL=MM,..", allow_hyphen_values = true)]
    sigma: Option<Lengths>,
    /// Thickness of the band in mm [default: auto = 2.5 x the largest spacing]; by label as --sigma
    #[arg(long, help_heading = "Method", value_name = "MM|auto|LABEL=MM,..", allow_hyphen_values = true)]
    thickness: Option<Lengths>,
    /// Half-width of the delta in units of the field, instead of a thickness
    #[arg(long, help_heading = "Method", hide_short_help = true, conflicts_with = "thickness", value_parser = positive, allow_hyphen_values = true)]
    epsilon: Option<f64>,
    /// Level of the blurred mask that is the surface [default: 0.5]
    #[arg(long, help_heading = "Method", hide_short_help = true, value_parser = fraction, allow_hyphen_values = true)]
    level: Option<f64>,
    /// How an object becomes a field [default: gaussian; of an object of which that loses detail, in `measure`
    /// and `report`, recovering where its errors are smaller, unless other choices are made]
    #[arg(long, help_heading = "Method", value_parser = one_of::<EmbeddingKind>())]
    embedding: Option<EmbeddingKind>,
    /// How the field is differentiated [default: matched where sigma is 1.75 to 8 voxels, else gaussian;
    /// finite-difference without a blur]
    #[arg(long, help_heading = "Method", hide_short_help = true, value_parser = one_of::<Derivatives>())]
    derivatives: Option<Derivatives>,
    /// How voxels are summed [default: sum]
    #[arg(long, help_heading = "Method", hide_short_help = true, value_parser = one_of::<QuadratureRule>())]
    quadrature: Option<QuadratureRule>,
    /// Profile of the delta [default: sine]
    #[arg(long, help_heading = "Method", hide_short_help = true, value_parser = one_of::<Smearing>())]
    delta: Option<Smearing>,
    /// What becomes of objects that the edge of the image cuts: closed with a flat cap, or measured between
    /// sections 3 sigma from the cuts
    #[arg(long, help_heading = "Method", default_value = "cap", value_parser = one_of::<Clip>())]
    clip: Clip,
    /// Closes a given field where its edge cuts the object: beyond it the field rises to this positive number in
    /// its own units, `auto` to its largest value [default: the surface is left open there]
    #[arg(long, help_heading = "Method", hide_short_help = true, value_name = "VALUE|auto", value_parser = padding, allow_hyphen_values = true)]
    padding: Option<Padding>,
    /// The paper's choices: finite-difference, simpson, sigma 2 mm, thickness 2.5 mm; options given beside it win
    #[arg(long, help_heading = "Method")]
    paper: bool,
}

impl MeasureOptions {
    /// The plan that the options describe, checked.
    pub(crate) fn plan(&self, curvature: CurvatureScale) -> Result<Plan> {
        Ok(self.choices().plan(curvature)?)
    }

    /// As [`InputSelection::files_read`].
    pub(crate) fn files_read<'a>(
        &self,
        inputs: &[String],
        more: impl IntoIterator<Item = &'a str>,
    ) -> Vec<String> {
        self.selection.files_read(inputs, more)
    }

    /// Whether labels were chosen.
    pub(crate) fn chooses_labels(&self) -> bool {
        !self.selection.label.is_empty()
    }

    /// Where a map's curvature is taken, if nothing is said of it.
    pub(crate) fn scale_of_map<'a>(
        &self,
        style: &MapStyle,
        outputs: impl IntoIterator<Item = &'a PathBuf>,
    ) -> CurvatureScale {
        self.choices().scale_of_map(style, outputs)
    }

    /// What the options say.
    pub(crate) fn choices(&self) -> Choices {
        Choices {
            sigma: self.sigma.clone().unwrap_or_default(),
            thickness: self.thickness.clone().unwrap_or_default(),
            epsilon: self.epsilon,
            level: self.level,
            embedding: self.embedding,
            derivatives: self.derivatives,
            quadrature: self.quadrature,
            delta: self.delta,
            clip: self.clip,
            padding: self.padding,
            paper: self.paper,
            ..self.selection.choices()
        }
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
        self.choices().sigma_is_automatic()
    }
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
