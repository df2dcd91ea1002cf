//! Inputs that claim more than there is, or name what is no file: refused in words, at once, without taking
//! memory or waiting.

use std::path::Path;
use std::time::{Duration, Instant};
use surfometry::io::{ReadOptions, read_labels, read_labels_with, read_mesh};
use surfometry::phantoms::Phantom;
use surfometry::validation::Validation;
use surfometry::volume::{FieldImage, FieldValues, Grid, Mask};

#[track_caller]
fn says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in: {message}");
    }
}

fn meta(lines: &str) -> Vec<u8> {
    format!("ObjectType = Image\nNDims = 3\nDimSize = 4 5 6\n{lines}\n").into()
}

fn refusal(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    let start = Instant::now();
    let error = if surfometry::io::is_mesh(&path) {
        read_mesh(&path).map(drop).unwrap_err()
    } else {
        read_labels(&path).map(drop).unwrap_err()
    };
    assert!(start.elapsed() < Duration::from_secs(5), "{name}: {:?}", start.elapsed());
    error.to_string()
}

/// A header may name anything as the file of its voxels: a pipe that nobody writes to, a device without end,
/// a folder.
#[cfg(unix)]
#[test]
fn data_files_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let made = std::process::Command::new("mkfifo").arg(at("fifo.raw")).status().unwrap();
    assert!(made.success());
    std::os::unix::fs::symlink("/dev/zero", at("zero.raw")).unwrap();
    std::fs::create_dir(at("folder.raw")).unwrap();
    for (name, kind) in [("fifo", "a device or pipe"), ("zero", "a device or pipe"), ("folder", "a folder")] {
        let raw = format!("{name}.raw");
        let lines = format!("ElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = {raw}");
        let message = refusal(folder.path(), "a.mhd", meta(&lines));
        says(&message, &[&raw, kind, "not a file"]);
        for encoding in ["raw", "gzip", "bzip2"] {
            let header = format!(
                "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 5 6\nspacings: 1 1 1\nencoding: {encoding}\ndata file: {raw}\n\n"
            );
            says(&refusal(folder.path(), "a.nhdr", header), &[&raw, kind, "not a file"]);
        }
        // Of a pair the image is looked at before it is opened.
        let image = at("pair.img");
        let _ = std::fs::remove_file(&image);
        std::os::unix::fs::symlink(at(&raw), &image).unwrap();
        let mut header = vec![0u8; 348];
        header[..4].copy_from_slice(&348i32.to_le_bytes());
        [3i16, 4, 5, 6].iter().enumerate().for_each(|(i, n)| {
            header[40 + 2 * i..42 + 2 * i].copy_from_slice(&n.to_le_bytes());
        });
        header[70] = 2;
        header[344..348].copy_from_slice(b"ni1\0");
        says(&refusal(folder.path(), "pair.hdr", header), &["pair.img", kind]);
        let mesh = at("mesh.stl");
        let _ = std::fs::remove_file(&mesh);
        std::os::unix::fs::symlink(at(&raw), &mesh).unwrap();
        says(&read_mesh(&mesh).unwrap_err().to_string(), &["mesh.stl", kind]);
    }
}

#[test]
fn meshes_that_claim_more_than_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let binary = "ply\nformat binary_little_endian 1.0\n";
    let place = "property float x\nproperty float y\nproperty float z\n";
    let corners = "property list uchar int vertex_indices\n";
    for (header, words) in [
        (
            format!("{binary}element vertex 2000000000\nelement face 2000000000\nend_header\n"),
            "no x, y and z",
        ),
        (format!("{binary}element vertex 2000000000\n{place}end_header\n"), "2000000000 elements `vertex`"),
        (format!("{binary}element face 4000000000\n{corners}end_header\n"), "4000000000 elements `face`"),
        (format!("{binary}element face 2000000000\nend_header\n"), "no vertex_indices"),
        (
            format!("{binary}element edge 3000000000\nproperty int a\nend_header\n"),
            "elements `edge` of 4 bytes",
        ),
        (
            format!("ply\nformat ascii 1.0\nelement vertex 900000000\n{place}end_header\n1 2 3\n"),
            "elements `vertex` of 5 bytes",
        ),
        (
            "ply\nformat ascii 1.0\nelement edge 900000000\nend_header\n\n".to_owned(),
            "900000000 elements `edge`",
        ),
        // A list of 2^32 corners.
        (
            format!(
                "{binary}element face 1\nproperty list uint int vertex_indices\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}"
            ),
            "export",
        ),
    ] {
        says(&refusal(folder.path(), "a.ply", header), &[words, "export the mesh again"]);
    }
    // Elements without properties take no room, so that they may be as many as they like.
    let tetrahedron = format!(
        "{binary}element nothing 4000000000\nelement vertex 0\n{place}element face 0\n{corners}end_header\n"
    );
    let path = folder.path().join("b.ply");
    std::fs::write(&path, tetrahedron).unwrap();
    assert!(read_mesh(&path).unwrap().triangles.is_empty());
    let mut stl = vec![0u8; 80];
    stl.extend(u32::MAX.to_le_bytes());
    says(&refusal(folder.path(), "a.stl", stl), &["export the mesh again"]);
}

#[test]
fn headers_of_thousands_of_axes() {
    let folder = tempfile::tempdir().unwrap();
    let ones = "1 ".repeat(15_000);
    let none = "none ".repeat(14_997) + "(1,0,0) (0,1,0) (0,0,1)";
    for field in
        [format!("space directions: {none}"), format!("kinds: {}", "list ".repeat(15_000)), String::new()]
    {
        let header = format!(
            "NRRD0004\ntype: uint8\ndimension: 15000\nsizes: {ones}\n{field}\nencoding: raw\n\n\u{1}"
        );
        says(&refusal(folder.path(), "a.nrrd", header), &["15000 axes", "at most 16"]);
    }
    let header = format!(
        "NDims = 15000\nDimSize = {ones}\nElementSpacing = {ones}\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    );
    says(&refusal(folder.path(), "a.mha", header), &["15000 axes", "at most 10"]);
}

#[test]
fn images_that_no_machine_makes() {
    for spec in [
        "phantom:ball?radius=1e5",
        "phantom:ball?radius=1e300",
        "phantom:ball?shift=1e9,0,0",
        "phantom:torus?major=20000&minor=3",
        "phantom:ball?radius=10&spacing=1e-3,1e-3,1e-3",
    ] {
        let start = Instant::now();
        let refused = Phantom::from_spec(spec).map(drop).unwrap_err().to_string();
        says(&refused, &["voxels would take days to make", "coarser spacing"]);
        assert!(start.elapsed() < Duration::from_secs(5), "{spec}");
    }
}

/// A field's surface is the same at any scale, as far as numbers go.
#[test]
fn fields_of_any_size_or_a_refusal() {
    let grid = Grid::axis_aligned([20; 3], [1.0; 3]).unwrap();
    let distance = |offset: usize| {
        let square: f64 = grid.index_of(offset).iter().map(|&i| (i as f64 - 9.4).powi(2)).sum();
        square.sqrt() - 5.0
    };
    let field = |scale: f64| {
        let values = (0..8000).map(|i| scale * distance(i)).collect();
        FieldImage::new(grid, FieldValues::F64(values))
    };
    let area = |scale: f64| {
        let measured = surfometry::Measurement::default().thickness_mm(2.5).run_field(field(scale).unwrap());
        measured.unwrap().blurred.surface_area_mm2.unwrap()
    };
    let one = area(1.0);
    assert!((one / (4.0 * std::f64::consts::PI * 25.0) - 1.0).abs() < 0.02, "{one}");
    for scale in [1e28, 1e6, 1e-6, 1e-28] {
        assert!((area(scale) / one - 1.0).abs() < 1e-5, "{scale}: {}", area(scale));
    }
    for scale in [1e300, -1e300, 1e30, 1e38] {
        says(&field(scale).unwrap_err().to_string(), &["beyond 1e30", "scale the field"]);
    }
}

#[test]
fn a_shape_too_small_for_its_grid() {
    let cases = Validation {
        resolutions: vec![1.0],
        ratios: vec![1.0],
        poses: 1,
        shapes: vec!["ball".to_owned()],
        ..Validation::default()
    };
    says(&cases.run(|| {}).unwrap_err().to_string(), &["nothing is left", "larger"]);
}

/// A wish to see it read right, beside those that are refused: lengths are the header's spacing, whatever the
/// directions' are.
#[test]
fn directions_of_any_length() {
    let folder = tempfile::tempdir().unwrap();
    for length in [1.0, 2.0, 0.3] {
        let lines = format!(
            "ElementSpacing = 0.8 0.9 1.1\nTransformMatrix = 0 {length} 0 -{length} 0 0 0 0 {length}\nElementType = MET_UCHAR\nElementDataFile = LOCAL"
        );
        let path = folder.path().join("a.mha");
        std::fs::write(&path, [meta(&lines), vec![1; 120]].concat()).unwrap();
        let affine = *read_labels(&path).unwrap().grid().affine();
        assert_eq!(affine.column_lengths(), [0.8, 0.9, 1.1], "{length}");
        assert_eq!(affine.axis_codes(), "PRS");
    }
    // Half turns about x, and about the diagonal of x and y; and a quarter turn about z, which is no longer
    // than it should be.
    let half = 0.5f32.sqrt();
    for (quaternion, codes) in [
        ([1f32, 0.0, 0.0], "RPI"),
        ([2.0, 0.0, 0.0], "RPI"),
        ([0.71, 0.71, 0.0], "ARI"),
        ([1.0, 1.0, 0.0], "ARI"),
        ([0.0, 0.0, half], "ALS"),
    ] {
        let mut file = vec![0u8; 352];
        let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, &348i32.to_le_bytes());
        [3i16, 4, 5, 6].iter().enumerate().for_each(|(i, n)| put(40 + 2 * i, &n.to_le_bytes()));
        put(70, &2i16.to_le_bytes());
        [1f32, 0.5, 0.75, 1.25].iter().enumerate().for_each(|(i, v)| put(76 + 4 * i, &v.to_le_bytes()));
        put(108, &352f32.to_le_bytes());
        put(252, &1i16.to_le_bytes());
        quaternion.iter().enumerate().for_each(|(i, v)| put(256 + 4 * i, &v.to_le_bytes()));
        put(344, b"n+1\0");
        file.extend([1; 120]);
        let path = folder.path().join("a.nii");
        std::fs::write(&path, file).unwrap();
        let image = read_labels(&path).unwrap();
        for (found, stated) in image.grid().spacing().mm().iter().zip([0.5, 0.75, 1.25]) {
            assert!((found / stated - 1.0).abs() < 1e-7, "{quaternion:?}: {found}");
        }
        assert_eq!(image.grid().affine().axis_codes(), codes, "{quaternion:?}");
    }
}

/// MetaIO takes the first letter; anything else is refused rather than guessed.
#[test]
fn yes_and_no_in_metaimage() {
    let folder = tempfile::tempdir().unwrap();
    let labels = |yes: &str| {
        let header = format!(
            "NDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1\nBinaryDataByteOrderMSB = {yes}\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
        );
        let voxels: Vec<u8> = (0..8).flat_map(|n| [0, n]).collect();
        let path = folder.path().join("a.mha");
        std::fs::write(&path, [header.as_bytes(), &voxels].concat()).unwrap();
        read_labels(&path).map(|image| image.summaries().last().unwrap().label)
    };
    for (text, expected) in [
        ("True", 7),
        ("T", 7),
        ("t", 7),
        ("1", 7),
        ("TRUE", 7),
        ("False", 7 << 8),
        ("F", 7 << 8),
        ("0", 7 << 8),
    ] {
        assert_eq!(labels(text).unwrap(), expected, "{text}");
    }
    says(
        &labels("maybe").unwrap_err().to_string(),
        &["BinaryDataByteOrderMSB = maybe", "neither True nor False"],
    );
}

/// An image that is read, so that what is refused above is refused for its own fault.
#[test]
fn what_is_possible_is_read() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.raw"), [1; 120]).unwrap();
    let path = folder.path().join("a.mhd");
    std::fs::write(&path, meta("ElementType = MET_UCHAR\nElementDataFile = a.raw")).unwrap();
    let image = read_labels_with(&path, ReadOptions { spacing: Some([1.0; 3]) }).unwrap();
    let mask: Mask = image.mask(1);
    assert_eq!(mask.voxels(), 120);
}
