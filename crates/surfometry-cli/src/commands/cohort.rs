//! `surfometry cohort`.

use super::ALL_DONE;
use crate::console::progress_bar;
use anyhow::{Result, anyhow};
use std::path::PathBuf;
use surfometry::io::try_writing;
use surfometry::phantoms::cohort;
use surfometry::runs::write_cohort;

/// Most bones of a kind: a file each.
const MOST: i64 = 100_000;

/// Write a cohort of femurs and vertebrae like the paper's, and a table of their exact integrals
///
/// Each is a phantom with a shape, size, pose and spacing of its own, the same at every run. truth.csv can be
/// given to `compare`. Files that are there already are left as they are, so a run that was stopped can be
/// started again.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::COHORT)]
pub(crate) struct Args {
    /// Folder to write into; it is made where it is not there
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Right proximal femurs
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(..=MOST))]
    femurs: u32,
    /// Fourth lumbar vertebrae
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(..=MOST))]
    vertebrae: u32,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    // Before an hour's work.
    std::fs::create_dir_all(&args.output)
        .and_then(|()| try_writing(args.output.join("trial")))
        .map_err(|error| anyhow!("{}: cannot be written: {error}", args.output.display()))?;
    let members = cohort(args.femurs, args.vertebrae);
    let progress = progress_bar(members.len(), quiet);
    write_cohort(&args.output, &members, |name| {
        progress.set_message(name.to_owned());
        progress.inc(1);
    })?;
    progress.finish_and_clear();
    Ok(ALL_DONE)
}
