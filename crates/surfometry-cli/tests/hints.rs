//! Slips that a new user makes, and what helps: each message says what was meant, before anything is measured in vain.

use std::path::Path;
use std::process::{Command, Output};

const BALL: &str = "phantom:ball?radius=8&shift=0.3,0.2,0.1";

fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_surfometry");
    Command::new(program).current_dir(folder).args(arguments).output().expect("the program starts")
}

fn run(arguments: &[&str]) -> Output {
    run_in(Path::new("."), arguments)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What a command says on stderr that ends with some status.
fn said(arguments: &[&str], status: i32) -> String {
    let output = run(arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
    said
}

/// Words of a table without the breaks of its lines.
fn shown(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A table for people is not written under the name of a spreadsheet.
#[test]
fn endings_of_other_forms_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments);
    let commands: [&[&str]; 3] =
        [&["measure", BALL], &["reference", BALL], &["sweep", BALL, "--range", "2:3:2"]];
    for command in commands {
        for name in ["out.xlsx", "out.tsv", "out.csv.gz", "out.PARQUET"] {
            let refused = run(&[command, &["-o", name]].concat());
            let said = text(&refused.stderr);
            assert_eq!(refused.status.code(), Some(2), "{command:?} {name}: {said}");
            assert!(said.contains(".csv, .json or .jsonl") && said.contains("--format"), "{said}");
            assert!(
                !folder.path().join(name).exists() && !folder.path().join(format!("{name}.partial")).exists()
            );
        }
    }
    for name in ["table", "out.txt", "out.log", "out.MD", "/dev/stdout"] {
        let written = run(&["measure", BALL, "-o", name]);
        assert_eq!(written.status.code(), Some(0), "{name}: {}", text(&written.stderr));
    }
    assert_eq!(run(&["measure", BALL, "--format", "csv", "-o", "out.tsv"]).status.code(), Some(0));
    let table = std::fs::read_to_string(folder.path().join("out.tsv")).unwrap();
    assert!(table.starts_with("input,"), "{table}");
}

/// Where numbers have no errors, it is said why, in both kinds of tables; maps have none to miss.
#[test]
fn errors_that_are_missing_are_told_of() {
    for choice in [&["--paper"][..], &["--level", "0.4"]] {
        let one = shown(&[&["measure", BALL], choice].concat());
        assert_eq!(one.matches("! not-computed: standard errors are").count(), 1, "{one}");
        let two = shown(&[&["measure", BALL, "phantom:ball?radius=9", "-q"], choice].concat());
        assert_eq!(two.matches("not-computed, 2 objects: standard errors are").count(), 1, "{two}");
    }
    assert!(!shown(&["measure", BALL]).contains("not-computed"));
    let folder = tempfile::tempdir().unwrap();
    let mapped = run_in(folder.path(), &["map", BALL, "--paper", "-o", "ball.ply"]);
    assert_eq!(mapped.status.code(), Some(0));
    assert!(!text(&mapped.stderr).contains("not-computed"), "{}", text(&mapped.stderr));
}

/// Of an object without a surface it is said why: too few voxels, or a blur that is too wide for them.
#[test]
fn objects_without_a_surface() {
    let tiny = shown(&["measure", "phantom:ball?radius=2"]);
    assert!(tiny.contains("fewer than 30 voxels (this one has 27)") && tiny.contains("scan finer"), "{tiny}");
    let fine = shown(&["measure", "phantom:ball?radius=0.4&spacing=0.0195,0.0195,0.0195", "--paper"]);
    assert!(fine.contains("(sigma is 2.0000 mm, 103 voxels wide)"), "{fine}");
    let chosen = shown(&["measure", "phantom:ball?radius=3", "--sigma", "3"]);
    assert!(
        chosen.contains("level, so the integrals are null; the recovering embedding keeps it"),
        "{chosen}"
    );
    assert!(!chosen.contains("smaller sigma"), "{chosen}");
}

/// `measure` is meant where its options come first; help and slips in commands are not taken for it.
#[test]
fn options_in_front_of_the_input() {
    let plain = shown(&["measure", BALL, "--label", "1"]);
    assert_eq!(shown(&["--label", "1", BALL]), plain);
    assert_eq!(shown(&["-q", "--label=1", "--threads", "1", BALL]), plain);
    let folder = tempfile::tempdir().unwrap();
    let written = run_in(folder.path(), &["-o", "out.csv", BALL]);
    assert_eq!(written.status.code(), Some(0), "{}", text(&written.stderr));
    assert!(folder.path().join("out.csv").exists());
    assert!(text(&run(&["--help"]).stdout).contains("Usage: surfometry [OPTIONS] <COMMAND>"));
    assert!(text(&run(&["--label", "1", "--help"]).stdout).contains("surfometry measure"));
    assert!(text(&run(&["--version"]).stdout).starts_with("surfometry "));
    assert!(said(&["mesure", BALL], 2).contains("'measure'"));
}

#[test]
fn names_that_are_nearly_right() {
    for (slip, meant) in [
        (&["measure", "phantom:bal"][..], "no phantom is called `bal`; did you mean ball"),
        (&["measure", "phantom:ball?raduis=10"], "did you mean radius?"),
        (&["measure", "phantom"], "a built-in shape is written as phantom:torus"),
        (&["measure", "torus?major=20"], "did you mean phantom:torus?major=20?"),
    ] {
        let said = said(slip, 1);
        assert!(said.contains(meant), "{said}");
    }
    for (slip, meant) in [
        (&["validate", "--shape", "tors"][..], "did you mean torus"),
        (&["measure", BALL, "--label", "20:22"], "`20-22`"),
        (&["measure", BALL, "--label", "20..22"], "`20-22`"),
        (&["measure", BALL, "--label", "20 21"], "`20,21`"),
    ] {
        let said = said(slip, 2);
        assert!(said.contains(meant), "{said}");
    }
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments);
    assert!(run(&["phantom", "ball?radius=4", "-o", "scan.nii.gz"]).status.success());
    let missing = run(&["measure", "scan.nii"]);
    assert_eq!(missing.status.code(), Some(1));
    let said = text(&missing.stderr);
    assert!(said.contains("No such file") && said.contains("did you mean scan.nii.gz?"), "{said}");
    assert!(run(&["measure", "scan.nii.gz", "-o", "ours.csv"]).status.success());
    let column = run(&["compare", "ours.csv", "ours.csv", "--column", "area"]);
    let said = text(&column.stderr);
    assert!(column.status.code() == Some(2) && said.contains("did you mean surface_area_mm2"), "{said}");
}

/// Files of kinds that are known are no voxels alone: it is said what to convert them to.
#[test]
fn pictures_and_meshes_that_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    for (kind, ending) in [("bmp", "BMP"), ("jpg", "jpg")] {
        std::fs::create_dir(at(kind)).unwrap();
        for z in 0..3 {
            std::fs::write(at(&format!("{kind}/s_{z:04}.{ending}")), "BM or else").unwrap();
        }
        std::fs::write(at(&format!("{kind}/s_rec.log")), "[System]").unwrap();
        for (input, words) in [
            (kind.to_owned(), format!("3 .{kind} pictures")),
            (format!("{kind}/s_0001.{ending}"), format!("a .{kind} picture")),
        ] {
            let said = said(&["measure", &at(&input)], 1);
            assert!(
                said.contains(&words) && said.contains("PNG or TIFF") && !said.contains("--raw"),
                "{said}"
            );
        }
    }
    for (name, bytes) in [
        ("a.gltf", &b"{}"[..]),
        ("a.vtu", &b"<VTKFile>"[..]),
        ("lh.white", &b"\xff\xff\xfecreated by me on Sunday\n\n"[..]),
    ] {
        std::fs::write(at(name), bytes).unwrap();
        let said = said(&["measure", &at(name)], 1);
        assert!(
            said.contains("GLB (.glb)") && said.contains("--spacing X,Y,Z") && !said.contains("--raw"),
            "{said}"
        );
    }
}

/// A failure stands once in a file that takes both stdout and stderr.
#[cfg(unix)]
#[test]
fn failures_are_told_once_in_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("both.txt");
    let file = std::fs::File::create(&path).unwrap();
    let status = Command::new(env!("CARGO_BIN_EXE_surfometry"))
        .args(["measure", "/nowhere/missing.nii", BALL])
        .stderr(file.try_clone().unwrap())
        .stdout(file)
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(1));
    let both = std::fs::read_to_string(&path).unwrap();
    assert!(both.matches("missing.nii").count() == 1 && both.contains("ball"), "{both}");
    let apart = run(&["measure", "/nowhere/missing.nii", BALL]);
    assert!(text(&apart.stdout).contains("not measured:") && text(&apart.stderr).contains("missing.nii"));
}

/// An input that is named twice has one name in tables.
#[test]
fn an_input_named_twice() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments);
    assert!(run(&["phantom", "ball?radius=6", "-o", "scan.nii"]).status.success());
    let table = text(&run(&["measure", "scan.nii", "scan.nii", "-q"]).stdout);
    let rows = |name: &str| table.lines().filter(|line| line.starts_with(name)).count();
    assert_eq!((rows("scan "), rows("scan-2")), (2, 0), "{table}");
}

/// Completions go to stdout: a file that is named for them is refused, and not left out in silence.
#[test]
fn completions_have_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let refused = run_in(folder.path(), &["generate", "bash", "-o", "completions"]);
    let said = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("--output: the folder of man pages") && said.contains("> completions"), "{said}");
    assert!(refused.stdout.is_empty() && !folder.path().join("completions").exists());
}

/// At other levels than 0.5 nothing is compensated: what a sweep over them shows is the blurred surface's.
#[test]
fn a_sweep_over_levels_says_whose_numbers_it_has() {
    let swept = shown(&["sweep", "phantom:ball?radius=8", "--over", "level", "--range", "0.3:0.7:3"]);
    assert!(
        swept.contains("of the smoothed surface at that level") && !swept.contains("as it was segmented"),
        "{swept}"
    );
}

/// `map` has no --explain: it names the command that has.
#[test]
fn a_map_names_the_command_that_explains() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--sigma", "1", "--thickness", "1.2", "-o", "ball.ply"];
    let mapped = run_in(folder.path(), &[&["map", "phantom:ball?radius=8"], &arguments[..]].concat());
    let said = text(&mapped.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("ask for an explanation (surfometry measure FILE --embedding gaussian --explain)"),
        "{said}"
    );
}

/// Where detail was given back as far as voxels allow, no other choice is advised.
#[test]
fn detail_that_no_choice_gives_back() {
    let shape = "phantom:gyroid?period=5&size=20";
    let recovered = shown(&["measure", shape, "--embedding", "recovering"]);
    let told = "! detail-lost: the recovering embedding does not give the object back: 1 voxel lost";
    assert!(recovered.contains(told) && recovered.contains("only a finer scan tells more"), "{recovered}");
    assert!(!recovered.contains("the recovering embedding keeps it"), "{recovered}");
}
