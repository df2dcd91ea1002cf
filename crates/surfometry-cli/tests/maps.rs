//! `map`, `report` and `measure --png` as a user meets them: exit status, names of files, what is refused.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

fn run_in(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).current_dir(folder).args(args).output().expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn files_in(folder: &Path) -> BTreeSet<String> {
    std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

fn names(list: &[&str]) -> BTreeSet<String> {
    list.iter().map(ToString::to_string).collect()
}

const BALL: &str = "phantom:ball?radius=8&shift=0.3,0.2,0.1";

/// Two boxes with labels 1 and 4, and a speck with label 7 that a blur of 2 mm removes.
fn three_labels(folder: &Path) {
    let inside = |x: usize, y: usize, z: usize, from: usize, to: usize| {
        (from..to).contains(&x) && (8..22).contains(&y) && (8..22).contains(&z)
    };
    let voxel = |i: usize| -> u8 {
        let (x, y, z) = (i % 50, i / 50 % 30, i / 1500);
        match () {
            () if inside(x, y, z, 5, 19) => 1,
            () if inside(x, y, z, 30, 44) => 4,
            () if (x, y, z) == (24, 15, 15) => 7,
            () => 0,
        }
    };
    let voxels: Vec<u8> = (0..50 * 30 * 30).map(voxel).collect();
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 50 30 30\nspacings: 1 1 1\nencoding: raw\n\n";
    std::fs::write(folder.join("three.nrrd"), [header.as_bytes(), &voxels].concat()).unwrap();
}

#[test]
fn every_format_is_written_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let outputs =
        ["a.ply", "a.vtp", "a.stl", "a.obj", "a.glb", "a.surf.gii", "a.csv", "a.nii.gz", "a.png", "a.json"];
    let mut args = vec!["map", BALL];
    for output in &outputs {
        args.extend(["-o", output]);
    }
    let done = run_in(folder.path(), &args);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let printed: BTreeSet<String> = text(&done.stdout).lines().map(str::to_owned).collect();
    assert_eq!(printed, files_in(folder.path()));
    assert_eq!(printed, names(&[&outputs[..], &["a.shape.gii", "a.vector.gii"]].concat()));
    let csv = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    // The contract: world coordinates first, then the arrays by their names.
    assert!(csv.starts_with("x_mm,y_mm,z_mm,"));
    for name in ["mean_curvature_per_mm", "gaussian_curvature_per_mm2", "displacement_mm", "direction_1_x"] {
        assert!(csv.lines().next().unwrap().split(',').any(|column| column == name), "{name}");
    }
}

#[test]
fn the_json_holds_results_and_distributions() {
    let folder = tempfile::tempdir().unwrap();
    let done = run_in(folder.path(), &["map", BALL, "-o", "a.json", "-o", "a.ply"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let document: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    assert_eq!(document["schema"], "surfometry.map/1");
    let result = &document["results"][0];
    assert_eq!(result["files"], serde_json::json!(["a.ply"]));
    assert_eq!(result["input"], BALL);
    let energy = result["curvature"]["bending_energy"].as_f64().unwrap();
    assert!((energy / (8.0 * std::f64::consts::PI) - 1.0).abs() < 0.05, "{energy}");
    let distributions = result["distributions"].as_array().unwrap();
    let of =
        |name: &str| distributions.iter().find(|d| d["name"] == name).unwrap_or_else(|| panic!("{name}"));
    let mean = &of("mean_curvature_per_mm");
    // Mean of H over the area is the band's <H>; the blurred ball's is above 1/8.
    let average = result["blurred"]["average_mean_curvature_per_mm"].as_f64().unwrap();
    assert!((mean["by_area"]["mean"].as_f64().unwrap() / average - 1.0).abs() < 0.02 && average > 1.0 / 8.0);
    assert_eq!(
        mean["by_area"]["quantiles"].as_array().unwrap().len(),
        result["quantiles"].as_array().unwrap().len()
    );
    let shares: f64 =
        mean["histogram"]["by_vertex"].as_array().unwrap().iter().filter_map(Value::as_f64).sum();
    assert!((shares - 1.0).abs() < 1e-9);
}

/// Several objects: a file each. One that the blur removes is listed, and the others are written all the
/// same.
#[test]
fn objects_have_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    three_labels(folder.path());
    let done =
        run_in(folder.path(), &["map", "three.nrrd", "--sigma", "2", "-o", "out.ply", "-o", "all.json"]);
    assert_eq!(done.status.code(), Some(1));
    let expected = ["three.nrrd", "out_label-1.ply", "out_label-4.ply", "all.json"];
    assert_eq!(files_in(folder.path()), names(&expected));
    let said = text(&done.stderr);
    assert!(
        said.contains("three.nrrd: label 7: nothing is left") && said.contains("smaller sigma"),
        "{said}"
    );
    let document: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("all.json")).unwrap()).unwrap();
    assert_eq!(document["results"].as_array().unwrap().len(), 3);
    assert!(document["failures"][0]["error"].as_str().unwrap().starts_with("label 7"));
    assert!(document["results"][2]["curvature"].is_null());

    let one = run_in(folder.path(), &["map", "three.nrrd", "--label", "4", "--sigma", "2", "-o", "one.vtp"]);
    assert_eq!(text(&one.stdout), "one.vtp\n");
    let two =
        run_in(folder.path(), &["map", "three.nrrd", BALL, "--label", "1", "-o", "two.stl", "--sigma", "2"]);
    assert_eq!(text(&two.stdout), "two_three.stl\ntwo_ball.stl\n");
}

/// Inputs of one name in two folders do not write over each other, nor a map over its input.
#[test]
fn nothing_is_written_twice_or_over_an_input() {
    let folder = tempfile::tempdir().unwrap();
    for sub in ["a", "b"] {
        std::fs::create_dir(folder.path().join(sub)).unwrap();
        let scan = format!("{sub}/scan.nii");
        let made = run_in(folder.path(), &["phantom", "ball?radius=6", "-o", &scan]);
        assert_eq!(made.status.code(), Some(0));
    }
    let both = run_in(folder.path(), &["map", "a/scan.nii", "b/scan.nii", "-o", "m.stl"]);
    assert_eq!(text(&both.stdout), "m_a-scan.stl\nm_b-scan.stl\n", "{}", text(&both.stderr));

    // With two inputs, `-o x.nii` means x_label-1.nii for an input of the name label-1, which is the other
    // one.
    three_labels(folder.path());
    std::fs::rename(folder.path().join("three.nrrd"), folder.path().join("label-1.nrrd")).unwrap();
    std::fs::copy(folder.path().join("a/scan.nii"), folder.path().join("x_label-1.nii")).unwrap();
    let before = std::fs::read(folder.path().join("x_label-1.nii")).unwrap();
    let refused =
        run_in(folder.path(), &["map", "x_label-1.nii", "label-1.nrrd", "--label", "1", "-o", "x.nii"]);
    assert!(text(&refused.stderr).contains("would replace an input"), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read(folder.path().join("x_label-1.nii")).unwrap(), before);
}

/// Two objects that come to one name: the second is refused, and the first stays.
#[test]
fn no_output_takes_anothers_place() {
    let folder = tempfile::tempdir().unwrap();
    three_labels(folder.path());
    std::fs::rename(folder.path().join("three.nrrd"), folder.path().join("a.nrrd")).unwrap();
    let made = run_in(folder.path(), &["phantom", "ball?radius=6", "-o", "a_label-1.nii"]);
    assert_eq!(made.status.code(), Some(0));
    let inputs = ["map", "a.nrrd", "a_label-1.nii", "--label", "all", "--sigma", "1", "-o", "o.csv"];
    let done = run_in(folder.path(), &inputs);
    assert_eq!(done.status.code(), Some(1));
    let said = text(&done.stderr);
    assert!(said.contains("another output of this run has that name already"), "{said}");
    let twice = run_in(folder.path(), &["map", BALL, "-o", "z.ply", "-o", "z.ply"]);
    assert_eq!(twice.status.code(), Some(2));
    let kinds = run_in(folder.path(), &["map", BALL, "--png", "p.png", "--picture", "slices,slices"]);
    assert_eq!(text(&kinds.stdout), "p.png\n");
    let gifti = run_in(folder.path(), &["map", BALL, "-o", "g.surf.gii", "-o", "g.gii"]);
    assert_eq!(gifti.status.code(), Some(2));
    let spelt = run_in(folder.path(), &["map", BALL, "-o", "z.ply", "-o", "./z.ply"]);
    assert_eq!(spelt.status.code(), Some(2));
    let both = run_in(folder.path(), &["measure", BALL, "-o", "b.png", "--png", "b.png"]);
    assert_eq!(both.status.code(), Some(2));
}

/// What the blur removes has no mesh, but its numbers, and the files that can be, are there whatever the
/// order of the options.
#[test]
fn one_file_that_cannot_be_keeps_no_other_from_being() {
    let folder = tempfile::tempdir().unwrap();
    let vanishing = ["map", "phantom:ball?radius=4.3", "--sigma", "3"];
    for outputs in [["v.ply", "v.nii"], ["w.nii", "w.ply"]] {
        let args = [&vanishing[..], &["-o", outputs[0], "-o", outputs[1], "--voxels", "phi"]].concat();
        let done = run_in(folder.path(), &args);
        assert_eq!(done.status.code(), Some(1), "{}", text(&done.stderr));
        assert!(text(&done.stdout).ends_with(".nii\n"), "{}", text(&done.stdout));
        assert_eq!(text(&done.stderr).matches("nothing is left").count(), 2, "{}", text(&done.stderr));
    }
    // Of an object that was measured, the missing picture is no failed input.
    let done =
        run_in(folder.path(), &["measure", "phantom:ball?radius=3", "--sigma", "10", "--png", "n.png"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(!text(&done.stdout).contains("not measured") && !folder.path().join("n.png").exists());
}

#[test]
fn a_map_warns_as_a_measurement_does() {
    let folder = tempfile::tempdir().unwrap();
    let thick = "phantom:ball?radius=20&spacing=0.5,0.5,5";
    let done = run_in(folder.path(), &["map", thick, "-o", "t.csv"]);
    assert_eq!(done.status.code(), Some(0));
    let said = text(&done.stderr);
    assert!(said.contains("! thick-slices") && said.contains("! sigma-below-spacing"), "{said}");
    assert!(run_in(folder.path(), &["map", thick, "-o", "u.csv", "--quiet"]).stderr.is_empty());
}

#[test]
fn the_ending_of_a_result_chooses_its_form() {
    let folder = tempfile::tempdir().unwrap();
    for (name, start) in [("r.json", "{"), ("r.csv", "input,label"), ("r.txt", "phantom:ball")] {
        assert_eq!(run_in(folder.path(), &["measure", BALL, "-o", name]).status.code(), Some(0));
        let written = std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(written.starts_with(start), "{name}: {written}");
    }
    let told = run_in(folder.path(), &["measure", BALL, "-o", "s.csv", "--format", "table"]);
    assert_eq!(told.status.code(), Some(0));
    assert!(std::fs::read_to_string(folder.path().join("s.csv")).unwrap().starts_with("phantom:ball"));
}

#[test]
fn pictures_and_voxel_maps_of_several_kinds_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["map", BALL, "--png", "p.png", "--picture", "surface,slices,histogram,volume", "--dpi", "48"];
    let voxels = ["-o", "v.nii", "--voxels", "phi,delta"];
    let done = run_in(folder.path(), &[&args[..], &voxels].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let expected = [
        "p_surface.png",
        "p_slices.png",
        "p_histogram.png",
        "p_volume.png",
        "v_phi.nii",
        "v_delta_per_mm.nii",
    ];
    assert_eq!(files_in(folder.path()), names(&expected));
}

#[test]
fn what_cannot_be_written_is_refused_before_anything_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 12] = [
        (&["map", "missing.nii"], "say what to write: -o FILE"),
        (&["map", "missing.nii", "-o", "a.xyz"], "a.xyz: the name must end in one of .ply"),
        (&["map", "missing.nii", "-o", "no/a.ply"], "the folder no does not exist"),
        (&["map", "missing.nii", "-o", "a.ply", "--view", "top"], "invalid value 'top'"),
        (&["map", "missing.nii", "-o", "a.ply", "--limit", "0"], "it must be positive"),
        (&["map", "missing.nii", "-o", "a.ply", "--quantity", "x"], "mean-curvature"),
        (&["map", "missing.nii", "-o", "a.png", "--range", "2..1"], "write LOW..HIGH"),
        (&["map", "missing.nii", "-o", "a.png", "--size", "10mm"], "between 40 and 1200 mm"),
        (&["map", "missing.nii", "-o", "a.png", "--slice", "w=1"], "write AXIS=N"),
        (&["map", "missing.nii", "-o", "a.png", "--camera", "30"], "write AZIMUTH,ELEVATION"),
        (&["report", "missing.nii"], "--output"),
        (&["measure", "missing.nii", "--png", "a.jpg"], "the picture's name must end in .png"),
    ];
    for (args, message) in cases {
        let refused = run_in(folder.path(), args);
        assert_eq!(refused.status.code(), Some(2), "{args:?}");
        assert!(text(&refused.stderr).contains(message), "{args:?}: {}", text(&refused.stderr));
        assert!(refused.stdout.is_empty() && files_in(folder.path()).is_empty(), "{args:?}");
    }
    let missing = run_in(folder.path(), &["map", "missing.nii", BALL, "-o", "a.ply"]);
    assert_eq!(missing.status.code(), Some(1));
    assert_eq!(files_in(folder.path()), names(&["a_ball.ply"]));
}

/// A quantity that an embedding does not have is an error with a cure, not a picture of zeros.
#[test]
fn a_displacement_needs_a_blur() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["map", BALL, "--embedding", "distance", "--quantity", "displacement", "-o", "a.png"];
    let done = run_in(folder.path(), &args);
    assert_eq!(done.status.code(), Some(1));
    assert!(text(&done.stderr).contains("Gaussian embedding at level 0.5"), "{}", text(&done.stderr));
    assert!(files_in(folder.path()).is_empty());
}

#[test]
fn a_measurement_may_end_in_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let done = run_in(folder.path(), &["measure", BALL, "--png", "ball.png"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("blurred"));
    let png = std::fs::read(folder.path().join("ball.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG") && png.len() > 10_000);
}

#[test]
fn a_report_lists_what_failed() {
    let folder = tempfile::tempdir().unwrap();
    let done = run_in(folder.path(), &["report", BALL, "missing.nii", "-o", "r.html", "--title", "A & B"]);
    assert_eq!(done.status.code(), Some(1));
    let page = std::fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains("A &amp; B") && page.contains("missing.nii") && page.contains("No such file"));
    assert!(page.contains("surfometry report") && page.contains("id=\"scene-1\""));
    assert!(page.contains("\"used_mm\":") && page.contains("total mean curvature (mm)"));
    assert!(done.stdout.is_empty());
    assert!(text(&done.stderr).contains("wrote r.html: 1 result, 1 failure"), "{}", text(&done.stderr));
    // The command is one that a shell takes.
    assert!(page.contains("-o r.html --title 'A & B'"), "the command");
    let nothing = run_in(folder.path(), &["report", "missing.nii", "-o", "empty.html"]);
    assert_eq!(nothing.status.code(), Some(1));
    assert!(text(&nothing.stderr).contains("nothing to show") && !folder.path().join("empty.html").exists());
}

/// Distances to a later scan: arrays in meshes, numbers in JSON, colours of them; of an object that the later scan lacks it is
/// said, and the others are compared.
#[test]
fn surfaces_are_compared_with_later_ones() {
    let folder = tempfile::tempdir().unwrap();
    let later = "phantom:ball?radius=9.5&shift=0.1,0.4,-0.2&spacing=0.9,0.9,1.1";
    let args = ["map", BALL, "--against", later, "-o", "a.csv", "-o", "a.json", "-o", "a.svg"];
    let done = run_in(folder.path(), &args);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    // What of it is noise stands where it is seen first.
    let said = text(&done.stderr);
    assert!(
        said.contains("mm on the mean") && said.contains("of the area differs by more than two"),
        "{said}"
    );
    let drawn = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert!(drawn.contains("Distance to the later surface") && drawn.contains("Two masks of one object"));
    let csv = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let columns: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    for name in ["distance_mm", "distance_mm_standard_error", "mean_curvature_change_per_mm"] {
        assert!(columns.contains(&name), "{name}");
    }
    let document: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    let against = &document["results"][0]["against"];
    assert_eq!(against["input"], later);
    let distance = |name: &str| against["distance_mm"][name].as_f64().unwrap();
    assert!((distance("mean") - 1.5).abs() < 0.04, "{against}");
    // Both balls stand at their shifts, so one has moved by 0.2 to 0.3 mm against the other along each axis.
    assert!(distance("rms") > 1.48 && distance("share_beyond_noise") > 0.99, "{against}");
    assert!((0.01..0.2).contains(&distance("noise_rms")), "{against}");
    assert!(against["hausdorff_95_mm"].as_f64().unwrap() > 1.6, "{against}");
    let named = |d: &Value| d["name"] == "mean_curvature_change_per_mm";
    assert!(document["results"][0]["distributions"].as_array().unwrap().iter().any(named));

    three_labels(folder.path());
    let args = ["map", "three.nrrd", "--against", later, "--label", "1,4", "-o", "b.json", "-o", "b.ply"];
    let done = run_in(folder.path(), &args);
    assert_eq!(done.status.code(), Some(1));
    let said = text(&done.stderr);
    assert!(said.contains("label 4") && said.contains(later) && said.contains('1'), "{said}");
    let document: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("b.json")).unwrap()).unwrap();
    assert!(document["results"][0]["against"]["distance_mm"]["mean"].is_f64());
    assert!(document["results"][1]["against"].is_null() && !document["results"][1]["files"].is_null());

    // What only the later image has is said; not where labels were chosen.
    let against = ["map", BALL, "--against", "three.nrrd", "-o", "e.csv"];
    let done = run_in(folder.path(), &against);
    assert!(
        text(&done.stderr).contains("label 4, 7 of it was compared with nothing"),
        "{}",
        text(&done.stderr)
    );
    assert!(text(&done.stderr).contains("95 % of either surface lies within"), "{}", text(&done.stderr));
    let done = run_in(folder.path(), &[&against[..], &["--label", "1"]].concat());
    assert!(!text(&done.stderr).contains("compared with nothing"), "{}", text(&done.stderr));

    // Without a later scan there is no distance; one that is not there ends the command before anything is written.
    let done = run_in(folder.path(), &["map", BALL, "--quantity", "distance", "--png", "c.png"]);
    assert_eq!(done.status.code(), Some(2));
    assert!(text(&done.stderr).contains("add --against LATER"), "{}", text(&done.stderr));
    let done = run_in(folder.path(), &["map", BALL, "--against", later, "-o", "c.nii.gz"]);
    assert_eq!(done.status.code(), Some(2));
    assert!(text(&done.stderr).contains("voxel maps have nothing of it"), "{}", text(&done.stderr));
    let before = files_in(folder.path());
    let done = run_in(folder.path(), &["map", BALL, "--against", "none.nrrd", "-o", "d.ply", "-o", "d.json"]);
    assert_eq!(done.status.code(), Some(2));
    assert!(text(&done.stderr).contains("none.nrrd"), "{}", text(&done.stderr));
    assert_eq!(files_in(folder.path()), before);
}

/// Objects in one picture and one voxel map; meshes stay one an object, and names without the option are what they were.
#[test]
fn objects_together() {
    let folder = tempfile::tempdir().unwrap();
    three_labels(folder.path());
    let outputs =
        ["-o", "s.svg", "-o", "s.pdf", "-o", "m.nii", "-o", "x.ply", "--voxels", "band,mean-curvature"];
    let args =
        ["map", "three.nrrd", "--sigma", "2", "--label", "1,4", "--together", "--title", "<b>both</b>"];
    let done = run_in(folder.path(), &[&args[..], &outputs].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let printed: BTreeSet<String> = text(&done.stdout).lines().map(str::to_owned).collect();
    let expected =
        ["s.svg", "s.pdf", "m_band.nii", "m_mean_curvature_per_mm.nii", "x_label-1.ply", "x_label-4.ply"];
    assert_eq!(printed, names(&expected));
    assert_eq!(files_in(folder.path()), names(&[&expected[..], &["three.nrrd"]].concat()));
    let svg = std::fs::read_to_string(folder.path().join("s.svg")).unwrap();
    assert!(svg.contains(">&lt;b&gt;both&lt;/b&gt;</text>") && svg.matches("<image").count() == 2);

    let several = ["map", "three.nrrd", BALL, "--sigma", "2", "--together", "-o", "all.png", "-o", "v.nii"];
    let done = run_in(folder.path(), &several);
    // Label 7 is lost to the blur, and said to be.
    assert_eq!(done.status.code(), Some(1));
    assert!(text(&done.stderr).contains("label 7"), "{}", text(&done.stderr));
    assert_eq!(text(&done.stdout), "v_three.nii\nv_ball.nii\nall.png\n");
}

/// Pictures of a surface alone show the original one; where a mesh is written or a blur chosen, what was measured.
#[test]
fn pictures_alone_show_the_original_surface() {
    let folder = tempfile::tempdir().unwrap();
    let caption = |options: &[&str]| {
        let done = run_in(folder.path(), &[&["map", BALL, "-o", "p.svg"], options].concat());
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        std::fs::read_to_string(folder.path().join("p.svg")).unwrap()
    };
    assert!(caption(&[]).contains(">Recovering embedding, sigma"));
    assert!(caption(&["--quantity", "mean-curvature-standard-error"]).contains("Standard error of mean"));
    for measured in [&["--sigma", "2"][..], &["-o", "p.csv"], &["--quantity", "displacement"]] {
        assert!(caption(measured).contains("Gaussian blur, sigma 2 mm"), "{measured:?}");
    }
    assert!(caption(&["--caption", "of <me>"]).contains(">of &lt;me&gt;</text>"));
    let refused = run_in(
        folder.path(),
        &[
            "map",
            BALL,
            "-o",
            "p.svg",
            "--curvature-sigma",
            "object",
            "--picture",
            "slices",
            "--slice",
            "z=900",
        ],
    );
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("there is no slice z = 900"), "{}", text(&refused.stderr));
}

/// A later image that shows a part, another place or an object too thin is no loss of the object.
#[test]
fn later_images_that_show_less() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, slices: std::ops::Range<usize>, away: usize, height: f64, label: u8| {
        let inside = |i: usize| {
            let place = [i % 40, i / 40 % 40, i / 1600 + slices.start].map(|v| v as f64 - 19.7);
            place.iter().zip([12.0, 12.0, height]).map(|(v, radius)| (v / radius).powi(2)).sum::<f64>() < 1.0
        };
        let voxels: Vec<u8> = (0..1600 * slices.len()).map(|i| if inside(i) { label } else { 0 }).collect();
        let header = format!(
            "NRRD0005\ntype: uint8\ndimension: 3\nspace: right-anterior-superior\nsizes: 40 40 {}\nspace directions: (1,0,0) (0,1,0) \
             (0,0,1)\nspace units: \"mm\" \"mm\" \"mm\"\nspace origin: ({away},0,{})\nencoding: raw\n\n",
            slices.len(),
            slices.start
        );
        std::fs::write(folder.path().join(name), [header.as_bytes(), &voxels].concat()).unwrap();
    };
    write("first.nrrd", 0..40, 0, 12.0, 1);
    write("half.nrrd", 0..22, 0, 12.0, 1);
    write("away.nrrd", 0..40, 900, 12.0, 1);
    write("other.nrrd", 0..40, 0, 12.0, 2);
    write("plate.nrrd", 0..40, 0, 1.8, 1);
    let compared = |first: &str, later: &str, code: i32, words: &[&str]| {
        let [json, csv] = ["json", "csv"].map(|ending| format!("{first}_{later}.{ending}"));
        let done = run_in(folder.path(), &["map", first, "--against", later, "-o", &json, "-o", &csv]);
        let said = text(&done.stderr);
        assert_eq!(done.status.code(), Some(code), "{later}: {said}");
        for words in words {
            assert!(said.contains(words), "{later}: {words}: {said}");
        }
        let read = std::fs::read(folder.path().join(json)).unwrap();
        serde_json::from_slice::<Value>(&read).unwrap()["results"][0].clone()
    };
    let found = compared("first.nrrd", "half.nrrd", 0, &["image-beside"]);
    let flags = found["flags"].to_string();
    for told in ["the later image half.nrrd: ", "% of the area has no distance", "touches-border"] {
        assert!(flags.contains(told), "{told}: {flags}");
    }
    let against = &found["against"];
    assert!((0.4..0.8).contains(&against["share_without_distance"].as_f64().unwrap()), "{against}");
    assert!(against["distance_mm"]["mean"].as_f64().unwrap().abs() < 0.02, "{against}");
    assert_eq!(against["distance_mm"]["share_beyond_noise"], 0.0);
    assert!(std::fs::read_to_string(folder.path().join("first.nrrd_half.nrrd.csv")).unwrap().contains("NaN"));
    let apart = ["the later image away.nrrd: it knows nothing of the object", "x 899.5 to", "x 7.5 to"];
    assert!(compared("first.nrrd", "away.nrrd", 1, &apart)["against"].is_null());
    compared("first.nrrd", "other.nrrd", 1, &["the later image other.nrrd: no label 1 in it; it holds 2"]);
    let thin = ["the later image plate.nrrd: ", "compensation-failed", "no distance"];
    assert!(compared("first.nrrd", "plate.nrrd", 1, &thin)["against"].is_null());
    let thin = compared("plate.nrrd", "first.nrrd", 1, &["compensation-failed", "no distance"]);
    assert!(thin["against"].is_null());
    let done = run_in(folder.path(), &["map", "first.nrrd", "--against", "none.nrrd", "-o", "c.json"]);
    assert_eq!(text(&done.stderr).matches("none.nrrd").count(), 1, "{}", text(&done.stderr));
}
