//! Thresholds, largest pieces and filled cavities on the command line: the same of every command, and in what they write.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use surfometry::io::{read_labels, write_labels, write_voxel_map};
use surfometry::volume::{Grid, LabelImage};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).args(args).output().expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A shell of 300, marrow of 40, air of -1000, and a speck of 350; and how many voxels of each there are.
fn write_scan(folder: &Path) -> (PathBuf, [u64; 2]) {
    let grid = Grid::axis_aligned([28, 26, 24], [0.9, 1.0, 1.2]).unwrap();
    let grey = |number: usize| {
        let [x, y, z] = grid.index_of(number).map(|v| v as f64);
        let square = ((x - 13.2) * 0.9).powi(2) + (y - 12.7).powi(2) + ((z - 11.6) * 1.2).powi(2);
        match square {
            _ if grid.index_of(number) == [1, 1, 1] => 350,
            s if s < 16.0 => 40,
            s if s < 81.0 => 300,
            _ => -1000,
        }
    };
    let values: Vec<i64> = (0..grid.voxel_count()).map(grey).collect();
    let path = folder.join("scan.nii.gz");
    write_labels(&path, &LabelImage::from_voxels(grid, &values).unwrap()).unwrap();
    (path, [300, 40].map(|grey| values.iter().filter(|v| **v == grey).count() as u64))
}

const ALL: [&str; 4] = ["--threshold", "200..", "--largest-component", "--fill-cavities"];

#[test]
fn records_say_what_was_done() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, [shell, marrow]) = write_scan(folder.path());
    let output = run(&[&["measure", scan.to_str().unwrap(), "--format", "json"], &ALL[..]].concat());
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let record = &document["results"][0];
    assert_eq!((&record["label"], &record["voxels"]["count"]), (&1.into(), &(shell + marrow).into()));
    let expected = serde_json::json!({
        "threshold": { "low": 200.0, "high": null }, "largest_component": true, "fill_cavities": true,
        "dropped_pieces": 1, "dropped_voxels": 1, "filled_voxels": marrow
    });
    assert_eq!(record["preparation"], expected);
    let table = run(&[&["measure", scan.to_str().unwrap(), "--format", "csv"], &ALL[..]].concat());
    let table = text(&table.stdout);
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let cell = |name: &str| rows[1][rows[0].iter().position(|column| *column == name).unwrap()];
    assert_eq!(cell("preparation_filled_voxels"), marrow.to_string());
    assert_eq!((cell("preparation_threshold_low"), cell("preparation_threshold_high")), ("200.0", ""));
    // Where nothing is asked the cells are empty.
    let plain = text(&run(&["measure", "phantom:ball?radius=5", "--format", "csv"]).stdout);
    assert_eq!(plain.lines().next(), table.lines().next());
    assert!(!plain.lines().nth(1).unwrap().contains("true"));
}

/// Each command that takes label images sees the same object.
#[test]
fn every_command_prepares() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, [shell, marrow]) = write_scan(folder.path());
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let with = |args: &[&str]| {
        let output = run(&[args, &[scan.to_str().unwrap()], &ALL[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", text(&output.stderr));
        output
    };
    let volume = (shell + marrow) as f64 * 0.9 * 1.2;
    let reference = with(&["reference", "--method", "voxels", "--format", "json"]);
    let document: Value = serde_json::from_slice(&reference.stdout).unwrap();
    assert!((document["results"][0]["volume_mm3"].as_f64().unwrap() / volume - 1.0).abs() < 1e-6);
    let flags = document["results"][0]["flags"].to_string();
    assert!(flags.contains("cavities-filled") && flags.contains("pieces-dropped"), "{flags}");
    with(&["embed", "--embedding", "recovering", "-o", &at("embedded.nii")]);
    assert!(
        (read_labels(at("embedded.nii")).unwrap().mask(1).voxels() as f64 / (shell + marrow) as f64 - 1.0)
            .abs()
            < 0.01
    );
    with(&["map", "-o", &at("map.json")]);
    let map: Value = serde_json::from_str(&std::fs::read_to_string(at("map.json")).unwrap()).unwrap();
    assert_eq!(map["results"][0]["voxels"]["count"], shell + marrow);
    let sweep = with(&["sweep", "--over", "sigma", "--range", "1.5:2.5:2", "--format", "json"]);
    let document: Value = serde_json::from_slice(&sweep.stdout).unwrap();
    assert_eq!(document["results"][1]["preparation"]["filled_voxels"], marrow);
    with(&["report", "-o", &at("report.html")]);
    assert!(std::fs::read_to_string(at("report.html")).unwrap().contains("cavities-filled"));
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, _) = write_scan(folder.path());
    let scan = scan.to_str().unwrap();
    for (options, words) in [
        (&["--threshold", "5"][..], "LOW..HIGH"),
        (&["--threshold", "9..1"], "LOW..HIGH"),
        (&["--threshold", "1..", "--embedding", "given"], "another embedding"),
        (&["--fill-cavities", "--embedding", "probability"], "another embedding"),
    ] {
        let refused = run(&[&["measure", scan], options].concat());
        assert_eq!(refused.status.code(), Some(2), "{options:?}");
        assert!(text(&refused.stderr).contains(words), "{}", text(&refused.stderr));
    }
    let nothing = run(&["measure", scan, "--threshold", "900.."]);
    assert_eq!(nothing.status.code(), Some(1));
    assert!(text(&nothing.stderr).contains("from -1000 to 350"), "{}", text(&nothing.stderr));
    // The cure of grey values in floats works.
    let grid = Grid::axis_aligned([12; 3], [1.0; 3]).unwrap();
    let values: Vec<f32> = (0..12 * 12 * 12)
        .map(|n| if grid.index_of(n).iter().all(|v| (3..9).contains(v)) { 0.7 } else { 0.1 })
        .collect();
    let grey = folder.path().join("grey.nii");
    write_voxel_map(&grey, &grid, &values, "grey").unwrap();
    let refused = run(&["measure", grey.to_str().unwrap()]);
    assert!(text(&refused.stderr).contains("--threshold LOW..HIGH"), "{}", text(&refused.stderr));
    let cured = run(&["measure", grey.to_str().unwrap(), "--threshold", "0.5..", "--format", "json"]);
    let document: Value = serde_json::from_slice(&cured.stdout).unwrap();
    assert_eq!(document["results"][0]["voxels"]["count"], 6 * 6 * 6);
}

/// A run goes on only with the voxels that it began with.
#[test]
fn a_journal_knows_the_threshold() {
    let folder = tempfile::tempdir().unwrap();
    let (scan, _) = write_scan(folder.path());
    let out = folder.path().join("out.jsonl");
    let begun = |threshold: &str| {
        let shard =
            ["measure", "--resume", "--shard", "1/1", "-o", out.to_str().unwrap(), scan.to_str().unwrap()];
        run(&[&shard, &["--threshold", threshold][..]].concat())
    };
    assert_eq!(begun("200..").status.code(), Some(0));
    let other = begun("250..");
    assert!(
        !other.status.success() && text(&other.stderr).contains("preparation"),
        "{}",
        text(&other.stderr)
    );
}
