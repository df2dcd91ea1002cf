//! `--raw`: files without a header.

use std::path::Path;
use std::process::{Command, Output};

fn surfometry(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).args(arguments).current_dir(folder).output().unwrap()
}

/// Big-endian shorts behind seven bytes: a box of 3 x 4 x 5 voxels of 0.5 x 0.75 x 2 mm.
fn bytes() -> Vec<u8> {
    let inside =
        |i: usize| (2..5).contains(&(i % 8)) && (2..6).contains(&(i / 8 % 9)) && (2..7).contains(&(i / 72));
    let voxels = (0..8 * 9 * 10).flat_map(|i| (if inside(i) { 300i16 } else { 0 }).to_be_bytes());
    b"abcdefg".iter().copied().chain(voxels).collect()
}

#[test]
fn what_is_said_is_read() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.raw"), bytes()).unwrap();
    let options = ["info", "a.raw", "--raw", "8x9x10:int16:big:7", "--spacing", "0.5,0.75,2", "--json"];
    let done = surfometry(&options, folder.path());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let document: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    let label = &document[0]["labels"][0];
    assert_eq!((label["label"].as_i64(), label["voxels"].as_i64()), (Some(300), Some(60)));
    assert_eq!(label["volume_mm3"].as_f64(), Some(60.0 * 0.75));
    assert_eq!(label["bounding_box"], serde_json::json!([[2, 2, 2], [4, 5, 6]]));
}

#[test]
fn what_does_not_fit_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.raw"), bytes()).unwrap();
    let said = |options: &[&str], status: i32| {
        let done = surfometry(&[&["info", "a.raw"], options].concat(), folder.path());
        assert_eq!(done.status.code(), Some(status));
        String::from_utf8(done.stdout).unwrap() + &String::from_utf8(done.stderr).unwrap()
    };
    assert!(said(&[], 1).contains("--raw XxYxZ:TYPE"));
    assert!(said(&["--raw", "8x9x10:int16:big:7"], 1).contains("--spacing"));
    assert!(
        said(&["--raw", "8x9x11:int16", "--spacing", "1,1,1"], 1).contains("end after 1447 of 1584 bytes")
    );
    assert!(said(&["--raw", "8x9x9:int16", "--spacing", "1,1,1"], 0).contains("151 bytes more"));
    assert!(said(&["--raw", "8x9x9:short", "--spacing", "1,1,1"], 2).contains("uint8 to uint64"));
}
