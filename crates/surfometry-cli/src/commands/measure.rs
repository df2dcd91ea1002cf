//! `surfometry measure`.

use crate::console::{Voice, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::journal_options::JournalOptions;
use crate::options::{MeasureOptions, OutputFormat, OutputOptions};
use crate::output::{
    Failures, RecordTables, Shown, check_output, say_sigmas, status, with_scales, write_results,
};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;
use surfometry::measurement::CurvatureScale;
use surfometry::runs::{
    Batch, Choices, ExplainTopology, FileLedger, MapFile, MapStyle, MeasureTask, PartFiles, PartTables,
    Pictures, Plan, Settings, SigmaRange,
};

/// Measure the objects of label images
///
/// INPUT is a file (NIfTI, MetaImage, NRRD, NumPy), a pattern, or a built-in shape with known truth:
/// phantom:NAME?key=value&... with these names and their keys: ball (radius), ellipsoid (radii), capsule (radius,
/// length), torus (major, minor), rounded-box (radii, radius), shell (radius, inner), two-balls (radius, length),
/// genus (genus, major, minor), gyroid (period, size), schwarz-p (period, size), femur (individual), vertebra
/// (individual, holes); all take spacing, rotate, shift, jitter, flips. A closed mesh (STL, PLY) is put on the lattice of
/// --spacing.
///
/// Exit status: 0 all measured, 1 some inputs failed (they are listed, the others are measured), 2 the
/// command was wrong, 130 stopped by Ctrl-C.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::MEASURE)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub(crate) struct Args {
    /// Files, patterns or phantoms
    #[arg(required = true, value_name = "INPUT", value_parser = input_name())]
    inputs: Vec<String>,
    #[command(flatten)]
    options: MeasureOptions,
    #[command(flatten)]
    results: OutputOptions,
    #[command(flatten)]
    journal: JournalOptions,
    /// Picture of the surface, coloured by mean curvature; `map` makes others. Where there are several inputs
    /// or objects, `_NAME` and `_label-N` go before the ending
    #[arg(long, value_name = "FILE.png", help_heading = "Results")]
    png: Option<PathBuf>,
    /// Shows every object in full in the table: as it was segmented, its standard error, the surface that was integrated over,
    /// and its voxels. So is one object alone; several have a line each
    #[arg(long, help_heading = "Results")]
    details: bool,
    /// The same, and shows what was added for the original object, term by term, and every place where the
    /// blur or the band changes the object's topology (docs/quantities.md); the places are in JSON too, and
    /// are looked for where voxels and surface agree as well
    #[arg(long, help_heading = "Results")]
    explain: bool,
    /// Label image, on any lattice, whose labels are regions: each object's numbers by region as well, which add up to its
    /// own. In JSON, below a table, and in FILE_regions.csv beside -o FILE.csv
    #[arg(long, value_name = "FILE", help_heading = "Objects")]
    regions: Option<String>,
    /// Area and curvature of the contact between any two labels that touch, background among them: in JSON, below a table,
    /// and in FILE_interfaces.csv beside -o FILE.csv
    #[arg(long, conflicts_with = "per_component", help_heading = "Objects")]
    interfaces: bool,
    /// Measures each 26-connected piece as an object of its own, the largest first
    #[arg(long, conflicts_with = "png", help_heading = "Objects")]
    per_component: bool,
    /// Says on stderr where the time went, stage by stage
    #[arg(long, help_heading = "Results", hide_short_help = true)]
    timings: bool,
    /// Says on stderr how much memory was needed
    #[arg(long, short, help_heading = "Results", hide_short_help = true)]
    verbose: bool,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let explain_topology = if args.explain { ExplainTopology::Always } else { ExplainTopology::default() };
    let choices =
        Choices { regions: args.regions.clone(), interfaces: args.interfaces, ..args.options.choices() };
    let plan = Plan {
        explain_topology,
        per_component: args.per_component,
        ..choices.plan(CurvatureScale::AsMeasured)?
    };
    plan.check()?;
    let inputs = expand(&args.inputs);
    let beside = part_files(args, &plan)?;
    let read = args.options.files_read(&inputs, args.regions.iter().map(String::as_str));
    for path in args.results.path().into_iter().chain(args.png.as_deref()).chain(beside.paths()) {
        check_output(Some(path), &read)?;
    }
    args.results.check()?;
    check_picture(args)?;
    let (path, style, ledger) = (args.png.clone(), MapStyle::default(), FileLedger::new(&read));
    let pictures = path.map(|path| Pictures { path, style, ledger });
    let (open, scale_ledger) = (plan.open.clone(), plan.scale_ledger.clone());
    let settings = Settings::of(&plan);
    let mut journal = args.journal.begin(&plan, &inputs, args.results.path())?;
    let inputs = args.journal.own(&inputs);
    let task = MeasureTask { plan, pictures, timings: args.timings };
    let control = control(inputs.len(), Voice { quiet, memory: args.verbose });
    let batch = Batch { inputs: &inputs, open, control: &control, cure };
    if let Some(journal) = journal.take_if(|_| args.journal.is_shard()) {
        return Ok(status(journal.run(&batch, task, None).context("the shard cannot be written")?));
    }
    let shown = RecordTables::new(Shown { details: args.details, explain: args.explain }, &inputs);
    let status = write_results(&args.results, shown, &settings, quiet, Failures::Told, |sink| {
        let mut tables = PartTables::new(sink, &beside);
        let mut sigmas = SigmaRange::new(&mut tables);
        let outcome = match journal {
            Some(journal) => journal.run(&batch, task, Some(&mut sigmas))?,
            None => batch.run(&task, &mut sigmas)?,
        };
        if !quiet && args.options.sigma_is_automatic() {
            say_sigmas(&sigmas);
        }
        tables.write()?;
        Ok(outcome)
    })?;
    Ok(with_scales(status, &scale_ledger, quiet))
}

/// The tables of regions and interfaces that lie beside the one of objects.
fn part_files(args: &Args, plan: &Plan) -> Result<PartFiles> {
    let wanted = args.regions.is_some() || args.interfaces;
    match args.results.path() {
        _ if !wanted || args.results.format() != OutputFormat::Csv => Ok(PartFiles::default()),
        Some(path) => Ok(PartFiles::beside(path, plan)),
        None => bail!(
            "regions and interfaces have tables of their own beside -o FILE.csv: name it, or take --format json"
        ),
    }
}

fn check_picture(args: &Args) -> Result<()> {
    let Some(path) = &args.png else { return Ok(()) };
    if MapFile::of_path(path) != Some(MapFile::Png) {
        bail!("{}: the picture's name must end in .png", path.display());
    }
    if args.results.path() == Some(path) {
        bail!("{}: named twice, for the results and for the picture", path.display());
    }
    Ok(())
}
