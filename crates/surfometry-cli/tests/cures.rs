//! A cure that an error names works: the command with it is run.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const N: usize = 24;

fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_surfometry");
    Command::new(program).current_dir(folder).args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Values of a ball of radius 8 voxels in the middle, by the distance from there.
fn ball(value: impl Fn(f32) -> f32) -> Vec<u8> {
    let distance = |i: usize| {
        let index = [i % N, i / N % N, i / (N * N)].map(|v| v as f32 - (N as f32 - 1.0) / 2.0);
        index.iter().map(|v| v * v).sum::<f32>().sqrt()
    };
    (0..N * N * N).flat_map(|i| value(distance(i)).to_le_bytes()).collect()
}

fn nrrd(folder: &Path, name: &str, more: &str, voxels: &[u8]) {
    // A blank line would end the header.
    let more = if more.is_empty() { String::new() } else { format!("{more}\n") };
    let header = format!(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {N} {N} {N}\n{more}endian: little\nencoding: raw\n\n"
    );
    fs::write(folder.join(name), [header.as_bytes(), voxels].concat()).unwrap();
}

/// A file, what is wrong with it, the option that the error names, and the same with a value.
const CASES: [(&str, &str, &str, &[&str]); 10] = [
    ("no_spacing.nrrd", "no voxel spacing", "--spacing X,Y,Z", &["--spacing", "1,1,1"]),
    ("unit.nrrd", "`furlong`", "--spacing X,Y,Z", &["--spacing", "1,1,1"]),
    ("negative.nrrd", "is -2 mm", "--spacing X,Y,Z", &["--spacing", "1,1,1"]),
    ("tiny.nrrd", "e-12 mm", "--spacing X,Y,Z", &["--spacing", "1,1,1"]),
    ("slabs.nrrd", "10000 times", "--spacing X,Y,Z", &["--spacing", "1,1,1"]),
    ("ball.stl", "no voxels", "--spacing X,Y,Z", &["--spacing", "0.5,0.5,0.5"]),
    ("field.nrrd", "not a whole number", "--embedding given", &["--embedding", "given"]),
    ("field.nrrd", "not a whole number", "--threshold LOW..HIGH", &["--threshold", "..0"]),
    ("faint.nrrd", "7.00e-5", "--threshold LOW..HIGH", &["--threshold", "5e-5.."]),
    ("labels.nrrd", "no label 9", "--label", &["--label", "7"]),
];

#[test]
fn the_option_that_an_error_names_helps() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let labels = ball(|d| if d < 8.0 { 7.0 } else { 0.0 });
    nrrd(folder, "no_spacing.nrrd", "", &labels);
    nrrd(
        folder,
        "unit.nrrd",
        "space dimension: 3\nspacings: 1 1 1\nunits: \"furlong\" \"furlong\" \"furlong\"",
        &labels,
    );
    nrrd(folder, "negative.nrrd", "spacings: 1 1 -2", &labels);
    nrrd(folder, "tiny.nrrd", "spacings: 1 1 1e-12", &labels);
    nrrd(folder, "slabs.nrrd", "spacings: 1 1 1e6", &labels);
    nrrd(folder, "labels.nrrd", "spacings: 1 1 1", &labels);
    nrrd(folder, "field.nrrd", "spacings: 1 1 1", &ball(|d| d - 8.0));
    nrrd(folder, "faint.nrrd", "spacings: 1 1 1", &ball(|d| if d < 8.0 { 7e-5 } else { 0.0 }));
    let mesh = run_in(folder, &["map", "phantom:ball?radius=8&spacing=0.3,0.3,0.3", "-o", "ball.stl"]);
    assert!(mesh.status.success());
    for (name, fault, option, cure) in CASES {
        let wrong: &[&str] = if name.starts_with("labels") { &["--label", "9"] } else { &[] };
        let refused = run_in(folder, &[&["measure", name], wrong].concat());
        let said = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(1), "{name}: {said}");
        assert!(said.contains(name) && said.contains(fault) && said.contains(option), "{name}: {said}");
        let cured = run_in(folder, &[&["measure", name, "--format", "json"], cure].concat());
        assert!(cured.status.success(), "{name} {cure:?}: {}", text(&cured.stderr));
        let volume = text(&cured.stdout);
        let volume: serde_json::Value = serde_json::from_str(&volume).unwrap();
        let volume = volume["results"][0]["volume_mm3"].as_f64().unwrap();
        // A ball of 8 mm: 2144.7 mm3.
        assert!((volume / 2144.7 - 1.0).abs() < 0.05, "{name} {cure:?}: {volume}");
    }
}
