//! Numbers of the original object on the command line: scales, sweeps, the zoo.

use serde_json::Value;
use std::process::{Command, Output};

const BALL: &str = "phantom:ball?radius=12&shift=0.3,0.2,0.1";

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).args(args).output().expect("the program runs")
}

fn run_in(folder: &std::path::Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_surfometry"));
    command.current_dir(folder).args(args).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

fn json(args: &[&str]) -> Value {
    let output = run(&[args, &["--format", "json"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// A ball shrinks by the blur, the compensated one stays.
#[test]
fn a_sweep_shows_what_depends_on_sigma() {
    let document = json(&["sweep", BALL, "--over", "sigma", "--range", "1.5:3:4"]);
    let results = document["results"].as_array().unwrap();
    let of = |path: [&str; 2]| -> Vec<f64> {
        results
            .iter()
            .map(|r| if path[0].is_empty() { &r[path[1]] } else { &r[path[0]][path[1]] }.as_f64().unwrap())
            .collect()
    };
    assert_eq!(of(["parameters", "sigma_mm"]), [1.5, 2.0, 2.5, 3.0]);
    let (plain, original) = (of(["blurred", "volume_mm3"]), of(["", "volume_mm3"]));
    assert!(plain.windows(2).all(|pair| pair[1] < 0.99 * pair[0]), "{plain:?}");
    let exact = results[0]["truth"]["volume_mm3"].as_f64().unwrap();
    assert!(original.iter().all(|v| (v / exact - 1.0).abs() < 0.01), "{original:?}");
    let table = run(&["sweep", BALL, "--range", "1:2:2", "--log"]);
    assert!(text(&table.stdout).contains("sigma mm"));
}

/// A chart an object, with its lines; a value that cannot be measured leaves the others.
#[test]
fn sweeps_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (svg, png) = (file("sweep.svg"), file("sweep.png"));
    let sweep = ["sweep", BALL, "--range", "1.5:3:4"];
    assert!(run(&[&sweep[..], &["--chart", &svg]].concat()).status.success());
    let drawn = std::fs::read_to_string(&svg).unwrap();
    for name in
        ["volume", "surface area", "total mean curvature", "Euler", "sigma (mm)", "original", "voxels"]
    {
        assert!(drawn.contains(name), "{name}");
    }
    // Three panels have an original with its bars.
    assert_eq!(drawn.matches("<polygon").count(), 3, "{drawn}");
    let partly =
        run(&["sweep", BALL, "--over", "thickness", "--range", "2:1000:3", "--log", "--chart", &png]);
    assert_eq!(partly.status.code(), Some(1));
    assert!(std::fs::read(&png).unwrap().starts_with(b"\x89PNG"));
    let wrong = run(&[&sweep[..], &["--chart", &file("sweep.jpg")]].concat());
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains(".png, .svg or .pdf"));
}

/// Any measure by its name, with its bars; and the surface at the first, some and the last value.
#[test]
fn sweeps_of_any_measure_and_surfaces_along_the_way() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (chart, surfaces) = (file("chart.svg"), file("ball.svg"));
    let sweep = ["sweep", BALL, "--range", "1.5:3:4", "--chart", &chart, "-q"];
    let measures = "average_mean_curvature_per_mm,mesh_triangles";
    let drawn =
        run(&[&sweep[..], &["--measures", measures, "--surfaces", &surfaces, "--surface-count", "3"]]
            .concat());
    assert!(drawn.status.success(), "{}", text(&drawn.stderr));
    let chart = std::fs::read_to_string(&chart).unwrap();
    assert!(measures.split(',').all(|name| chart.contains(name)));
    // The count of triangles has no bars.
    assert_eq!(chart.matches("<polygon").count(), 1);
    for sigma in ["1.5", "2.5", "3"] {
        let picture = std::fs::read_to_string(file(&format!("ball_sigma-{sigma}.svg"))).unwrap();
        assert!(picture.contains(&format!("sigma {sigma} mm")), "{sigma}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
    let unknown = run(&[&sweep[..], &["--measures", "roundness"]].concat());
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stderr).contains("roundness: no number of that name"));
}

/// Blurred, plus the terms, is the original.
#[test]
fn compensation_is_explained() {
    let output = run(&["measure", BALL, "--explain"]);
    let number = |name: &str, column: usize| -> f64 {
        let line =
            text(&output.stdout).lines().find(|line| line.contains(name)).unwrap_or_else(|| panic!("{name}"));
        let values = &line[line.find(name).unwrap() + name.len()..].replace("+ ", "").replace("- ", "-");
        values.split_whitespace().nth(column).unwrap().parse().unwrap()
    };
    for column in 0..3 {
        let terms = ["blurred", "blur's shift", "band's width", "terraces"];
        // V is the voxels'.
        let count = if column == 0 { number("count", 0) } else { 0.0 };
        let sum = count + terms.iter().map(|term| number(term, column)).sum::<f64>();
        assert!((sum / number("original", column) - 1.0).abs() < 1e-4, "{}", text(&output.stdout));
    }
}

#[test]
fn sweeps_that_make_no_sense() {
    for args in [
        ["--over", "sigma", "--range", "1:2:1"],
        ["--over", "sigma", "--range", "0:2:3"],
        ["--over", "sigma", "--range", "1:2"],
    ] {
        assert_eq!(run(&[&["sweep", BALL], &args[..]].concat()).status.code(), Some(2), "{args:?}");
    }
    // What contradicts itself is told before any input is looked at: this one is not there.
    for args in [
        &["--over", "level", "--range", "0.5:1.2:3"][..],
        &["--over", "level", "--range", "0.4:0.6:3", "--embedding", "corrected"],
        &["--range", "1:2:3", "--embedding", "distance"],
        &["--range", "1:2:3", "--epsilon", "0.6"],
        &["--range", "1:2:3", "--chart", "chart.png", "--measures", "volume"],
    ] {
        let refused = run(&[&["sweep", "nowhere.nii"], args].concat());
        assert_eq!(refused.status.code(), Some(2), "{args:?}");
        assert!(!text(&refused.stderr).contains("nowhere"), "{}", text(&refused.stderr));
    }
    let twice = run(&["sweep", BALL, "--range", "1:2:3", "--sigma", "2"]);
    assert_eq!(twice.status.code(), Some(2));
    // A band too thick for the blur is left out and told; the others are there.
    let partly = run(&["sweep", BALL, "--over", "thickness", "--range", "2.5:1000:2", "--format", "json"]);
    assert_eq!(partly.status.code(), Some(1));
    let document: Value = serde_json::from_slice(&partly.stdout).unwrap();
    assert_eq!(document["results"].as_array().unwrap().len(), 1);
    assert!(
        document["failures"][0]["error"].as_str().unwrap().starts_with("t mm 1000: the band is too wide")
    );
}

/// The surface of the original ball, not of the blurred one; its scale is in the record, and each vertex has
/// its errors.
#[test]
fn maps_at_a_scale_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (csv, record) = (file("ball.csv"), file("ball.json"));
    let ball = "phantom:ball?radius=30&shift=0.3,0.2,0.1";
    let output = run(&["map", ball, "--curvature-sigma", "object", "-o", &csv, "-o", &record]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let document: Value = serde_json::from_str(&std::fs::read_to_string(record).unwrap()).unwrap();
    let parameters = &document["results"][0]["parameters"];
    assert_eq!(parameters["sigma_mm"], 2.0);
    let sigma = document["results"][0]["curvature_sigma_mm"].as_f64().unwrap();
    // 0.66 h^(2/7) R^(5/7), and more where curvature hardly varies, at most 0.49 of 2 V / A.
    let rule = 0.66 * 30f64.powf(5.0 / 7.0);
    assert!((1.15 * rule..0.49 * 20.0).contains(&sigma), "{sigma}");
    let lines = std::fs::read_to_string(csv).unwrap();
    let columns: Vec<&str> = lines.lines().next().unwrap().split(',').collect();
    let column = |name: &str| columns.iter().position(|c| *c == name).unwrap_or_else(|| panic!("{name}"));
    let rows: Vec<Vec<f64>> =
        lines.lines().skip(1).map(|l| l.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    let mean = |name: &str| rows.iter().map(|row| row[column(name)]).sum::<f64>() / rows.len() as f64;
    // The ball that is blurred at this sigma has 10 % more.
    assert!((30.0 * mean("mean_curvature_per_mm") - 1.0).abs() < 0.01);
    assert!(
        mean("mean_curvature_per_mm_standard_error") > 0.0
            && mean("gaussian_curvature_per_mm2_standard_error") > 0.0
    );
    assert!(!columns.contains(&"displacement_mm"));
    let refused =
        run(&["map", BALL, "--embedding", "distance", "--curvature-sigma", "auto", "-o", &file("x.csv")]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("leave it out"), "{}", text(&refused.stderr));
}

#[test]
fn the_zoo_is_measured() {
    let document = json(&["validate", "--poses", "1", "--resolutions", "6", "--ratios", "1", "--no-local"]);
    let summaries = document["summaries"].as_array().unwrap();
    assert_eq!(summaries.len(), 13);
    assert_eq!(document["cases"].as_array().unwrap().len(), 13);
    for summary in summaries {
        let plain = summary["worst_blurred"]["surface_area"].as_f64().unwrap();
        let compensated = summary["worst_original"]["surface_area"].as_f64().unwrap();
        // Of an object that is recovered, both are near.
        assert!(compensated.abs() < plain.abs() || plain.abs() < 1.5 && compensated.abs() < 1.5, "{summary}");
    }
    let two = json(&[
        "validate",
        "--poses",
        "1",
        "--resolutions",
        "6",
        "--ratios",
        "1",
        "--no-local",
        "--shape",
        "torus",
    ]);
    assert_eq!(two["summaries"].as_array().unwrap().len(), 2);
    assert_eq!(run(&["validate", "--shape", "cube"]).status.code(), Some(2));
    assert_eq!(run(&["validate", "--resolutions", "1e9"]).status.code(), Some(2));
}

/// Another program's numbers are set beside ours: here our own, and exact ones.
#[test]
fn another_program_goes_through_the_zoo() {
    let folder = tempfile::tempdir().unwrap();
    let zoo = [
        "validate",
        "--zoo",
        "thin",
        "--shape",
        "ring",
        "--poses",
        "2",
        "--ratios",
        "1",
        "--resolutions",
        "2,3",
    ];
    let in_folder = |more: &[&str]| run_in(folder.path(), &[&zoo[..], more].concat());
    assert!(in_folder(&["--write", "masks"]).status.success());
    let masks: Vec<String> = std::fs::read_dir(folder.path().join("masks"))
        .unwrap()
        .map(|entry| format!("masks/{}", entry.unwrap().file_name().to_string_lossy()))
        .filter(|name| name.ends_with(".nii.gz"))
        .collect();
    assert_eq!(masks.len(), 4);
    let names: Vec<&str> = masks.iter().map(String::as_str).collect();
    assert!(
        run_in(folder.path(), &[&["measure"], &names[..], &["-o", "ours.csv"]].concat()).status.success()
    );
    let found = in_folder(&["--against", "ours.csv", "--format", "json"]);
    let rivalries: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
    assert_eq!(rivalries["schema"], "surfometry.validate-against/1");
    for rivalry in rivalries["results"].as_array().unwrap() {
        assert_eq!(rivalry["cases"], 2);
        // The voxel size of files is a f32.
        let error = |who: &str| rivalry[who]["rms"]["surface_area"].as_f64().unwrap();
        assert!((error("theirs") - error("ours")).abs() < 1e-3, "{rivalry}");
    }
    let truth = std::fs::read_to_string(folder.path().join("masks/truth.csv")).unwrap();
    std::fs::write(folder.path().join("truth.csv"), truth).unwrap();
    let exact = in_folder(&["--against", "truth.csv"]);
    assert!(text(&exact.stdout).contains("+0.00, 0.00"), "{}", text(&exact.stdout));
    // A phantom twice, and a word for a number.
    let ours = std::fs::read_to_string(folder.path().join("ours.csv")).unwrap();
    let row = ours.lines().nth(1).unwrap();
    std::fs::write(folder.path().join("twice.csv"), format!("{ours}{row}\n")).unwrap();
    std::fs::write(folder.path().join("words.csv"), format!("input,volume_mm3\n{},big\n", names[0])).unwrap();
    for (table, said) in [("twice.csv", "more than once"), ("words.csv", "no number")] {
        let refused = in_folder(&["--against", table]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).contains(said), "{}", text(&refused.stderr));
    }
    std::fs::write(folder.path().join("none.csv"), "input,volume_mm3\nx.nii,1\n").unwrap();
    assert_eq!(in_folder(&["--against", "none.csv"]).status.code(), Some(2));
}

/// A surface that is mapped at scales of its own is the object's, not the blur's: so are the numbers and warnings beside it.
/// The volume, and what was chosen, stay as they are.
#[test]
fn numbers_beside_the_original_surface_are_those_of_measure() {
    let folder = tempfile::tempdir().unwrap();
    let rod = "phantom:capsule?radius=1.5&length=20&rotate=30,40,50";
    let mapped = |name: &str, more: &[&str]| -> (Value, Vec<u8>) {
        let [json, voxels] = [".json", ".nii"].map(|ending| format!("{name}{ending}"));
        let args = ["map", rod, "--curvature-sigma", "auto", "-o", &json, "-o", &voxels, "-q"];
        let output = run_in(folder.path(), &[&args, more].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let document = std::fs::read(folder.path().join(json)).unwrap();
        let document: Value = serde_json::from_slice(&document).unwrap();
        (document["results"][0].clone(), std::fs::read(folder.path().join(voxels)).unwrap())
    };
    let (ours, volume) = mapped("ours", &[]);
    let measured = &json(&["measure", rod])["results"][0];
    for field in ["surface_area_mm2", "total_mean_curvature_mm", "standard_error", "parameters"] {
        assert_eq!(ours[field], measured[field], "{field}");
    }
    // One more is about the surface.
    let [ours_raised, raised] = [&ours, measured].map(|object| object["flags"].as_array().unwrap());
    assert_eq!(ours_raised[..raised.len()], raised[..]);
    assert!(raised.iter().all(|flag| flag["code"] != "detail-lost"), "{raised:?}");
    let [area, error] =
        [&ours["surface_area_mm2"], &ours["standard_error"]["surface_area_mm2"]].map(|v| v.as_f64().unwrap());
    let exact = ours["truth"]["surface_area_mm2"].as_f64().unwrap();
    assert!((area - exact).abs() < 2.0 * error && error < 0.1 * exact, "{area} ± {error} of {exact}");
    let (chosen, same) = mapped("chosen", &["--embedding", "gaussian"]);
    assert!(chosen["surface_area_mm2"].is_null(), "{chosen}");
    assert!(volume == same);
}

/// A turned gyroid with walls of two to four voxels, cut out of space, as a NRRD.
fn network() -> Vec<u8> {
    const SIDE: usize = 24;
    let (turn, period) = (0.4_f64, 8.0);
    let is_inside = |index: [usize; 3]| {
        let [i, j, z] = index.map(|i| (i as f64 + 0.37) * std::f64::consts::TAU / period);
        let (x, y) = (turn.cos() * i - turn.sin() * j, turn.sin() * i + turn.cos() * j);
        let wave = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        wave > 0.0 && index.iter().all(|i| (2..SIDE - 2).contains(i))
    };
    let voxel = |n: usize| u8::from(is_inside([n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE]));
    let header = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 24\nspacings: 1 1 1\nencoding: raw\n\n";
    header.iter().copied().chain((0..SIDE.pow(3)).map(voxel)).collect()
}

/// A map at scales of its own may tear what is thin: where its surface is not the one that was measured, that is told, and its mesh is
/// in the record; of a ball both are the same.
#[test]
fn a_map_that_shows_another_surface_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let mapped = |shape: &str, name: &str| -> (Value, usize) {
        let (json, mesh) = (format!("{name}.json"), format!("{name}.obj"));
        let args = ["map", shape, "--curvature-sigma", "auto", "-o", &json, "-o", &mesh, "-q"];
        let output = run_in(folder.path(), &args);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let document: Value =
            serde_json::from_slice(&std::fs::read(folder.path().join(json)).unwrap()).unwrap();
        let faces = std::fs::read_to_string(folder.path().join(mesh)).unwrap();
        (document["results"][0].clone(), faces.lines().filter(|line| line.starts_with("f ")).count())
    };
    let flag = |object: &Value| {
        let flags = object["flags"].as_array().unwrap().clone();
        flags.into_iter().find(|flag| flag["code"] == "map-differs-from-object")
    };
    std::fs::write(folder.path().join("gyroid.nrrd"), network()).unwrap();
    for (shape, name, differs) in [(BALL, "ball", false), ("gyroid.nrrd", "network", true)] {
        let (object, triangles) = mapped(shape, name);
        let own = &object["mapped"];
        assert_eq!(own["triangles"], triangles, "{name}");
        let chi = [&own["euler_characteristic"], &object["topology"]["euler_characteristic_mesh"]];
        let told = flag(&object);
        assert_eq!(told.is_some(), differs, "{name}: {own} {}", object["mesh"]);
        assert_eq!(chi[0] == chi[1], !differs, "{name}: {own}");
        let message = told.map_or_else(String::new, |flag| flag["message"].to_string());
        assert_eq!(message.contains("Euler characteristic is"), differs, "{message}");
        assert!(!message.contains("  "), "{message}");
    }
    assert!(run_in(folder.path(), &["map", BALL, "-o", "b.json", "-q"]).status.success());
    let blurred: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("b.json")).unwrap()).unwrap();
    assert!(blurred["results"][0]["mapped"].is_null());
}
