//! Inputs as typed, with patterns expanded where the shell did not.

use std::path::{Path, PathBuf};

/// Files that a pattern names, in order of name; anything else stands for itself.
pub(crate) fn expand(inputs: &[String]) -> Vec<String> {
    inputs.iter().flat_map(|input| matches(input).unwrap_or_else(|| vec![input.clone()])).collect()
}

/// The files among them, canonical.
pub(crate) fn existing(inputs: &[String]) -> Vec<PathBuf> {
    inputs.iter().filter_map(|input| Path::new(input).canonicalize().ok()).collect()
}

fn matches(input: &str) -> Option<Vec<String>> {
    let is_pattern = input.contains(['*', '?', '[']);
    if !is_pattern || input.starts_with("phantom:") || Path::new(input).exists() {
        return None;
    }
    let found: Vec<String> =
        glob::glob(input).ok()?.flatten().map(|p| p.to_string_lossy().into_owned()).collect();
    (!found.is_empty()).then_some(found)
}
