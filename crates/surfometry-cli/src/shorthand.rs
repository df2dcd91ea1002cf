//! `surfometry scan.nii.gz` means `surfometry measure scan.nii.gz`.

use clap::{Arg, Command};
use std::ffi::{OsStr, OsString};
use std::path::Path;

/// The arguments with the command `measure` where none is given and the first that is no option is an input, or has options of
/// `measure` in front.
pub(crate) fn with_command(arguments: impl IntoIterator<Item = OsString>, cli: &Command) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = arguments.into_iter().collect();
    if means_measure(&arguments, cli) {
        arguments.insert(1, "measure".into());
    }
    arguments
}

fn means_measure(arguments: &[OsString], cli: &Command) -> bool {
    let mut has_option = false;
    let mut words = arguments.iter().skip(1);
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        if !text.starts_with('-') || text == "-" {
            let is_command = text == "help" || cli.find_subcommand(&*text).is_some();
            return !is_command && (has_option || looks_like_input(word));
        }
        let Some((option, is_global)) = option_of(&text, cli) else { return has_option };
        has_option |= !is_global;
        if takes_next(option, &text) {
            words.next();
        }
    }
    has_option
}

/// The option that a word begins with, and whether every command has it; `None` of one that neither the program nor `measure`
/// has, and of those that ask for help.
fn option_of<'a>(word: &str, cli: &'a Command) -> Option<(&'a Arg, bool)> {
    let is_meant = |option: &&Arg| match word.strip_prefix("--") {
        Some(long) => option.get_long() == long.split('=').next(),
        None => option.get_short().is_some_and(|short| word.chars().nth(1) == Some(short)),
    };
    let global = cli.get_arguments().find(is_meant).map(|option| (option, true));
    let own = || cli.find_subcommand("measure")?.get_arguments().find(is_meant).map(|option| (option, false));
    global.or_else(own)
}

/// Whether the word behind an option is its value: not where that stands in the same word.
fn takes_next(option: &Arg, word: &str) -> bool {
    let is_alone = if word.starts_with("--") { !word.contains('=') } else { word.chars().count() == 2 };
    is_alone && option.get_action().takes_values()
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
    use clap::ArgAction;

    fn words(text: &str) -> String {
        let option = |name: &'static str| Arg::new(name).long(name);
        let switch = |name: &'static str| option(name).action(ArgAction::SetTrue);
        let measure = Command::new("measure").args([
            option("label"),
            option("output").short('o'),
            switch("details"),
            switch("verbose").short('v'),
        ]);
        let cli = Command::new("surfometry")
            .args([option("threads"), switch("quiet").short('q')])
            .subcommand(measure)
            .subcommand(Command::new("info"));
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
            ("s --label 1 scan.nii.gz", "s measure --label 1 scan.nii.gz"),
            ("s -q --label=1 --details scan", "s measure -q --label=1 --details scan"),
            ("s -o out.csv scan.nii.gz", "s measure -o out.csv scan.nii.gz"),
            ("s -oout.csv -v scan.nii.gz", "s measure -oout.csv -v scan.nii.gz"),
            ("s --label 1", "s measure --label 1"),
            ("s --label 1 --help", "s measure --label 1 --help"),
            ("s --label 1 info scan.nii.gz", "s --label 1 info scan.nii.gz"),
            ("s --lable 1 scan.nii.gz", "s --lable 1 scan.nii.gz"),
            ("s --threads 2 mesure", "s --threads 2 mesure"),
            ("s --version", "s --version"),
            ("s -h", "s -h"),
            ("s help", "s help"),
            ("s", "s"),
        ] {
            assert_eq!(words(typed), meant);
        }
    }
}
