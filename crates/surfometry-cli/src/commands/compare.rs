//! `surfometry compare`.

use super::ALL_DONE;
use crate::output::{Layout, check_output, deliver, digits, json_text, say};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use surfometry::comparison::{ColumnPair, Comparison, EulerAgreement, Table, compare};
use surfometry::report::{ComparisonPage, Provenance, Source, comparison_chart, render_comparison};
use surfometry::runs::{MapStyle, write_figure};
use surfometry::statistics::{Agreement, Bootstrap, ConfusionMatrix, Estimate};

/// Compare two tables of the same objects: regression, Bland-Altman, concordance, Euler characteristics
///
/// Tables are CSV files as `measure --format csv` writes them, or any others with a column `input`; objects are matched by
/// the columns input and label, and by file names without folders where folders differ. Bias is METHOD minus STANDARD.
/// Give the same file twice to compare two of its columns, as volume_mm3:truth_volume_mm3.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Table of the method
    #[arg(value_name = "METHOD.csv")]
    method: String,
    /// Table of the standard
    #[arg(value_name = "STANDARD.csv")]
    standard: String,
    /// What to compare: a column of both tables, or one of each; may be given several times [default: volume_mm3,
    /// surface_area_mm2, total_mean_curvature_mm, average_mean_curvature_per_mm, euler_characteristic]
    #[arg(long = "column", value_name = "NAME|METHOD:STANDARD")]
    columns: Vec<ColumnPair>,
    /// What to call the two [default: the files' names]
    #[arg(long, value_name = "METHOD,STANDARD", value_parser = two_names)]
    names: Option<[String; 2]>,
    /// Files to write as well: .html a page with charts, .png or .svg the charts, .json everything; may be given several times
    #[arg(short, long = "output", value_name = "FILE")]
    outputs: Vec<PathBuf>,
    /// Samples of the bootstrap
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    bootstrap: u32,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let inputs = [args.method.clone(), args.standard.clone()];
    for (number, output) in args.outputs.iter().enumerate() {
        check_output(Some(output), &inputs)?;
        kind_of(output)?;
        if args.outputs[..number].contains(output) {
            bail!("{}: named twice", output.display());
        }
    }
    let [method, standard] = [Table::read(Path::new(&inputs[0]))?, Table::read(Path::new(&inputs[1]))?];
    let how = Bootstrap { samples: args.bootstrap as usize, ..Bootstrap::default() };
    let comparison = compare([&method, &standard], names(args), &args.columns, how)?;
    if !quiet {
        let lost = comparison.only_method.len() + comparison.only_standard.len();
        if lost > 0 {
            say(&format!("{} objects are in both tables, {lost} in one alone", comparison.matched));
        }
    }
    for output in &args.outputs {
        write(output, &comparison, &inputs)?;
    }
    deliver(&text(&comparison), None)?;
    Ok(ALL_DONE)
}

/// As told; else the files' names without folders and endings, with folders where these are the same.
fn names(args: &Args) -> [String; 2] {
    if let Some(names) = &args.names {
        return names.clone();
    }
    let stem = |path: &String| {
        Path::new(path).file_stem().map_or_else(|| path.clone(), |stem| stem.to_string_lossy().into_owned())
    };
    let [method, standard] = [stem(&args.method), stem(&args.standard)];
    if method != standard {
        [method, standard]
    } else if args.method != args.standard {
        [args.method.clone(), args.standard.clone()]
    } else {
        ["method".to_owned(), "standard".to_owned()]
    }
}

fn two_names(text: &str) -> Result<[String; 2], String> {
    let (method, standard) = text.split_once(',').ok_or("write two names with a comma between them")?;
    Ok([method.to_owned(), standard.to_owned()])
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

fn write(path: &Path, comparison: &Comparison, inputs: &[String; 2]) -> Result<()> {
    match kind_of(path)? {
        Kind::Picture => {
            let chart =
                comparison_chart(comparison).context("no measure could be compared, so there is no chart")?;
            Ok(write_figure(&chart, path, MapStyle::default().dpi_scale)?)
        }
        Kind::Json => deliver(&json_text(comparison)?, Some(path)),
        Kind::Page => {
            let command: Vec<String> = std::env::args().collect();
            let source = |input: &String| Source::of_files(input, &[PathBuf::from(input)]);
            let sources = inputs.iter().map(source).collect::<Result<_, _>>()?;
            let page = ComparisonPage::new(comparison.clone(), Provenance::new(command.join(" "), sources));
            deliver(&render_comparison(&page)?, Some(path))
        }
    }
}

fn text(comparison: &Comparison) -> String {
    let Comparison { method, standard, matched, .. } = comparison;
    let mut parts = vec![format!("{method} against {standard}: {matched} objects\n")];
    for measure in &comparison.measures {
        parts.push(format!("\n{}", column(&measure.column, &measure.standard_column)));
        if measure.left_out > 0 {
            parts.push(format!(" ({} objects without a value)", measure.left_out));
        }
        parts.push("\n".to_owned());
        parts.push(match &measure.agreement {
            Some(agreement) => agreement_text(agreement, [method, standard]),
            None => format!("  {}\n", measure.problem.as_deref().unwrap_or_default()),
        });
    }
    parts.extend(comparison.euler.iter().map(euler_text));
    parts.push(
        "\nbias: method minus standard; in brackets: 95 % intervals; proportional bias: slope of the differences on the means of both.\n".to_owned(),
    );
    parts.concat()
}

fn column(method: &str, standard: &str) -> String {
    if method == standard { method.to_owned() } else { format!("{method} : {standard}") }
}

fn agreement_text(a: &Agreement, [method, standard]: [&String; 2]) -> String {
    let spread =
        |s: surfometry::statistics::Spread| format!("{} \u{b1} {}", digits(s.mean), digits(s.deviation));
    let b = &a.bland_altman;
    let rows = [
        (method.as_str(), spread(a.method)),
        (standard.as_str(), spread(a.standard)),
        ("slope", estimate(&a.regression.slope)),
        ("intercept", estimate(&a.regression.intercept)),
        ("R\u{b2}", digits(a.regression.r_squared)),
        (
            "bias",
            format!("{}, {} %, p {}", estimate(&b.bias), digits(b.bias_percent), p_value(b.bias_p_value)),
        ),
        ("limits of agreement", format!("{} to {}", digits(b.limits[0].value), digits(b.limits[1].value))),
        (
            "proportional bias",
            format!("{}, p {}", estimate(&b.proportional.slope), p_value(b.proportional.slope_p_value)),
        ),
        ("concordance", estimate(&a.concordance)),
        ("ICC, agreement", estimate(&a.intraclass.agreement)),
    ];
    rows.map(|(name, value)| format!("  {name:<20} {value}\n")).concat()
}

fn estimate(e: &Estimate) -> String {
    let [value, low, high] = [e.value, e.interval[0], e.interval[1]].map(digits);
    format!("{value} ({low}, {high})")
}

fn p_value(p: f64) -> String {
    if p < 1e-4 { "< 0.0001".to_owned() } else { format!("{p:.4}") }
}

fn euler_text(euler: &EulerAgreement) -> String {
    let matrices = [("even numbers", &euler.even), ("whole numbers, as in the paper", &euler.integer)];
    let matrices = matrices.map(|(name, matrix)| {
        let share = 100.0 * matrix.accuracy();
        format!("  rounded to {name}: the same in {share:.1} % of {}\n", euler.values.len())
            + &confusion_text(matrix)
    });
    format!("\n{}\n{}", column(&euler.column, &euler.standard_column), matrices.concat())
}

/// Rows are the standard's classes, columns the method's.
fn confusion_text(matrix: &ConfusionMatrix) -> String {
    let classes: Vec<String> = matrix.classes.iter().map(ToString::to_string).collect();
    let mut columns = vec!["standard \\ method"];
    columns.extend(classes.iter().map(String::as_str));
    let mut layout = Layout::new(&columns);
    for (class, counts) in classes.iter().zip(&matrix.counts) {
        let mut row = vec![class.clone()];
        row.extend(counts.iter().map(ToString::to_string));
        layout.row(row);
    }
    layout.text()
}
