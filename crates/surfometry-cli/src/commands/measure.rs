//! `surfometry measure`.

use crate::console::{Voice, control};
use crate::cures::cure;
use crate::inputs::{expand, input_name};
use crate::journal_options::JournalOptions;
use crate::options::{MeasureOptions, OutputOptions};
use crate::output::{RecordTables, Shown, check_output, say_sigmas, status, with_scales, write_results};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;
use surfometry::measurement::CurvatureScale;
use surfometry::runs::{
    Batch, ExplainTopology, FileLedger, MapFile, MapStyle, MeasureTask, Pictures, Plan, Settings, SigmaRange,
};

/// Measure the objects of label images
///
/// INPUT is a file (NIfTI, MetaImage, NRRD, NumPy), a pattern, or a built-in shape with known truth:
/// phantom:NAME?key=value&... with NAME ball, ellipsoid, capsule, torus, rounded-box, shell, two-balls,
/// genus, gyroid, schwarz-p, femur or vertebra and keys radius, radii, major, minor, length, inner, genus,
/// period, size, individual, holes, spacing, rotate, shift, jitter, flips. A closed mesh (STL, PLY) is put on the
/// lattice of --spacing.
///
/// Exit status: 0 all measured, 1 some inputs failed (they are listed, the others are measured), 2 the
/// command was wrong, 130 stopped by Ctrl-C.
#[derive(Debug, clap::Args)]
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
    #[arg(long, value_name = "FILE.png")]
    png: Option<PathBuf>,
    /// Shows every object in full in the table: as it was segmented, its standard error, the surface that was integrated over,
    /// and its voxels. So is one object alone; several have a line each
    #[arg(long)]
    details: bool,
    /// The same, and shows what was added for the original object, term by term, and every place where the
    /// blur or the band changes the object's topology (docs/quantities.md); the places are in JSON too, and
    /// are looked for where voxels and surface agree as well
    #[arg(long)]
    explain: bool,
    /// Measures each 26-connected piece as an object of its own, the largest first
    #[arg(long, conflicts_with = "png")]
    per_component: bool,
    /// Says on stderr where the time went, stage by stage
    #[arg(long)]
    timings: bool,
    /// Says on stderr how much memory was needed
    #[arg(long, short)]
    verbose: bool,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let explain_topology = if args.explain { ExplainTopology::Always } else { ExplainTopology::default() };
    let plan = Plan {
        explain_topology,
        per_component: args.per_component,
        ..args.options.plan(CurvatureScale::AsMeasured)?
    };
    plan.check()?;
    let inputs = expand(&args.inputs);
    check_output(args.results.path(), &inputs)?;
    check_output(args.png.as_deref(), &inputs)?;
    check_picture(args)?;
    let (path, style, ledger) = (args.png.clone(), MapStyle::default(), FileLedger::new(&inputs));
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
    let tables = RecordTables::new(Shown { details: args.details, explain: args.explain }, &inputs);
    let status = write_results(&args.results, tables, &settings, quiet, |sink| {
        let mut sigmas = SigmaRange::new(sink);
        let outcome = match journal {
            Some(journal) => journal.run(&batch, task, Some(&mut sigmas))?,
            None => batch.run(&task, &mut sigmas)?,
        };
        if !quiet && args.options.sigma_is_automatic() {
            say_sigmas(&sigmas);
        }
        Ok(outcome)
    })?;
    Ok(with_scales(status, &scale_ledger, quiet))
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
