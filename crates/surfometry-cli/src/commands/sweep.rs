//! `surfometry sweep`.

use super::{ALL_DONE, SOME_FAILED};
use crate::inputs::expand;
use crate::options::{MeasureOptions, OutputFormat, OutputOptions};
use crate::output::{Layout, check_output, csv_text, deliver, digits, failures_text, json_text, say};
use crate::picture_options::PictureOptions;
use crate::progress::{progress_bar, said_failure};
use anyhow::{Result, bail};
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use surfometry::Measurement;
use surfometry::measurement::{CurvatureScale, Parameters};
use surfometry::pictures::{PictureStyle, color_scale};
use surfometry::runs::{
    ExplainTopology, FileLedger, InputError, InputOptions, MapFile, Output, Record, SweepAxis,
    distinct_parts, measure_input, visit_objects, with_parts, write_map_files, write_sweep_chart,
};

/// Measure the same objects over a range of sigma, thickness or level
///
/// Where a number stays the same over the range it is the object's; where it drifts or jumps, the choice matters: parts are lost, or the grid shows. The
/// records are those of `measure`, one a value; what is swept stands in their parameters.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,
    /// What is swept
    #[arg(long, value_enum, default_value = "sigma")]
    over: Swept,
    /// First and last value, and how many: mm, or the level itself
    #[arg(long, value_name = "FROM:TO:COUNT", value_parser = range)]
    range: Range,
    /// Equal ratios between values, not equal steps
    #[arg(long)]
    log: bool,
    /// Chart of V, A, M and chi over the range, an object each: blurred, and original with 95 % bars. Where there are several inputs or
    /// objects, `_NAME` and `_label-N` go before the ending
    #[arg(long, value_name = "FILE.png|.svg")]
    chart: Option<PathBuf>,
    /// What the chart shows instead: names of columns of --format csv, such as average_mean_curvature_per_mm,blurred_volume_mm3
    #[arg(long, value_delimiter = ',', value_name = "NAME", requires = "chart")]
    measures: Vec<String>,
    /// Pictures of the surface along the way, all in the colours of the first; the value, such as `_sigma-2`, goes before the ending
    #[arg(long, value_name = "FILE.png|.svg")]
    surfaces: Option<PathBuf>,
    /// How many of them, evenly over the values
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=100))]
    surface_count: u32,
    #[command(flatten)]
    pictures: PictureOptions,
    #[command(flatten)]
    results: OutputOptions,
    #[command(flatten)]
    options: MeasureOptions,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Swept {
    Sigma,
    Thickness,
    Level,
}

impl Swept {
    fn set(self, measurement: Measurement, value: f64) -> Measurement {
        match self {
            Self::Sigma => measurement.sigma_mm(value),
            Self::Thickness => measurement.thickness_mm(value),
            Self::Level => measurement.level(value),
        }
    }

    fn of(self, record: &Record) -> Option<f64> {
        self.value()(&record.measured.parameters)
    }

    fn value(self) -> fn(&Parameters) -> Option<f64> {
        match self {
            Self::Sigma => |p| p.sigma_mm,
            Self::Thickness => |p| Some(p.thickness_mm),
            Self::Level => |p| p.level,
        }
    }

    /// The horizontal axis of a chart.
    fn axis(self, log: bool) -> SweepAxis {
        let name = match self {
            Self::Sigma => "sigma (mm)",
            Self::Thickness => "thickness t (mm)",
            Self::Level => "level",
        };
        SweepAxis { name, value: self.value(), log }
    }

    fn heading(self) -> &'static str {
        match self {
            Self::Sigma => "sigma mm",
            Self::Thickness => "t mm",
            Self::Level => "level",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Range {
    first: f64,
    last: f64,
    count: u32,
}

/// Most values of a sweep.
const MOST_VALUES: u32 = 1000;

fn range(text: &str) -> Result<Range, String> {
    let wrong =
        || format!("`{text}`: write FROM:TO:COUNT, two positive numbers and a count of 2 to {MOST_VALUES}");
    let [first, last, count] = text.split(':').collect::<Vec<_>>().try_into().map_err(|_| wrong())?;
    let number =
        |part: &str| part.parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0).ok_or_else(wrong);
    let count = count.parse().ok().filter(|n| (2..=MOST_VALUES).contains(n)).ok_or_else(wrong)?;
    Ok(Range { first: number(first)?, last: number(last)?, count })
}

impl Range {
    fn values(&self, log: bool) -> Vec<f64> {
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

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let measurement = args.options.measurement()?;
    if args.options.gives(args.over.to_possible_value().expect("none is skipped").get_name()) {
        bail!("the same length is swept and given: leave the option out");
    }
    let wanted = InputOptions {
        explain_topology: ExplainTopology::Never,
        ..args.options.inputs(CurvatureScale::AsMeasured)
    };
    let inputs = expand(&args.inputs);
    check_output(args.results.path(), &inputs)?;
    for (path, what) in [(&args.chart, "chart"), (&args.surfaces, "pictures")] {
        check_picture(args, path.as_deref(), what)?;
        check_output(path.as_deref(), &inputs)?;
    }
    let (mut ledger, mut all_drawn) = (FileLedger::new(&inputs), true);
    let values = args.range.values(args.log);
    let progress = progress_bar(inputs.len() * values.len(), quiet);
    let (mut results, mut failures) = (Vec::new(), Vec::new());
    for (input, part) in inputs.iter().zip(distinct_parts(&inputs)) {
        let mut of_input = Vec::new();
        for &value in &values {
            progress.set_message(format!("{input}, {} {}", args.over.heading(), digits(value)));
            match records(input, &args.over.set(measurement, value), &wanted) {
                Ok(records) => of_input.extend(records),
                // A value that makes no sense leaves the others; a file that cannot be read does not change.
                Err(error @ InputError::Measure(_)) => {
                    let error = format!("{} {}: {error}", args.over.heading(), digits(value));
                    failures.push(said_failure(&progress, input, &error));
                }
                Err(error) => {
                    failures.push(said_failure(&progress, input, &error));
                    break;
                }
            }
            progress.inc(1);
        }
        // Object by object, each over the range.
        of_input.sort_by_key(|record: &Record| record.label.as_ref().map(|label| label.labels().to_vec()));
        if let Some(path) = &args.chart {
            for failure in draw(args, &of_input, &with_parts(path, part.as_slice()), &mut ledger) {
                progress.suspend(|| say(&format!("no chart: {failure}")));
                all_drawn = false;
            }
        }
        if let Some(path) = &args.surfaces {
            let path = with_parts(path, part.as_slice());
            if let Err(failure) =
                draw_surfaces(args, input, (&measurement, &wanted), &values, &path, &mut ledger)
            {
                progress.suspend(|| say(&format!("no pictures of {input}: {failure}")));
                all_drawn = false;
            }
        }
        results.extend(of_input);
    }
    progress.finish_and_clear();
    let output = Output::new(results, failures);
    let text = match args.results.format() {
        OutputFormat::Table => table(args.over, &output) + &failures_text(&output),
        OutputFormat::Json => json_text(&output)?,
        OutputFormat::Csv => csv_text(&output)?,
    };
    deliver(&text, args.results.path())?;
    Ok(if output.failures.is_empty() && all_drawn { ALL_DONE } else { SOME_FAILED })
}

fn check_picture(args: &Args, path: Option<&Path>, what: &str) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if !matches!(MapFile::of_path(path), Some(MapFile::Png | MapFile::Svg)) {
        bail!("{}: the {what}'s name must end in .png or .svg", path.display());
    }
    if args.results.path() == Some(path) {
        bail!("{}: named twice, for the results and for the {what}", path.display());
    }
    Ok(())
}

/// Draws the surfaces of an input's objects at some of the values.
fn draw_surfaces(
    args: &Args,
    input: &str,
    (measurement, wanted): (&Measurement, &InputOptions),
    values: &[f64],
    path: &Path,
    ledger: &mut FileLedger,
) -> Result<()> {
    let mut style = args.pictures.map_style();
    let count = (args.surface_count as usize).min(values.len());
    let name = args.over.to_possible_value().expect("none is skipped").get_name().to_owned();
    for n in 0..count {
        let value = values[(n * (values.len() - 1)).div_ceil((count - 1).max(1))];
        let path = with_parts(path, &[format!("{name}-{}", digits(value))]);
        visit_objects(input, &args.over.set(*measurement, value), wanted, |object| {
            let PictureStyle { quantity, limit, .. } = style.picture;
            let [_, most] = color_scale(object.surface(), quantity, limit).limits();
            style.picture.limit = Some(most);
            write_map_files(object, &path, &style, ledger)?;
            Ok(())
        })?;
    }
    Ok(())
}

/// Draws a chart for each object of an input; what could not be drawn.
fn draw(args: &Args, records: &[Record], path: &Path, ledger: &mut FileLedger) -> Vec<InputError> {
    let objects: Vec<&[Record]> = records.chunk_by(|a, b| a.label == b.label).collect();
    let several = objects.len() > 1;
    let mut draw = |records: &&[Record]| {
        let label = records[0].label.as_ref().filter(|_| several).map(|label| format!("label-{label}"));
        write_sweep_chart(
            records,
            &args.over.axis(args.log),
            &args.measures,
            &with_parts(path, label.as_slice()),
            ledger,
        )
        .err()
    };
    objects.iter().filter_map(&mut draw).collect()
}

fn records(input: &str, measurement: &Measurement, wanted: &InputOptions) -> Result<Vec<Record>, InputError> {
    Ok(measure_input(input, measurement, wanted, |_| {})?.records)
}

fn table(over: Swept, output: &Output) -> String {
    let columns = [
        "label",
        over.heading(),
        "V",
        "\u{b1}",
        "blurred",
        "A",
        "\u{b1}",
        "blurred",
        "M",
        "\u{b1}",
        "blurred",
        "chi",
        "chi mesh",
        "flags",
    ];
    let by_input = output.results.chunk_by(|a, b| a.input == b.input);
    let text_of = |records: &[Record]| {
        let mut layout = Layout::new(&columns);
        for record in records {
            layout.row(row(over, record));
        }
        format!("{}\n{}", records[0].input, layout.text())
    };
    let text = by_input.map(text_of).collect::<Vec<_>>().join("\n");
    text + "\nV mm\u{b3}, A mm\u{b2}, M = total H mm of the object as it was segmented, with standard errors; blurred: of the smoothed surface.\n"
}

fn row(over: Swept, record: &Record) -> Vec<String> {
    let m = &record.measured;
    let number = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), digits);
    let rough = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.2e}"));
    let (e, b) = (&m.standard_error, &m.blurred);
    let codes: Vec<String> = m.flags.iter().map(|flag| flag.code.to_string()).collect();
    vec![
        record.label.as_ref().map_or_else(String::new, ToString::to_string),
        number(over.of(record)),
        number(m.volume_mm3),
        rough(e.volume_mm3),
        number(b.volume_mm3),
        number(m.surface_area_mm2),
        rough(e.surface_area_mm2),
        number(b.surface_area_mm2),
        number(m.total_mean_curvature_mm),
        rough(e.total_mean_curvature_mm),
        number(b.total_mean_curvature_mm),
        b.euler_characteristic.map_or_else(|| "-".to_owned(), |chi| format!("{chi:.2}")),
        m.topology.euler_characteristic_mesh.map_or_else(|| "-".to_owned(), |chi| chi.to_string()),
        codes.join(";"),
    ]
}
