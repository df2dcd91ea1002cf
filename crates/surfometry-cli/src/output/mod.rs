//! Results as text.

mod comparison_text;
mod description_text;
mod map_sink;
mod page_sink;
mod results;
mod sweep_table;
mod table;
mod table_sink;
mod validation_table;

pub(crate) use comparison_text::comparison_text;
pub(crate) use description_text::description_text;
pub(crate) use map_sink::MapSink;
pub(crate) use page_sink::PageSink;
pub(crate) use results::{say_sigmas, status, with_scales, write_results};
pub(crate) use sweep_table::sweep_tables;
pub(crate) use table::{Layout, digits, flags_text, raised_text, record_tables};
pub(crate) use table_sink::{Legend, TableSink, TableStyle};
pub(crate) use validation_table::{rivalry_table, validation_table};

use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use surfometry::inputs::{OpenOptions, open};
use surfometry::io::write_whole;

/// A document as JSON, indented.
pub(crate) fn json_text(document: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(document)? + "\n")
}

/// Says something on stderr. That it cannot be said, as on a full disk, is no reason to lose results.
pub(crate) fn say(message: &str) {
    // Names of files may hold anything, what a terminal takes for commands too.
    let is_plain = |c: char| !c.is_control() || c == '\n' || c == '\t';
    let plain: String = message
        .chars()
        .flat_map(|c| if is_plain(c) { vec![c] } else { c.escape_default().collect() })
        .collect();
    let _ = writeln!(std::io::stderr(), "surfometry: {plain}");
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
    // Its header's or its voxels' file; what cannot be opened has its own error later.
    let mut unfinished = path.as_os_str().to_owned();
    unfinished.push(".partial");
    let outputs: Vec<PathBuf> =
        [path, Path::new(&unfinished)].iter().filter_map(|path| path.canonicalize().ok()).collect();
    if outputs.is_empty() {
        return Ok(());
    }
    let same = |input: &String| {
        let is_there = |file: &PathBuf| file.canonicalize().is_ok_and(|i| outputs.contains(&i));
        let own = is_there(&PathBuf::from(input));
        let options = OpenOptions { spacing: Some([1.0; 3]), ..OpenOptions::default() };
        let parts = || open(input, &options).is_ok_and(|source| source.files().iter().any(is_there));
        own || (has_parts(input) && parts())
    };
    match inputs.iter().find(|input| same(input)) {
        Some(input) => {
            bail!("{}: the output would replace the input {input}; choose another name", path.display())
        }
        None => Ok(()),
    }
}

/// Whether a header's name says that its voxels are in another file.
fn has_parts(input: &str) -> bool {
    let name = input.to_lowercase();
    [".mhd", ".nhdr", ".hdr", ".hdr.gz", ".img", ".img.gz"].iter().any(|ending| name.ends_with(ending))
}

/// Prints to stdout (also for `-`), or writes a file, whole or not at all.
pub(crate) fn deliver(text: &str, file: Option<&Path>) -> Result<()> {
    match file.filter(|p| *p != Path::new("-")) {
        Some(path) => write_whole(path, |out| out.write_all(text.as_bytes()))
            .with_context(|| format!("{}: cannot be written", path.display())),
        None => match std::io::stdout().write_all(text.as_bytes()) {
            // The reader went away, as `head` does: nothing is wrong.
            Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
            outcome => outcome.context("stdout cannot be written"),
        },
    }
}
