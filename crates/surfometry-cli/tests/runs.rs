//! Runs over many inputs: what is there when they are killed or stopped, and in which order.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const BINARY: &str = env!("CARGO_BIN_EXE_surfometry");

fn start(folder: &Path, arguments: &[String]) -> Child {
    let mut command = Command::new(BINARY);
    command.current_dir(folder).args(arguments).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

/// Balls of different sizes, some of them large enough to be measured alone.
fn balls(count: u32) -> Vec<String> {
    (0..count).map(|n| format!("phantom:ball?radius={}&shift=0.3,0.2,0.1", 6 + n % 40)).collect()
}

fn measure(count: u32, output: &str) -> Vec<String> {
    let mut arguments = vec!["measure".to_owned()];
    arguments.extend(balls(count));
    arguments.extend(["-o".to_owned(), output.to_owned()]);
    arguments
}

fn documents(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

/// Killed at any moment, what was finished is there, as a whole document, and nothing else.
#[cfg(unix)]
#[test]
fn what_was_finished_survives_a_kill() {
    let (mut unfinished, mut most) = (0, 0);
    for n in 0..30u64 {
        let folder = tempfile::tempdir().unwrap();
        let format = ["json", "csv", "jsonl"][n as usize % 3];
        let mut child = start(folder.path(), &measure(300, &format!("results.{format}")));
        std::thread::sleep(Duration::from_millis(10 + 37 * n % 700));
        child.kill().unwrap();
        child.wait().unwrap();
        for path in documents(folder.path()) {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            assert!(
                name == format!("results.{format}") || name == format!("results.{format}.partial"),
                "{name}"
            );
            let text = std::fs::read_to_string(&path).unwrap();
            let rows = match format {
                "json" => {
                    // A run that was killed before its first byte has an empty file.
                    let document: Value =
                        if text.is_empty() { Value::Null } else { serde_json::from_str(&text).unwrap() };
                    document["results"].as_array().map_or(0, Vec::len)
                }
                "jsonl" => {
                    let whole = |line: &&str| serde_json::from_str::<Value>(line).is_ok();
                    assert!(text.lines().all(|line| whole(&line)), "a line is whole");
                    text.lines().count()
                }
                _ => {
                    let columns = |line: &str| line.split(',').count();
                    let header = text.lines().next().map_or(0, columns);
                    assert!(text.is_empty() || text.ends_with('\n'), "a row is whole");
                    text.lines().filter(|line| columns(line) == header).count().saturating_sub(1)
                }
            };
            unfinished += usize::from(name.ends_with(".partial"));
            most = most.max(rows);
        }
    }
    println!("{unfinished} of 30 were unfinished, with up to {most} results");
    assert!(unfinished > 0 && most > 0);
}

#[cfg(unix)]
fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Pages and documents of a run that was stopped hold what was finished.
#[cfg(unix)]
#[test]
fn a_stop_leaves_pages_and_documents() {
    for (command, name) in [("report", "page.html"), ("map", "map.json")] {
        let folder = tempfile::tempdir().unwrap();
        let inputs = ["phantom:ball?radius=6", "phantom:gyroid?period=40&size=400"];
        let arguments: Vec<String> =
            [&[command], &inputs[..], &["-o", name]].concat().into_iter().map(str::to_owned).collect();
        let partial = folder.path().join(format!("{name}.partial"));
        let child = start(folder.path(), &arguments);
        let started = Instant::now();
        let is_finished = || std::fs::read_to_string(&partial).is_ok_and(|text| text.contains(inputs[0]));
        while !is_finished() && started.elapsed() < Duration::from_mins(1) {
            std::thread::sleep(Duration::from_millis(5));
        }
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{command}");
        let text = std::fs::read_to_string(&partial).expect("what was finished");
        assert!(text.contains("phantom:ball?radius=6"), "{command}");
        assert!(!folder.path().join(name).exists());
    }
}

/// Ctrl-C ends a run soon, says so, and leaves what was finished.
#[cfg(unix)]
#[test]
fn a_stop_is_soon_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let mut arguments = measure(50, "results.csv");
    // A large one at the end, in the midst of which the stop comes.
    arguments.insert(51, "phantom:gyroid?period=40&size=400".to_owned());
    let child = start(folder.path(), &arguments);
    let partial = folder.path().join("results.csv.partial");
    let started = Instant::now();
    let lines = || std::fs::read_to_string(&partial).map_or(0, |text| text.lines().count());
    while lines() < 20 && started.elapsed() < Duration::from_mins(1) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let stopped = Instant::now();
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    let took = stopped.elapsed();
    println!("stopped within {took:?}");
    assert_eq!(output.status.code(), Some(130));
    assert!(String::from_utf8_lossy(&output.stderr).contains("stopped"));
    assert!(lines() >= 20 && !folder.path().join("results.csv").exists());
    // On a machine with nothing else to do it is below 0.2 s.
    assert!(took < Duration::from_secs(2), "{took:?}");
}

/// Rows stand in the order of the inputs, small and large ones and those that fail, and have the same
/// columns.
#[test]
fn rows_in_the_order_of_the_inputs() {
    let folder = tempfile::tempdir().unwrap();
    let large = "phantom:ball?radius=70";
    let mut inputs = balls(40);
    inputs.insert(7, "nowhere.nii".to_owned());
    inputs.insert(23, large.to_owned());
    let measured = |arguments: &[&str]| {
        let mut command = Command::new(BINARY);
        let done =
            command.current_dir(folder.path()).arg("measure").args(&inputs).args(arguments).output().unwrap();
        assert_eq!(done.status.code(), Some(1));
        String::from_utf8(done.stdout).unwrap()
    };
    let lines = measured(&["--format", "jsonl"]);
    let found: Vec<String> = lines
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap()["input"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(found, inputs);
    let table = measured(&["--format", "csv"]);
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let header: Vec<String> = rows.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(rows.records().map(Result::unwrap).count(), inputs.len());
    let one = Command::new(BINARY)
        .args(["measure", large, "--clip", "exclude", "--format", "csv"])
        .output()
        .unwrap();
    let one = String::from_utf8(one.stdout).unwrap();
    assert_eq!(one.lines().next().unwrap().split(',').collect::<Vec<_>>(), header);
}

/// A page goes to stdout where that is asked for.
#[test]
fn a_page_goes_to_stdout() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(BINARY);
    let arguments = ["report", "phantom:ball?radius=5", "-o", "-"];
    let output = command.current_dir(folder.path()).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stdout).contains("phantom:ball?radius=5"));
    assert!(documents(folder.path()).is_empty());
}
