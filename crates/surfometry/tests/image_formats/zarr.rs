//! Zarr arrays that are not compressed, and OME's words about them.

use crate::{SIZE, SPACING, assert_read, assert_refused, voxels};
use std::fs;
use std::path::Path;
use surfometry::inputs::{OpenOptions, open};
use surfometry::volume::Affine;

/// Chunks of the whole image but for z, of which they have four: the last one goes beyond it.
fn array(folder: &Path, version: u8) {
    let [nx, ny, nz] = SIZE;
    let slice = nx * ny;
    fs::create_dir_all(folder.join("c")).unwrap();
    let metadata = if version == 2 {
        let text = r#"{"zarr_format": 2, "shape": [6, 5, 7], "chunks": [4, 5, 7], "dtype": "|u1", "compressor": null, "filters": null, "fill_value": 0, "order": "C"}"#;
        (".zarray", text.to_owned())
    } else {
        let text = r#"{"zarr_format": 3, "node_type": "array", "shape": [6, 5, 7], "data_type": "uint8", "fill_value": 0, "codecs": [{"name": "bytes"}],
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [4, 5, 7]}}, "chunk_key_encoding": {"name": "default", "configuration": {"separator": "."}}}"#;
        ("zarr.json", text.to_owned())
    };
    fs::write(folder.join(metadata.0), metadata.1).unwrap();
    let mut padded = voxels();
    padded.resize(8 * slice, 0);
    assert_eq!(nz, 6);
    for (number, chunk) in padded.chunks(4 * slice).enumerate() {
        let name = if version == 2 { format!("{number}.0.0") } else { format!("c.{number}.0.0") };
        fs::write(folder.join(name), chunk).unwrap();
    }
    fs::remove_dir(folder.join("c")).unwrap();
}

const IMAGE: &str = r#""multiscales": [{"axes": [
    {"name": "z", "type": "space", "unit": "millimeter"}, {"name": "y", "type": "space", "unit": "um"}, {"name": "x", "type": "space", "unit": "micrometer"}],
    "datasets": [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 750, 500]}, {"type": "translation", "translation": [2, 1000, 0]}]}],
    "coordinateTransformations": [{"type": "scale", "scale": [2, 1, 1]}]}],
    "image-label": {"properties": [{"label-value": 1, "name": " femur "}]}"#;

fn group(folder: &Path, version: u8, attributes: &str) {
    if version == 2 {
        fs::write(folder.join(".zgroup"), r#"{"zarr_format": 2}"#).unwrap();
        fs::write(folder.join(".zattrs"), format!("{{{attributes}}}")).unwrap();
    } else {
        let text = format!(
            r#"{{"zarr_format": 3, "node_type": "group", "attributes": {{"ome": {{"version": "0.5", {attributes}}}}}}}"#
        );
        fs::write(folder.join("zarr.json"), text).unwrap();
    }
}

#[test]
fn images_of_both_versions() {
    for version in [2, 3] {
        let folder = tempfile::tempdir().unwrap();
        array(&folder.path().join("0"), version);
        assert_read(&folder.path().join("0"), Some(SPACING), 1, Affine::diagonal(SPACING));
        assert_refused(&folder.path().join("0"), &["no voxel spacing"]);
        group(folder.path(), version, IMAGE);
        // The transformations of a resolution come first, those of all behind them; each axis has its unit.
        let affine = Affine { origin: [0.0, 1.0, 4.0], ..Affine::diagonal(SPACING) };
        for path in [folder.path().to_owned(), folder.path().join("0")] {
            assert_read(&path, None, 1, affine);
            let source = open(path.to_str().unwrap(), &OpenOptions::default()).unwrap();
            assert_eq!(source.label_names().get(&1).map(String::as_str), Some("femur"));
        }
    }
}

/// JSON has one kind of number: 1.0 is 1 and names the same label.
#[test]
fn whole_numbers_with_a_point() {
    let folder = tempfile::tempdir().unwrap();
    array(&folder.path().join("0"), 2);
    let colours = r#""image-label": {"colors": [{"label-value": 1.0, "rgba": [255.0, 16, 0, 255]}, {"label-value": 1.5, "rgba": [1, 1, 1, 1]}], "#;
    let attributes =
        IMAGE.replace("\"label-value\": 1,", "\"label-value\": 1.0,").replace("\"image-label\": {", colours);
    group(folder.path(), 2, &attributes);
    let table = open(folder.path().to_str().unwrap(), &OpenOptions::default()).unwrap().label_table();
    let femur = surfometry::volume::LabelGroup::single(1);
    assert_eq!(table.name_of(&femur).as_deref(), Some("femur"));
    assert_eq!(table.colour_of(&femur), Some([255, 16, 0]));
    assert_eq!(table.names().len(), 1);
}

/// All that an image is read from: metadata of groups on the way, of the array, and each chunk.
#[test]
fn files_that_an_image_rests_on() {
    let folder = tempfile::tempdir().unwrap();
    // The temporary folder may be a link.
    let folder = folder.path().canonicalize().unwrap();
    group(&folder, 2, "");
    let labels = folder.join("labels");
    fs::create_dir_all(labels.join("bones")).unwrap();
    group(&labels, 2, r#""labels": ["bones"]"#);
    group(&labels.join("bones"), 2, IMAGE);
    array(&labels.join("bones/0"), 2);
    let of_image = ["bones/.zgroup", "bones/.zattrs", "bones/0/.zarray", "bones/0/0.0.0", "bones/0/1.0.0"];
    let of_labels = [&[".zgroup", ".zattrs"], &of_image[..]].concat();
    for (named, expected) in [("", &of_labels[..]), ("bones", &of_image[..]), ("bones/0", &of_image[..])] {
        let name = labels.join(named).to_str().unwrap().trim_end_matches('/').to_owned();
        let files = open(&name, &OpenOptions::default()).unwrap().files();
        let expected: Vec<_> = expected.iter().map(|file| labels.join(file)).collect();
        assert_eq!(files, expected, "{name}");
    }
}

#[test]
fn what_is_not_meant_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |attributes: &str, words: &[&str]| {
        group(folder.path(), 3, attributes);
        assert_refused(folder.path(), words);
    };
    array(&folder.path().join("0"), 3);
    refused(r#""plate": {}"#, &["a plate"]);
    refused(
        &IMAGE.replace("\"scale\": [2, 1, 1]", "\"scale\": [2, 1]"),
        &["a scale without a number for each of 3 axes"],
    );
    refused(
        &IMAGE.replace("\"type\": \"scale\", \"scale\": [2, 1, 1]", "\"type\": \"affine\""),
        &["`affine`"],
    );
    refused(
        &IMAGE.replace("\"name\": \"z\", \"type\": \"space\"", "\"name\": \"t\", \"type\": \"time\""),
        &["t = 6"],
    );
    refused(&IMAGE.replace("\"path\": \"0\"", "\"path\": \"../0\""), &["leads out of the image"]);
    refused(&IMAGE.replace("\"um\"", "\"parsec\""), &["`parsec`"]);
    refused(r#""labels": ["a", "b"]"#, &["2 sets of labels"]);
    let text = r#"{"zarr_format": 3, "node_type": "group", "attributes": {"ome": {"version": "0.6.dev2"}}}"#;
    fs::write(folder.path().join("zarr.json"), text).unwrap();
    assert_refused(folder.path(), &["OME-Zarr 0.6.dev2", "up to 0.5"]);
    group(folder.path(), 3, IMAGE);
    fs::write(folder.path().join("0/c.1.0.0"), [1; 9]).unwrap();
    assert_refused(folder.path(), &["damaged"]);
    let huge = fs::read_to_string(folder.path().join("0/zarr.json"))
        .unwrap()
        .replace("[4, 5, 7]", "[400000, 500000, 7]");
    fs::write(folder.path().join("0/zarr.json"), huge).unwrap();
    assert_refused(folder.path(), &["save the array in smaller ones"]);
}

/// An array of these sizes, in version 3 with its chunks in folders.
fn empty_array(folder: &Path, shape: [usize; 3], chunks: [usize; 3], fill: u8) {
    let text = format!(
        r#"{{"zarr_format": 3, "node_type": "array", "shape": {shape:?}, "data_type": "uint8", "fill_value": {fill}, "codecs": [{{"name": "bytes"}}],
        "chunk_grid": {{"name": "regular", "configuration": {{"chunk_shape": {chunks:?}}}}}, "chunk_key_encoding": {{"name": "default"}}}}"#
    );
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("zarr.json"), text).unwrap();
}

fn put_chunk(folder: &Path, key: &str, bytes: &[u8]) {
    let path = folder.join(key);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

/// What is not stored has the fill value and costs nothing, however many chunks that is: 27 million here.
#[test]
fn chunks_that_are_not_stored() {
    let folder = tempfile::tempdir().unwrap();
    empty_array(folder.path(), [300; 3], [1; 3], 0);
    assert_refused(folder.path(), &["none of its 27000000 chunks", "copied"]);
    // Of no array, and beyond this one.
    put_chunk(folder.path(), "c/7/9", &[1]);
    put_chunk(folder.path(), "c/7/8/300", &[1]);
    put_chunk(folder.path(), "c/7/8/9.tmp", &[1]);
    assert_refused(folder.path(), &["none of its 27000000 chunks"]);
    for (key, value) in [("c/7/8/9", 3), ("c/299/0/1", 5)] {
        put_chunk(folder.path(), key, &[value]);
    }
    let start = std::time::Instant::now();
    let options = surfometry::io::ReadOptions { spacing: Some(SPACING) };
    let image = surfometry::io::read_labels_with(folder.path(), options).unwrap();
    assert_eq!((image.get([9, 8, 7]), image.get([1, 0, 299])), (3, 5));
    assert_eq!(image.summaries().iter().map(|label| label.voxels).sum::<u64>(), 2);
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
    // Another fill value, in chunks that go beyond the array and are cut at every side.
    empty_array(folder.path(), [9, 7, 5], [4, 3, 2], 6);
    fs::remove_dir_all(folder.path().join("c")).unwrap();
    put_chunk(folder.path(), "c/2/2/2", &(1..=24).collect::<Vec<u8>>());
    put_chunk(folder.path(), "c/0/1/1", &(101..=124).collect::<Vec<u8>>());
    let image = surfometry::io::read_labels_with(folder.path(), options).unwrap();
    for i in 0..9 * 7 * 5 {
        let [x, y, z] = [i % 5, i / 5 % 7, i / 35];
        let in_chunk = 1 + (x % 2 + 2 * (y % 3) + 6 * (z % 4)) as i64;
        let expected = match [x / 2, y / 3, z / 4] {
            [2, 2, 2] => in_chunk,
            [1, 1, 0] => 100 + in_chunk,
            _ => 6,
        };
        assert_eq!(image.get([x, y, z]), expected, "{x} {y} {z}");
    }
}

/// A slice that fills the memory, an image that takes hours, and a chunk that cannot be so large.
#[test]
fn more_voxels_than_are_stored() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |words: &[&str]| {
        let options = surfometry::io::ReadOptions { spacing: Some(SPACING) };
        let said = surfometry::io::read_labels_with(folder.path(), options).unwrap_err().to_string();
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    };
    for (shape, chunks, bytes) in [([100_000; 3], [100; 3], 1_000_000), ([2_000; 3], [10; 3], 1_000)] {
        empty_array(folder.path(), shape, chunks, 0);
        put_chunk(folder.path(), "c/0/0/0", &vec![1; bytes]);
        refused(&[&format!("claims {} x", shape[0]), &format!("and {bytes} bytes are stored")]);
    }
    empty_array(folder.path(), [1_000; 3], [1_000; 3], 0);
    refused(&["c/0/0/0: 1000 bytes", "cannot be a chunk of 1000000000 bytes"]);
}

/// A pipe that nobody writes to, in the place of a chunk or of metadata, is not waited for.
#[cfg(unix)]
#[test]
fn pipes_in_an_array() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = |key: &str| {
        let path = folder.path().join(key);
        let _ = fs::remove_file(&path);
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    };
    array(folder.path(), 2);
    pipe("1.0.0");
    assert_refused(folder.path(), &["1.0.0: a device or pipe, not a file"]);
    fs::remove_file(folder.path().join("1.0.0")).unwrap();
    pipe(".zattrs");
    assert_refused(folder.path(), &[".zattrs: a device or pipe, not a file"]);
}
