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
