//! Results as text.

mod comparison_text;
mod description_text;
mod details;
mod layout;
mod lines;
mod map_sink;
mod numbers;
mod page_sink;
mod parts_text;
mod raised;
mod record_tables;
mod results;
mod sweep_table;
mod table_sink;
mod validation_table;
mod width;

pub(crate) use comparison_text::comparison_text;
pub(crate) use description_text::description_text;
pub(crate) use layout::Layout;
pub(crate) use map_sink::MapSink;
pub(crate) use numbers::{counted, digits};
pub(crate) use page_sink::PageSink;
pub(crate) use raised::{map_flags_text, raised_text};
pub(crate) use record_tables::{RecordTables, Shown, record_name};
pub(crate) use results::{Failures, say_sigmas, say_written, status, with_scales, write_results};
pub(crate) use surfometry::text::{one_line, plain};
pub(crate) use sweep_table::SweepTables;
pub(crate) use table_sink::{Presenter, TableSink};
pub(crate) use validation_table::{rivalry_table, validation_table};

use anyhow::{Context, Result, anyhow, bail};
use serde::Serialize;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use surfometry::inputs::files_of;
use surfometry::io::{try_writing, unfinished, write_whole};
use width::wrapped;

/// The command that was given, as a shell takes it.
pub(crate) fn command_line() -> String {
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let quoted = shlex::try_join(words.iter().map(String::as_str));
    // No argument has the byte 0, which alone cannot be quoted.
    quoted.unwrap_or_else(|_| words.join(" "))
}

/// A document as JSON, indented.
pub(crate) fn json_text(document: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(document)? + "\n")
}

/// Says something on stderr. That it cannot be said, as on a full disk, is no reason to lose results.
pub(crate) fn say(message: &str) {
    let message = format!("surfometry: {}\n", plain(message));
    let mut stderr = std::io::stderr();
    let shown = if stderr.is_terminal() {
        message.lines().map(|line| wrapped(line, "", "    ")).collect()
    } else {
        message
    };
    let _ = stderr.write_all(shown.as_bytes());
}

/// Whether what stderr has told stands where results do: on one terminal, or in the file or pipe that takes both.
pub(crate) fn is_one_place() -> bool {
    std::io::stdout().is_terminal() && std::io::stderr().is_terminal() || is_one_file()
}

#[cfg(unix)]
fn is_one_file() -> bool {
    use std::os::unix::fs::MetadataExt;
    let file = |path: &str| std::fs::metadata(path).ok().map(|file| (file.dev(), file.ino()));
    file("/dev/stdout").is_some_and(|stdout| file("/dev/stderr") == Some(stdout))
}

#[cfg(not(unix))]
fn is_one_file() -> bool {
    false
}

/// Refuses, before anything is measured, an output that could not be written or that would replace an input.
pub(crate) fn check_output(file: Option<&Path>, inputs: &[String]) -> Result<()> {
    let Some(path) = file.filter(|p| *p != Path::new("-")) else { return Ok(()) };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|f| !f.is_dir()) {
        bail!("{}: the folder {} does not exist", path.display(), folder.display());
    }
    if path.is_dir() {
        bail!("{}: a folder; name a file in it", path.display());
    }
    let outputs: Vec<PathBuf> =
        [path, &unfinished(path)].iter().filter_map(|path| path.canonicalize().ok()).collect();
    let is_output = |file: &PathBuf| file.canonicalize().is_ok_and(|file| outputs.contains(&file));
    let same = |input: &String| {
        is_output(&PathBuf::from(input)) || lies_in(&outputs, input) || files_of(input).iter().any(is_output)
    };
    if let Some(input) = inputs.iter().find(|input| !outputs.is_empty() && same(input)) {
        bail!("{}: the output would replace the input {input}; choose another name", path.display());
    }
    try_writing(path).map_err(|error| anyhow!("{}: cannot be written: {error}", path.display()))
}

/// Whether an output is a file of an input that is a folder: a chunk of a Zarr, which may have thousands. Tables and pages may
/// lie beside what they are of.
fn lies_in(outputs: &[PathBuf], input: &str) -> bool {
    let Ok(folder) = Path::new(input).canonicalize() else { return false };
    let is_result = |path: &PathBuf| {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        ["csv", "json", "jsonl", "html", "partial"].contains(&ending.as_str())
    };
    folder.is_dir() && outputs.iter().any(|path| path.starts_with(&folder) && !is_result(path))
}

/// Prints to stdout (also for `-`), or writes a file, whole or not at all.
pub(crate) fn deliver(text: &str, file: Option<&Path>) -> Result<()> {
    match file.filter(|p| *p != Path::new("-")) {
        Some(path) => {
            let written = write_whole(path, |out| out.write_all(text.as_bytes()));
            written.or_else(|error| {
                // What took hours to measure is not lost.
                print(text)?;
                Err(error).with_context(|| format!("{}: cannot be written; it is printed", path.display()))
            })
        }
        None => print(text),
    }
}

fn print(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout();
    let shown = if stdout.is_terminal() { plain(text) } else { text.into() };
    match stdout.write_all(shown.as_bytes()) {
        // The reader went away, as `head` does: nothing is wrong.
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        outcome => outcome.context("stdout cannot be written"),
    }
}
