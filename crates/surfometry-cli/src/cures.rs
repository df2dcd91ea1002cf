//! What the command line calls the cures of errors.

use surfometry::runs::{Cure, RunError};

/// The option that helps, where one does.
pub(crate) fn cure(error: &RunError) -> Option<&'static str> {
    match Cure::of(error)? {
        Cure::Spacing => Some("--spacing X,Y,Z"),
        Cure::GivenEmbedding => Some("--threshold LOW..HIGH, or --embedding given"),
        Cure::Threshold => Some("--threshold LOW..HIGH"),
        Cure::Label => Some("--label"),
        Cure::Names => Some("--names FILE"),
        Cure::Raw => Some("--raw XxYxZ:TYPE, as 80x50x83:uint16"),
        _ => None,
    }
}
