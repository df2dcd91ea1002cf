//! Results as text.

mod csv;
mod table;

pub(crate) use csv::csv_text;
pub(crate) use table::{Layout, table_text};

use anyhow::{Context, Result};
use std::io::{ErrorKind, Write};
use std::path::Path;
use surfometry::io::write_whole;
use surfometry::runs::Output;

pub(crate) fn json_text(output: &Output) -> Result<String> {
    Ok(serde_json::to_string_pretty(output)? + "\n")
}

/// Prints to stdout, or writes a file, whole or not at all.
pub(crate) fn deliver(text: &str, file: Option<&Path>) -> Result<()> {
    match file {
        Some(path) => write_whole(path, |out| out.write_all(text.as_bytes()))
            .with_context(|| format!("{}: cannot be written", path.display())),
        None => match std::io::stdout().write_all(text.as_bytes()) {
            // The reader went away, as `head` does: nothing is wrong.
            Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
            outcome => outcome.context("stdout cannot be written"),
        },
    }
}
