//! Topology on the command line: where it changed, and an object's pieces.

use serde_json::Value;
use std::process::{Command, Output};

fn run(args: &[&str]) -> Output {
    let output =
        Command::new(env!("CARGO_BIN_EXE_surfometry")).args(args).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

fn results(args: &[&str]) -> Vec<Value> {
    let document = run(&[args, &["--format", "json"]].concat()).stdout;
    let document: Value = serde_json::from_slice(&document).expect("JSON");
    document["results"].as_array().expect("results").clone()
}

/// A hole 6 mm wide around the world's origin, which a blur of 5 mm closes.
const PIERCED: &str = "phantom:genus?genus=1&major=3&minor=6";

#[test]
fn what_the_blur_closed_is_said_with_its_place() {
    let record = &results(&["measure", PIERCED, "--sigma", "5"])[0];
    let change = &record["topology"]["changes"][0];
    assert_eq!((&change["stage"], &change["kind"]), (&"blur".into(), &"hole-closed".into()));
    let position = change["position_mm"].as_array().unwrap();
    assert!(position.iter().all(|v| v.as_f64().unwrap().abs() < 1.0), "{change}");
    let table = String::from_utf8(run(&["measure", PIERCED, "--sigma", "5", "--explain"]).stdout).unwrap();
    assert!(table.contains("hole-closed") && table.contains("1 hole closed ("), "{table}");
    let rows =
        String::from_utf8(run(&["measure", PIERCED, "--sigma", "5", "--format", "csv"]).stdout).unwrap();
    assert!(rows.contains("topology_changes") && rows.contains(",hole-closed,"), "{rows}");
    let explained =
        String::from_utf8(run(&["measure", PIERCED, "--sigma", "5", "--format", "csv", "--explain"]).stdout)
            .unwrap();
    assert!(explained.contains(",hole-closed;hole-opened,"), "{explained}");
}

/// Nothing is looked for where nothing disagrees, unless it is asked for; then nothing is found.
#[test]
fn what_agrees_is_not_looked_into() {
    let torus = "phantom:torus?major=14&minor=6";
    assert!(results(&["measure", torus])[0]["topology"]["changes"].is_null());
    let asked = &results(&["measure", torus, "--explain"])[0]["topology"];
    assert_eq!(asked["changes"].as_array().unwrap().len(), 0);
    assert_eq!(asked["euler_characteristic_expected"], 0.0);
}

/// In one embedding: of two whose errors are nearly the same, as in the middle of the grid, a piece may be measured in another
/// than the whole.
#[test]
fn pieces_are_measured_one_by_one() {
    let balls = "phantom:two-balls?radius=9&length=30";
    let whole = &results(&["measure", balls, "--embedding", "gaussian"])[0];
    let pieces = results(&["measure", balls, "--embedding", "gaussian", "--per-component"]);
    assert!(whole["component"].is_null());
    assert_eq!(pieces.iter().map(|p| p["component"].as_u64().unwrap()).collect::<Vec<_>>(), [1, 2]);
    for value in ["volume_mm3", "surface_area_mm2", "euler_characteristic"] {
        let sum: f64 = pieces.iter().map(|piece| piece[value].as_f64().unwrap()).sum();
        assert!((sum / whole[value].as_f64().unwrap() - 1.0).abs() < 1e-4, "{value}");
    }
    let table = String::from_utf8(run(&["measure", balls, "--per-component"]).stdout).unwrap();
    assert!(table.contains("1 #2"), "{table}");
}
