//! Each kind of bad input once: the error says what is wrong and what to do, and nothing panics.

use proptest::prelude::*;
use std::path::{Path, PathBuf};
use surfometry::Measurement;
use surfometry::io::{ReadError, ReadOptions, read_field, read_labels, read_labels_with, write_labels};
use surfometry::measurement::{Derivatives, EmbeddingKind, MeasureError};
use surfometry::phantoms::{Ball, Phantom, Pose};
use surfometry::volume::{FieldImage, FieldValues, Grid, LabelSelection, Mask, VolumeError};

/// A small NIfTI-1 header: bytes at offsets are then replaced to make it bad.
fn nifti(dim: [i16; 8], datatype: i16, voxels: &[u8]) -> Vec<u8> {
    let mut file = vec![0u8; 352];
    file[..4].copy_from_slice(&348i32.to_le_bytes());
    dim.iter().enumerate().for_each(|(i, d)| put(&mut file, 40 + 2 * i, &d.to_le_bytes()));
    put(&mut file, 70, &datatype.to_le_bytes());
    (0..4).for_each(|i| put(&mut file, 76 + 4 * i, &1f32.to_le_bytes()));
    put(&mut file, 108, &352f32.to_le_bytes());
    put(&mut file, 344, b"n+1\0");
    file.extend(voxels);
    file
}

fn put(file: &mut [u8], offset: usize, bytes: &[u8]) {
    file[offset..offset + bytes.len()].copy_from_slice(bytes);
}

const CUBE: [i16; 8] = [3, 4, 4, 4, 1, 1, 1, 1];

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// The error of reading a file with the given bytes and name.
fn refusal(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), name, bytes);
    read_labels(path).expect_err(name).to_string()
}

fn assert_says(message: &str, words: &[&str]) {
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in: {message}");
    }
}

#[test]
fn files_that_are_none() {
    let missing = read_labels("/nowhere/missing.nii").unwrap_err().to_string();
    assert_says(&missing, &["/nowhere/missing.nii", "No such file"]);
    assert_says(&refusal("a.nii", b""), &["empty", "export it again"]);
    assert_says(&refusal("a.xyz", b"x"), &["names no format", ".nrrd"]);
    assert_says(&refusal("a.jpg", b"x"), &["JPEG", "PNG or TIFF"]);
    assert_says(&refusal("a.nii", b"short"), &["ends after 5 bytes"]);
    assert_says(&refusal("a.nii", vec![7u8; 400]), &["sizeof_hdr", "not NIfTI"]);
    assert_says(&refusal("a.nrrd", b"something else"), &["no NRRD magic"]);
    assert_says(&refusal("a.mha", b"no equals sign\n"), &["not MetaImage"]);
    assert_says(&refusal("a.npy", b"not numpy at all"), &["NumPy"]);
    let folder = tempfile::tempdir().unwrap();
    assert_says(&read_labels(folder.path()).unwrap_err().to_string(), &["a folder"]);
}

#[test]
fn shapes_that_are_not_one_volume() {
    assert_says(
        &refusal("a.nii", nifti([2, 8, 8, 1, 1, 1, 1, 1], 2, &[1; 64])),
        &["3-D", "stack the slices"],
    );
    assert_says(&refusal("a.nii", nifti([3, 8, 8, 1, 1, 1, 1, 1], 2, &[1; 64])), &["3-D"]);
    assert_says(
        &refusal("a.nii", nifti([4, 4, 4, 4, 3, 1, 1, 1], 2, &[1; 192])),
        &["3 volumes", "a file of its own"],
    );
    assert_says(&refusal("a.nii", nifti([3, 4, 0, 4, 1, 1, 1, 1], 2, &[])), &["without voxels"]);
    assert_says(&refusal("a.nii", nifti([3, 4, -4, 4, 1, 1, 1, 1], 2, &[])), &["dim[2] is -4", "damaged"]);
    assert_says(&refusal("a.nii", nifti([9, 4, 4, 4, 1, 1, 1, 1], 2, &[])), &["dim[0] is 9"]);
    assert_says(&refusal("a.nii", nifti(CUBE, 128, &[1; 192])), &["datatype 128", "convert"]);
}

#[test]
fn data_that_the_header_promises_and_the_file_lacks() {
    assert_says(&refusal("a.nii", nifti(CUBE, 2, &[1; 63])), &["after 63 of 64 bytes", "truncated"]);
    let huge = [3, 32_767, 32_767, 32_767, 1, 1, 1, 1];
    assert_says(&refusal("a.nii", nifti(huge, 64, &[1; 64])), &["truncated"]);
    // Compressed, the size is unknown before it is read, a slab at a time: its end is what is found.
    let gz = gzip(&nifti([3, 512, 512, 512, 1, 1, 1, 1], 64, &[1; 64]));
    assert_says(&refusal("a.nii.gz", gz), &["after 64 of", "truncated"]);
    // Unless nothing compresses so well.
    let gz = gzip(&nifti(huge, 64, &[1; 64]));
    assert_says(&refusal("a.nii.gz", gz), &["32767 x 32767 x 32767 voxels", "are stored"]);
    let mut cut = gzip(&nifti(CUBE, 2, &pseudo_random()));
    cut.truncate(cut.len() - 20);
    assert_says(&refusal("a.nii.gz", cut), &["of 64 bytes", "truncated"]);
    let mut damaged = gzip(&nifti(CUBE, 2, &pseudo_random()));
    let end = damaged.len() - 6;
    damaged[end] ^= 0xff;
    damaged[end - 20] ^= 0xff;
    assert_says(&refusal("a.nii.gz", damaged), &["again"]);
    let header =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1000 1000 1000\nspacings: 1 1 1\nencoding: gzip\n\n";
    assert_says(&refusal("a.nrrd", header), &["after 0 of", "truncated"]);
}

fn pseudo_random() -> Vec<u8> {
    (0..64u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn spacings_and_affines_without_sense() {
    for (value, words) in
        [(0f32, "is 0 mm"), (-2.0, "is -2 mm"), (f32::NAN, "is NaN mm"), (f32::INFINITY, "is inf mm")]
    {
        let mut file = nifti(CUBE, 2, &[1; 64]);
        put(&mut file, 84, &value.to_le_bytes());
        assert_says(&refusal("a.nii", &file), &[words, "say what"]);
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), "a.nii", file);
        let repaired = read_labels_with(path, ReadOptions { spacing: Some([1.0, 2.0, 3.0]) }).unwrap();
        assert_eq!(repaired.grid().spacing().mm(), [1.0, 2.0, 3.0]);
    }
    let mut sheared = nifti(CUBE, 2, &[1; 64]);
    put(&mut sheared, 254, &1i16.to_le_bytes());
    for (offset, value) in [(280, 1f32), (284, 0.2), (300, 1.0), (320, 1.0)] {
        put(&mut sheared, offset, &value.to_le_bytes());
    }
    assert_says(&refusal("a.nii", &sheared), &["sheared", "axes 0 and 1", "resample"]);
    let negative = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nspacings: 1 -1 1\nencoding: raw\n\n";
    assert_says(&refusal("a.nrrd", negative.to_owned() + &"\u{1}".repeat(64)), &["is -1 mm", "positive"]);
    let none = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n";
    assert_says(
        &refusal("a.nrrd", none.to_owned() + &"\u{1}".repeat(64)),
        &["no voxel spacing", "say what it is"],
    );
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "a.nrrd", none.to_owned() + &"\u{1}".repeat(64));
    let with = |spacing| read_labels_with(&path, ReadOptions { spacing: Some(spacing) });
    assert_eq!(with([1.0, 2.0, 3.0]).unwrap().grid().spacing().mm(), [1.0, 2.0, 3.0]);
    assert!(matches!(
        with([1.0, 0.0, 3.0]),
        Err(ReadError::Volume(VolumeError::InvalidSpacing { axis: 1, .. }))
    ));
}

#[test]
fn voxels_that_are_no_labels() {
    let floats = |value: f32| -> Vec<u8> {
        (0..64).flat_map(|i| if i == 5 { value } else { 1.0 }.to_le_bytes()).collect()
    };
    assert_says(&refusal("a.nii", nifti(CUBE, 16, &floats(0.5))), &["[1, 1, 0]", "0.5", "given"]);
    assert_says(&refusal("a.nii", nifti(CUBE, 16, &floats(f32::NAN))), &["[1, 1, 0]", "NaN"]);
    assert_says(&refusal("a.nii", nifti(CUBE, 16, &floats(f32::INFINITY))), &["inf"]);
}

#[test]
fn labels_that_are_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(
        folder.path(),
        "a.nii",
        nifti(CUBE, 2, &pseudo_random().iter().map(|v| v % 3).collect::<Vec<_>>()),
    );
    let image = read_labels(path).unwrap();
    let missing = "7".parse::<LabelSelection>().unwrap().resolve(&image).unwrap_err();
    assert_says(&missing.to_string(), &["no label 7", "it holds 1, 2"]);
    let path = write(folder.path(), "b.nii", nifti(CUBE, 2, &[0; 64]));
    let empty = LabelSelection::All.resolve(&read_labels(path).unwrap()).unwrap_err();
    assert_eq!(empty, VolumeError::NoForeground);
}

fn ball() -> Mask {
    Phantom::new(Ball { radius: 6.0 }, Pose::new([0.0; 3], [0.2; 3]), [1.0; 3])
        .unwrap()
        .labels()
        .unwrap()
        .mask(1)
}

#[test]
fn parameters_without_sense() {
    let m = Measurement::default();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(m.sigma_mm(bad).run(ball()), Err(MeasureError::OutOfRange { name: "sigma", .. })));
        assert!(matches!(m.thickness_mm(bad).run(ball()), Err(MeasureError::OutOfRange { .. })));
        assert!(matches!(m.epsilon(bad).run(ball()), Err(MeasureError::OutOfRange { .. })));
        assert!(matches!(m.level(bad).run(ball()), Err(MeasureError::OutOfRange { .. })));
    }
    assert!(matches!(m.level(1.0).run(ball()), Err(MeasureError::OutOfRange { .. })));
    assert!(matches!(m.thickness_mm(1.0).epsilon(0.1).run(ball()), Err(MeasureError::Conflict(_))));
    let distance = m.embedding(EmbeddingKind::Distance).derivatives(Derivatives::Gaussian);
    assert!(matches!(distance.run(ball()), Err(MeasureError::Conflict(_))));
    assert!(matches!(m.embedding(EmbeddingKind::Given).run(ball()), Err(MeasureError::Conflict(_))));
    // The band of the blurred field would reach its background value and weigh all of space.
    let wide = m.level(0.1).thickness_mm(2.5).run(ball()).unwrap_err();
    assert_says(&wide.to_string(), &["at level 0.1", "flat from 0.1", "smaller thickness"]);
    assert!(matches!(m.epsilon(0.6).run(ball()), Err(MeasureError::BandTooWide { .. })));
    // Lengths that no memory holds, in voxels.
    let far = m.sigma_mm(1e4).level(1e-12).epsilon(1e-13).run(ball()).unwrap_err();
    assert_says(&far.to_string(), &["sigma 10000 mm is 10000 voxels", "smaller sigma"]);
    let thick = m.embedding(EmbeddingKind::Distance).thickness_mm(1e6).run(ball()).unwrap_err();
    assert_says(&thick.to_string(), &["thickness 1000000 mm", "smaller thickness"]);
    let empty = Mask::from_predicate(*ball().grid(), |_| false);
    assert!(matches!(m.run(&empty), Err(MeasureError::Volume(VolumeError::NoForeground))));
}

#[test]
fn fields_without_sense() {
    let grid = Grid::axis_aligned([8, 8, 8], [1.0; 3]).unwrap();
    let field = |f: fn(usize) -> f64| FieldImage::new(grid, FieldValues::F64((0..512).map(f).collect()));
    let m = Measurement::default();
    assert!(matches!(
        field(|i| if i == 9 { f64::NAN } else { 1.0 }),
        Err(VolumeError::NotFinite { index: [1, 1, 0], .. })
    ));
    // A step, as an indicator less 0.5, whose slope by fourth-order differences is 7/12: t of 2.5 voxels
    // stands for more than the field reaches.
    let step = field(|i| if i < 256 { -0.5 } else { 0.5 }).unwrap();
    let wide = m.thickness_mm(2.5).run_field(&step).unwrap_err().to_string();
    assert_says(&wide, &["epsilon is 0.7292", "nowhere above 0.5", "smaller thickness"]);
    assert!(m.epsilon(0.4).run_field(&step).is_ok());
    let positive = m.run_field(field(|_| 1.0).unwrap());
    assert!(matches!(positive, Err(MeasureError::Volume(VolumeError::NothingInside))));
    let negative = m.run_field(field(|_| -1.0).unwrap());
    assert!(matches!(negative, Err(MeasureError::Volume(VolumeError::NothingOutside))));
    let thin = Grid::axis_aligned([8, 8, 5], [1.0; 3]).unwrap();
    let small = FieldImage::new(thin, FieldValues::F32(vec![-1.0; 320])).unwrap();
    assert!(matches!(m.run_field(&small), Err(MeasureError::FieldTooSmall { axis: 2, voxels: 5 })));
    let folder = tempfile::tempdir().unwrap();
    let short = write(folder.path(), "a.nii", nifti(CUBE, 16, &[0; 64]));
    assert!(matches!(read_field(short, ReadOptions::default()), Err(ReadError::Truncated { .. })));
}

#[test]
fn a_failed_write_leaves_nothing() {
    let image = Phantom::new(Ball { radius: 3.0 }, Pose::new([0.0; 3], [0.0; 3]), [1.0; 3])
        .unwrap()
        .labels()
        .unwrap();
    assert!(write_labels("/nowhere/ball.nii", &image).is_err());
}

fn npy(voxels: &[u8]) -> Vec<u8> {
    let mut header = "{'descr': '|u1', 'fortran_order': False, 'shape': (4, 4, 4), }".to_owned();
    header += &" ".repeat(117 - header.len());
    [b"\x93NUMPY\x01\x00\x76\x00", header.as_bytes(), b"\n", voxels].concat()
}

fn nifti_2(voxels: &[u8]) -> Vec<u8> {
    let mut file = vec![0u8; 544];
    put(&mut file, 0, &540i32.to_le_bytes());
    put(&mut file, 4, b"n+2\0\r\n\x1a\n");
    put(&mut file, 12, &2i16.to_le_bytes());
    [3i64, 4, 4, 4, 1, 1, 1, 1]
        .iter()
        .enumerate()
        .for_each(|(i, d)| put(&mut file, 16 + 8 * i, &d.to_le_bytes()));
    (0..4).for_each(|i| put(&mut file, 104 + 8 * i, &1f64.to_le_bytes()));
    put(&mut file, 168, &544i64.to_le_bytes());
    file.extend(voxels);
    file
}

/// Each is read before it is damaged, or damaging it would prove nothing.
#[test]
fn specimens_are_valid() {
    for (name, bytes) in specimens() {
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), name, bytes);
        let image = read_labels_with(path, ReadOptions { spacing: Some([1.0; 3]) });
        assert!(image.is_ok(), "{name}: {}", image.unwrap_err());
    }
}

/// Products of dimensions that wrap around are not mistaken for one volume.
#[test]
fn sizes_that_overflow() {
    let mut file = nifti_2(&pseudo_random());
    let dims = [5i64, 4, 4, 4, 1 << 32, 1 << 32, 1, 1];
    dims.iter().enumerate().for_each(|(i, d)| put(&mut file, 16 + 8 * i, &d.to_le_bytes()));
    assert_says(&refusal("a.nii", file), &["volumes or channels in one file"]);
    let header = "NRRD0004\ntype: uint8\ndimension: 5\nsizes: 4 4 4 4294967296 4294967296\nspacings: 1 1 1 1 1\nencoding: raw\n\n";
    assert_says(
        &refusal("a.nrrd", header.to_owned() + &"\u{1}".repeat(64)),
        &["volumes or channels in one file"],
    );
}

/// Several gzip members are one stream, cut anywhere, in the header too.
#[test]
fn several_gzip_members_are_read_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let whole = nifti(CUBE, 2, &pseudo_random());
    let expected = read_labels(write(folder.path(), "whole.nii", &whole)).unwrap();
    for cut in [100, 352, 380] {
        let members = [gzip(&whole[..cut]), gzip(&whole[cut..400]), gzip(&whole[400..])].concat();
        let image = read_labels(write(folder.path(), "members.nii.gz", members)).unwrap();
        assert_eq!(image.summaries(), expected.summaries(), "cut at {cut}");
    }
}

/// Units other than mm, and a named but empty sform.
#[test]
fn units_and_forms() {
    let folder = tempfile::tempdir().unwrap();
    let spacing = |name: &str, bytes: Vec<u8>| {
        read_labels(write(folder.path(), name, bytes)).unwrap().grid().spacing().mm()
    };
    let meta = "NDims = 3\nDimSize = 4 4 4\nElementSpacing = 500 500 500\nDistanceUnits = um\nElementType = MET_UCHAR\nElementDataFile = Local\n";
    assert_eq!(spacing("a.mha", [meta.as_bytes(), &pseudo_random()].concat()), [0.5; 3]);
    let mut empty_sform = nifti(CUBE, 2, &pseudo_random());
    put(&mut empty_sform, 254, &1i16.to_le_bytes());
    assert_eq!(spacing("a.nii", empty_sform), [1.0; 3]);
    let mixed = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nspacings: 1 1 1\nunits: \"mm\" \"mm\" \"um\"\nencoding: raw\n\n";
    assert_says(&refusal("a.nrrd", mixed.to_owned() + &"\u{1}".repeat(64)), &["different units"]);
}

/// Valid files of each format, to be damaged.
fn specimens() -> Vec<(&'static str, Vec<u8>)> {
    let voxels = pseudo_random();
    let with = |header: &str| [header.as_bytes(), &voxels].concat();
    vec![
        ("a.nii", nifti(CUBE, 2, &voxels)),
        ("a.nii.gz", gzip(&nifti(CUBE, 4, &[&voxels[..], &voxels[..]].concat()))),
        (
            "a.mha",
            with(
                "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
            ),
        ),
        (
            "a.nrrd",
            with(
                "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nspace: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n",
            ),
        ),
        ("a.npy", npy(&voxels)),
        ("b.nii", nifti_2(&voxels)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// Any bytes in place of any others: an error or an image, never a panic.
    #[test]
    fn damaged_files_do_not_panic(
        which in 0usize..6, position in 0usize..700, bytes in prop::collection::vec(any::<u8>(), 1..9), cut in 0usize..600
    ) {
        let (name, mut file) = specimens().swap_remove(which);
        let position = position % file.len();
        for (i, byte) in bytes.iter().enumerate() {
            if let Some(b) = file.get_mut(position + i) {
                *b = *byte;
            }
        }
        if cut < file.len() {
            file.truncate(cut.max(1));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), name, file);
        let _ = read_labels_with(&path, ReadOptions { spacing: Some([1.0; 3]) });
        let _ = read_field(&path, ReadOptions::default());
    }
}
