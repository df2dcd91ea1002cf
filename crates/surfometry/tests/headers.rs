//! Headers as other programs write them, and what a file is where it is not what its name says.

use std::io::Write;
use std::path::{Path, PathBuf};
use surfometry::io::{ReadOptions, read_labels, read_labels_with};
use surfometry::volume::LabelImage;
use tempfile::TempDir;

const DIMENSIONS: [usize; 3] = [4, 5, 6];
const SPACING: [f64; 3] = [0.8, 1.0, 1.5];

/// A block of 2 x 3 x 4 voxels of label 7.
fn voxels() -> Vec<u8> {
    let [nx, ny, nz] = DIMENSIONS;
    let inside = |x, y, z| (1..3).contains(&x) && (1..4).contains(&y) && (1..5).contains(&z);
    let index = |i| (i % nx, i / nx % ny, i / (nx * ny));
    (0..nx * ny * nz).map(index).map(|(x, y, z)| if inside(x, y, z) { 7 } else { 0 }).collect()
}

#[track_caller]
fn assert_block(image: &LabelImage) {
    assert_eq!(image.grid().dimensions(), DIMENSIONS);
    for (found, expected) in image.grid().spacing().mm().iter().zip(SPACING) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
    let block = &image.summaries()[0];
    assert_eq!((block.label, block.voxels), (7, 24));
    assert_eq!(block.bounds, surfometry::tiling::IndexBox::new([1, 1, 1], [3, 4, 5]));
}

struct Files(TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn put(&self, name: &str, parts: &[&[u8]]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, parts.concat()).unwrap();
        path
    }
}

fn refusal(path: &Path) -> String {
    read_labels(path).map(drop).expect_err(&path.display().to_string()).to_string()
}

fn nifti(magic: [u8; 4], dimensions: &[i16], pixdim: [f32; 3], datatype: i16) -> Vec<u8> {
    let mut header = vec![0u8; 352];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    put(40, &(dimensions.len() as i16).to_le_bytes());
    dimensions.iter().enumerate().for_each(|(i, n)| put(42 + 2 * i, &n.to_le_bytes()));
    put(70, &datatype.to_le_bytes());
    put(76, &1f32.to_le_bytes());
    pixdim.iter().enumerate().for_each(|(i, s)| put(80 + 4 * i, &s.to_le_bytes()));
    put(108, &352f32.to_le_bytes());
    put(344, &magic);
    header
}

const STATED: [f32; 3] = [0.8, 1.0, 1.5];

/// nibabel and ITK know a pair by its names.
#[test]
fn a_pair_is_one_by_its_names() {
    let files = Files::new();
    for (name, magic) in [("a", *b"n+1\0"), ("b", *b"ni1\0")] {
        let mut header = nifti(magic, &[4, 5, 6], STATED, 2);
        header[108..112].copy_from_slice(&0f32.to_le_bytes());
        files.put(&format!("{name}.hdr"), &[&header]);
        let image = files.put(&format!("{name}.img"), &[&voxels()]);
        assert_block(&read_labels(&image).unwrap());
        assert_block(&read_labels(image.with_extension("hdr")).unwrap());
    }
    // The offset of a file that holds both, in the header of a pair.
    files.put("c.hdr", &[&nifti(*b"n+1\0", &[4, 5, 6], STATED, 2)]);
    assert_block(&read_labels(files.put("c.img", &[&voxels()])).unwrap());
    // The magic of a pair in one file.
    assert_block(
        &read_labels(files.put("d.nii", &[&nifti(*b"ni1\0", &[4, 5, 6], STATED, 2), &voxels()])).unwrap(),
    );
}

#[test]
fn a_channel_in_front_is_named() {
    let files = Files::new();
    let header = nifti(*b"n+1\0", &[1, 4, 5, 6], [1.0, 0.8, 1.0], 2);
    let message = refusal(&files.put("a.nii", &[&header, &voxels()]));
    assert!(message.contains("channel") && message.contains("[4, 5, 6]"), "{message}");
    // An array has no spacings that could belong to other axes.
    for shape in ["(6, 5, 4)", "(1, 6, 5, 4)", "(6, 5, 4, 1)", "(1, 1, 6, 5, 4)", "(1, 6, 5, 4, 1)"] {
        let mut header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}");
        header += &" ".repeat(117 - header.len());
        let path = files.put("a.npy", &[b"\x93NUMPY\x01\x00\x76\x00", header.as_bytes(), b"\n", &voxels()]);
        assert_block(&read_labels_with(&path, ReadOptions { spacing: Some(SPACING) }).unwrap());
    }
}

#[test]
fn types_of_several_numbers_are_named() {
    let files = Files::new();
    for (datatype, name) in
        [(128, "RGB24"), (2304, "RGBA32"), (32, "complex64"), (1, "one bit"), (1536, "float128")]
    {
        let message =
            refusal(&files.put("a.nii", &[&nifti(*b"n+1\0", &[4, 5, 6], STATED, datatype), &voxels()]));
        assert!(message.contains(name) && message.contains("convert"), "{message}");
    }
}

/// ITK writes images of one time point with a space of four dimensions.
#[test]
fn a_space_of_four_dimensions() {
    let files = Files::new();
    for space in ["space dimension: 4", "space: left-posterior-superior-time"] {
        let header = format!(
            "NRRD0004\ntype: uchar\ndimension: 4\n{space}\nsizes: 4 5 6 1\nspace directions: (0.8,0,0,0) (0,1,0,0) (0,0,1.5,0) (0,0,0,1)\n\
             encoding: raw\nspace origin: (0,0,0,0)\n\n"
        );
        assert_block(&read_labels(files.put("a.nrrd", &[header.as_bytes(), &voxels()])).unwrap());
    }
}

#[test]
fn units_in_every_spelling_and_unknown_ones() {
    let files = Files::new();
    let nrrd = |unit: &str, scale: f64| {
        let [x, y, z] = SPACING.map(|s| s * scale);
        let header = format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 5 6\nspace dimension: 3\nspace directions: ({x},0,0) (0,{y},0) (0,0,{z})\n\
             space units: \"{unit}\" \"{unit}\" \"{unit}\"\nencoding: raw\n\n"
        );
        files.put("a.nrrd", &[header.as_bytes(), &voxels()])
    };
    let meta = |unit: &str, scale: f64| {
        let [x, y, z] = SPACING.map(|s| s * scale);
        let header = format!(
            "NDims = 3\nDimSize = 4 5 6\nElementSpacing = {x} {y} {z}\nDistanceUnits = {unit}\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
        );
        files.put("a.mha", &[header.as_bytes(), &voxels()])
    };
    for (unit, scale) in [
        ("mm", 1.0),
        ("Millimetres", 1.0),
        ("Microns", 1e3),
        ("µm", 1e3),
        ("UM", 1e3),
        ("Metre", 1e-3),
        ("inches", 1.0 / 25.4),
    ] {
        assert_block(&read_labels(nrrd(unit, scale)).unwrap());
        assert_block(&read_labels(meta(unit, scale)).unwrap());
    }
    for unit in ["pixel", "s", "ms"] {
        for path in [nrrd(unit, 3.0), meta(unit, 3.0)] {
            let message = refusal(&path);
            let told = [&*format!("`{unit}`"), "say what the voxel spacing is"];
            assert!(told.iter().all(|words| message.contains(words)), "{message}");
            assert_block(&read_labels_with(&path, ReadOptions { spacing: Some(SPACING) }).unwrap());
        }
    }
}

#[test]
fn values_that_round_to_nothing_are_told() {
    let files = Files::new();
    let faint: Vec<u8> = voxels().iter().flat_map(|v| (f32::from(*v) * 1e-5).to_le_bytes()).collect();
    let message = refusal(&files.put("a.nii", &[&nifti(*b"n+1\0", &[4, 5, 6], STATED, 16), &faint]));
    assert!(message.contains("the largest value is 7.00e-5") && message.contains("threshold"), "{message}");
    // Beside a label they are what scale factors leave.
    let noisy: Vec<u8> = voxels().iter().flat_map(|v| (f32::from(*v) + 1e-5).to_le_bytes()).collect();
    assert_block(
        &read_labels(files.put("b.nii", &[&nifti(*b"n+1\0", &[4, 5, 6], STATED, 16), &noisy])).unwrap(),
    );
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn bzip2(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Whatever is compressed as a whole is read as if it were not; a flipped bit is refused.
#[test]
fn any_file_may_be_packed() {
    let files = Files::new();
    let meta = "NDims = 3\nDimSize = 4 5 6\nElementSpacing = 0.8 1 1.5\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    let nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 5 6\nspacings: 0.8 1 1.5\nencoding: raw\n\n";
    let whole = [
        ("a.mha", [meta.as_bytes(), &voxels()].concat()),
        ("a.nrrd", [nrrd.as_bytes(), &voxels()].concat()),
        ("a.nii", [&nifti(*b"n+1\0", &[4, 5, 6], STATED, 2)[..], &voxels()].concat()),
    ];
    for (name, bytes) in whole {
        assert_block(&read_labels(files.put(name, &[&bytes])).unwrap());
        for (ending, packed) in [("gz", gzip(&bytes)), ("bz2", bzip2(&bytes))] {
            assert_block(&read_labels(files.put(&format!("{name}.{ending}"), &[&packed])).unwrap());
            let mut damaged = packed.clone();
            let last = damaged.len() - 6;
            damaged[last] ^= 4;
            let message = refusal(&files.put(&format!("{name}.{ending}"), &[&damaged]));
            assert!(message.contains("damaged"), "{name}.{ending}: {message}");
        }
    }
    let twice = nrrd.replace("raw", "gzip");
    let message = refusal(&files.put("b.nrrd.gz", &[&gzip(&[twice.as_bytes(), &gzip(&voxels())].concat())]));
    assert!(message.contains("gunzip"), "{message}");
}

#[test]
fn a_file_is_named_for_what_it_is() {
    let files = Files::new();
    let mut dicom = vec![0u8; 128];
    dicom.extend(b"DICM\x02\0\0\0UL\x04\0");
    let padding = [0u8; 600];
    for (content, words) in [
        (&b"PK\x03\x04..."[..], "ZIP"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\n", "git lfs pull"),
        (b"\n<!DOCTYPE html><html>", "HTML"),
        (b"\x89HDF\r\n\x1a\n", "HDF5"),
        (&dicom, "DICOM"),
        (b"%PDF-1.7", "PDF"),
    ] {
        for name in ["a.nii.gz", "a.nii", "a.mha", "a.nrrd", "a.npy", "a.unknown"] {
            let message = refusal(&files.put(name, &[content, &padding]));
            assert!(message.contains(words), "{name}: {message}");
        }
    }
    // One of ours under another's name.
    let message = refusal(&files.put("b.mha", &[b"NRRD0004\ntype: uchar\n\n"]));
    assert!(message.contains("NRRD") && message.contains("MetaImage"), "{message}");
}

/// Sizes whose product no number holds, of slices in files of their own.
#[test]
fn sizes_beyond_all_numbers_in_many_files() {
    let files = Files::new();
    let huge = "4294967296 4294967296";
    let nrrd = format!(
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {huge} 2\nspacings: 1 1 1\nencoding: raw\ndata file: LIST\na.raw\nb.raw\n"
    );
    let meta = format!(
        "NDims = 3\nDimSize = {huge} 2\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LIST\na.raw\nb.raw\n"
    );
    for (name, header) in [("a.nhdr", nrrd), ("a.mhd", meta)] {
        let message = refusal(&files.put(name, &[header.as_bytes()]));
        assert!(message.contains("4294967296"), "{name}: {message}");
    }
}

/// A field that stands in a header twice says two things, and one is wrong; the same twice is one.
#[test]
fn fields_and_segments_that_are_there_twice() {
    let files = Files::new();
    let nrrd = |more: &str| {
        let header = format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 5 6\nspacings: 0.8 1 1.5\n{more}encoding: raw\n\n"
        );
        files.put("a.seg.nrrd", &[header.as_bytes(), &voxels()])
    };
    assert_block(&read_labels(nrrd("Spacings: 0.8 1 1.5\n")).unwrap());
    let message = refusal(&nrrd("spacings: 8 1 1.5\n"));
    assert!(message.contains("`spacings` stands there twice, as `0.8 1 1.5` and as `8 1 1.5`"), "{message}");
    let segment = |number: i32, name: &str, value: i32| {
        format!(
            "Segment{number}_Name:={name}\nSegment{number}_LabelValue:={value}\nSegment{number}_Layer:=0\n"
        )
    };
    let message = refusal(&nrrd(&(segment(0, "liver", 7) + &segment(1, "spleen", 7))));
    assert!(
        message.contains("segments `liver` and `spleen` have the same LabelValue 7 in layer 0"),
        "{message}"
    );
    assert_block(&read_labels(nrrd(&(segment(0, "liver", 7) + &segment(1, "spleen", 8)))).unwrap());
}

/// Shapes whose product no number holds, sizes that are none, and brackets without end: npy headers are Python's.
#[test]
fn arrays_of_absurd_shapes() {
    let files = Files::new();
    let read = |fields: &str| {
        let (header, length) = (fields.as_bytes(), (fields.len() as u32).to_le_bytes());
        let path = files.put("a.npy", &[b"\x93NUMPY\x02\0", &length, header, &voxels()]);
        read_labels_with(path, ReadOptions { spacing: Some(SPACING) }).map_err(|error| error.to_string())
    };
    let shape = |shape: &str| format!("{{'descr': '|u1', 'fortran_order': True, 'shape': {shape}, }}");
    let most = u64::MAX;
    for (fields, words) in [
        (shape(&format!("({most}, {most}, {most})")), "voxels"),
        (shape(&format!("({most}, 2, 2, {most})")), "volumes or channels"),
        (shape("(340282366920938463463374607431768211456, 5, 6)"), "where sizes of axes are expected"),
        (shape("(4, -5, 6)"), "where sizes of axes are expected"),
        (shape("(4, 5.0, 6)"), "where sizes of axes are expected"),
        (shape("'4, 5, 6'"), "where sizes of axes are expected"),
        ("(".repeat(60_000), "brackets in brackets"),
        (" ".repeat(70_000), "longer one than arrays of numbers"),
        ("[1, 2]".to_owned(), "no dictionary: [1, 2]"),
        ("{'descr': '|u1', 'shape': (4, 5, 6)}".to_owned(), "no 'fortran_order'"),
        (
            "{'descr': '|u1', 'fortran_order': 1, 'shape': (4, 5, 6)}".to_owned(),
            "where True or False is expected",
        ),
        (
            "{'descr': [('a', '<u2')], 'fortran_order': True, 'shape': (4, 5, 6)}".to_owned(),
            "NumPy [('a', '<u2')]",
        ),
        ("{'descr': '<U3', 'fortran_order': True, 'shape': (4, 5, 6)}".to_owned(), "NumPy '<U3'"),
    ] {
        let message = read(&fields).map(drop).unwrap_err();
        assert!(message.contains(words), "`{words}` is missing in: {message}");
    }
    assert_block(&read(&shape("(4, 5, 6)")).unwrap());
}
