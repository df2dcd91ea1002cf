//! What made a result.

use crate::vectors;
use serde::{Deserialize, Serialize};

/// What made a result: the numbers of one version have the same bits on every machine; which it was is said
/// for whoever looks for a cause.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MadeBy {
    /// Version of surfometry.
    pub version: String,
    /// The commit that it was made of, where this is known; it ends in `-dirty` where files differed from it.
    pub commit: Option<String>,
    /// System, processor and its instructions that are used.
    pub machine: String,
}

impl MadeBy {
    /// This program on this machine.
    pub fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: option_env!("SURFOMETRY_COMMIT").map(str::to_owned),
            machine: format!("{} {} {}", std::env::consts::OS, std::env::consts::ARCH, vectors::name()),
        }
    }
}
