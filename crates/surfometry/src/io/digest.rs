//! What tells contents apart.

use sha2::{Digest, Sha256};

/// SHA-256 as it is written.
pub(crate) fn sha256_text(hash: Sha256) -> String {
    let digits: Vec<String> = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    digits.concat()
}
