//! The command line of surfometry as a function, for whatever starts it: the program of that name, or the script of the
//! Python package. Parses, calls the library, prints.

mod commands;
mod console;
mod cures;
mod examples;
mod inputs;
mod journal_options;
mod options;
mod output;
mod picture_options;
mod shorthand;
mod values;

use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;

/// Measures the surfaces of segmented 3-D objects: volume, area, mean and Gaussian curvature, Euler
/// characteristic.
#[derive(Debug, Parser)]
#[command(name = "surfometry", version, arg_required_else_help = true, after_help = examples::PROGRAM)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Threads, at most the cores there are; results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No progress and no warnings on stderr
    #[arg(long, short, global = true)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Measure(commands::measure::Args),
    Merge(commands::merge::Args),
    Rerun(commands::rerun::Args),
    Map(commands::map::Args),
    Report(commands::report::Args),
    Embed(commands::embed::Args),
    Info(commands::info::Args),
    Phantom(commands::phantom::Args),
    Cohort(commands::cohort::Args),
    Sweep(commands::sweep::Args),
    Reference(commands::reference::Args),
    Compare(commands::compare::Args),
    Validate(commands::validate::Args),
    Generate(commands::generate::Args),
}

/// Does what the arguments say, of which the first is the program's name, and returns the exit status.
///
/// `--help`, `--version` and arguments that cannot be parsed end the process.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = Cli::parse_from(shorthand::with_command(arguments, &Cli::command()));
    // More threads than cores only cost time and memory.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = cli.threads.map_or(cores, usize::from).min(cores);
    if let Err(error) = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global() {
        output::say(&format!("cannot start {threads} threads: {error}"));
        return commands::WRONG_COMMAND;
    }
    let outcome = match cli.command {
        Command::Measure(args) => commands::measure::run(&args, cli.quiet),
        Command::Merge(args) => commands::merge::run(&args, cli.quiet),
        Command::Rerun(args) => commands::rerun::run(&args, cli.quiet),
        Command::Map(args) => commands::map::run(&args, cli.quiet),
        Command::Report(args) => commands::report::run(&args, cli.quiet),
        Command::Embed(args) => commands::embed::run(&args, cli.quiet),
        Command::Info(args) => commands::info::run(&args, cli.quiet),
        Command::Cohort(args) => commands::cohort::run(&args, cli.quiet),
        Command::Phantom(args) => commands::phantom::run(&args),
        Command::Sweep(args) => commands::sweep::run(&args, cli.quiet),
        Command::Reference(args) => commands::reference::run(&args, cli.quiet),
        Command::Compare(args) => commands::compare::run(&args, cli.quiet),
        Command::Validate(args) => commands::validate::run(&args, cli.quiet),
        Command::Generate(args) => commands::generate::run(&args, Cli::command()),
    };
    outcome.unwrap_or_else(|error| {
        output::say(&words_of(&error));
        status_of(&error)
    })
}

/// The exit status of a command that ended with an error. What could not be written at the end was no fault of
/// the command, which has been refused by then if it was wrong.
fn status_of(error: &anyhow::Error) -> u8 {
    if error.is::<std::io::Error>() { commands::SOME_FAILED } else { commands::WRONG_COMMAND }
}

/// An error with its causes, without those that its own words tell already.
fn words_of(error: &anyhow::Error) -> String {
    let mut words = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !words.contains(&cause) {
            words += if words.is_empty() { "" } else { ": " };
            words += &cause;
        }
    }
    words
}
