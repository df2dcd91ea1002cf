//! `surfometry`: measures the surfaces of segmented 3-D objects. Parses, calls the library, prints.

mod commands;
mod inputs;
mod options;
mod output;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Measures the surfaces of segmented 3-D objects: volume, area, mean and Gaussian curvature, Euler characteristic.
#[derive(Debug, Parser)]
#[command(version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Threads to use; results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No progress and no warnings on stderr
    #[arg(long, short, global = true)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Measure(commands::measure::Args),
    Info(commands::info::Args),
    Phantom(commands::phantom::Args),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Some(threads) = cli.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        if let Err(error) = pool.build_global() {
            eprintln!("surfometry: cannot start {threads} threads: {error}");
            return commands::WRONG_COMMAND.into();
        }
    }
    let outcome = match cli.command {
        Command::Measure(args) => commands::measure::run(&args, cli.quiet),
        Command::Info(args) => commands::info::run(&args),
        Command::Phantom(args) => commands::phantom::run(&args),
    };
    match outcome {
        Ok(status) => status.into(),
        Err(error) => {
            eprintln!("surfometry: {error:#}");
            commands::WRONG_COMMAND.into()
        }
    }
}
