//! `surfometry merge`.

use crate::inputs::expand;
use crate::options::OutputOptions;
use crate::output::{Failures, RecordTables, Shown, check_output, say_sigmas, write_results};
use anyhow::Result;
use std::path::PathBuf;
use surfometry::runs::{Shards, SigmaRange};

/// Join the shards of a run (`measure --shard`) into one table, CSV or JSON
///
/// The result is what one run over all inputs writes: the same rows in the same order. Shards that are missing, there
/// twice, unfinished, or measured with other choices, other inputs or another version are refused.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::MERGE)]
pub(crate) struct Args {
    /// Files that `measure --shard` wrote, in any order, or patterns
    #[arg(required = true, value_name = "SHARD")]
    shards: Vec<String>,
    #[command(flatten)]
    results: OutputOptions,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    let paths = expand(&args.shards);
    check_output(args.results.path(), &paths)?;
    args.results.check()?;
    let shards = Shards::read(&paths.into_iter().map(PathBuf::from).collect::<Vec<_>>())?;
    let settings = shards.settings().clone();
    let shown = Shown { explain: settings.explain(), ..Shown::default() };
    let tables = RecordTables::new(shown, &shards.inputs());
    write_results(&args.results, tables, &settings, quiet, Failures::Untold, |sink| {
        let mut sigmas = SigmaRange::new(sink);
        let outcome = shards.replay(&mut sigmas)?;
        if !quiet && settings.sigma_is_automatic() {
            say_sigmas(&sigmas);
        }
        Ok(outcome)
    })
}
