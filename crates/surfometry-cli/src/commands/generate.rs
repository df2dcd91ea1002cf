//! `surfometry generate`.

use super::ALL_DONE;
use crate::output::deliver;
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use clap_complete::Shell;
use std::path::PathBuf;

/// Write man pages, or what a shell completes commands and options with
///
/// Completions go to stdout, for the shell's own folder of them; of man pages there is one a command.
#[derive(Debug, clap::Args)]
#[command(after_help = crate::examples::GENERATE)]
pub(crate) struct Args {
    /// What to write
    #[arg(value_enum)]
    what: Generated,
    /// Folder of the man pages
    #[arg(short, long, value_name = "FOLDER", required_if_eq("what", "man"))]
    output: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Generated {
    Man,
    Bash,
    Elvish,
    Fish,
    Powershell,
    Zsh,
}

impl Generated {
    fn shell(self) -> Option<Shell> {
        match self {
            Self::Man => None,
            Self::Bash => Some(Shell::Bash),
            Self::Elvish => Some(Shell::Elvish),
            Self::Fish => Some(Shell::Fish),
            Self::Powershell => Some(Shell::PowerShell),
            Self::Zsh => Some(Shell::Zsh),
        }
    }
}

pub(crate) fn run(args: &Args, mut program: clap::Command) -> Result<u8> {
    if let Some(shell) = args.what.shell() {
        if let Some(output) = &args.output {
            bail!("--output: the folder of man pages; completions go to stdout (> {})", output.display());
        }
        let mut script = Vec::new();
        clap_complete::generate(shell, &mut program, "surfometry", &mut script);
        deliver(&String::from_utf8_lossy(&script), None)?;
    } else if let Some(folder) = &args.output {
        let written =
            std::fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(program, folder));
        written.with_context(|| format!("{}: man pages cannot be written", folder.display()))?;
    }
    Ok(ALL_DONE)
}
