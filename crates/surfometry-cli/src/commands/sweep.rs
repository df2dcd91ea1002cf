//! `surfometry sweep`.

use crate::console::{Voice, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::options::{MeasureOptions, OutputOptions, Range};
use crate::output::{Failures, SweepTables, check_output, with_scales, write_results};
use crate::picture_options::PictureOptions;
use crate::values::one_of;
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use surfometry::measurement::CurvatureScale;
use surfometry::runs::{
    Batch, ExplainTopology, FileLedger, MapFile, Plan, Settings, SweepChart, SweepTask, SweptParameter,
    SweptSurfaces,
};
use surfometry::surface::LocalQuantity;

/// Measure the same objects over a range of sigma, thickness or level
///
/// Where a number stays the same over the range it is the object's; where it drifts or jumps, the choice
/// matters: parts are lost, or the grid shows. The records are those of `measure`, one a value; what is swept
/// stands in their parameters.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::SWEEP)]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
    inputs: Vec<String>,
    /// What is swept
    #[arg(long, default_value = "sigma", value_parser = one_of::<SweptParameter>())]
    over: SweptParameter,
    /// First and last value, and how many: mm, or the level itself
    #[arg(long, value_name = "FROM:TO:COUNT")]
    range: Range,
    /// Equal ratios between values, not equal steps
    #[arg(long)]
    log: bool,
    /// Chart of V, A, M and chi over the range, an object each: blurred, and original with 95 % bars. Where
    /// there are several inputs or objects, `_NAME` and `_label-N` go before the ending
    #[arg(long, value_name = "FILE.png|.svg", help_heading = "Pictures")]
    chart: Option<PathBuf>,
    /// What the chart shows instead: names of columns of --format csv, such as
    /// average_mean_curvature_per_mm,blurred_volume_mm3
    #[arg(long, value_delimiter = ',', value_name = "NAME", requires = "chart", help_heading = "Pictures")]
    measures: Vec<String>,
    /// Pictures of the surface along the way, all in the colours of the first; the value, such as `_sigma-2`,
    /// goes before the ending
    #[arg(long, value_name = "FILE.png|.svg", help_heading = "Pictures")]
    surfaces: Option<PathBuf>,
    /// How many of them, evenly over the values
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=100), help_heading = "Pictures")]
    surface_count: u32,
    #[command(flatten)]
    pictures: PictureOptions,
    #[command(flatten)]
    results: OutputOptions,
    #[command(flatten)]
    options: MeasureOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    if args.options.gives(args.over) {
        bail!("the same length is swept and given: leave the option out");
    }
    let plan = args.options.plan(CurvatureScale::AsMeasured)?;
    let plan = Plan { explain_topology: ExplainTopology::Never, recover: false, ..plan };
    let inputs = expand(&args.inputs);
    let read = args.options.files_read(&inputs, None);
    check_output(args.results.path(), &read)?;
    args.results.check()?;
    for (path, what) in [(&args.chart, "chart"), (&args.surfaces, "picture")] {
        check_picture(args, path.as_deref(), what)?;
        check_output(path.as_deref(), &read)?;
    }
    let control = control(inputs.len(), Voice { quiet, memory: false });
    let (scale_ledger, settings) = (plan.scale_ledger.clone(), Settings::of(&plan));
    let batch = Batch { inputs: &inputs, open: plan.open.clone(), control: &control, cure };
    let (count, style) = (args.surface_count as usize, args.pictures.map_style(LocalQuantity::default())?);
    let (measures, log, dpi_scale) = (args.measures.clone(), args.log, style.dpi_scale);
    let chart = args.chart.clone().map(|path| SweepChart { path, measures, log, dpi_scale });
    let surfaces = args.surfaces.clone().map(|path| SweptSurfaces { path, count, style });
    let task = SweepTask {
        plan,
        over: args.over,
        values: args.range.values(args.log),
        chart,
        surfaces,
        ledger: FileLedger::new(&read),
    };
    task.check()?;
    let status =
        write_results(&args.results, SweepTables(args.over), &settings, quiet, Failures::Told, |sink| {
            batch.run(&task, sink)
        })?;
    Ok(with_scales(status, &scale_ledger, quiet))
}

fn check_picture(args: &Args, path: Option<&Path>, what: &str) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    if !MapFile::of_path(path).is_some_and(MapFile::is_picture) {
        bail!("{}: the {what}'s name must end in .png, .svg or .pdf", path.display());
    }
    if args.results.path() == Some(path) {
        bail!("{}: named twice, for the results and for the {what}", path.display());
    }
    Ok(())
}
