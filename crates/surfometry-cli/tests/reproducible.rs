//! What a document says of how it was made is enough to make it again.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_surfometry");
    Command::new(program).current_dir(folder).args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[track_caller]
fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = run_in(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn document(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(name)).unwrap()).unwrap()
}

/// By coreutils.
fn sha256sum(folder: &Path, name: &str) -> String {
    let output = Command::new("sha256sum").current_dir(folder).arg(name).output().expect("coreutils");
    text(&output.stdout).split_whitespace().next().expect("a digest").to_owned()
}

#[test]
fn documents_name_program_settings_and_input() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    succeeds(folder, &["phantom", "ball?radius=6&spacing=0.8,1,1.2", "-o", "a.nii.gz"]);
    succeeds(folder, &["measure", "a.nii.gz", "phantom:ball?radius=5", "--sigma", "1.5", "-o", "a.json"]);
    let made = document(folder, "a.json");
    assert_eq!(made["version"], env!("CARGO_PKG_VERSION"));
    assert!(made["machine"].as_str().unwrap().starts_with(std::env::consts::OS));
    assert!(made.get("commit").is_some());
    assert_eq!(made["settings"]["sigma"], 1.5);
    assert_eq!(made["results"][0]["input_sha256"], sha256sum(folder, "a.nii.gz"));
    assert_eq!(made["results"][1]["input_sha256"], Value::Null);
    // Of a header and its data, the digest of their digests.
    let header = "NDims = 3\nDimSize = 20 20 20\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = b.raw\n";
    fs::write(folder.join("b.mhd"), header).unwrap();
    let cube =
        (0..8000).map(|i| u8::from([i % 20, i / 20 % 20, i / 400].iter().all(|v| (5..15).contains(v))));
    fs::write(folder.join("b.raw"), cube.collect::<Vec<u8>>()).unwrap();
    succeeds(folder, &["measure", "b.mhd", "-o", "b.csv"]);
    let both = format!("{}\n{}\n", sha256sum(folder, "b.mhd"), sha256sum(folder, "b.raw"));
    fs::write(folder.join("both"), both).unwrap();
    assert!(fs::read_to_string(folder.join("b.csv")).unwrap().contains(&sha256sum(folder, "both")));
}

#[test]
fn a_result_is_measured_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    succeeds(folder, &["phantom", "two-balls?radius=6&spacing=0.8,1,1.2", "-o", "a.nii.gz"]);
    let torus = "phantom:torus?major=9&minor=4&rotate=20,30,40&spacing=0.7,0.9,1.1";
    let choices = ["--sigma", "auto,1=1.7", "--thickness", "4", "--per-component"];
    let command = [&["measure", "a.nii.gz", torus, "missing.nii", "-o", "a.json"][..], &choices].concat();
    assert_eq!(run_in(folder, &command).status.code(), Some(1));
    let again = run_in(folder, &["rerun", "a.json", "--threads", "1"]);
    let found = text(&again.stdout);
    assert!(again.status.success(), "{found} {}", text(&again.stderr));
    let count = document(folder, "a.json")["results"].as_array().unwrap().len();
    assert!(
        count >= 2 && found.ends_with(&format!("{count} of {count} the same to the last bit\n")),
        "{found}"
    );

    // Another number, another file, no file.
    let mut changed = document(folder, "a.json");
    changed["results"][count - 1]["volume_mm3"] = 1.0.into();
    fs::write(folder.join("b.json"), changed.to_string()).unwrap();
    let again = run_in(folder, &["rerun", "b.json"]);
    assert_eq!(again.status.code(), Some(1));
    assert!(
        text(&again.stdout).contains("1 fields differ, most volume_mm3: 1.0, now "),
        "{}",
        text(&again.stdout)
    );
    succeeds(folder, &["phantom", "two-balls?radius=6.5&spacing=0.8,1,1.2", "-o", "a.nii.gz"]);
    let again = run_in(folder, &["rerun", "a.json"]);
    assert_eq!(again.status.code(), Some(1));
    assert!(text(&again.stdout).contains("the file is another one"), "{}", text(&again.stdout));
    fs::remove_file(folder.join("a.nii.gz")).unwrap();
    let again = run_in(folder, &["rerun", "a.json"]);
    assert_eq!(again.status.code(), Some(1));
    assert!(text(&again.stdout).contains("failed: No such file"), "{}", text(&again.stdout));

    // A setting that this version does not know, at any depth, would be left out in silence.
    for (place, name) in [("/settings", "sigmma_mm"), ("/settings/preparation", "fill_holes")] {
        let mut unknown = document(folder, "a.json");
        unknown.pointer_mut(place).unwrap()[name] = 1.5.into();
        fs::write(folder.join("b.json"), unknown.to_string()).unwrap();
        let refused = run_in(folder, &["rerun", "b.json"]);
        let (said, field) = (text(&refused.stderr), format!("`{}.{name}`", place[1..].replace('/', ".")));
        assert!(refused.status.code() == Some(2) && said.contains(&field), "{said}");
    }

    // An input named twice is one; the same object with several parameters is none.
    succeeds(folder, &["measure", torus, torus, "-o", "twice.json"]);
    let again = run_in(folder, &["rerun", "twice.json"]);
    assert!(text(&again.stdout).ends_with("1 of 1 the same to the last bit\n"), "{}", text(&again.stdout));
    succeeds(folder, &["sweep", torus, "--range", "1:2:2", "-o", "sweep.json"]);
    let refused = run_in(folder, &["rerun", "sweep.json"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("several parameters"), "{}", text(&refused.stderr));

    for (name, content, words) in [
        ("c.json", "{}", "missing field"),
        ("d.csv", "input,label\n", "measure -o FILE.json"),
        ("e.json", "", "EOF"),
    ] {
        fs::write(folder.join(name), content).unwrap();
        let refused = run_in(folder, &["rerun", name]);
        assert_eq!(refused.status.code(), Some(2));
        let said = text(&refused.stderr);
        assert!(said.contains(name) && said.contains(words), "{said}");
    }
}

/// Vector instructions are another order of the same operations at most: the bits stay.
#[test]
#[cfg(target_arch = "x86_64")]
fn numbers_do_not_depend_on_vector_instructions() {
    let folder = tempfile::tempdir().unwrap();
    let torus = "phantom:torus?major=14&minor=5&rotate=20,30,40&spacing=0.7,0.9,1.1";
    // One of which detail is lost, so that it is recovered, and Gaussian derivatives.
    let thin = "phantom:capsule?radius=1.5&length=15&rotate=10,50,20&spacing=0.8,1,1.1";
    let measured = |vectors: Option<&str>, more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_surfometry"));
        if let Some(vectors) = vectors {
            command.env("SURFOMETRY_VECTORS", vectors);
        }
        let output = command
            .current_dir(folder.path())
            .args(["measure", torus, thin, "--format", "json"])
            .args(more)
            .output();
        let document: Value = serde_json::from_slice(&output.unwrap().stdout).unwrap();
        let timeless = |row: &Value| {
            let mut row = row.clone();
            row.as_object_mut().unwrap().retain(|name, _| !name.ends_with("seconds"));
            row
        };
        let rows: Vec<Value> = document["results"].as_array().unwrap().iter().map(timeless).collect();
        (document["machine"].clone(), rows)
    };
    for more in [&[][..], &["--derivatives", "gaussian"], &["--embedding", "distance"]] {
        let (machine, widest) = measured(None, more);
        assert_eq!(widest.len(), 2);
        for vectors in ["sse2", "sse4_2", "avx2"] {
            let (narrower, rows) = measured(Some(vectors), more);
            assert_eq!(rows, widest, "{vectors} {more:?}");
            assert!(
                narrower.as_str().unwrap().ends_with(vectors) || machine == narrower,
                "{machine} {narrower}"
            );
        }
    }
}
