//! Tables for people: they fit, every object is in them once, and digits end where the error bars say.

use serde_json::Value;
use std::process::Command;

const TORUS: &str = "phantom:torus?major=12&minor=5&rotate=20,30,40&spacing=1,1,1.3";
const BALL: &str = "phantom:ball?radius=8&shift=0.3,0.2,0.1";

fn run(columns: &str, arguments: &[&str]) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_surfometry"));
    let output = program.args(arguments).env("COLUMNS", columns).output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Lines are no longer than a window, names of inputs apart.
fn fits(table: &str, width: usize) {
    for line in table.lines().filter(|line| !line.starts_with("phantom:")) {
        assert!(line.chars().count() <= width, "{line}");
    }
}

#[test]
fn several_objects_have_a_line_each() {
    // The slices of the torus are thick enough for a flag.
    let thick = "phantom:torus?major=12&minor=5&rotate=20,30,40&spacing=1,1,2";
    for (columns, width) in [("80", 80), ("", 80), ("20", 80), ("100", 100), ("120", 120), ("400", 120)] {
        let table = run(columns, &["measure", thick, BALL, "--quiet"]);
        fits(&table, width);
        assert_eq!(table.contains("mean H 1/mm"), width == 120, "{table}");
        let lines: Vec<&str> = table.lines().collect();
        assert!(lines[0].starts_with("object ") && lines[0].ends_with("flags"), "{table}");
        assert!(lines[1].starts_with("torus") && lines[2].starts_with("ball"), "{table}");
        // A letter for the flag, which is explained once.
        assert!(lines[1].ends_with('a') && !lines[2].ends_with('a'), "{table}");
        assert_eq!(table.matches("  a thick-slices, 1 object: ").count(), 1, "{table}");
    }
}

/// A value is printed to the second digit of its standard error, and so is that.
#[test]
fn digits_end_with_the_error_bar() {
    let record: Value = serde_json::from_str(&run("80", &["measure", TORUS, "--format", "json"])).unwrap();
    let record = &record["results"][0];
    let number = |value: &Value, name: &str| value[name].as_f64().unwrap();
    let table = run("80", &["measure", TORUS, BALL, "--quiet"]);
    let line = table.lines().nth(1).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    let names = ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm"];
    for (name, printed) in names.into_iter().zip(words[1..].chunks(3)) {
        let (value, error) = (number(record, name), number(&record["standard_error"], name));
        let [shown, plus_minus, bar] = printed else { panic!("{line}") };
        let (shown, bar): (f64, f64) = (shown.parse().unwrap(), bar.parse().unwrap());
        assert_eq!(*plus_minus, "\u{b1}");
        assert!(
            (bar / error - 1.0).abs() < 0.05 && (shown - value).abs() < 0.05 * error,
            "{line} {value} {error}"
        );
        assert!(printed[0].len() <= 7, "{line}");
    }
}

#[test]
fn one_object_alone_and_details_stand_in_full() {
    let alone = run("80", &["measure", TORUS]);
    let all = run("80", &["measure", TORUS, BALL, "--details", "--quiet"]);
    fits(&alone, 80);
    fits(&all, 80);
    for row in ["original", "s.e.", "voxels", "exact"] {
        let count = |table: &str| {
            table.lines().filter(|line| line.trim_start().starts_with(&format!("{row} "))).count()
        };
        assert_eq!((count(&alone), count(&all)), (1, 2), "{row}: {all}");
    }
}

#[test]
fn what_was_written_is_said() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, said) in [
        (&["measure", BALL, TORUS, "-o", "out.csv"][..], "wrote out.csv: 2 results"),
        (&["measure", BALL, "-o", "one.json"], "wrote one.json: 1 result\n"),
        (&["measure", BALL, "missing.nii", "-o", "out.jsonl"], "wrote out.jsonl: 1 result, 1 failure"),
        (&["reference", BALL, "--method", "triangulation", "-o", "r.csv"], "wrote r.csv: 1 result\n"),
    ] {
        let run = |more: &[&str]| {
            let mut program = Command::new(env!("CARGO_BIN_EXE_surfometry"));
            let output = program.args(arguments).args(more).current_dir(folder.path()).output().unwrap();
            String::from_utf8(output.stderr).unwrap()
        };
        let (loud, quiet) = (run(&[]), run(&["--quiet"]));
        assert!(loud.contains(said) && !quiet.contains("wrote"), "{loud} {quiet}");
    }
}
