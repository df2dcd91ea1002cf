//! Tells the tests whether the shared data set is there; those that need it are ignored, visibly, where it is
//! not.

use std::path::Path;

fn main() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    println!("cargo::rustc-check-cfg=cfg(shared_data)");
    // A missing path named here would count as changed at every build.
    println!("cargo::rerun-if-changed=build.rs");
    if data.is_dir() {
        println!("cargo::rerun-if-changed={}", data.display());
        println!("cargo::rustc-cfg=shared_data");
    }
}
