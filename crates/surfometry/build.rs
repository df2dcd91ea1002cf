//! Tells the library which commit it is made of: of a package that of its file, of a checkout that of git. Only where
//! it is made to be used (`--release`), or where `SURFOMETRY_COMMIT` says it: a commit must not build everything anew.

use std::process::Command;

fn main() {
    println!("cargo:rerun-if-env-changed=SURFOMETRY_COMMIT");
    let release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let told = || std::env::var("SURFOMETRY_COMMIT").ok();
    if let Some(commit) = told().or_else(packaged).or_else(|| release.then(checked_out).flatten()) {
        println!("cargo:rustc-env=SURFOMETRY_COMMIT={commit}");
    }
}

/// What `cargo package` writes beside the sources.
fn packaged() -> Option<String> {
    println!("cargo:rerun-if-changed=build.rs");
    let text = std::fs::read_to_string(".cargo_vcs_info.json").ok()?;
    let (_, after) = text.split_once("\"sha1\"")?;
    after.split('"').nth(1).map(str::to_owned)
}

/// The commit of a checkout, with `-dirty` where files differ from it.
fn checked_out() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output =
            Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
        String::from_utf8(output.stdout).ok().map(|text| text.trim().to_owned())
    };
    // A later commit, another branch, another file: it is asked again.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo:rerun-if-changed={log}");
    }
    println!("cargo:rerun-if-changed=src");
    git(&["describe", "--always", "--dirty", "--exclude=*", "--abbrev=40"])
}
