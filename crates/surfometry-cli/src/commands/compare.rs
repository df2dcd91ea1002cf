//! `surfometry compare`.

use super::ALL_DONE;
use crate::output::{check_output, command_line, comparison_text, deliver, json_text, plain, say};
use crate::values::two_names;
use anyhow::{Context, Result, anyhow, bail};
use std::path::{Path, PathBuf};
use surfometry::comparison::{
    ColumnChoice, Comparison, MeasureAgreement, Table, TableError, chosen_columns, compare, names_of,
    read_tables,
};
use surfometry::pictures::Figure;
use surfometry::report::{ComparisonPage, HashedInput, Provenance, comparison_chart, render_comparison};
use surfometry::runs::{MapStyle, write_figure};
use surfometry::statistics::Bootstrap;

/// Compare two tables of the same objects: regression, Bland-Altman, concordance, Euler characteristics
///
/// Tables are what `measure`, `reference`, `sweep`, `validate` and `cohort` write, as CSV, JSON or JSONL,
/// or CSV of other programs, with commas, semicolons or tabs, read as numbers only
/// where their decimal signs cannot be mistaken; a folder stands for all tables in it. Objects
/// are matched by the columns input and label, as far as both tables have them, and by file names without
/// folders and endings where these differ. Where an object has a row for each of several methods, the
/// columns are called NAME@METHOD. What is compared by default is the original object's. Bias is METHOD
/// minus STANDARD. Give the same file twice to compare two of its columns, as
/// volume_mm3:truth_volume_mm3 or surface_area_mm2@crofton-13:surface_area_mm2@lindblad.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::COMPARE)]
pub(crate) struct Args {
    /// Table of the method, or a folder of tables
    #[arg(value_name = "METHOD.csv")]
    method: String,
    /// Table of the standard, or a folder of tables
    #[arg(value_name = "STANDARD.csv")]
    standard: String,
    /// What to compare: a column of both tables, or one of each; may be given several times [default:
    /// volume_mm3, surface_area_mm2, total_mean_curvature_mm, average_mean_curvature_per_mm,
    /// euler_characteristic]
    #[arg(long = "column", value_name = "NAME|METHOD:STANDARD")]
    columns: Vec<ColumnChoice>,
    /// Column that names the objects' inputs: of both tables, or one of each
    #[arg(long, value_name = "NAME|METHOD:STANDARD", default_value = "input")]
    object: ColumnChoice,
    /// Column that has the objects' labels: of both tables, or one of each [default: label, where there is one]
    #[arg(long, value_name = "NAME|METHOD:STANDARD")]
    label: Option<ColumnChoice>,
    /// What to call the two [default: the files' names]
    #[arg(long, value_name = "METHOD,STANDARD", value_parser = two_names)]
    names: Option<[String; 2]>,
    /// Files to write as well: .html a page with charts, .png or .svg the charts, .json everything; may be
    /// given several times
    #[arg(short, long = "output", value_name = "FILE")]
    outputs: Vec<PathBuf>,
    /// Samples of the bootstrap
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    bootstrap: u32,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let [method, standard] = tables(args)?;
    let files = method.files.iter().chain(&standard.files);
    let inputs: Vec<String> = files.map(|file| file.to_string_lossy().into_owned()).collect();
    for (number, output) in args.outputs.iter().enumerate() {
        check_output(Some(output), &inputs)?;
        kind_of(output)?;
        if args.outputs[..number].contains(output) {
            bail!("{}: named twice", output.display());
        }
    }
    let how = Bootstrap { samples: args.bootstrap as usize, ..Bootstrap::default() };
    let columns = chosen_columns([&method, &standard], &args.columns)?;
    let names = args.names.clone().unwrap_or_else(|| names_of([&args.method, &args.standard]));
    let comparison = compare([&method, &standard], names, &columns, how)?;
    if !quiet {
        let lost = comparison.only_method.len() + comparison.only_standard.len();
        if lost > 0 {
            say(&format!("{} objects are in both tables, {lost} in one alone", comparison.matched));
        }
    }
    // All is made before any of it is written, so that what cannot be made leaves nothing behind.
    let made = |output: &PathBuf| made(output, &comparison, [&method, &standard]);
    let made = args.outputs.iter().map(made).collect::<Result<Vec<_>>>()?;
    for (output, made) in args.outputs.iter().zip(made) {
        made.write(output)?;
    }
    deliver(&plain(&comparison_text(&comparison)), None)?;
    Ok(ALL_DONE)
}

fn tables(args: &Args) -> Result<[Table; 2]> {
    let paths = [&args.method, &args.standard].map(Path::new);
    read_tables(paths, &args.object, args.label.as_ref()).map_err(|error| match error {
        TableError::Unnamed { .. } => anyhow!("{error}; name the one that does with --object"),
        error => error.into(),
    })
}

#[derive(Clone, Copy)]
enum Kind {
    Page,
    Picture,
    Json,
}

fn kind_of(path: &Path) -> Result<Kind> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    Ok(match ending.as_deref() {
        Some("html" | "htm") => Kind::Page,
        Some("png" | "svg") => Kind::Picture,
        Some("json") => Kind::Json,
        _ => bail!("{}: the name must end in .html, .png, .svg or .json", path.display()),
    })
}

/// What a file will hold.
enum Made {
    Text(String),
    Picture(Figure),
}

impl Made {
    fn write(&self, path: &Path) -> Result<()> {
        match self {
            Self::Text(text) => deliver(text, Some(path)),
            Self::Picture(chart) => Ok(write_figure(chart, path, MapStyle::default().dpi_scale)?),
        }
    }
}

fn made(path: &Path, comparison: &Comparison, tables: [&Table; 2]) -> Result<Made> {
    Ok(match kind_of(path)? {
        Kind::Picture => {
            Made::Picture(comparison_chart(comparison).with_context(|| no_chart(path, comparison))?)
        }
        Kind::Json => Made::Text(json_text(comparison)?),
        Kind::Page => {
            let source = |table: &Table| HashedInput::of(&table.path.to_string_lossy(), &table.files);
            let sources = tables.into_iter().map(source).collect::<Result<_, _>>()?;
            let page = ComparisonPage::new(comparison.clone(), Provenance::new(command_line(), sources));
            Made::Text(render_comparison(&page)?)
        }
    })
}

fn no_chart(path: &Path, comparison: &Comparison) -> String {
    let why = |m: &MeasureAgreement| m.problem.as_ref().map(|problem| format!("{}: {problem}", m.column));
    let whys: Vec<String> = comparison.measures.iter().filter_map(why).collect();
    let why = if whys.is_empty() {
        "Euler characteristics have none but on the page (.html)".to_owned()
    } else {
        whys.join("; ")
    };
    format!("{}: there is no chart to draw: {why}; nothing was written, leave this file out", path.display())
}
