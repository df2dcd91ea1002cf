//! Inputs as typed, with patterns expanded where the shell did not.

use clap::builder::{OsStringValueParser, TypedValueParser};
use glob::{MatchOptions, Pattern};
use std::fs::DirEntry;
use std::path::{Component, Path, PathBuf};
use surfometry::inputs::shown_name;
use surfometry::phantoms::Phantom;

/// Takes any name: one that is no text has its odd bytes shown, and is told so when it is opened, while the others are
/// measured.
pub(crate) fn input_name() -> impl TypedValueParser<Value = String> {
    OsStringValueParser::new().map(|name| shown_name(&name))
}

/// Files that a pattern names, in order of name; anything else stands for itself.
pub(crate) fn expand(inputs: &[String]) -> Vec<String> {
    inputs.iter().flat_map(|input| matches(input).unwrap_or_else(|| vec![input.clone()])).collect()
}

fn matches(input: &str) -> Option<Vec<String>> {
    if !is_pattern(input) || Phantom::is_spec(input) || Path::new(input).exists() {
        return None;
    }
    let mut found = vec![PathBuf::new()];
    for part in Path::new(input).components() {
        found = found.iter().flat_map(|folder| step(folder, part)).collect();
    }
    // A part without a pattern was only put behind the others.
    found.retain(|path| path.exists());
    found.sort();
    found.dedup();
    let names: Vec<String> = found.iter().map(|path| shown_name(path.as_os_str())).collect();
    (!names.is_empty()).then_some(names)
}

fn is_pattern(text: &str) -> bool {
    text.contains(['*', '?', '['])
}

/// What a part of a pattern stands for in a folder. A name with brackets that is there stands for itself.
fn step(folder: &Path, part: Component<'_>) -> Vec<PathBuf> {
    let itself = folder.join(part);
    let text = part.as_os_str().to_string_lossy();
    if !is_pattern(&text) || itself.symlink_metadata().is_ok() {
        return vec![itself];
    }
    if text == "**" {
        return folders_below(folder);
    }
    let Ok(pattern) = Pattern::new(&text) else { return Vec::new() };
    // As in a shell: a leading dot is matched by itself alone, so that what macOS keeps beside a file is none of them.
    let options = MatchOptions { require_literal_leading_dot: true, ..MatchOptions::default() };
    let entries =
        entries(folder).filter(|entry| pattern.matches_with(&shown_name(&entry.file_name()), options));
    entries.map(|entry| folder.join(entry.file_name())).collect()
}

/// A folder and all in it, but hidden ones; links are not followed, which may lead back.
fn folders_below(folder: &Path) -> Vec<PathBuf> {
    let is_shown = |entry: &DirEntry| !entry.file_name().to_string_lossy().starts_with('.');
    let is_folder = |entry: &DirEntry| entry.file_type().is_ok_and(|kind| kind.is_dir());
    let inner = entries(folder).filter(|entry| is_folder(entry) && is_shown(entry));
    let below = inner.flat_map(|entry| folders_below(&folder.join(entry.file_name())));
    [folder.to_owned()].into_iter().chain(below).collect()
}

fn entries(folder: &Path) -> impl Iterator<Item = DirEntry> {
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    std::fs::read_dir(here).into_iter().flatten().flatten()
}
