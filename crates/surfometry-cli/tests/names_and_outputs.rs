//! Odd names of inputs, and outputs that cannot be written: nothing is left out in silence, nothing is overwritten,
//! nothing is measured in vain.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    /// A ball of a radius of 4 mm.
    fn ball(&self, name: impl AsRef<Path>) {
        let made = self.path("ball.nii");
        if !made.exists() {
            assert!(
                self.run(&["phantom", "ball?radius=4&spacing=1,1,1.2", "-o", "ball.nii"]).status.success()
            );
        }
        std::fs::create_dir_all(self.path(&name).parent().unwrap()).unwrap();
        std::fs::copy(made, self.path(name)).unwrap();
    }

    fn run<S: AsRef<std::ffi::OsStr>>(&self, arguments: &[S]) -> Output {
        let mut program = Command::new(env!("CARGO_BIN_EXE_surfometry"));
        program.args(arguments).current_dir(self.0.path()).output().expect("the program runs")
    }
}

const BALL: &str = "phantom:ball?radius=10&shift=0.3,0.2,0.1";

fn document(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output.stderr)))
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// The inputs of a document's results, and its failures.
fn named(document: &Value) -> (Vec<&str>, Vec<[&str; 2]>) {
    let list = |name: &str| document[name].as_array().unwrap();
    let results = list("results").iter().map(|row| row["input"].as_str().unwrap()).collect();
    let failures =
        list("failures").iter().map(|f| [f["input"].as_str().unwrap(), f["error"].as_str().unwrap()]);
    (results, failures.collect())
}

/// A name that is no text, by a pattern or as the shell hands it on: it fails by its name, the others are measured.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let desk = Desk::new();
    let odd = std::ffi::OsStr::from_bytes(b"in/b\xe9.nii");
    desk.ball("in/a.nii");
    desk.ball(Path::new(odd));
    let (command, json) = (["measure".as_ref(), "--format".as_ref(), "json".as_ref()], "in/*.nii");
    let by_pattern = [&command[..], &[json.as_ref()]].concat();
    let by_shell = [&command[..], &["in/a.nii".as_ref(), odd]].concat();
    for arguments in [by_pattern, by_shell] {
        let output = desk.run(&arguments);
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        let document = document(&output);
        let (results, failures) = named(&document);
        assert_eq!((results, failures[0][0]), (vec!["in/a.nii"], r"in/b\xE9.nii"));
        assert!(
            failures[0][1].contains("not UTF-8") && failures[0][1].contains("rename"),
            "{}",
            failures[0][1]
        );
    }
    for command in ["info", "reference", "map"] {
        let output = desk.run(
            &[command.as_ref(), odd, "-o".as_ref(), "a.json".as_ref()]
                [..if command == "info" { 2 } else { 4 }],
        );
        assert_eq!(output.status.code(), Some(1), "{command}");
        assert!(text(&output.stderr).contains(r"in/b\xE9.nii: the file's name is not UTF-8"), "{command}");
    }
}

/// Brackets in a folder's name are the name's where such a folder is there; `*` in the same pattern is none.
#[test]
fn patterns_and_names_with_brackets() {
    let desk = Desk::new();
    for name in ["data[1]/a.nii", "data[1]/b.nii", "data1/c.nii", "deep/er/d.nii", "deep/e.nii"] {
        desk.ball(name);
    }
    for (pattern, expected) in [
        ("data[1]/*.nii", vec!["data[1]/a.nii", "data[1]/b.nii"]),
        ("data[1]/a.nii", vec!["data[1]/a.nii"]),
        ("data[12]/?.nii", vec!["data1/c.nii"]),
        ("d*1*/[bc].nii", vec!["data1/c.nii", "data[1]/b.nii"]),
        ("deep/**/*.nii", vec!["deep/e.nii", "deep/er/d.nii"]),
        ("./deep/*", vec!["deep/e.nii", "deep/er"]),
    ] {
        let output = desk.run(&["measure", pattern, "--format", "json"]);
        let document = document(&output);
        let (results, failures) = named(&document);
        let found: Vec<&str> = results.into_iter().chain(failures.iter().map(|f| f[0])).collect();
        let found: Vec<&str> = found.iter().map(|name| name.strip_prefix("./").unwrap_or(name)).collect();
        assert_eq!(found, expected, "{pattern}");
    }
    let none = desk.run(&["measure", "data[2]/*.nii"]);
    assert!(text(&none.stderr).contains("no file matches this pattern"), "{}", text(&none.stderr));
}

/// A terminal's commands in names are shown, not obeyed; a spreadsheet's formulas are words, and numbers numbers.
#[test]
fn names_that_terminals_and_spreadsheets_obey() {
    let desk = Desk::new();
    let red = "\u{1b}[31mred.nii";
    desk.ball(red);
    std::fs::write(desk.path("\u{1b}]0;broken.nii"), "no image").unwrap();
    let inputs = [red, "\u{1b}]0;broken.nii"];
    for command in
        [&["measure"][..], &["info"], &["reference"], &["measure", "--format", "json"], &["info", "--json"]]
    {
        let output = desk.run(&[command, &inputs].concat());
        assert!(text(&output.stdout).contains("31mred"), "{command:?}: {}", text(&output.stderr));
        assert!(![&output.stdout, &output.stderr].iter().any(|bytes| bytes.contains(&0x1b)), "{command:?}");
    }
    for formula in ["=1+2.nii", "+a.nii", "-a.nii", "@a.nii"] {
        desk.ball(formula);
        let output = desk.run(&["measure", "--format", "csv", "--", formula]);
        let mut rows = csv::Reader::from_reader(&output.stdout[..]);
        let row = rows.records().next().unwrap().unwrap();
        assert_eq!(&row[0], format!("'{formula}"));
        std::fs::write(desk.path("a.csv"), &output.stdout).unwrap();
        let names = format!("input,label,volume_mm3\n{formula},1,200\n");
        std::fs::write(desk.path("b.csv"), names).unwrap();
        let compared = desk.run(&["compare", "a.csv", "b.csv", "--column", "volume_mm3"]);
        assert!(text(&compared.stdout).contains("volume_mm3"), "{}", text(&compared.stderr));
    }
    let output = desk.run(&["measure", "--format", "csv", "phantom:ball?radius=4&shift=-20,0,0"]);
    let mut rows = csv::Reader::from_reader(&output.stdout[..]);
    let place = rows.headers().unwrap().iter().position(|name| name == "voxels_centroid_mm_x").unwrap();
    let x: f64 = rows.records().next().unwrap().unwrap()[place].parse().unwrap();
    assert!((x + 20.0).abs() < 0.1, "{x}");
}

/// A file that an input rests on is no output: voxels of a header, materials of a mesh.
#[test]
fn what_inputs_rest_on_is_not_overwritten() {
    let desk = Desk::new();
    assert!(desk.run(&["map", "phantom:ball?radius=6", "-o", "a.obj", "-o", "a.ply"]).status.success());
    let mesh = std::fs::read_to_string(desk.path("a.obj")).unwrap();
    std::fs::write(desk.path("a.obj"), format!("mtllib other.mtl paint.csv\n{mesh}")).unwrap();
    let ply = std::fs::read(desk.path("a.ply")).unwrap();
    let end = ply.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    std::fs::write(
        desk.path("a.ply"),
        [&ply[..end], b"comment TextureFile paint.csv\n", &ply[end..]].concat(),
    )
    .unwrap();
    std::fs::write(desk.path("paint.csv"), "colours").unwrap();
    for command in ["measure", "map", "reference"] {
        for input in ["a.obj", "a.ply"] {
            let refused = desk.run(&[command, input, "--spacing", "1,1,1", "-o", "paint.csv"]);
            assert_eq!(refused.status.code(), Some(2), "{command}: {}", text(&refused.stderr));
            assert!(text(&refused.stderr).contains("would replace the input"), "{}", text(&refused.stderr));
        }
    }
    assert_eq!(std::fs::read(desk.path("paint.csv")).unwrap(), b"colours");
}

/// What cannot be written is told before anything is measured, by one status in all commands.
#[cfg(target_os = "linux")]
/// What is read beside the inputs is no more overwritten than they are.
#[test]
fn what_is_read_beside_is_not_overwritten() {
    let desk = Desk::new();
    desk.ball("scan.nii");
    for name in ["dose.nii", "zones.nii", "scan_map.nii", "names_regions.csv"] {
        desk.ball(name);
    }
    let names = "label,name\n1,bone\n";
    for name in ["names.csv", "names_interfaces.csv"] {
        std::fs::write(desk.path(name), names).unwrap();
    }
    for line in [
        "map scan.nii --sample dose.nii -o dose.nii",
        "map scan.nii --sample d=dose.nii -o x.ply -o dose.nii",
        "map scan.nii --regions zones.nii -o zones.nii",
        "map scan.nii --names names.csv -o names.csv",
        "measure scan.nii --names names.csv -o names.csv",
        "measure scan.nii --regions names_regions.csv -o names.csv",
        "measure scan.nii --interfaces --names names_interfaces.csv -o names.csv",
        "report scan.nii --names names.csv -o names.csv",
        "reference scan.nii --names names.csv -o names.csv",
        "sweep scan.nii --range 1:2:2 --names names.csv -o names.csv",
        "embed scan.nii --names names.csv -o names.csv",
    ] {
        let refused = desk.run(&line.split(' ').collect::<Vec<_>>());
        assert_eq!(refused.status.code(), Some(2), "{line}: {}", text(&refused.stderr));
        assert_eq!(std::fs::read_to_string(desk.path("names.csv")).unwrap(), names, "{line}");
    }
    let ball = std::fs::read(desk.path("ball.nii")).unwrap();
    for name in ["dose.nii", "zones.nii", "names_regions.csv"] {
        assert_eq!(std::fs::read(desk.path(name)).unwrap(), ball, "{name}");
    }
}

#[test]
fn outputs_are_tried_before_the_work() {
    let desk = Desk::new();
    desk.ball("a.nii");
    std::fs::write(desk.path("t.csv"), "input,volume_mm3\na,1\nb,2\nc,3\n").unwrap();
    // Nobody can make files there.
    for arguments in [
        &["measure", "a.nii", "-o", "/proc/x.csv"][..],
        &["measure", "a.nii", "--png", "/proc/x.png"],
        &["map", "a.nii", "-o", "/proc/x.ply"],
        &["map", "a.nii", "-o", "/proc/x.json"],
        &["report", "a.nii", "-o", "/proc/x.html"],
        &["embed", "a.nii", "-o", "/proc/x.nii"],
        &["reference", "a.nii", "-o", "/proc/x.csv"],
        &["sweep", "a.nii", "--range", "1:2:2", "-o", "/proc/x.csv"],
        &["compare", "t.csv", "t.csv", "-o", "/proc/x.json"],
        &["phantom", "ball", "-o", "/proc/x.nii"],
        &["cohort", "--femurs", "1", "--vertebrae", "0", "-o", "/proc/x"],
        &["validate", "-o", "/proc/x.json"],
    ] {
        let refused = desk.run(arguments);
        let words = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}: {words}");
        assert!(words.contains("/proc/x") && words.contains("cannot be written"), "{arguments:?}: {words}");
        assert!(refused.stdout.is_empty(), "{arguments:?}");
    }
    assert_eq!(std::fs::read_dir(desk.0.path()).unwrap().count(), 4, "files were left behind");
}

/// A mesh's format is said, also of a packed one.
#[test]
fn info_names_the_format_of_meshes() {
    let desk = Desk::new();
    let names = ["a.stl", "a.ply", "a.obj", "a.vtp", "a.glb", "a.surf.gii"];
    let outputs: Vec<&str> = names.iter().flat_map(|name| ["-o", name]).collect();
    assert!(desk.run(&[&["map", "phantom:ball?radius=6"], &outputs[..]].concat()).status.success());
    for (name, format) in names.iter().zip(["STL", "PLY", "OBJ", "VTP", "GLB", "GIFTI"]) {
        let output = desk.run(&["info", name, "--spacing", "1,1,1.5", "--json"]);
        assert_eq!(document(&output)[0]["format"], format);
    }
}

/// What `measure` says of twelve balls where the system takes so many blocks of half a kilobyte, and then reports an error, which it
/// does by a signal where nobody minds.
#[cfg(target_os = "linux")]
fn on_a_full_disk(desk: &Desk, name: &str, blocks: u32) -> String {
    let inputs: Vec<String> =
        (4..16).map(|radius| format!("'phantom:ball?radius={radius}&spacing=2,2,2'")).collect();
    let (program, inputs) = (env!("CARGO_BIN_EXE_surfometry"), inputs.join(" "));
    let line = format!("trap '' XFSZ; ulimit -f {blocks}; exec {program} measure {inputs} -q -o {name}");
    let output = Command::new("sh").args(["-c", &line]).current_dir(desk.0.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    text(&output.stderr).to_owned()
}

/// Where no more can be written, as on a full disk, the run ends and says where what was finished is: a whole document.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_what_was_finished() {
    let desk = Desk::new();
    let said = on_a_full_disk(&desk, "all.json", 20);
    assert!(said.contains("what was finished is in all.json.partial"), "{said}");
    let kept = std::fs::read(desk.path("all.json.partial")).unwrap();
    let document: Value = serde_json::from_slice(&kept).unwrap();
    let results = document["results"].as_array().unwrap().len();
    assert!((1..12).contains(&results), "{results} results in {} bytes", kept.len());
    assert!(!desk.path("all.json").exists());
}

/// The same of rows: none is begun that there is no room for, and where there is room for none, no file is left.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_whole_rows() {
    let desk = Desk::new();
    for name in ["all.csv", "all.jsonl"] {
        let said = on_a_full_disk(&desk, name, 24);
        assert!(said.contains(&format!("what was finished is in {name}.partial")), "{said}");
        let kept = std::fs::read_to_string(desk.path(format!("{name}.partial"))).unwrap();
        assert!(kept.ends_with('\n') && kept.lines().count() > 1, "{kept}");
        if name == "all.csv" {
            let rows = csv::Reader::from_reader(kept.as_bytes()).into_records().map(Result::unwrap).count();
            assert!((1..12).contains(&rows), "{rows}");
        } else {
            kept.lines().for_each(|line| drop(serde_json::from_str::<Value>(line).unwrap()));
        }
    }
    assert!(!on_a_full_disk(&desk, "none.csv", 0).contains("what was finished"));
    assert!(!desk.path("none.csv.partial").exists() && !desk.path("none.csv").exists());
}

/// What a folder of masks rests on is not written over; a table may lie beside, also a second time.
#[test]
fn files_of_folders_are_not_replaced() {
    let desk = Desk::new();
    for name in ["masks/a.nii", "masks/b.nii"] {
        desk.ball(name);
    }
    let before = std::fs::read(desk.path("masks/b.nii")).unwrap();
    let refused = desk.run(&["measure", "masks", "--format", "csv", "-o", "masks/b.nii"]);
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    assert!(text(&refused.stderr).contains("would replace the input masks"), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read(desk.path("masks/b.nii")).unwrap(), before);
    for _ in 0..2 {
        let written = desk.run(&["measure", "masks", "-o", "masks/results.csv"]);
        assert!(written.status.success(), "{}", text(&written.stderr));
    }
}

/// All files in the folder of a Zarr are its own: an output is none of them, nor a new one, which would be taken for metadata or a
/// chunk; also of the image around an array that is named.
#[test]
fn nothing_is_written_into_a_zarr() {
    let desk = Desk::new();
    let zarr = desk.path("a.zarr");
    std::fs::create_dir_all(zarr.join("0")).unwrap();
    let array = r#"{"zarr_format": 2, "shape": [20, 20, 20], "chunks": [20, 20, 20], "dtype": "|u1", "compressor": null, "filters": null, "fill_value": 0, "order": "C"}"#;
    let axis = |name: &str| format!(r#"{{"name": "{name}", "type": "space", "unit": "millimeter"}}"#);
    let image = format!(
        r#"{{"multiscales": [{{"version": "0.4", "axes": [{}], "datasets": [{{"path": "0", "coordinateTransformations": [{{"type": "scale", "scale": [1, 1, 1]}}]}}]}}]}}"#,
        ["z", "y", "x"].map(axis).join(", ")
    );
    let inside = |i: usize| [i % 20, i / 20 % 20, i / 400].iter().all(|n| (4..16).contains(n));
    let voxels: Vec<u8> = (0..8000).map(|i| u8::from(inside(i))).collect();
    std::fs::write(zarr.join(".zgroup"), r#"{"zarr_format": 2}"#).unwrap();
    std::fs::write(zarr.join(".zattrs"), &image).unwrap();
    std::fs::write(zarr.join("0/.zarray"), array).unwrap();
    std::fs::write(zarr.join("0/0.0.0"), &voxels).unwrap();
    for input in ["a.zarr", "a.zarr/0"] {
        assert_eq!(desk.run(&["measure", input, "--format", "csv"]).status.code(), Some(0));
        let old = ["a.zarr/.zattrs", "a.zarr/0/0.0.0"].map(|output| (output, "would replace the input"));
        let new = ["a.zarr/zarr.json", "a.zarr/0/zarr.json", "a.zarr/0/0.0.1", "a.zarr/results.csv"]
            .map(|output| (output, "would lie in the Zarr"));
        for (output, words) in old.into_iter().chain(new) {
            let refused = desk.run(&["measure", input, "--format", "csv", "-o", output]);
            assert_eq!(refused.status.code(), Some(2), "{input} {output}: {}", text(&refused.stderr));
            assert!(text(&refused.stderr).contains(words), "{output}: {}", text(&refused.stderr));
        }
        let refused = desk.run(&["map", input, "-o", "a.zarr/zarr.json"]);
        assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    }
    assert_eq!(std::fs::read_dir(&zarr).unwrap().count(), 3);
    assert_eq!(std::fs::read_dir(zarr.join("0")).unwrap().count(), 2);
    assert_eq!(std::fs::read_to_string(zarr.join(".zattrs")).unwrap(), image);
}

/// What no file can be called is told of before anything is measured.
#[test]
fn an_output_is_called_as_a_file_is() {
    let desk = Desk::new();
    for more in [vec![], vec!["--resume"]] {
        for output in ["x.csv/", "x.csv/."] {
            let refused = desk.run(&[vec!["measure", BALL, "-o", output], more.clone()].concat());
            assert_eq!(refused.status.code(), Some(2), "{output}: {}", text(&refused.stderr));
            assert!(text(&refused.stderr).contains("as a folder's does"), "{}", text(&refused.stderr));
        }
    }
    assert_eq!(std::fs::read_dir(desk.0.path()).unwrap().count(), 0);
}

/// What came of a command within some seconds: one that waits for who never comes is ended.
#[cfg(target_os = "linux")]
fn at_once(desk: &Desk, line: &str) -> (Option<i32>, String) {
    let program = env!("CARGO_BIN_EXE_surfometry");
    let line = line.replace("surfometry", &format!("timeout 20 {program}"));
    let output = Command::new("bash").args(["-c", &line]).current_dir(desk.0.path()).output().unwrap();
    (output.status.code(), format!("{}{}", text(&output.stdout), text(&output.stderr)))
}

/// A pipe that nobody is at the other end of is not waited for, and what never ends is not read on and on; pipes that a
/// shell hands on are files.
#[cfg(target_os = "linux")]
#[test]
fn pipes_and_devices() {
    let desk = Desk::new();
    let pipes = ["pipe", "pipe.json", "pipe.jsonl"].map(|name| desk.path(name));
    let made = Command::new("mkfifo").args(pipes).status().unwrap();
    assert!(made.success());
    std::fs::write(desk.path("t.csv"), "input,volume_mm3\na,1\nb,2\nc,3\n").unwrap();
    for (line, status, words) in [
        ("surfometry compare pipe t.csv", 2, "pipe: cannot be read: it is a folder, a pipe or a device"),
        ("surfometry compare t.csv /dev/zero", 2, "/dev/zero: cannot be read"),
        ("surfometry merge pipe", 2, "pipe: cannot be read or written: it is a folder, a pipe or a device"),
        ("surfometry merge /dev/zero", 2, "/dev/zero: cannot be read or written"),
        ("surfometry rerun pipe", 2, "pipe: a device or pipe, not a file"),
        ("surfometry measure phantom:ball?radius=4 --names pipe", 2, "pipe: a device or pipe, not a file"),
        ("surfometry measure phantom:ball?radius=4 --names /dev/zero", 2, "/dev/zero: a device or pipe"),
        ("surfometry measure phantom:ball?radius=4 -o pipe", 2, "pipe that nobody reads"),
        ("surfometry measure phantom:ball?radius=4 --shard 1/1 -o pipe.jsonl", 2, "a pipe or a device"),
        ("surfometry compare t.csv t.csv -o pipe.json", 1, "pipe that nobody reads"),
    ] {
        let (found, said) = at_once(&desk, line);
        assert!(found == Some(status) && said.contains(words), "{line}: {found:?}: {said}");
    }
    for line in [
        "surfometry compare <(cat t.csv) t.csv --column volume_mm3",
        "surfometry compare /dev/stdin t.csv --column volume_mm3 < t.csv",
        "cat t.csv | surfometry compare t.csv /dev/stdin --column volume_mm3",
        "surfometry measure phantom:ball?radius=4 --format csv -o /dev/stdout | grep volume_mm3",
        "surfometry measure phantom:ball?radius=4 --format csv -o >(cat > o.csv); sleep 0.2; grep volume_mm3 o.csv",
        "cat pipe & sleep 0.5; surfometry measure phantom:ball?radius=4 --format csv -o pipe; wait",
    ] {
        let (status, said) = at_once(&desk, line);
        assert!(status == Some(0) && said.contains("volume_mm3"), "{line}: {status:?}: {said}");
    }
}

/// Names in another encoding than UTF-8 are read, and that they are guessed is said; of two names of a label both are.
#[test]
fn tables_of_names_in_latin_1_or_with_two_of_a_label() {
    let desk = Desk::new();
    desk.ball("a.nii");
    std::fs::write(desk.path("names.txt"), b"1 F\xe9mur gauche\n").unwrap();
    let output = desk.run(&["measure", "a.nii", "--names", "names.txt", "--format", "json"]);
    assert_eq!(document(&output)["results"][0]["name"], "F\u{e9}mur gauche");
    let said = text(&output.stderr);
    assert!(said.contains("names.txt") && said.contains("Windows-1252"), "{said}");
    std::fs::write(desk.path("names.txt"), "1 F\u{e9}mur\n").unwrap();
    let output = desk.run(&["measure", "a.nii", "--names", "names.txt", "--format", "json"]);
    assert_eq!((&document(&output)["results"][0]["name"], text(&output.stderr)), (&"F\u{e9}mur".into(), ""));
    for (table, words) in [
        ("1 femur\n2 tibia\n1 fibula\n", "label 1 has two names, `femur` (line 1) and `fibula` (line 3)"),
        ("label,name\n1,femur\n1,tibia\n", "`femur` (line 2) and `tibia` (line 3)"),
        (r#"{"1": "femur", "1": "tibia"}"#, "`femur` (key `1`) and `tibia` (key `1`)"),
        (r#"{"labels": {"femur": 1, "tibia": 1}}"#, "`femur` (key `femur`) and `tibia` (key `tibia`)"),
    ] {
        std::fs::write(desk.path("names.txt"), table).unwrap();
        let refused = desk.run(&["measure", "a.nii", "--names", "names.txt"]);
        assert!(refused.status.code() == Some(2), "{table}");
        assert!(text(&refused.stderr).contains(words), "{}", text(&refused.stderr));
    }
}

#[test]
fn output_is_written_whole_or_not_at_all() {
    let desk = Desk::new();
    let ok = desk.run(&["measure", BALL, "--format", "csv", "-o", "out.csv"]);
    assert_eq!(ok.status.code(), Some(0));
    assert!(ok.stdout.is_empty());
    let before = std::fs::read(desk.path("out.csv")).unwrap();
    assert!(before.starts_with(b"input,label,name,component,surface,volume_mm3"));
    let nowhere = desk.run(&["measure", BALL, "-o", "no/such/folder/out.csv"]);
    assert_eq!(nowhere.status.code(), Some(2));
    let folder_itself = desk.run(&["measure", BALL, "-o", "."]);
    assert_eq!(folder_itself.status.code(), Some(2));
    let stdout = desk.run(&["measure", BALL, "--format", "csv", "-o", "-"]);
    assert!(stdout.stdout.starts_with(b"input,label"));
    assert!(text(&nowhere.stderr).contains("no/such/folder/out.csv"));
    let wrong = desk.run(&["measure", BALL, "--sigma", "0", "-o", "out.csv"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert_eq!(std::fs::read(desk.path("out.csv")).unwrap(), before);
    assert_eq!(std::fs::read_dir(desk.0.path()).unwrap().count(), 1, "no temporary file is left");
}

/// That a result could not be written is no fault of the command.
#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_written_at_the_end() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output =
        Command::new(env!("CARGO_BIN_EXE_surfometry")).args(["measure", BALL]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("stdout: cannot be written"), "{}", text(&output.stderr));
}

/// The segmentation is never what gets written over.
#[test]
fn an_output_does_not_replace_an_input() {
    let desk = Desk::new();
    assert_eq!(desk.run(&["phantom", "ball?radius=4", "-o", "a.nii"]).status.code(), Some(0));
    let before = std::fs::read(desk.path("a.nii")).unwrap();
    let refused = desk.run(&["measure", "a.nii", "--sigma", "1", "-o", "./a.nii"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("would replace the input"), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read(desk.path("a.nii")).unwrap(), before);
    // Nor while a run goes on, under the name that its file has until then.
    std::fs::copy(desk.path("a.nii"), desk.path("b.nii.partial")).unwrap();
    let refused = desk.run(&["measure", "b.nii.partial", "-o", "b.nii"]);
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read(desk.path("b.nii.partial")).unwrap(), before);
}

/// Either file of a pair stays as it is, whichever was named.
#[test]
fn an_output_does_not_replace_a_header() {
    let desk = Desk::new();
    assert_eq!(desk.run(&["phantom", "ball?radius=4", "-o", "a.nii"]).status.code(), Some(0));
    let mut header = std::fs::read(desk.path("a.nii")).unwrap();
    let voxels = header.split_off(352);
    // A pair's magic and offset.
    header[344..348].copy_from_slice(b"ni1\0");
    header[108..112].copy_from_slice(&0_f32.to_le_bytes());
    std::fs::write(desk.path("p.hdr"), &header).unwrap();
    std::fs::write(desk.path("p.img"), voxels).unwrap();
    assert_eq!(desk.run(&["measure", "p.img"]).status.code(), Some(0));
    for (input, output) in [("p.img", "p.hdr"), ("p.hdr", "p.img")] {
        let refused = desk.run(&["measure", input, "-o", output]);
        assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    }
    assert_eq!(std::fs::read(desk.path("p.hdr")).unwrap(), header);
}

/// A full stderr loses no results.
#[cfg(target_os = "linux")]
#[test]
fn messages_that_cannot_be_said_lose_no_results() {
    let desk = Desk::new();
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let status = Command::new(env!("CARGO_BIN_EXE_surfometry"))
        .current_dir(desk.0.path())
        .args(["measure", "missing.nii", BALL, "-o", "out.txt"])
        .stderr(full)
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(1));
    let written = std::fs::read_to_string(desk.path("out.txt")).unwrap();
    assert!(
        written.contains("volume mm") && written.contains("not measured:\n  missing.nii: No such file"),
        "{written}"
    );
}
