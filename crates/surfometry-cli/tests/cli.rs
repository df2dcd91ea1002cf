//! The command line as a user meets it: exit status, stdout, stderr, files.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn run(args: &[&str]) -> Output {
    run_in(Path::new("."), args)
}

fn run_in(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).current_dir(folder).args(args).output().expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn json(args: &[&str]) -> Value {
    let output = run(&[args, &["--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Keys of an object, nested, in order.
fn keys(value: &Value) -> Vec<String> {
    let mut all = Vec::new();
    if let Value::Object(fields) = value {
        for (key, inner) in fields {
            all.push(key.clone());
            all.extend(keys(inner).into_iter().map(|k| format!("{key}.{k}")));
        }
    }
    all
}

const BALL: &str = "phantom:ball?radius=10&shift=0.3,0.2,0.1";

/// docs/contract.md, field by field and in its order; fields may be added, never renamed.
#[test]
fn json_is_the_contract() {
    let document = json(&["measure", BALL]);
    assert_eq!(document["schema"], "surfometry.measure/2");
    assert_eq!(document["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(document["failures"], Value::Array(Vec::new()));
    let record = &document["results"][0];
    let plain = [
        "volume_mm3",
        "surface_area_mm2",
        "total_mean_curvature_mm",
        "average_mean_curvature_per_mm",
        "total_gaussian_curvature",
        "euler_characteristic",
        "total_squared_mean_curvature",
    ];
    let group = |name: &str, fields: &[&str]| {
        let inner = fields.iter().map(|f| format!("{name}.{f}"));
        [name.to_owned()].into_iter().chain(inner).collect::<Vec<_>>()
    };
    let first = ["input", "label", "name", "component", "surface"];
    let mut expected: Vec<String> = first.iter().chain(&plain).map(ToString::to_string).collect();
    expected.extend(group("standard_error", &plain));
    expected.extend(group("blurred", &plain));
    expected.extend(group("blurred.grid_noise", &plain));
    expected.extend(group("mesh", &["volume_mm3", "surface_area_mm2", "vertices", "triangles"]));
    expected.extend(group("voxels", &["count", "volume_mm3", "centroid_mm", "cut_area_mm2", "bounding_box"]));
    expected.extend(group(
        "topology",
        &[
            "euler_characteristic_mesh",
            "euler_characteristic_voxels_26",
            "euler_characteristic_voxels_6",
            "components",
            "cavities",
            "handles",
            "euler_characteristic_expected",
            "changes",
        ],
    ));
    expected.push("clip".to_owned());
    expected.extend(group(
        "parameters",
        &[
            "embedding",
            "derivatives",
            "quadrature",
            "delta",
            "sigma_mm",
            "thickness_mm",
            "level",
            "epsilon",
            "clip",
            "padding",
        ],
    ));
    expected.extend(group("grid", &["dimensions", "spacing_mm"]));
    expected.extend(["recovery", "flags"].map(str::to_owned));
    expected.extend(group("truth", &plain[..6]));
    expected.extend(
        [
            "preparation",
            "regions",
            "interfaces",
            "curvature_sigma_mm",
            "input_sha256",
            "read_seconds",
            "seconds",
        ]
        .map(str::to_owned),
    );
    assert_eq!(keys(record), expected);
    assert_eq!(record["label"], 1);
    assert!(
        record["name"].is_null() && record["curvature_sigma_mm"].is_null() && record["recovery"].is_null()
    );
    assert!(record["blurred"]["grid_noise"]["volume_mm3"].is_number());
    assert!(record["surface"] == "original" && record["euler_characteristic"] == 2.0);
    assert_eq!(record["parameters"]["derivatives"], "matched");
    let chi = record["blurred"]["euler_characteristic"].as_f64().unwrap();
    assert!((chi - 2.0).abs() < 0.01);
}

#[test]
fn paper_settings_and_what_overrides_them() {
    let parameters = |args: &[&str]| {
        json(&[&["measure", BALL, "--paper"], args].concat())["results"][0]["parameters"].clone()
    };
    let paper = parameters(&[]);
    assert_eq!(paper["derivatives"], "finite-difference");
    assert_eq!(paper["quadrature"], "simpson");
    assert_eq!(paper["sigma_mm"], 2.0);
    assert_eq!(paper["thickness_mm"], 2.5);
    let changed = parameters(&["--sigma", "1.5", "--quadrature", "sum"]);
    assert_eq!(changed["sigma_mm"], 1.5);
    assert_eq!(changed["quadrature"], "sum");
    let automatic = parameters(&["--sigma", "auto", "--epsilon", "0.2"]);
    assert_eq!(automatic["sigma_mm"], 2.0);
    // What the half-width stands for: erf(t / (2 sqrt2 sigma)) / 2 = 0.2.
    assert!((automatic["thickness_mm"].as_f64().unwrap() - 2.0976).abs() < 1e-3);
    assert_eq!(automatic["epsilon"], 0.2);
}

#[test]
fn table_shows_plain_compensated_and_exact() {
    let output = run(&["measure", "phantom:torus?major=15&minor=6&rotate=20,30,40&shift=0.3,0.2,0.1"]);
    let table = text(&output.stdout);
    for word in ["blurred", "original", "exact", "volume mm³", "chi", "sigma 2 mm"] {
        assert!(table.contains(word), "{word} is missing in\n{table}");
    }
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
}

#[test]
fn failed_inputs_are_listed_and_the_others_measured() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.nii"), b"nonsense").unwrap();
    let args = ["measure", "bad.nii", BALL, "missing.nrrd", "phantom:cube"];
    let output = run_in(folder.path(), &[&args[..], &["--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(1));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["results"].as_array().unwrap().len(), 1);
    let failed: Vec<&str> =
        document["failures"].as_array().unwrap().iter().map(|f| f["input"].as_str().unwrap()).collect();
    assert_eq!(failed, ["bad.nii", "missing.nrrd", "phantom:cube"]);
    let errors = text(&output.stderr);
    assert!(errors.contains("surfometry: bad.nii:") && errors.contains("No such file"), "{errors}");
    let csv = run_in(folder.path(), &[&args[..], &["--format", "csv"]].concat());
    let lines: Vec<String> = text(&csv.stdout).lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 5);
    let column = lines[0].split(',').position(|c| c == "input").unwrap();
    assert_eq!(column, 0);
    assert!(lines[0].ends_with("error") && lines[0].contains("standard_error_volume_mm3"));
    assert!(
        lines[0].contains("voxels_centroid_mm_x,voxels_centroid_mm_y")
            && lines[0].contains("voxels_bounding_box_min_x")
    );
    // Rows stand in the order of the inputs.
    assert!(lines[1].starts_with("bad.nii,") && !lines[1].ends_with(',') && lines[2].ends_with(','));
}

#[test]
fn wrong_commands_end_with_2() {
    let wrong: [&[&str]; 16] = [
        &["measure"],
        &["measur", BALL],
        &["measure", BALL, "--sigma", "0"],
        &["measure", BALL, "--sigma", "-1"],
        &["measure", BALL, "--sigma", "nan"],
        &["measure", BALL, "--thickness", "inf"],
        &["measure", BALL, "--level", "1"],
        &["measure", BALL, "--label", "1,,2"],
        &["measure", BALL, "--spacing", "1,0,1"],
        &["measure", BALL, "--spacing", "1,1"],
        &["measure", BALL, "--thickness", "2", "--epsilon", "0.1"],
        &["measure", BALL, "--embedding", "distance", "--sigma", "2"],
        &["measure", BALL, "--embedding", "distance", "--derivatives", "gaussian"],
        &["measure", BALL, "--embedding", "distance", "--clip", "exclude"],
        &["measure", BALL, "--per-component", "--png", "ball.png"],
        &["measure", BALL, "--threads", "0"],
    ];
    for args in wrong {
        let output = run(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{args:?}");
    }
}

/// A phantom beside files that need a spacing is put on the same lattice.
#[test]
fn a_spacing_replaces_that_of_a_phantom() {
    let volume = |args: &[&str]| {
        let output = run(&[&["measure", "--format", "csv"], args].concat());
        let rows = csv::Reader::from_reader(&output.stdout[..]).into_records();
        let row = rows.map(|row| row.expect("a row")).next().expect("a result");
        row[5].to_owned()
    };
    let asked = volume(&["phantom:ball?radius=6", "--spacing", "0.5,0.6,0.7"]);
    assert_eq!(asked, volume(&["phantom:ball?radius=6&spacing=0.5,0.6,0.7"]));
    assert_ne!(asked, volume(&["phantom:ball?radius=6"]));
}

/// Everything but the times is the same text for any number of threads.
#[test]
fn threads_do_not_change_the_output() {
    let stripped = |threads: &str| {
        let input = "phantom:genus?genus=1&rotate=10,20,30&spacing=1,0.8,0.9";
        let mut document = json(&["measure", input, "--threads", threads]);
        for key in ["seconds", "read_seconds"] {
            document["results"][0][key] = Value::Null;
        }
        document.to_string()
    };
    let one = stripped("1");
    assert_eq!(one, stripped("2"));
    assert_eq!(one, stripped("3"));
}

#[test]
fn a_phantom_written_and_read_is_the_same_phantom() {
    let folder = tempfile::tempdir().unwrap();
    let spec = "ellipsoid?radii=12,9,8&rotate=10,20,30&shift=0.2,0.3,0.4&spacing=0.8,1,1.2";
    let written = run_in(folder.path(), &["phantom", spec, "-o", "e.nii.gz"]);
    assert_eq!(written.status.code(), Some(0), "{}", text(&written.stderr));
    let file = folder.path().join("e.nii.gz");
    let from_file = json(&["measure", file.to_str().unwrap()])["results"][0].clone();
    let from_memory = json(&["measure", &format!("phantom:{spec}")])["results"][0].clone();
    assert_eq!(from_file["voxels"]["count"], from_memory["voxels"]["count"]);
    for key in ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm"] {
        let (a, b) = (from_file[key].as_f64().unwrap(), from_memory[key].as_f64().unwrap());
        assert!((a / b - 1.0).abs() < 1e-6, "{key}: {a} {b}");
    }
    let truth: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("e.truth.json")).unwrap()).unwrap();
    assert_eq!(truth["truth"], from_memory["truth"]);
    assert!(from_file["truth"].is_null());
    let refused = run_in(folder.path(), &["phantom", spec, "-o", "e.stl"]);
    assert_eq!(refused.status.code(), Some(2));
}

/// An image of two labels that touch, 1 and 4.
fn two_labels(folder: &Path) -> String {
    let mut voxels = vec![0u8; 30 * 30 * 30];
    for (i, voxel) in voxels.iter_mut().enumerate() {
        let (x, y, z) = (i % 30, i / 30 % 30, i / 900);
        if (5..25).contains(&x) && (8..22).contains(&y) && (8..22).contains(&z) {
            *voxel = if x < 15 { 1 } else { 4 };
        }
    }
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 30 30 30\nspacings: 1 1 1\nencoding: raw\n\n";
    let path = folder.join("two.nrrd");
    std::fs::write(&path, [header.as_bytes(), &voxels].concat()).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Two labels, one at a time, listed, united, and one that is not there.
#[test]
fn labels_are_chosen_and_united() {
    let folder = tempfile::tempdir().unwrap();
    let path = two_labels(folder.path());
    let path = path.as_str();
    let labels = |args: &[&str]| -> Vec<Value> {
        let document = json(&[&["measure", path, "--sigma", "1"], args].concat());
        document["results"].as_array().unwrap().iter().map(|r| r["label"].clone()).collect()
    };
    assert_eq!(labels(&[]), [Value::from(1), Value::from(4)]);
    assert_eq!(labels(&["--label", "4"]), [Value::from(4)]);
    assert_eq!(labels(&["--label", "4,1"]), [Value::from(4), Value::from(1)]);
    assert_eq!(labels(&["--label", "1+4"]), [Value::from("1+4")]);
    let volume = |label: &str| {
        json(&["measure", path, "--sigma", "1", "--label", label])["results"][0]["voxels"]["count"].clone()
    };
    assert_eq!(volume("1+4"), 20 * 14 * 14);
    let missing = run(&["measure", path, "--label", "9"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(
        text(&missing.stderr).contains("no label 9 in the image; it holds 1, 4"),
        "{}",
        text(&missing.stderr)
    );
    let info = text(&run(&["info", path]).stdout);
    assert!(info.contains("NRRD, uint8, 30 x 30 x 30 voxels") && info.contains("[5,8,8]"), "{info}");
}

/// While slices go by, as a whole, on the surface: the labels that are there are measured, each that is not is a failure.
#[test]
fn a_missing_label_fails_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = two_labels(folder.path());
    std::fs::write(folder.path().join("names.csv"), "label,name\n1,left\n3,front\n4,right\n").unwrap();
    let document = |args: &[&str]| -> (Vec<Value>, Vec<String>) {
        let output = run_in(folder.path(), &[&["measure", path.as_str(), "--format", "json"], args].concat());
        assert_eq!(output.status.code(), Some(1), "{args:?}: {}", text(&output.stderr));
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let of = |list: &str, field: &str| {
            document[list].as_array().unwrap().iter().map(|r| r[field].clone()).collect()
        };
        let failures: Vec<Value> = of("failures", "error");
        (of("results", "label"), failures.iter().map(|error| error.as_str().unwrap().to_owned()).collect())
    };
    let both = [Value::from(1), Value::from(4)];
    for more in [&[][..], &["--per-component"]] {
        let (labels, failures) = document(&[&["--label", "1-4"], more].concat());
        assert_eq!(labels, both);
        let expected = [2, 3].map(|label| format!("no label {label} in the image; it holds 1, 4 (--label)"));
        assert_eq!(failures, expected);
        let (labels, failures) = document(&[&["--label", "9", "--label", "4"], more].concat());
        assert_eq!((labels, failures.len()), (vec![Value::from(4)], 1));
        let names = ["--names", "names.csv", "--label", "left,front,top,right"];
        let (labels, failures) = document(&[&names, more].concat());
        assert_eq!(labels, both);
        assert!(
            failures[0].contains("no label is called `top`")
                && failures[1].contains("`front` (label 3) has no voxels")
        );
    }
    // Thousands are told of as fast as one.
    let (labels, failures) = document(&["--label", "1-9000"]);
    assert_eq!((labels.len(), failures.len()), (2, 8998));
    let mapped = run_in(folder.path(), &["map", &path, "--label", "2-4", "-o", "m.ply"]);
    assert_eq!(mapped.status.code(), Some(1));
    assert!(folder.path().join("m.ply").exists(), "{}", text(&mapped.stdout));
}

/// `surfometry scan.nii.gz` is `surfometry measure scan.nii.gz`; a slip in a command's name is not.
#[test]
fn an_input_alone_is_measured() {
    let (short, long) =
        (run(&["-q", BALL, "--format", "csv"]), run(&["measure", "-q", BALL, "--format", "csv"]));
    let rows = |output: &Output| text(&output.stdout).lines().count();
    assert_eq!((short.status.code(), rows(&short)), (Some(0), rows(&long)));
    let slip = run(&["mesure", BALL]);
    assert_eq!(slip.status.code(), Some(2));
    assert!(text(&slip.stderr).contains("'measure'"), "{}", text(&slip.stderr));
}

#[test]
fn an_object_that_the_blur_removes_is_no_failure() {
    let document = json(&["measure", "phantom:ball?radius=3", "--sigma", "10"]);
    let record = &document["results"][0];
    assert!(record["blurred"]["volume_mm3"].is_null() && record["surface_area_mm2"].is_null());
    assert_eq!(record["volume_mm3"], record["voxels"]["volume_mm3"]);
    let codes: Vec<&str> =
        record["flags"].as_array().unwrap().iter().map(|f| f["code"].as_str().unwrap()).collect();
    assert!(codes.contains(&"surface-vanished"), "{codes:?}");
}

#[test]
fn images_of_different_spacing_get_a_warning() {
    let two = ["measure", BALL, "phantom:ball?radius=10&spacing=1,1,2"];
    // Numbers of the blurred surface are not comparable then; those of the object are.
    let blurred = ["--level", "0.45"];
    let warned = run(&[&two[..], &blurred].concat());
    assert_eq!(warned.status.code(), Some(0));
    assert!(text(&warned.stderr).contains("use --sigma 2.5198"), "{}", text(&warned.stderr));
    for silent in [&[][..], &["--level", "0.45", "--sigma", "2"], &["--level", "0.45", "--quiet"]] {
        assert!(run(&[&two[..], silent].concat()).stderr.is_empty());
    }
    // A result does not depend on what else is measured in the run.
    let alone = json(&["measure", BALL])["results"][0]["volume_mm3"].clone();
    assert_eq!(json(&two)["results"][0]["volume_mm3"], alone);
}

#[test]
fn patterns_name_files() {
    let folder = tempfile::tempdir().unwrap();
    // The last is what macOS keeps beside a file on other disks.
    for name in ["b.nii", "a.nii", "._a.nii"] {
        assert_eq!(run_in(folder.path(), &["phantom", "ball?radius=4", "-o", name]).status.code(), Some(0));
    }
    let output = run_in(folder.path(), &["measure", "*.nii", "--sigma", "1", "--format", "csv"]);
    let inputs: Vec<String> =
        text(&output.stdout).lines().skip(1).map(|l| l.split(',').next().unwrap().to_owned()).collect();
    assert_eq!(inputs, ["a.nii", "b.nii"]);
    let none = run_in(folder.path(), &["measure", "*.mha"]);
    assert_eq!(none.status.code(), Some(1));
    assert!(text(&none.stderr).contains("*.mha: no file matches"), "{}", text(&none.stderr));
}

#[test]
fn a_field_is_measured_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let distance =
        |x: f64, y: f64, z: f64| ((x - 15.3).powi(2) + (y - 15.1).powi(2) + (z - 14.8).powi(2)).sqrt() - 9.0;
    let values =
        (0..27_000).map(|i| distance(f64::from(i % 30), f64::from(i / 30 % 30), f64::from(i / 900)) as f32);
    let header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 30 30 30\nspacings: 1 1 1\nendian: little\nencoding: raw\n\n";
    let path = folder.path().join("phi.nrrd");
    std::fs::write(&path, [header.as_bytes().to_vec(), values.flat_map(f32::to_le_bytes).collect()].concat())
        .unwrap();
    let path = path.to_str().unwrap();
    let record = json(&["measure", path, "--embedding", "given"])["results"][0].clone();
    assert!(record["label"].is_null() && record["parameters"]["sigma_mm"].is_null());
    let area = record["surface_area_mm2"].as_f64().unwrap();
    assert!((area / (4.0 * std::f64::consts::PI * (81.0 + 0.2)) - 1.0).abs() < 2e-3, "{area}");
    assert!(record["parameters"]["padding"].is_null());
    let padded = json(&["measure", path, "--embedding", "given", "--padding", "5"])["results"][0].clone();
    assert!(
        padded["parameters"]["padding"] == 5.0 && padded["surface_area_mm2"] == record["surface_area_mm2"]
    );
    let of_a_mask = run(&["measure", "phantom:ball?radius=4", "--padding", "auto"]);
    assert_eq!(of_a_mask.status.code(), Some(2));
    assert!(text(&of_a_mask.stderr).contains("padding closes a field that is given"));
    let as_labels = run(&["measure", path]);
    assert_eq!(as_labels.status.code(), Some(1));
    assert!(text(&as_labels.stderr).contains("--embedding given"), "{}", text(&as_labels.stderr));
    let info = run(&["info", path]);
    assert_eq!(info.status.code(), Some(1));
    let shown = text(&info.stdout);
    assert!(shown.contains("NRRD, float32, 30 x 30 x 30 voxels of 1 x 1 x 1 mm"), "{shown}");
    assert!(shown.contains("no label image: voxel [0, 0, 0]"), "{shown}");
}

#[test]
fn help_names_every_command_and_option() {
    let help = text(&run(&["measure", "--help"]).stdout);
    for option in [
        "--label",
        "--sigma",
        "--thickness",
        "--epsilon",
        "--level",
        "--embedding",
        "--derivatives",
        "--quadrature",
        "--delta",
        "--paper",
        "--spacing",
        "--format",
        "--output",
        "--shard",
        "--resume",
        "--threads",
        "--quiet",
    ] {
        assert!(help.contains(option), "{option}");
    }
}

/// The README's first example prints what the README shows.
#[test]
fn the_readme_shows_what_the_program_prints() {
    let readme = include_str!("../../../README.md");
    let shown =
        readme.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a text block");
    let spec = shown.lines().next().unwrap();
    assert!(readme.contains(&format!("cargo run --release -- measure '{spec}'")));
    let printed = text(&run(&["measure", spec]).stdout);
    assert!(printed.starts_with(shown), "the README shows\n{shown}\nthe program prints\n{printed}");
}

/// A closed mesh is measured on a lattice that is asked for; without one, or with a hole, it is told what to
/// do.
#[test]
fn meshes_are_measured() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (stl, ply) = (file("ball.stl"), file("ball.ply"));
    let ball = "phantom:ball?radius=16&spacing=0.5,0.5,0.5&shift=0.1,0.2,0.3";
    assert!(run(&["map", ball, "-o", &stl, "-o", &ply, "-q"]).status.success());
    for mesh in [&stl, &ply] {
        let output = run(&["measure", mesh, "--spacing", "0.8,0.9,1", "--format", "json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let record = &document["results"][0];
        // The mesh is that of the blurred ball: sigma^2 / R = 1/16 mm smaller.
        let radius = 16.0 - 1.0 / 16.0;
        let area = record["surface_area_mm2"].as_f64().unwrap();
        assert!((area / (4.0 * std::f64::consts::PI * radius * radius) - 1.0).abs() < 2e-3, "{area}");
        assert_eq!(record["topology"]["euler_characteristic_mesh"], 2);
    }
    let bare = run(&["measure", &stl]);
    assert_eq!(bare.status.code(), Some(1));
    assert!(text(&bare.stderr).contains("--spacing X,Y,Z"), "{}", text(&bare.stderr));
    let page = file("page.html");
    assert!(run(&["report", &ply, "--spacing", "1,1,1", "-o", &page, "-q"]).status.success());
    let bytes = std::fs::read(&stl).unwrap();
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) - 1;
    let holed = [&bytes[..80], &count.to_le_bytes(), &bytes[84..bytes.len() - 50]].concat();
    std::fs::write(file("holed.stl"), holed).unwrap();
    let open = run(&["measure", &file("holed.stl"), "--spacing", "1,1,1"]);
    assert_eq!(open.status.code(), Some(1));
    assert!(text(&open.stderr).contains("is not closed: 3 edges"), "{}", text(&open.stderr));
}

/// The list in the help is that of the shapes, and whoever slips is told the keys of his own.
#[test]
fn phantoms_have_the_keys_that_the_help_lists() {
    let help = text(&run(&["measure", "--help"]).stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    for name in surfometry::phantoms::PHANTOM_NAMES {
        let wrong = text(&run(&["measure", &format!("phantom:{name}?wrong=1")]).stderr);
        let taken = wrong.split_once("it takes ").expect("its keys").1.trim();
        let own = taken.strip_suffix(", spacing, rotate, shift, jitter, flips").expect("the pose's");
        assert!(help.contains(&format!("{name} ({own})")), "{name} ({own}) in {help}");
    }
}

/// A page under another kind's name would be opened as that.
#[test]
fn a_report_is_a_page() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.pdf", "a.txt"] {
        let refused = run_in(folder.path(), &["report", BALL, "-o", name]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).contains("must end in .html or .htm"), "{}", text(&refused.stderr));
        assert!(!folder.path().join(name).exists());
    }
    for name in ["a.HTM", "a"] {
        assert!(run_in(folder.path(), &["report", BALL, "-o", name]).status.success());
        assert!(folder.path().join(name).is_file());
    }
}

/// Names neither command the terminal, nor turn its lines around, nor begin new ones.
#[cfg(unix)]
#[test]
fn names_stay_names() {
    let folder = tempfile::tempdir().unwrap();
    let name = "a\u{1b}31m\u{202e}gpj.exe\nb.nii";
    let shown = "a\\u{1b}31m\\u{202e}gpj.exe\\nb.nii";
    let failed = run_in(folder.path(), &["measure", name]);
    assert_eq!(failed.status.code(), Some(1));
    assert!(text(&failed.stderr).starts_with(&format!("surfometry: {shown}: ")), "{}", text(&failed.stderr));
    assert!(text(&failed.stdout).contains(shown), "{}", text(&failed.stdout));
    run_in(folder.path(), &["phantom", "ball?radius=5", "-o", "ball.nii"]);
    std::fs::rename(folder.path().join("ball.nii"), folder.path().join(name)).unwrap();
    let measured = run_in(folder.path(), &["measure", name, "--quiet"]);
    assert!(text(&measured.stdout).starts_with(&format!("{shown}\n")), "{}", text(&measured.stdout));
}

/// Negative numbers are told what is wrong with them, not that they look like options.
#[test]
fn negative_numbers_are_no_options() {
    for (command, option, value, words) in [
        ("map", "--size", "-5mm", "-5"),
        ("map", "--dpi", "-1", "24..=1200"),
        ("measure", "--shard", "-1/2", "which shard, and of how many"),
    ] {
        let refused = run(&[command, BALL, "-o", "x.png", option, value]);
        let said = text(&refused.stderr);
        assert!(
            refused.status.code() == Some(2) && said.contains(words) && !said.contains("use '--"),
            "{said}"
        );
    }
}

/// Dots per inch are those of charts too.
#[test]
fn a_chart_has_its_dots() {
    let folder = tempfile::tempdir().unwrap();
    let width = |dpi: &str| {
        let sweep = ["sweep", "phantom:ball?radius=6", "--range", "1:2:2", "--chart", "c.png", "--dpi", dpi];
        assert!(run_in(folder.path(), &sweep).status.success());
        let png = std::fs::read(folder.path().join("c.png")).unwrap();
        u32::from_be_bytes(png[16..20].try_into().unwrap())
    };
    assert!(width("192").abs_diff(2 * width("96")) <= 2);
}
