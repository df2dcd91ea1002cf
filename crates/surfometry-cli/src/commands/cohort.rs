//! `surfometry cohort`.

use super::ALL_DONE;
use crate::output::deliver;
use crate::progress::progress_bar;
use anyhow::{Context, Result};
use std::path::PathBuf;
use surfometry::io::write_labels;
use surfometry::phantoms::{CohortMember, Phantom, Truth, cohort};
use surfometry::runs::open_labels;

/// Write a cohort of femurs and vertebrae like the paper's, and a table of their exact integrals
///
/// Each is a phantom with a shape, size, pose and spacing of its own, the same at every run. truth.csv can be given to `compare`. Files that are there already are
/// left as they are, so a run that was stopped can be started again.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Folder to write into; it is made where it is not there
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Right proximal femurs
    #[arg(long, default_value_t = 50)]
    femurs: u32,
    /// Fourth lumbar vertebrae
    #[arg(long, default_value_t = 50)]
    vertebrae: u32,
}

pub(crate) fn run(args: &Args, quiet: bool) -> Result<u8> {
    std::fs::create_dir_all(&args.output).with_context(|| args.output.display().to_string())?;
    let members = cohort(args.femurs, args.vertebrae);
    let progress = progress_bar(members.len(), quiet);
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record([
        "input",
        "label",
        "volume_mm3",
        "surface_area_mm2",
        "total_mean_curvature_mm",
        "average_mean_curvature_per_mm",
        "euler_characteristic",
        "phantom",
    ])?;
    for member in &members {
        progress.set_message(member.name.clone());
        let truth = write(member, args)?;
        let file = format!("{}.nii.gz", member.name);
        let mut row = vec![file, "1".to_owned()];
        let numbers =
            [truth.volume, truth.surface_area, truth.total_mean_curvature, truth.average_mean_curvature];
        row.extend(numbers.map(|v| v.to_string()));
        row.extend([truth.euler_characteristic.to_string(), member.spec.clone()]);
        table.write_record(row)?;
        progress.inc(1);
    }
    progress.finish_and_clear();
    deliver(&String::from_utf8(table.into_inner()?)?, Some(&args.output.join("truth.csv")))?;
    Ok(ALL_DONE)
}

fn write(member: &CohortMember, args: &Args) -> Result<Truth> {
    let path = args.output.join(format!("{}.nii.gz", member.name));
    let truth = if path.exists() {
        Phantom::from_spec(&member.spec)?.truth()
    } else {
        let source = open_labels(&member.spec, None).with_context(|| member.spec.clone())?;
        write_labels(&path, &source.image).with_context(|| path.display().to_string())?;
        source.truth
    };
    truth.with_context(|| format!("{}: its exact integrals did not converge", member.spec))
}
