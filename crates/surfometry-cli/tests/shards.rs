//! Parts of a run that are merged, and runs that go on where they were killed.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const BINARY: &str = env!("CARGO_BIN_EXE_surfometry");

fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(BINARY).current_dir(folder).args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Shapes of many kinds on anisotropic lattices, an image of two labels, one of which detail is lost, a large one
/// (more than two million voxels), and some that fail: there is none, and it is no image.
fn inputs(folder: &Path) -> Vec<String> {
    let two = "phantom:two-balls?radius=7&spacing=0.9,1,1.3";
    assert!(
        run_in(folder, &["phantom", "ball?radius=9&spacing=0.8,1,1.2", "-o", "ball.nii.gz"]).status.success()
    );
    fs::write(folder.join("broken.nii"), b"no image").unwrap();
    let mut inputs: Vec<String> = (0..9)
        .map(|n| {
            format!(
                "phantom:torus?major={}&minor=4&rotate=20,{n},40&shift=0.3,0.1,0.2&spacing=0.7,0.9,1.1",
                9 + n
            )
        })
        .collect();
    inputs.insert(1, two.to_owned());
    inputs.insert(3, "missing.nii.gz".to_owned());
    inputs.insert(4, "phantom:ball?radius=62&spacing=0.8,1,1".to_owned());
    inputs.insert(7, "ball.nii.gz".to_owned());
    inputs.insert(8, "broken.nii".to_owned());
    inputs
}

fn measure<'a>(inputs: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["measure", "--quiet"];
    arguments.extend(inputs.iter().map(String::as_str));
    arguments.extend(more);
    arguments
}

/// A document without its times, which no two runs have alike.
fn timeless(folder: &Path, name: &str) -> String {
    let text = fs::read_to_string(folder.join(name)).unwrap();
    if Path::new(name).extension().is_some_and(|ending| ending == "csv") {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let kept: Vec<usize> = (0..reader.headers().unwrap().len())
            .filter(|&c| !reader.headers().unwrap()[c].ends_with("seconds"))
            .collect();
        let rows = reader.records().map(|row| {
            let row = row.unwrap();
            kept.iter().map(|&c| &row[c]).collect::<Vec<_>>().join(",")
        });
        return rows.collect::<Vec<_>>().join("\n");
    }
    let kept = text.lines().filter(|line| !line.contains("seconds\":"));
    kept.collect::<Vec<_>>().join("\n")
}

fn shards(folder: &Path, inputs: &[String], of: usize, more: &[&str]) -> Vec<String> {
    let of_number = |number: usize| {
        let (shard, name) = (format!("{number}/{of}"), format!("shard-{number}.jsonl"));
        let run = run_in(folder, &measure(inputs, &[&["--shard", &shard, "-o", &name], more].concat()));
        assert!(run.status.code().is_some_and(|code| code < 2), "{}", text(&run.stderr));
        name
    };
    (1..=of).map(of_number).collect()
}

fn merge(folder: &Path, shards: &[String], output: &str) -> Output {
    let names = shards.iter().map(String::as_str);
    run_in(folder, &["merge"].into_iter().chain(names).chain(["-o", output]).collect::<Vec<_>>())
}

/// Whatever the number of shards and the form, the bytes of one run, times apart.
#[test]
fn merged_shards_are_the_bytes_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let (folder, inputs) = (folder.path(), inputs(folder.path()));
    for output in ["whole.csv", "whole.json", "whole.txt"] {
        let whole = run_in(folder, &measure(&inputs, &["-o", output]));
        assert_eq!(whole.status.code(), Some(1), "two inputs fail");
    }
    for of in [1, 3, inputs.len() + 2] {
        let mut names = shards(folder, &inputs, of, &[]);
        names.reverse();
        for form in ["csv", "json", "txt"] {
            let merged = merge(folder, &names, &format!("merged.{form}"));
            assert_eq!(merged.status.code(), Some(1), "{}", text(&merged.stderr));
            let (one, all) =
                (timeless(folder, &format!("merged.{form}")), timeless(folder, &format!("whole.{form}")));
            assert!(all.lines().count() > 12 && one == all, "{of} shards, {form}");
        }
    }
}

/// What cannot be one run is refused before anything is written, with the files and what to do.
#[test]
fn shards_that_do_not_belong_together() {
    let folder = tempfile::tempdir().unwrap();
    let (folder, inputs) = (folder.path(), inputs(folder.path())[5..].to_vec());
    let names = shards(folder, &inputs, 3, &[]);
    fs::create_dir(folder.join("other")).unwrap();
    let other = |number: usize, inputs: &[String], more: &[&str]| {
        let (shard, name) = (format!("{number}/3"), "other/shard.jsonl".to_owned());
        run_in(folder, &measure(inputs, &[&["--shard", &shard, "-o", &name], more].concat()));
        name
    };
    let refused = |names: &[String], words: &[&str]| {
        let merged = merge(folder, names, "merged.csv");
        let said = text(&merged.stderr);
        assert_eq!(merged.status.code(), Some(2), "{said}");
        assert!(words.iter().all(|word| said.contains(word)), "{words:?} in {said}");
        assert!(!folder.join("merged.csv").exists() && !folder.join("merged.csv.partial").exists());
    };
    let with = |last: String| vec![names[0].clone(), names[1].clone(), last];
    refused(&names[..2], &["of 3 shards 1 is missing", "3/3"]);
    refused(&[names.clone(), vec![names[1].clone()]].concat(), &["both shard 2/3", "shard-2.jsonl"]);
    refused(&with(other(3, &inputs, &["--sigma", "1.5"])), &["different runs", "sigma", "1.5"]);
    refused(&with(other(3, &inputs, &["--label", "1"])), &["different runs", "label"]);
    refused(&with(other(3, &inputs, &["--interfaces"])), &["different runs", "interfaces"]);
    refused(&with(other(3, &inputs[1..], &[])), &["lists of"]);
    let mut changed = inputs.clone();
    changed.rotate_left(1);
    refused(&with(other(3, &changed, &[])), &["different runs", "list of inputs changed"]);
    // As many, of which one is another: it is in no other shard.
    let mut changed = inputs.clone();
    changed[0] = "phantom:ball?radius=4".to_owned();
    refused(&with(other(3, &changed, &[])), &["different runs", "list of inputs changed"]);
    // What a killed run leaves.
    let whole = fs::read_to_string(folder.join(&names[2])).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let write = |text: String| {
        fs::write(folder.join("left.jsonl"), text).unwrap();
        with("left.jsonl".to_owned())
    };
    refused(&write(lines[..2].join("\n")), &["left.jsonl", "unfinished", "--resume"]);
    refused(&write(whole[..whole.len() - 40].to_owned()), &["left.jsonl", "line", "damaged"]);
    refused(&write(whole.replace("journal/1", "journal/9")), &["no journal"]);
    refused(&write(whole.replace("\"version\":\"0", "\"version\":\"99")), &["written by version 99"]);
    refused(&["broken.nii".to_owned()], &["broken.nii", "no journal"]);
    refused(&["nowhere.jsonl".to_owned()], &["nowhere.jsonl", "cannot be read"]);
}

/// Commands that make no sense, told before anything is measured.
#[test]
fn shards_and_resumes_that_are_no_commands() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |more: &[&str], words: &str| {
        let ball = ["phantom:ball?radius=6".to_owned()];
        let run = run_in(folder.path(), &measure(&ball, more));
        assert_eq!(run.status.code(), Some(2));
        assert!(text(&run.stderr).contains(words), "{words} in {}", text(&run.stderr));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    };
    refused(&["--shard", "0/3", "-o", "a.jsonl"], "which shard, and of how many");
    refused(&["--shard", "4/3", "-o", "a.jsonl"], "which shard, and of how many");
    refused(&["--shard", "1/3"], "--output");
    refused(&["--resume", "-o", "-"], "-o FILE");
    refused(&["--shard", "1/3", "-o", "a.csv"], "surfometry merge");
    refused(&["--shard", "1/3", "-o", "a.jsonl", "--sigma", "2,1=1.5"], "labels of their own");
    refused(&["phantom:ball?radius=6", "--shard", "1/3", "-o", "a.jsonl"], "named twice");
}

/// A run that is refused leaves the files of the earlier one, and none of its own.
#[test]
fn a_refused_resume_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ball = ["phantom:ball?radius=6".to_owned()];
    let resumed = |more: &[&str]| {
        let run = run_in(folder, &measure(&ball, &[&["--resume", "-o", "r.csv"], more].concat()));
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names, ["r.csv", "r.csv.journal"]);
        run.status.code()
    };
    assert_eq!(resumed(&[]), Some(0));
    assert_eq!(resumed(&["--sigma", "3"]), Some(2));
    // What only one of two runs states.
    assert_eq!(resumed(&["--interfaces"]), Some(2));
    assert_eq!(resumed(&["--regions", "phantom:ball?radius=6"]), Some(2));
    fs::write(folder.join("r.csv.journal"), "garbage\n").unwrap();
    assert_eq!(resumed(&[]), Some(2));
}

/// A killed run's journal is unfinished; a run with other choices says which file is in its way, and goes once that is removed.
#[test]
fn a_refused_resume_names_the_file_that_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ball = ["phantom:ball?radius=6".to_owned()];
    let args = measure(&ball, &["--shard", "1/1", "--resume", "-o", "s.jsonl"]);
    assert_eq!(run_in(folder, &args).status.code(), Some(0));
    // As a kill leaves it.
    fs::rename(folder.join("s.jsonl"), folder.join("s.jsonl.partial")).unwrap();
    let other = [&args[..], &["--sigma", "3"]].concat();
    let refused = run_in(folder, &other);
    assert_eq!(refused.status.code(), Some(2));
    let words = text(&refused.stderr);
    assert!(words.contains("s.jsonl.partial: it is of another run"), "{words}");
    fs::remove_file(folder.join("s.jsonl.partial")).unwrap();
    assert_eq!(run_in(folder, &other).status.code(), Some(0));
}

/// Numbers by region belong to the image of regions that was there; a file may be as old as it says.
#[test]
fn a_resume_looks_at_all_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for name in ["a.nii.gz", "zones.nii.gz"] {
        assert!(run_in(folder, &["phantom", "ball?radius=6", "-o", name]).status.success());
    }
    let long_ago = std::time::SystemTime::UNIX_EPOCH - std::time::Duration::from_millis(1_234_567_890_500);
    let file = fs::File::options().write(true).open(folder.join("a.nii.gz")).unwrap();
    file.set_modified(long_ago).unwrap();
    let inputs = ["a.nii.gz".to_owned()];
    let more = ["--resume", "--regions", "zones.nii.gz", "-o", "r.json"];
    let resumed = || run_in(folder, &measure(&inputs, &more));
    for _ in 0..2 {
        let run = resumed();
        assert!(run.status.success(), "{}", text(&run.stderr));
    }
    assert!(run_in(folder, &["phantom", "ball?radius=4", "-o", "zones.nii.gz"]).status.success());
    let refused = resumed();
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("the file of regions"), "{}", text(&refused.stderr));
}

/// Voxels along each axis of the image below.
const SIDE: usize = 20;

/// A ball about the middle of a cube, in voxels.
fn ball_voxels(radius: f64, label: u8) -> Vec<u8> {
    let from_middle = |index: usize| index as f64 - SIDE as f64 / 2.0;
    let squared = |i: usize| {
        let index = [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE];
        index.into_iter().map(|index| from_middle(index).powi(2)).sum::<f64>()
    };
    (0..SIDE.pow(3)).map(|i| if squared(i) <= radius * radius { label } else { 0 }).collect()
}

/// A header of such voxels, which are in `voxels` beside it.
fn header(spacing: &str, voxels: &str) -> String {
    let size = format!("{SIDE} {SIDE} {SIDE}");
    format!(
        "NDims = 3\nDimSize = {size}\nElementSpacing = {spacing}\nElementType = MET_UCHAR\nElementDataFile = {voxels}\n"
    )
}

/// The table of an input by a run that goes on, which has to be that of a run in one go.
fn resumed_table(folder: &Path, input: &str, table: &str) -> String {
    let inputs = [input.to_owned()];
    for more in [["--resume", "-o", table].as_slice(), &["-o", "fresh.csv"]] {
        let run = run_in(folder, &measure(&inputs, more));
        assert!(run.status.success(), "{}", text(&run.stderr));
    }
    let resumed = timeless(folder, table);
    assert_eq!(resumed, timeless(folder, "fresh.csv"), "{input}");
    resumed
}

/// The SHA-256 of a table's first input.
fn hash_in(folder: &Path, table: &str) -> String {
    let mut reader = csv::Reader::from_path(folder.join(table)).unwrap();
    let column = reader.headers().unwrap().iter().position(|name| name == "input_sha256").unwrap();
    reader.records().next().unwrap().unwrap()[column].to_owned()
}

/// Names of masks are those of their files, and headers have the spacing.
#[test]
fn a_resume_looks_at_names_and_headers_of_masks() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("masks")).unwrap();
    for (name, radius) in [("liver", 6.0), ("spleen", 5.0)] {
        fs::write(folder.join(format!("masks/{name}.raw")), ball_voxels(radius, 1)).unwrap();
        let text = header("1 1 1.2", &format!("{name}.raw"));
        fs::write(folder.join(format!("masks/{name}.mhd")), text).unwrap();
    }
    let table = || resumed_table(folder, "masks", "r.csv");
    let (first, hash) = (table(), hash_in(folder, "r.csv"));
    for name in ["liver", "spleen"] {
        let text = header("1 1 1.4", &format!("{name}.raw"));
        fs::write(folder.join(format!("masks/{name}.mhd")), text).unwrap();
    }
    let thicker = table();
    assert_ne!(thicker, first);
    assert_ne!(hash_in(folder, "r.csv"), hash);
    fs::rename(folder.join("masks/liver.mhd"), folder.join("masks/left_liver.mhd")).unwrap();
    let renamed = table();
    assert!(renamed != thicker && renamed.contains("left_liver"), "{renamed}");
}

/// A Zarr is more than the array's metadata: its chunks, and the image around it, which says where voxels lie.
#[test]
fn a_resume_looks_at_all_of_a_zarr() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir_all(folder.join("a.zarr/0")).unwrap();
    fs::write(folder.join("a.zarr/.zgroup"), r#"{"zarr_format": 2}"#).unwrap();
    let array = format!(
        r#"{{"zarr_format": 2, "shape": [{SIDE}, {SIDE}, {SIDE}], "chunks": [{SIDE}, {SIDE}, {SIDE}], "dtype": "|u1", "compressor": null, "filters": null, "fill_value": 0, "order": "C"}}"#
    );
    fs::write(folder.join("a.zarr/0/.zarray"), array).unwrap();
    let place = |scale: &str| {
        let axis = |name: &str| format!(r#"{{"name": "{name}", "type": "space", "unit": "millimeter"}}"#);
        let axes = ["z", "y", "x"].map(axis).join(", ");
        let text = format!(
            r#"{{"multiscales": [{{"version": "0.4", "axes": [{axes}], "datasets": [{{"path": "0", "coordinateTransformations": [{{"type": "scale", "scale": [{scale}]}}]}}]}}]}}"#
        );
        fs::write(folder.join("a.zarr/.zattrs"), text).unwrap();
    };
    let put = |radius: f64| fs::write(folder.join("a.zarr/0/0.0.0"), ball_voxels(radius, 1)).unwrap();
    for (input, results) in [("a.zarr", "image.csv"), ("a.zarr/0", "array.csv")] {
        place("1.2, 1, 1");
        put(6.0);
        let table = || resumed_table(folder, input, results);
        let (first, hash) = (table(), hash_in(folder, results));
        put(5.0);
        let smaller = table();
        assert_ne!(smaller, first);
        assert_ne!(hash_in(folder, results), hash);
        place("1.4, 1, 1");
        assert_ne!(table(), smaller);
    }
}

/// The voxels of regions may lie beside the file that is named.
#[test]
fn a_resume_looks_at_the_voxels_of_regions() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.raw"), ball_voxels(6.0, 1)).unwrap();
    fs::write(folder.join("a.mhd"), header("1 1 1.2", "a.raw")).unwrap();
    fs::write(folder.join("zones.mhd"), header("1 1 1.2", "zones.raw")).unwrap();
    let inputs = ["a.mhd".to_owned()];
    let resumed = |region: u8| {
        fs::write(folder.join("zones.raw"), ball_voxels(9.0, region)).unwrap();
        run_in(folder, &measure(&inputs, &["--resume", "--regions", "zones.mhd", "-o", "r.json"]))
    };
    let first = resumed(1);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let refused = resumed(2);
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    assert!(text(&refused.stderr).contains("the file of regions"), "{}", text(&refused.stderr));
}

/// Killed again and again, in whatever moment, a run comes to the table of a run in one go; what was in its journal is
/// never measured again.
#[cfg(unix)]
#[test]
fn a_killed_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let inputs: Vec<String> = [
        inputs(folder),
        (0..200).map(|n| format!("phantom:ball?radius={}", 6.0 + 0.1 * f64::from(n))).collect(),
    ]
    .concat();
    assert_eq!(run_in(folder, &measure(&inputs, &["-o", "whole.csv"])).status.code(), Some(1));
    let journal = folder.join("results.csv.journal.partial");
    let results = |text: &str| {
        let lines =
            text.lines().filter(|line| line.starts_with("{\"result\"") && !line.contains("\"failure\""));
        lines
            .filter_map(|line| serde_json::from_str::<Value>(line).ok())
            .map(|line| line["result"].clone())
            .collect::<Vec<_>>()
    };
    let (mut kills, mut wait) = (0, 60);
    let mut known = Vec::new();
    loop {
        let mut command = Command::new(BINARY);
        command
            .current_dir(folder)
            .args(measure(&inputs, &["--resume", "-o", "results.csv"]))
            .stderr(Stdio::null());
        let mut child = command.spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        (kills, wait) = (kills + 1, wait + 20);
        let left = fs::read_to_string(&journal).unwrap_or_default();
        let now = results(&left);
        assert!(now.starts_with(&known), "nothing that was finished is lost, or done again");
        known = now;
        // Half a line, as of a full disk.
        fs::write(&journal, left + "{\"result\":{\"inp").unwrap();
    }
    println!("{kills} kills");
    assert!(kills > 2);
    assert_eq!(timeless(folder, "results.csv"), timeless(folder, "whole.csv"));
    let finished = fs::read_to_string(folder.join("results.csv.journal")).unwrap();
    let names: Vec<String> = results(&finished).iter().map(|result| result["input"].to_string()).collect();
    assert_eq!(names.len(), inputs.len() - 2, "each input once");
    // Everything is there: nothing is measured, the times of the table are the old ones.
    let before = fs::read(folder.join("results.csv")).unwrap();
    run_in(folder, &measure(&inputs, &["--resume", "-o", "results.csv"]));
    assert_eq!(fs::read(folder.join("results.csv")).unwrap(), before);
}

/// Only what changed, failed or is new is measured; a shard goes on as well, and other choices are another run.
#[test]
fn what_is_measured_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let inputs = inputs(folder)[6..].to_vec();
    let resumed =
        |inputs: &[String], more: &[&str]| run_in(folder, &measure(inputs, &[&["--resume"], more].concat()));
    let rows = || {
        let mut reader = csv::Reader::from_path(folder.join("r.csv")).unwrap();
        reader
            .records()
            .map(|row| row.unwrap().iter().map(str::to_owned).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    };
    assert_eq!(resumed(&inputs, &["-o", "r.csv"]).status.code(), Some(1));
    let first = rows();
    let refused = resumed(&inputs, &["-o", "r.csv", "--level", "0.4"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("level: the default and 0.4"), "{}", text(&refused.stderr));
    // One is another ball now, one is no longer broken, one is new.
    run_in(folder, &["phantom", "ball?radius=10&spacing=0.8,1,1.2", "-o", "ball.nii.gz"]);
    run_in(folder, &["phantom", "ball?radius=8", "-o", "broken.nii"]);
    let longer = [inputs.clone(), vec!["phantom:ball?radius=7".to_owned()]].concat();
    assert_eq!(resumed(&longer, &["-o", "r.csv"]).status.code(), Some(0));
    let second = rows();
    assert_eq!(second.len(), first.len() + 1);
    for (earlier, now) in first.iter().zip(&second) {
        let is_changed = earlier[0] == "ball.nii.gz" || earlier[0] == "broken.nii";
        assert_eq!(earlier != now, is_changed, "{}", earlier[0]);
    }
    for number in ["1/2", "2/2"] {
        let name = format!("{}.jsonl", &number[..1]);
        assert!(resumed(&longer, &["--shard", number, "-o", &name]).status.success());
        let before = fs::metadata(folder.join(&name)).unwrap().len();
        assert!(resumed(&longer, &["--shard", number, "-o", &name]).status.success());
        assert!(before > 0 && fs::metadata(folder.join(&name)).unwrap().len() >= before);
    }
    // Killed just as it began to go on with a finished one: its head alone is in the new one.
    let finished = fs::read_to_string(folder.join("1.jsonl")).unwrap();
    fs::write(folder.join("1.jsonl.partial"), finished.lines().next().unwrap().to_owned() + "\n").unwrap();
    assert!(resumed(&longer, &["--shard", "1/2", "-o", "1.jsonl"]).status.success());
    let other = resumed(&longer, &["--shard", "2/2", "-o", "1.jsonl"]);
    assert!(text(&other.stderr).contains("another run (shard 1/2)"), "{}", text(&other.stderr));
    run_in(
        folder,
        &["measure", "--quiet", "-o", "plain.csv"]
            .into_iter()
            .chain(longer.iter().map(String::as_str))
            .collect::<Vec<_>>(),
    );
    assert!(merge(folder, &["1.jsonl".to_owned(), "2.jsonl".to_owned()], "merged.csv").status.success());
    assert_eq!(timeless(folder, "merged.csv"), timeless(folder, "plain.csv"));
}
