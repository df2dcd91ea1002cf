//! Soft segmentations on the command line.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use surfometry::io::write_voxel_map;
use surfometry::volume::Grid;

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).args(args).output().expect("it starts")
}

fn measured(args: &[&str]) -> Value {
    let output = run(&[&["measure"], args, &["--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    document["results"][0].clone()
}

/// A ball of 10 voxels whose edge is as wide as a voxel, times a factor.
fn write_ball(path: &Path, factor: f32) {
    let grid = Grid::axis_aligned([32; 3], [1.0; 3]).unwrap();
    let value = |number: usize| {
        let square: f32 = grid.index_of(number).iter().map(|&v| (v as f32 - 15.4).powi(2)).sum();
        // A voxel's box, h^2 / 12 wide, moves the place of 1/2 in by that over R, as any blur does.
        factor * (10.5 - 1.0 / 120.0 - square.sqrt()).clamp(0.0, 1.0)
    };
    let values: Vec<f32> = (0..grid.voxel_count()).map(value).collect();
    write_voxel_map(path, &grid, &values, "share").unwrap();
}

/// One object without a label, whose numbers are those of the ball.
#[test]
fn a_file_of_values_is_one_object() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.nii");
    write_ball(&path, 1.0);
    let options = ["--embedding", "probability"];
    let record = measured(&[&[path.to_str().unwrap()], &options[..]].concat());
    assert_eq!(record["label"], Value::Null);
    assert_eq!(record["surface"], "original");
    assert_eq!(record["parameters"]["embedding"], "probability");
    let volume = record["volume_mm3"].as_f64().unwrap();
    assert!((volume / (4.0 / 3.0 * std::f64::consts::PI * 1e3) - 1.0).abs() < 2e-3, "{volume}");
    assert!(record["standard_error"]["volume_mm3"].as_f64().unwrap() < 0.002 * volume);
    // Its surface can be had as well.
    let mesh = folder.path().join("ball.ply");
    let map = run(&[&["map", path.to_str().unwrap(), "-o", mesh.to_str().unwrap()], &options[..]].concat());
    assert_eq!(map.status.code(), Some(0), "{}", String::from_utf8_lossy(&map.stderr));
    assert!(mesh.exists());
}

/// A built-in shape is zeros and ones, with its truth.
#[test]
fn a_phantom_is_a_mask() {
    let ball = "phantom:ball?radius=9&shift=0.2,0.3,0.4";
    let mut soft = measured(&[ball, "--embedding", "probability"]);
    let mask = measured(&[ball]);
    assert_eq!((&soft["label"], &mask["label"]), (&Value::Null, &Value::from(1)));
    soft["label"] = mask["label"].clone();
    soft["parameters"]["embedding"] = "gaussian".into();
    for field in ["seconds", "read_seconds"] {
        soft[field] = mask[field].clone();
    }
    // What helps is another embedding for masks alone.
    for (soft, hard) in
        soft["flags"].as_array_mut().unwrap().iter_mut().zip(mask["flags"].as_array().unwrap())
    {
        soft["message"] = hard["message"].clone();
    }
    assert_eq!(soft, mask);
}

#[test]
fn what_is_no_probability_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("percent.nii.gz");
    write_ball(&path, 100.0);
    let input = [path.to_str().unwrap(), "--embedding", "probability"];
    let refused = run(&[&["measure"], &input[..]].concat());
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_ne!(refused.status.code(), Some(0));
    assert!(message.contains("voxel [") && message.contains("percent"), "{message}");
    write_ball(&path, 1.0);
    for option in [["--label", "1"].as_slice(), &["--per-component"]] {
        let refused = run(&[&["measure"], &input[..], option].concat());
        assert_ne!(refused.status.code(), Some(0), "{option:?}");
        assert!(String::from_utf8_lossy(&refused.stderr).contains("no labels"), "{option:?}");
    }
}
