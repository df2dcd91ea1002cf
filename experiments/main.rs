//! The paper's figures and tables, made anew: `cargo run --release -p surfometry-experiments`.
//!
//! A folder an experiment: `mod.rs` says what the paper did and does it, `expected/numbers.csv` holds what
//! came out when it was last looked at. What is done already is not done again.

mod alternatives;
mod bones;
mod curvature_flow;
mod dataset;
mod desk;
mod euler_characteristic;
mod local_accuracy;
mod necessity;
mod overview;
mod second_hole;
mod smoothing;
mod sweeps;
mod table;
mod thickness;
mod torus;
mod validation;
mod workflow;

use anyhow::{Result, bail};
use clap::Parser;
use desk::Desk;
use std::path::PathBuf;
use std::time::Instant;

/// One figure or table.
pub(crate) struct Experiment {
    /// Its folder here.
    pub(crate) name: &'static str,
    /// Its heading on the page.
    pub(crate) title: &'static str,
    /// Does it.
    pub(crate) run: fn(&mut Desk) -> Result<()>,
}

/// In the order of the page; later ones read what earlier ones measured.
const EXPERIMENTS: [Experiment; 13] = [
    workflow::EXPERIMENT,
    torus::EXPERIMENT,
    curvature_flow::EXPERIMENT,
    dataset::EXPERIMENT,
    necessity::EXPERIMENT,
    smoothing::EXPERIMENT,
    thickness::EXPERIMENT,
    validation::EXPERIMENT,
    euler_characteristic::EXPERIMENT,
    second_hole::EXPERIMENT,
    overview::EXPERIMENT,
    local_accuracy::EXPERIMENT,
    alternatives::EXPERIMENT,
];

/// Reproduces the figures and tables of Besler et al. on a cohort made by code
#[derive(Debug, Parser)]
struct Args {
    /// Experiments by name; all where none is named
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(EXPERIMENTS.map(|e| e.name)))]
    names: Vec<String>,
    /// Where cohort, figures and numbers go
    #[arg(short, long, default_value = "target/reproduction")]
    output: PathBuf,
    /// Do again what is done already
    #[arg(long)]
    again: bool,
    /// Compare the numbers with those of expected/; exit status 1 where they differ
    #[arg(long)]
    check: bool,
    /// Take the numbers into expected/, and all sections and figures into docs/
    #[arg(long)]
    accept: bool,
}

fn main() -> Result<()> {
    let args = Args::parse();
    let wanted: Vec<&Experiment> = EXPERIMENTS
        .iter()
        .filter(|e| args.names.is_empty() || args.names.iter().any(|name| name == e.name))
        .collect();
    let mut differing = Vec::new();
    for (number, experiment) in (1..).zip(&wanted) {
        let mut desk = Desk::new(&args.output, experiment.name)?;
        eprint!("{number}/{} {}", wanted.len(), experiment.name);
        if args.again {
            desk.clear()?;
        }
        if desk.is_done() {
            eprintln!(": done before");
        } else {
            eprintln!();
            let start = Instant::now();
            (experiment.run)(&mut desk)?;
            desk.finish(experiment.title)?;
            eprintln!("  {:.0} s", start.elapsed().as_secs_f64());
        }
        if args.check {
            differing.extend(desk.differences()?);
        }
        if args.accept {
            desk.accept()?;
        }
    }
    if args.accept && args.names.is_empty() {
        desk::write_page(&args.output, &EXPERIMENTS.map(|e| e.name))?;
    }
    if !differing.is_empty() {
        bail!("{} numbers are not those of expected/:\n{}", differing.len(), differing.join("\n"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quick ones; all of them are compared by `.ci/scheduled`.
    #[test]
    fn quick_experiments_give_the_expected_numbers() {
        let folder = tempfile::tempdir().unwrap();
        for experiment in [torus::EXPERIMENT, curvature_flow::EXPERIMENT] {
            let mut desk = Desk::new(folder.path(), experiment.name).unwrap();
            assert!(!desk.is_done());
            (experiment.run)(&mut desk).unwrap();
            desk.finish(experiment.title).unwrap();
            assert!(desk.is_done());
            assert_eq!(desk.differences().unwrap(), Vec::<String>::new());
        }
    }
}
