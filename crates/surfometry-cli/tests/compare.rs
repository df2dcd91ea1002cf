//! `compare` on tables that a user has.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).args(args).output().expect("the program runs")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// Objects of 10, 20, .. by a method that is 2 % and 0.5 too large, give or take 0.1, in folders of their
/// own, in another order, with one object that the other has not and one failure each.
fn tables(folder: &Path) -> [String; 2] {
    let mut method = vec!["input,label,volume_mm3,euler_characteristic,error".to_owned()];
    let mut standard = vec!["label,input,volume_mm3,euler_characteristic,extra".to_owned()];
    for n in 1..=6 {
        let value = 10.0 * f64::from(n);
        let noise = if n % 2 == 0 { 0.1 } else { -0.1 };
        let chi = if n == 6 { 0.1 } else { 2.04 };
        method.push(format!("a/{n}.nii,1,{},{chi},", 1.02 * value + 0.5 + noise));
    }
    for n in (1..=7).rev() {
        standard.push(format!("1,b/{n}.nii,{},2,x", 10.0 * f64::from(n)));
    }
    method.extend(["a/8.nii,,,,not a NIfTI file".to_owned(), "a/9.nii,1,5,2,".to_owned()]);
    let write = |name: &str, lines: Vec<String>| {
        let path = folder.join(name);
        std::fs::write(&path, lines.join("\n")).unwrap();
        path.to_str().unwrap().to_owned()
    };
    [write("method.csv", method), write("standard.csv", standard)]
}

#[test]
fn two_tables_of_the_same_objects() {
    let folder = tempfile::tempdir().unwrap();
    let [method, standard] = tables(folder.path());
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (page, chart, numbers) = (file("page.html"), file("chart.svg"), file("all.json"));
    let output = run(&["compare", &method, &standard, "-o", &page, "-o", &chart, "-o", &numbers]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("6 objects are in both tables, 2 in one alone"));
    let document: Value = serde_json::from_slice(&std::fs::read(&numbers).unwrap()).unwrap();
    assert_eq!(document["schema"], "surfometry.compare/1");
    assert_eq!(document["only_method"][0]["input"], "a/9.nii");
    assert_eq!(document["only_standard"][0]["input"], "b/7.nii");
    let agreement = &document["measures"][0]["agreement"];
    // Differences are 0.02 v + 0.5 -+ 0.1: 1.2 on the mean over 10 .. 60. Method minus standard.
    let bias = agreement["bland_altman"]["bias"]["value"].as_f64().unwrap();
    assert!((bias - 1.2).abs() < 1e-9, "{bias}");
    let slope = agreement["regression"]["slope"]["value"].as_f64().unwrap();
    assert!((slope - 1.02).abs() < 0.003, "{slope}");
    let euler = &document["euler"][0];
    assert_eq!(euler["even"]["classes"], serde_json::json!([0, 2]));
    assert_eq!(euler["even"]["counts"], serde_json::json!([[0, 0], [1, 5]]));
    assert!(text(&output.stdout).contains("rounded to even numbers: the same in 83.3 % of 6"));
    let page = std::fs::read_to_string(&page).unwrap();
    for wanted in ["volume_mm3", "limits of agreement", "<svg", "7.nii", "SHA-256", "as in the paper"] {
        assert!(page.contains(wanted), "{wanted}");
    }
    // Nothing is fetched, and no name is markup.
    assert!(!page.contains("<script") && !page.contains("src="));
    assert!(std::fs::read_to_string(&chart).unwrap().contains("difference: method minus standard"));
}

fn bias_of(args: &[&str], folder: &Path) -> Result<f64, String> {
    let all = folder.join("bias.json");
    let output = run(&[&["compare"], args, &["-o", all.to_str().unwrap()]].concat());
    if !output.status.success() {
        return Err(text(&output.stderr).to_owned());
    }
    let document: Value = serde_json::from_slice(&std::fs::read(&all).unwrap()).unwrap();
    Ok(document["measures"][0]["agreement"]["bland_altman"]["bias"]["value"].as_f64().unwrap())
}

/// The same standard as other programs write it: whichever form it has, the bias is the 1.2 that it was made with.
#[test]
fn tables_of_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    let [method, _] = tables(folder.path());
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let write = |name: &str, lines: &[String]| {
        std::fs::create_dir_all(folder.path().join(name).parent().unwrap()).unwrap();
        std::fs::write(folder.path().join(name), lines.join("\r\n")).unwrap();
        path(name)
    };
    let lines = |head: &str, line: &dyn Fn(i32) -> String| -> Vec<String> {
        [head.to_owned()].into_iter().chain((1..=6).map(line)).collect()
    };
    let forms = [
        write("comma.csv", &lines("input;label;volume_mm3", &|n| format!("b/{n}.nii;1,0;{n}0,0"))),
        write("missing.csv", &{
            let mut lines = lines("input,LABEL,volume_mm3,error", &|n| format!("c/{n}.nii.gz,1.0,{n}0.0,NA"));
            lines.push("c/9.nii.gz,1.0,NA,None".to_owned());
            lines
        }),
        write("tabs.tsv", &lines("volume_mm3\tinput", &|n| format!("{n}0\t{n}"))),
        write(
            "lines.jsonl",
            &lines("", &|n| format!("{{\"input\": \"{n}\", \"label\": 1, \"volume_mm3\": {n}0}}")),
        ),
    ];
    for n in 1..=6 {
        write(&format!("each/{n}.csv"), &["volume_mm3;name".to_owned(), format!("{n}0,0;x")]);
    }
    for form in forms.iter().chain([&path("each")]) {
        let bias = bias_of(&[&method, form], folder.path()).unwrap();
        assert!((bias - 1.2).abs() < 1e-9, "{form}: {bias}");
    }
    let named = write("named.csv", &lines("Image,volume_mm3", &|n| format!("{n},{n}0")));
    assert!(
        bias_of(&[&method, &named], folder.path())
            .unwrap_err()
            .contains("name the one that does with --object")
    );
    let bias = bias_of(&[&method, &named, "--object", "input:Image"], folder.path()).unwrap();
    assert!((bias - 1.2).abs() < 1e-9, "{bias}");
    // Without labels it cannot be told which of two objects of a file is meant; and what is no table says so.
    let two =
        write("two.csv", &["input,label,volume_mm3".to_owned(), "1,1,5".to_owned(), "1,2,5".to_owned()]);
    let wrong = bias_of(&[&two, &forms[2]], folder.path()).unwrap_err();
    assert!(wrong.contains("two.csv: 1 is there more than once"), "{wrong}");
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let document = write("document.json", &["{}".to_owned()]);
    for (table, wanted) in [(path("empty"), "a folder without tables"), (document, "it has no `results`")] {
        let wrong = bias_of(&[&method, &table], folder.path()).unwrap_err();
        assert!(wrong.contains(wanted), "{wrong}");
    }
}

/// Methods as rows, as `reference` has them, and values of a sweep: each is compared, or the one that is named.
/// Method a is 1 above the standard, b is 2 above it and says nothing of one object.
#[test]
fn methods_as_rows() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, lines: &[String]| {
        let path = folder.path().join(name);
        std::fs::write(&path, lines.join("\n")).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let rows = |head: &str, row: &dyn Fn(i32) -> String| -> Vec<String> {
        [head.to_owned()].into_iter().chain((1..=4).map(row)).collect()
    };
    let standard =
        write("standard.csv", &rows("input,label,surface_area_mm2", &|n| format!("{n}.nii,1,{n}0")));
    let methods = rows("input,label,method,surface_area_mm2,flags", &|n| {
        let b = if n == 4 { String::new() } else { format!("{n}2") };
        let flags = if n == 1 { "touches-border;thin-for-sigma" } else { "" };
        format!("{n}.nii,1,a,{n}1,\n{n}.nii,1,b,{b},{flags}")
    });
    let methods = write("methods.csv", &methods);
    let all = folder.path().join("all.json");
    let output = run(&["compare", &methods, &standard, "-o", all.to_str().unwrap()]);
    assert!(
        text(&output.stdout).contains("methods: 1 of 4 carry flags (thin-for-sigma 1, touches-border 1)")
    );
    let document: Value = serde_json::from_slice(&std::fs::read(&all).unwrap()).unwrap();
    assert_eq!(document["method_rows"]["flagged"], 1);
    assert!(document["standard_rows"]["flagged"].is_null());
    let found = document["measures"].as_array().unwrap();
    let told: Vec<(&str, f64, u64)> = found
        .iter()
        .map(|measure| {
            let bias = &measure["agreement"]["bland_altman"]["bias"]["value"];
            let column = measure["column"].as_str().unwrap();
            (column, bias.as_f64().unwrap(), measure["left_out"].as_u64().unwrap())
        })
        .collect();
    assert_eq!(told, [("surface_area_mm2@a", 1.0, 0), ("surface_area_mm2@b", 2.0, 1)]);
    let of_one_table = "surface_area_mm2@b:surface_area_mm2@a";
    assert_eq!(bias_of(&[&methods, &methods, "--column", of_one_table], folder.path()), Ok(1.0));
    // A sweep's rows: sigma 2 and 2.0 are one value.
    let sweep = rows("input,label,parameters_sigma_mm,surface_area_mm2,truth_surface_area_mm2", &|n| {
        format!("{n}.nii,1,2.0,{n}3,{n}0\n{n}.nii,1,2.5,{n}4,{n}0")
    });
    let sweep = write("sweep.csv", &sweep);
    for (column, bias) in [("surface_area_mm2@2", 3.0), ("surface_area_mm2@2.5", 4.0)] {
        let against_truth = format!("{column}:truth_surface_area_mm2");
        assert_eq!(bias_of(&[&sweep, &sweep, "--column", &against_truth], folder.path()), Ok(bias));
    }
    let unlike = bias_of(&[&sweep, &methods], folder.path()).unwrap_err();
    assert!(unlike.contains("name one of each"), "{unlike}");
}

/// What `validate` writes: the phantoms' truth, and the errors of all cases, of the original object by default.
#[test]
fn tables_of_validate() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let zoo =
        ["validate", "--shape", "ball", "--resolutions", "8", "--ratios", "1", "--poses", "2", "--no-local"];
    let (place, cases, ours) = (file("zoo"), file("cases.json"), file("ours.csv"));
    assert!(run(&[&zoo[..], &["--write", &place]].concat()).status.success());
    assert!(run(&[&zoo[..], &["--format", "json", "-o", &cases]].concat()).status.success());
    assert!(run(&["measure", &format!("{place}/*.nii.gz"), "-o", &ours]).status.success());
    let truth = format!("{place}/truth.csv");
    assert!(text(&run(&["compare", &ours, &truth]).stdout).contains("ours against truth: 4 objects"));
    let mm3 = bias_of(&[&ours, &truth, "--column", "volume_mm3"], folder.path()).unwrap();
    assert!(mm3.abs() < 30.0, "{mm3}");
    let errors = run(&["compare", &cases, &cases, "--names", "a,b"]);
    for column in ["original_volume", "original_surface_area", "original_total_mean_curvature"] {
        assert!(text(&errors.stdout).contains(&format!("\n{column}\n")), "{}", text(&errors.stdout));
    }
    // The blur of two voxels takes 10 to 20 % of the area of balls of 8 voxels, and compensation gives it back.
    let blur = "blurred_surface_area:original_surface_area";
    let percent = bias_of(&[&cases, &cases, "--column", blur], folder.path()).unwrap();
    assert!((-25.0..-8.0).contains(&percent), "{percent}");
}

/// What was measured against what is exact: two columns of one table.
#[test]
fn two_columns_of_one_table() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("balls.csv");
    let table = table.to_str().unwrap();
    let balls = ["10", "12", "14", "17"].map(|r| format!("phantom:ball?radius={r}&shift=0.3,0.2,0.1"));
    let mut args = vec!["measure"];
    args.extend(balls.iter().map(String::as_str));
    args.extend(["--format", "csv", "-o", table]);
    assert!(run(&args).status.success());
    let columns = "surface_area_mm2:truth_surface_area_mm2";
    let chi = "euler_characteristic:truth_euler_characteristic";
    let output =
        run(&["compare", table, table, "--column", columns, "--column", chi, "--names", "ours,exact"]);
    let shown = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(shown.contains("ours against exact: 4 objects") && shown.contains(&columns.replace(':', " : ")));
    assert!(shown.contains("the same in 100.0 % of 4"));
}

#[test]
fn a_cause_is_told_once() {
    let missing = run(&["compare", "nowhere.csv", "nowhere.csv"]);
    assert_eq!(text(&missing.stderr).matches("No such file").count(), 1, "{}", text(&missing.stderr));
}

#[test]
fn tables_that_cannot_be_compared() {
    let folder = tempfile::tempdir().unwrap();
    let [method, standard] = tables(folder.path());
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let unnamed = file("unnamed.csv", "name,volume_mm3\na,1\n");
    let twice = file("twice.csv", "input,volume_mm3\na,1\na,2\n");
    let words = file("words.csv", "input,label,volume_mm3\na/1.nii,1,big\n");
    let others = file("others.csv", "input,label,volume_mm3\nz.nii,1,2\n");
    let ragged = file("ragged.csv", "input,label\na,1,2,3\n");
    let bare = file("bare.csv", "input,label,mass\na/1.nii,1,2\n");
    let page = folder.path().join("page.html");
    let page = page.to_str().unwrap();
    let image = file("image.nii", "\0\0");
    let cases: [(&[&str], &str); 11] = [
        (&[&image, &standard], "image.nii: not read as CSV: it is no text"),
        (&[&unnamed, &standard], "unnamed.csv: there is no column `input`"),
        (&[&twice, &twice], "twice.csv: a is there more than once"),
        (&[&words, &standard, "--column", "volume_mm3"], "words.csv: a/1.nii label 1 has `big` in column"),
        (&[&method, &others], "no object is in both"),
        (&[&ragged, &standard], "ragged.csv: not read as CSV"),
        (&[&bare, &bare], "name one"),
        (&[&method, &standard, "--column", "mass"], "no column `mass`; columns of numbers are"),
        (
            &[&method, "nowhere.csv"],
            "nowhere.csv: cannot be read: No such file or directory (os error 2); name a table",
        ),
        (&[&method, &standard, "-o", "page.pdf"], "must end in .html, .png, .svg or .json"),
        (&[&method, &standard, "-o", &method], "would replace the input"),
    ];
    for (args, wanted) in cases {
        let output = run(&[&["compare"], args, &["-o", page]].concat());
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(text(&output.stderr).contains(wanted), "{args:?}: {}", text(&output.stderr));
        assert!(!Path::new(page).exists(), "{args:?}");
    }
    // Too few objects: said in the place of the numbers, and all else is there.
    let single = run(&["compare", &bare, &bare, "--column", "mass"]);
    assert!(single.status.success() && text(&single.stdout).contains("agreement needs three"));
}

/// Two methods on the same inputs, from files to the page's numbers: the area of the triangulated mask is 8 %
/// above ours.
#[test]
fn classical_methods_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let balls = ["12", "14", "17", "20"].map(|r| format!("phantom:ball?radius={r}&shift=0.3,0.2,0.1"));
    let balls: Vec<&str> = balls.iter().map(String::as_str).collect();
    let (ours, classical, all) = (file("ours.csv"), file("classical.csv"), file("all.json"));
    assert!(run(&[&["measure"], &balls[..], &["-o", &ours]].concat()).status.success());
    let method = ["--method", "triangulation", "-o", &classical];
    assert!(run(&[&["reference"], &balls[..], &method].concat()).status.success());
    let column = "surface_area_mm2:surface_area_mm2";
    assert!(run(&["compare", &classical, &ours, "--column", column, "-o", &all]).status.success());
    let document: Value = serde_json::from_slice(&std::fs::read(&all).unwrap()).unwrap();
    let bias = document["measures"][0]["agreement"]["bland_altman"]["bias_percent"].as_f64().unwrap();
    assert!((7.5..9.0).contains(&bias), "{bias}");
    let table = run(&["reference", balls[0]]);
    for name in ["voxels", "odgaard-gundersen-26", "crofton-13", "SMI"] {
        assert!(text(&table.stdout).contains(name), "{name}");
    }
    let partly = run(&["reference", balls[0], "nowhere.nii", "--method", "voxels"]);
    assert_eq!(partly.status.code(), Some(1));
    assert!(text(&partly.stdout).contains("not measured") && text(&partly.stdout).contains("nowhere.nii"));
    assert_eq!(run(&["reference", balls[0], "--method", "guess"]).status.code(), Some(2));
}

/// A cohort of one, its table of exact integrals, and what is measured of it: V within 0.2, A within 0.5 % of
/// the exact bone, the slices' jitter included. A second run finds the image there and writes the same table.
#[test]
fn a_cohort_and_its_truth() {
    let folder = tempfile::tempdir().unwrap();
    let cohort = folder.path().join("cohort");
    let file = |name: &str| cohort.join(name).to_str().unwrap().to_owned();
    let make = || run(&["cohort", "--femurs", "1", "--vertebrae", "0", "-o", cohort.to_str().unwrap(), "-q"]);
    assert!(make().status.success());
    let table = std::fs::read_to_string(file("truth.csv")).unwrap();
    assert!(make().status.success());
    assert_eq!(std::fs::read_to_string(file("truth.csv")).unwrap(), table);
    // Images of other runs keep their rows, those that are gone do not; what is another table is not written over.
    std::fs::copy(file("femur_01.nii.gz"), file("femur_09.nii.gz")).unwrap();
    let other = |name: &str| table.lines().nth(1).unwrap().replace("femur_01", name) + "\n";
    std::fs::write(file("truth.csv"), table.clone() + &other("femur_09") + &other("femur_08")).unwrap();
    assert!(make().status.success());
    assert_eq!(std::fs::read_to_string(file("truth.csv")).unwrap(), table.clone() + &other("femur_09"));
    std::fs::write(file("truth.csv"), "input,age\nS1,63\n").unwrap();
    let refused = make();
    assert!(!refused.status.success() && text(&refused.stderr).contains("choose another folder"));
    assert_eq!(std::fs::read_to_string(file("truth.csv")).unwrap(), "input,age\nS1,63\n");
    let measured = run(&["measure", &file("femur_01.nii.gz"), "--format", "json"]);
    let document: Value = serde_json::from_slice(&measured.stdout).unwrap();
    let record = &document["results"][0];
    let row: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(row[..2], ["femur_01.nii.gz", "1"]);
    for (n, (name, percent)) in [("volume_mm3", 0.2), ("surface_area_mm2", 0.5)].into_iter().enumerate() {
        let exact: f64 = row[2 + n].parse().unwrap();
        let off = 100.0 * (record[name].as_f64().unwrap() / exact - 1.0);
        println!("{name} {off:+.3} %");
        assert!(off.abs() < percent, "{name} {off}");
    }
    assert_eq!((row[6], record["topology"]["euler_characteristic_mesh"].as_i64()), ("2", Some(2)));
}

/// A ball that the image cuts in half: the flag stands under the table and in every row, the cut face is told apart, and
/// of the ball's chi of 2 the half has its share, 1.
#[test]
fn samples_are_flagged() {
    use surfometry::volume::{Grid, LabelImage};
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let inside = |x: usize, y: usize, z: usize| {
        let from = [x as f64 - 15.3, y as f64 - 14.8, z as f64 + 0.5];
        from.iter().map(|d| d * d).sum::<f64>() < 144.0
    };
    let at = (0..15usize * 31 * 31).map(|n| (n % 31, n / 31 % 31, n / 961));
    let voxels: Vec<u8> = at.map(|(x, y, z)| u8::from(inside(x, y, z))).collect();
    let grid = Grid::axis_aligned([31, 31, 15], [1.0; 3]).unwrap();
    let (image, table) = (file("half.nii.gz"), file("half.csv"));
    surfometry::io::write_labels(&image, &LabelImage::from_voxels(grid, &voxels).unwrap()).unwrap();
    let shown = run(&["reference", &image]);
    assert_eq!(
        text(&shown.stdout).matches("! touches-border: the edge of the image cuts the object").count(),
        1
    );
    assert!(run(&["reference", &image, "-o", &table]).status.success());
    let mut rows = csv_rows(&table);
    assert!(rows.iter().all(|row| row["flags"] == "touches-border"));
    let mut row = |method: &str| rows.remove(rows.iter().position(|row| row["method"] == method).unwrap());
    let (euler, lindblad) = (row("odgaard-gundersen-26"), row("lindblad"));
    let number =
        |row: &std::collections::HashMap<String, String>, name: &str| row[name].parse::<f64>().unwrap();
    assert_eq!(number(&euler, "euler_characteristic"), 2.0);
    assert_eq!(number(&euler, "euler_characteristic_edge_corrected"), 1.0);
    let total = 31.0 * 31.0 * 15.0;
    assert!((number(&euler, "connectivity_density_edge_corrected_per_mm3") - 0.5 / total).abs() < 1e-12);
    let half_sphere = 2.0 * std::f64::consts::PI * 144.0;
    let open = number(&lindblad, "specific_surface_without_cuts_per_mm") * number(&lindblad, "volume_mm3");
    assert!((open / half_sphere - 1.0).abs() < 0.01, "{open} {half_sphere}");
    assert!(number(&lindblad, "surface_area_mm2") > 1.35 * half_sphere);
}

fn csv_rows(path: &str) -> Vec<std::collections::HashMap<String, String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<String> = lines.next().unwrap().collect();
    lines.map(|cells| names.iter().cloned().zip(cells).collect()).collect()
}
