//! `surfometry scan.nii.gz` means `surfometry measure scan.nii.gz`.

use clap::Command;
use std::ffi::{OsStr, OsString};
use std::path::Path;

/// The arguments with the command `measure` where none is given and the first that is no global option is an input.
pub(crate) fn with_command(arguments: impl IntoIterator<Item = OsString>, cli: &Command) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = arguments.into_iter().collect();
    if first_word(&arguments, cli).is_some_and(looks_like_input) {
        arguments.insert(1, "measure".into());
    }
    arguments
}

/// The first argument behind the program's name that is no global option; `None` where it is a command.
fn first_word<'a>(arguments: &'a [OsString], cli: &Command) -> Option<&'a OsStr> {
    let mut words = arguments.iter().skip(1);
    loop {
        let word = words.next()?;
        match word.to_str() {
            Some("--threads") => _ = words.next(),
            Some("--quiet" | "-q") => {}
            Some(text) if text.starts_with("--threads=") => {}
            Some(text) if cli.find_subcommand(text).is_some() => return None,
            _ => return Some(word),
        }
    }
}

/// A built-in shape, a file that is there, or a name that only a file has: a slip in a command's name has no dot.
fn looks_like_input(word: &OsStr) -> bool {
    let text = word.to_string_lossy();
    !text.starts_with('-')
        && (text.starts_with("phantom:") || text.contains(['.', '*']) || Path::new(word).exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> String {
        let cli =
            Command::new("surfometry").subcommand(Command::new("measure")).subcommand(Command::new("info"));
        let arguments = with_command(text.split(' ').map(OsString::from), &cli);
        arguments.iter().map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn an_input_alone_is_measured() {
        for (typed, meant) in [
            ("s scan.nii.gz --sigma 2", "s measure scan.nii.gz --sigma 2"),
            ("s -q --threads 2 phantom:ball", "s measure -q --threads 2 phantom:ball"),
            ("s --threads=1 scans/*", "s measure --threads=1 scans/*"),
            ("s info scan.nii.gz", "s info scan.nii.gz"),
            ("s -q info scan.nii.gz", "s -q info scan.nii.gz"),
            ("s mesure scan.nii.gz", "s mesure scan.nii.gz"),
            ("s --version", "s --version"),
            ("s", "s"),
        ] {
            assert_eq!(words(typed), meant);
        }
    }
}
