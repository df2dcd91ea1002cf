//! Tests on the data set that lies beside a checkout, in ../shared/data; where it is absent they are ignored,
//! visibly.

use std::path::{Path, PathBuf};

/// A real segmentation or mesh.
pub fn real(name: &str) -> PathBuf {
    data().join("real").join(name)
}

/// A small file that some version got wrong.
pub fn fault(name: &str) -> PathBuf {
    data().join("faults").join(name)
}

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data")
}
