//! Inputs as typed, with patterns expanded where the shell did not.

use std::path::Path;
use surfometry::phantoms::Phantom;

/// Files that a pattern names, in order of name; anything else stands for itself.
pub(crate) fn expand(inputs: &[String]) -> Vec<String> {
    inputs.iter().flat_map(|input| matches(input).unwrap_or_else(|| vec![input.clone()])).collect()
}

fn matches(input: &str) -> Option<Vec<String>> {
    let is_pattern = input.contains(['*', '?', '[']);
    if !is_pattern || Phantom::is_spec(input) || Path::new(input).exists() {
        return None;
    }
    let found: Vec<String> =
        glob::glob(input).ok()?.flatten().map(|p| p.to_string_lossy().into_owned()).collect();
    (!found.is_empty()).then_some(found)
}
