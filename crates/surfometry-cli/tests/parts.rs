//! `measure --regions`, `--interfaces` and `map --sample` as a user meets them.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use surfometry::io::{write_labels, write_voxel_map};
use surfometry::volume::{Affine, Grid, LabelImage};

fn run_in(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).current_dir(folder).args(args).output().expect("it starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

fn grid(spacing: [f64; 3], size: f64) -> Grid {
    let dimensions = spacing.map(|h| (size / h) as usize);
    let mut affine = Affine::diagonal(spacing);
    affine.origin = std::array::from_fn(|a| -0.5 * (dimensions[a] - 1) as f64 * spacing[a]);
    Grid::new(dimensions, affine).unwrap()
}

fn labels(path: &Path, spacing: [f64; 3], size: f64, label: impl Fn([f64; 3]) -> u8) {
    let grid = grid(spacing, size);
    let voxel = |n: usize| label(grid.affine().apply(grid.index_of(n).map(|i| i as f64)));
    let voxels: Vec<u8> = (0..grid.voxel_count()).map(voxel).collect();
    write_labels(path, &LabelImage::from_voxels(grid, &voxels).unwrap()).unwrap();
}

/// A ball of two labels, regions of another lattice, and a volume that rises along z.
fn images(folder: &Path) {
    let inside = |p: [f64; 3]| p.iter().map(|v| v * v).sum::<f64>() < 100.0;
    labels(&folder.join("ball.nii.gz"), [1.0; 3], 32.0, |p| match p[0] {
        _ if !inside(p) => 0,
        x if x < 0.2 => 3,
        _ => 5,
    });
    labels(&folder.join("atlas.nii.gz"), [0.8, 1.1, 0.9], 40.0, |p| 1 + u8::from(p[2] > 2.2));
    let lattice = grid([1.3; 3], 40.0);
    let values: Vec<f32> = (0..lattice.voxel_count())
        .map(|n| lattice.affine().apply(lattice.index_of(n).map(|i| i as f64))[2] as f32)
        .collect();
    write_voxel_map(folder.join("stress.nii.gz"), &lattice, &values, "stress").unwrap();
}

fn results(output: &Output) -> Vec<Value> {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    document["results"].as_array().unwrap().clone()
}

#[test]
fn regions_and_interfaces_in_json_tables_and_a_repeated_run() {
    let folder = tempfile::tempdir().unwrap();
    images(folder.path());
    let asked = ["measure", "ball.nii.gz", "--regions", "atlas.nii.gz", "--interfaces", "-q"];
    let records = results(&run_in(folder.path(), &[&asked[..], &["--format", "json"]].concat()));
    for record in &records {
        let parts = record["regions"].as_array().unwrap();
        assert_eq!(parts.len(), 2);
        for number in
            ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm", "total_gaussian_curvature"]
        {
            let sum: f64 = parts.iter().map(|part| part[number].as_f64().unwrap()).sum();
            let whole = record[number].as_f64().unwrap();
            assert!((sum - whole).abs() < 1e-9 * whole.abs(), "{number}: {sum} for {whole}");
        }
        let contacts = record["interfaces"].as_array().unwrap();
        assert_eq!(contacts.len(), 2, "{contacts:?}");
    }
    // Each contact stands in both records, and in one row of the table.
    assert_eq!(records[0]["interfaces"][1], records[1]["interfaces"][1]);
    assert_eq!(records[0]["interfaces"][1]["labels"], serde_json::json!([3, 5]));
    let table = run_in(folder.path(), &[&asked[..], &["-o", "out.csv"]].concat());
    assert_eq!(table.status.code(), Some(0), "{}", text(&table.stderr));
    let rows = |name: &str| -> Vec<String> {
        std::fs::read_to_string(folder.path().join(name)).unwrap().lines().map(str::to_owned).collect()
    };
    assert_eq!(
        [rows("out.csv").len(), rows("out_regions.csv").len(), rows("out_interfaces.csv").len()],
        [3, 5, 4]
    );
    assert!(rows("out_interfaces.csv")[0].starts_with("input,label_1,label_2,name_1,name_2,"));
    let shown = run_in(folder.path(), &asked);
    assert!(
        text(&shown.stdout).contains("touches") && text(&shown.stdout).contains("region"),
        "{}",
        text(&shown.stdout)
    );
    let saved = run_in(folder.path(), &[&asked[..], &["-o", "out.json"]].concat());
    assert_eq!(saved.status.code(), Some(0), "{}", text(&saved.stderr));
    let again = run_in(folder.path(), &["rerun", "out.json"]);
    assert_eq!(again.status.code(), Some(0), "{}{}", text(&again.stdout), text(&again.stderr));
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    images(folder.path());
    let refused = |args: &[&str], code: i32, words: &str| {
        let done = run_in(folder.path(), args);
        let said = format!("{}{}", text(&done.stdout), text(&done.stderr));
        assert_eq!(done.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.contains(words), "{args:?}: {said}");
    };
    refused(&["measure", "ball.nii.gz", "--interfaces", "--format", "csv"], 2, "-o FILE.csv");
    refused(&["measure", "ball.nii.gz", "--regions", "none.nii.gz", "-q"], 1, "regions none.nii.gz");
    labels(&folder.path().join("empty.nii.gz"), [1.0; 3], 32.0, |_| 0);
    refused(&["measure", "ball.nii.gz", "--regions", "empty.nii.gz", "-q"], 1, "it holds no region");
    refused(
        &["measure", "ball.nii.gz", "--regions", "atlas.nii.gz", "-o", "atlas.nii.gz"],
        2,
        "replace the input",
    );
    refused(&["measure", "ball.nii.gz", "--interfaces", "--embedding", "given"], 2, "interfaces");
    refused(&["map", "ball.nii.gz", "-o", "a.ply", "--sample", "k1_per_mm=stress.nii.gz"], 2, "NAME=FILE");
    for name in ["x_mm", "normal_x", "direction_2_z", "curvature_sigma_mm", "distance_mm_standard_error", ""]
    {
        let sample = format!("{name}=stress.nii.gz");
        refused(&["map", "ball.nii.gz", "-o", "a.ply", "--sample", &sample], 2, "NAME=FILE");
    }
    let twice =
        ["map", "ball.nii.gz", "-o", "a.ply", "--sample", "a=stress.nii.gz", "--sample", "a=stress.nii.gz"];
    refused(&twice, 2, "give each its own");
    refused(&["map", "ball.nii.gz", "-o", "a.ply", "--sample", "none.nii.gz"], 1, "sample none.nii.gz");
}

#[test]
fn samples_stand_at_vertices_and_beside_curvature() {
    let folder = tempfile::tempdir().unwrap();
    images(folder.path());
    let args = [
        "map",
        "ball.nii.gz",
        "--label",
        "3+5",
        "--sample",
        "stress.nii.gz",
        "--sample",
        "again=stress.nii.gz",
    ];
    let done = run_in(
        folder.path(),
        &[&args[..], &["--regions", "atlas.nii.gz", "-o", "m.csv", "-o", "m.ply", "-o", "m.json", "-q"]]
            .concat(),
    );
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let csv = std::fs::read_to_string(folder.path().join("m.csv")).unwrap();
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().ends_with("stress,again"));
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        // The volume is z.
        assert!(
            (cells[cells.len() - 1] - cells[2]).abs() < 1e-4
                && cells[cells.len() - 1] == cells[cells.len() - 2]
        );
    }
    let document: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("m.json")).unwrap()).unwrap();
    let record = &document["results"][0];
    let sample = &record["samples"][0];
    assert_eq!((sample["name"].as_str(), sample["vertices_outside"].as_u64()), (Some("stress"), Some(0)));
    let interval = &sample["correlations"][0]["pearson"]["interval"];
    assert!(interval[0].as_f64() < Some(0.0) && interval[1].as_f64() > Some(0.0), "{interval}");
    assert_eq!(sample["correlations"].as_array().unwrap().len(), 3);
    let regions = record["region_distributions"].as_array().unwrap();
    let area: f64 = regions.iter().map(|part| part["area_mm2"].as_f64().unwrap()).sum();
    assert!((area / record["mesh"]["surface_area_mm2"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{area}");
}

/// Images that lie elsewhere, or are of another kind, are failures with words of their own, not numbers.
#[test]
fn images_that_tell_nothing_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    images(folder.path());
    let away = |name: &str, far: f64, value: &dyn Fn(usize) -> f32| {
        let here = grid([1.3; 3], 40.0);
        let affine = Affine { origin: here.affine().origin.map(|v| v + far), ..*here.affine() };
        let lattice = Grid::new(here.dimensions(), affine).unwrap();
        let values: Vec<f32> = (0..lattice.voxel_count()).map(value).collect();
        write_voxel_map(folder.path().join(name), &lattice, &values, name).unwrap();
    };
    away("far.nii.gz", 1000.0, &|_| 1.0);
    away("corners.nii.gz", 0.0, &|n| if n == 0 || n == 26_999 { 1.0 } else { 0.0 });
    away("grey.nii.gz", 0.0, &|n| (n.wrapping_mul(2_654_435_761) >> 7 & 511) as f32);
    away("half.nii.gz", 0.0, &|_| 0.5);
    away("same.nii.gz", 0.0, &|_| 5.0);
    away("gaps.nii.gz", 0.0, &|n| if n % 30 < 15 { f32::NAN } else { n as f32 });
    away("infinite.nii.gz", 0.0, &|n| if n == 7 { f32::INFINITY } else { 1.0 });
    let run = |args: &[&str], code: i32, words: &[&str]| {
        let done = run_in(folder.path(), args);
        let said = format!("{}{}", text(&done.stdout), text(&done.stderr));
        assert_eq!(done.status.code(), Some(code), "{args:?}: {said}");
        for words in words {
            assert!(said.contains(words), "{args:?}: {words}: {said}");
        }
        assert!(!said.contains("--threshold") && !said.contains("--embedding"), "{args:?}: {said}");
        said
    };
    let measured = |file: &str, code: i32, words: &[&str]| {
        run(&["measure", "ball.nii.gz", "--label", "3+5", "--regions", file], code, words)
    };
    measured("far.nii.gz", 1, &["regions far.nii.gz: it knows nothing of the object", "x 9", "x -1"]);
    measured("grey.nii.gz", 1, &["regions grey.nii.gz: its values are no labels"]);
    measured("half.nii.gz", 1, &["regions half.nii.gz: its values are no labels"]);
    let missing = measured("none.nii.gz", 1, &["regions none.nii.gz: "]);
    // Once in the table and once on stderr.
    assert!(missing.lines().all(|line| line.matches("none.nii.gz").count() < 2), "{missing}");
    measured("corners.nii.gz", 0, &["image-beside"]);
    // Layers of two segments, apart from each other and not.
    let segments = |name: &str, from: usize| {
        let layers = (0..8000).flat_map(|n| [u8::from(n % 20 < 10), u8::from(n % 20 >= from)]);
        let segment =
            |n: usize| format!("Segment{n}_Name:=s{n}\nSegment{n}_LabelValue:=1\nSegment{n}_Layer:={n}\n");
        let header = format!(
            "NRRD0004\ntype: uchar\ndimension: 4\nspace: right-anterior-superior\nsizes: 2 20 20 20\nkinds: list domain domain domain\n\
             space directions: none (2,0,0) (0,2,0) (0,0,2)\nspace origin: (-19,-19,-19)\nencoding: raw\n{}{}\n",
            segment(0),
            segment(1)
        );
        std::fs::write(folder.path().join(name), [header.into_bytes(), layers.collect()].concat()).unwrap();
    };
    segments("joint.seg.nrrd", 8);
    segments("apart.seg.nrrd", 10);
    measured("joint.seg.nrrd", 1, &["regions joint.seg.nrrd: its segments overlap"]);
    measured("apart.seg.nrrd", 0, &["s0", "s1"]);
    // The sample, and what the flags say.
    let mapped = |file: &str, code: i32, words: &[&str]| {
        let output = format!("{file}.json");
        run(&["map", "ball.nii.gz", "--label", "3+5", "--sample", file, "-o", &output], code, words);
        let read = std::fs::read(folder.path().join(output)).unwrap();
        let record = serde_json::from_slice::<Value>(&read).unwrap()["results"][0].clone();
        (record["samples"][0].clone(), record["flags"].to_string())
    };
    let (sample, _) = mapped("far.nii.gz", 1, &["sample far.nii.gz: it knows nothing of the object"]);
    assert!(sample["mean"].is_null() && sample["share_outside"] == 1.0, "{sample}");
    let (sample, flags) = mapped("same.nii.gz", 0, &["image-beside"]);
    assert!(flags.contains("sample same: it is the same everywhere"), "{flags}");
    let correlation = &sample["correlations"][0];
    assert!(correlation["spearman"].is_null() && correlation["pearson"].is_null(), "{sample}");
    assert!((sample["mean"].as_f64().unwrap() - 5.0).abs() < 1e-9, "{sample}");
    let (sample, flags) = mapped("gaps.nii.gz", 0, &["image-beside"]);
    assert!(flags.contains("sample gaps: ") && flags.contains("% of the area has no value"), "{flags}");
    assert!((0.3..0.7).contains(&sample["share_outside"].as_f64().unwrap()), "{sample}");
    run(&["map", "ball.nii.gz", "--sample", "infinite.nii.gz", "-o", "m.ply"], 1, &["write NaN"]);
}
