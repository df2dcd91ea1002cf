//! One blur and one thickness for each label.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use surfometry::io::write_labels;
use surfometry::volume::{Grid, LabelImage};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).args(args).output().expect("the program runs")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// Three balls of 2, 20 and 21 in a row, on voxels of unequal edges.
fn image(folder: &Path) -> String {
    let (dimensions, spacing) = ([90, 34, 30], [0.8, 0.9, 1.0]);
    let balls = [(2, 15.3), (20, 43.1), (21, 73.6)];
    let inside = |at: [usize; 3], centre: f64| {
        let from = [at[0] as f64 - centre, at[1] as f64 - 16.2, at[2] as f64 - 14.7];
        (0..3).map(|a| (from[a] * spacing[a]).powi(2)).sum::<f64>() < 81.0
    };
    let mut voxels = Vec::new();
    for z in 0..dimensions[2] {
        for y in 0..dimensions[1] {
            for x in 0..dimensions[0] {
                let label = balls.iter().find(|(_, centre)| inside([x, y, z], *centre));
                voxels.push(label.map_or(0i16, |(label, _)| *label));
            }
        }
    }
    let grid = Grid::axis_aligned(dimensions, spacing).unwrap();
    let path = folder.join("balls.nii.gz");
    write_labels(&path, &LabelImage::from_voxels(grid, &voxels).unwrap()).unwrap();
    path.to_str().unwrap().to_owned()
}

fn records(args: &[&str]) -> Vec<Value> {
    let output = run(&[&["measure"], args, &["--format", "json", "-q"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut records = document["results"].as_array().unwrap().clone();
    for record in &mut records {
        for time in ["seconds", "read_seconds"] {
            record.as_object_mut().unwrap().remove(time);
        }
    }
    records
}

/// Each label is measured as in a run of its own with its sigma and thickness, which its record states.
#[test]
fn labels_have_their_own_sigma_and_thickness() {
    let folder = tempfile::tempdir().unwrap();
    let image = image(folder.path());
    let found = records(&[&image, "--sigma", "2,20=1.5,21=auto", "--thickness", "20=3"]);
    let alone = [
        records(&[&image, "--label", "2", "--sigma", "2"]),
        records(&[&image, "--label", "20", "--sigma", "1.5", "--thickness", "3"]),
        records(&[&image, "--label", "21"]),
    ];
    assert_eq!(found, alone.concat());
    let parameter = |n: usize, name: &str| found[n]["parameters"][name].as_f64().unwrap();
    assert_eq!([0, 1].map(|n| parameter(n, "sigma_mm")), [2.0, 1.5]);
    assert!((parameter(2, "sigma_mm") - 2.0 * (0.8f64 * 0.9).cbrt()).abs() < 1e-6);
    assert_eq!((parameter(1, "thickness_mm"), parameter(2, "thickness_mm")), (3.0, 2.5));
    // Without one for all the others have the automatic one; united labels are named as they are chosen.
    let united = records(&[&image, "--label", "20+21,2", "--sigma", "20+21=1.7"]);
    assert_eq!(united[0]["parameters"]["sigma_mm"], 1.7);
    assert_eq!(united[1]["parameters"]["sigma_mm"], found[2]["parameters"]["sigma_mm"]);
    let shown = run(&["measure", &image, "--sigma", "2,20=1.5,21=2", "-q"]);
    assert!(text(&shown.stdout).contains("sigma 2/1.5/2 mm"), "{}", text(&shown.stdout));
}

/// Maps, pages and embedded images have them as well.
#[test]
fn all_commands_have_them() {
    let folder = tempfile::tempdir().unwrap();
    let image = image(folder.path());
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let [document, page, mask] = ["map.json", "page.html", "mask.nii.gz"].map(file);
    let scales = ["--sigma", "2,20=1.25"];
    for (command, output) in [("map", &document), ("report", &page), ("embed", &mask)] {
        let done = run(&[&[command, &image, "-o", output], &scales[..]].concat());
        assert!(done.status.success(), "{command}: {}", text(&done.stderr));
        if command == "embed" {
            let rows: Vec<Vec<&str>> =
                text(&done.stdout).lines().map(|line| line.split_whitespace().collect()).collect();
            assert_eq!(rows[2..5].iter().map(|row| row[2]).collect::<Vec<_>>(), ["2", "1.25", "2"]);
        }
    }
    let map: Value = serde_json::from_slice(&std::fs::read(&document).unwrap()).unwrap();
    assert_eq!(map["results"][1]["parameters"]["sigma_mm"], 1.25);
    assert!(std::fs::read_to_string(&page).unwrap().contains("1.25"));
}

#[test]
fn lengths_that_belong_to_nothing_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let image = image(folder.path());
    let cases: [(&[&str], i32, &str); 12] = [
        (&["--sigma", "2,5=1"], 1, "given for label 5, which is not among the objects: 2, 20, 21"),
        (&["--thickness", "20+21=3"], 1, "balls.nii.gz: a sigma or thickness is given for label 20+21"),
        (&["--thickness", "20+21=3"], 1, "; write 20=MM"),
        (&["--label", "20+21", "--sigma", "2,20=1"], 2, "among the objects: 20+21; write 20+21=MM"),
        (&["--sigma", "20+21=1,21+20=2"], 2, "has two lengths"),
        (&["--label", "2", "--sigma", "20=1"], 2, "given for label 20, which is not among the objects: 2"),
        (&["--sigma", "1,2"], 2, "LABEL=MM"),
        (&["--sigma", "2=1,2=3"], 2, "label 2 has two lengths"),
        (&["--sigma", "2=-1"], 2, "positive"),
        (&["--sigma", "all=1"], 2, "name one label"),
        (&["--sigma", "2=1", "--embedding", "probability"], 2, "has no labels"),
        (&["--thickness", "2=1", "--embedding", "given"], 2, "has no labels"),
    ];
    for (args, status, wanted) in cases {
        let output = run(&[&["measure", &image], args].concat());
        assert_eq!(output.status.code(), Some(status), "{args:?}");
        assert!(text(&output.stderr).contains(wanted), "{args:?}: {}", text(&output.stderr));
    }
}

/// Of several images some may lack a label, which is said once; where none has it that is an error. Each record has
/// the sigma of its label, in whatever order united labels are named.
#[test]
fn images_may_lack_a_label() {
    let folder = tempfile::tempdir().unwrap();
    let image = image(folder.path());
    let other = "phantom:ball?radius=8";
    for (inputs, status, wanted) in [
        ([&image, other], 0, "for label 20, which 1 of 2 inputs lack, as phantom:ball?radius=8"),
        (
            [other, "phantom:ball?radius=9"],
            1,
            "for label 20, which none of the 2 inputs has: phantom:ball?radius=8 has 1; name",
        ),
    ] {
        let output = run(&[&["measure", "--sigma", "2,20=1.25", "--format", "json"], &inputs[..]].concat());
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{told}");
        assert_eq!(told.matches(wanted).count(), 1, "{told}");
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        for record in document["results"].as_array().unwrap() {
            let sigma = if record["label"] == 20 { 1.25 } else { 2.0 };
            assert_eq!(record["parameters"]["sigma_mm"], sigma);
        }
        assert_eq!(document["failures"].as_array().unwrap().len(), 0);
    }
    let united = records(&[&image, "--label", "20+21", "--sigma", "2,21+20=1.5"]);
    assert_eq!(united[0]["parameters"]["sigma_mm"], 1.5);
}
