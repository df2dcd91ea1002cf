//! Bytes that no header accounts for are told, in every format.

use std::io::Write;
use std::path::Path;
use surfometry::inputs::{OpenOptions, open};
use surfometry::volume::LabelImage;

const VOXELS: usize = 4 * 5 * 6;

/// The flags of an input once it was read.
fn flags(path: &Path) -> Vec<String> {
    let source =
        open(path.to_str().unwrap(), &OpenOptions { spacing: Some([1.0; 3]), ..OpenOptions::default() })
            .unwrap();
    LabelImage::from_slabs(&mut source.slabs().unwrap()).unwrap();
    source.flags().into_iter().map(|flag| format!("{}: {}", flag.code, flag.message)).collect()
}

#[track_caller]
fn assert_flagged(path: &Path, surplus: usize) {
    let found = flags(path);
    if surplus == 0 {
        assert!(found.is_empty(), "{}: {found:?}", path.display());
    } else {
        let words = format!("the data hold {surplus} bytes more");
        assert!(
            found.len() == 1 && found[0].starts_with("surplus-data") && found[0].contains(&words),
            "{}: {found:?}",
            path.display()
        );
    }
}

fn voxels(surplus: usize) -> Vec<u8> {
    (0..VOXELS + surplus).map(|i| (i % 3) as u8).collect()
}

fn meta(lines: &str) -> Vec<u8> {
    format!("ObjectType = Image\nNDims = 3\nDimSize = 4 5 6\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\n{lines}\n").into()
}

fn nrrd(lines: &str) -> Vec<u8> {
    format!("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 5 6\nspacings: 1 1 1\n{lines}\n\n").into()
}

fn nifti(magic: [u8; 4], offset: f32) -> Vec<u8> {
    let mut header = vec![0u8; 352];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    [3i16, 4, 5, 6].iter().enumerate().for_each(|(i, n)| put(40 + 2 * i, &n.to_le_bytes()));
    put(70, &2i16.to_le_bytes());
    (0..4).for_each(|i| put(76 + 4 * i, &1f32.to_le_bytes()));
    put(108, &offset.to_le_bytes());
    put(344, &magic);
    header
}

fn npy() -> Vec<u8> {
    let mut header = "{'descr': '|u1', 'fortran_order': False, 'shape': (6, 5, 4), }".to_owned();
    header += &" ".repeat(117 - header.len());
    [b"\x93NUMPY\x01\x00\x76\x00", header.as_bytes(), b"\n"].concat()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn what_follows_the_voxels_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, parts: &[&[u8]]| {
        let path = folder.path().join(name);
        std::fs::write(&path, parts.concat()).unwrap();
        path
    };
    for surplus in [0, 1, 512] {
        let data = voxels(surplus);
        file("a.raw", &[&data]);
        file("b.img", &[&data]);
        for path in [
            file("a.mhd", &[&meta("ElementDataFile = a.raw")]),
            file("a.nhdr", &[&nrrd("encoding: raw\ndata file: a.raw")]),
            file("b.hdr", &[&nifti(*b"ni1\0", 0.0)]),
            file("a.mha", &[&meta("ElementDataFile = LOCAL"), &data]),
            file("a.nrrd", &[&nrrd("encoding: raw"), &data]),
            file("a.nii", &[&nifti(*b"n+1\0", 352.0), &data]),
            file("a.npy", &[&npy(), &data]),
            file("a.nii.gz", &[&gzip(&[nifti(*b"n+1\0", 352.0), data.clone()].concat())]),
            file("z.nrrd", &[&nrrd("encoding: gzip"), &gzip(&data)]),
            file("z.mha", &[&meta("CompressedData = True\nElementDataFile = LOCAL"), &zlib(&data)]),
        ] {
            assert_flagged(&path, surplus);
        }
    }
}

/// What a header accounts for, and padding.
#[test]
fn what_is_said_of_it_is_no_surplus() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, parts: &[&[u8]]| {
        let path = folder.path().join(name);
        std::fs::write(&path, parts.concat()).unwrap();
        path
    };
    file("a.raw", &[&[7; 512], &voxels(0)]);
    for path in [
        file("a.mhd", &[&meta("HeaderSize = 512\nElementDataFile = a.raw")]),
        file("b.mhd", &[&meta("HeaderSize = -1\nElementDataFile = a.raw")]),
        file("c.mha", &[&meta("HeaderSize = -1\nElementDataFile = LOCAL"), &[7; 33], &voxels(0)]),
        file("a.nhdr", &[&nrrd("encoding: raw\nbyte skip: 512\ndata file: a.raw")]),
        file("b.nhdr", &[&nrrd("encoding: raw\nbyte skip: -1\ndata file: a.raw")]),
        file("a.nii.gz", &[&gzip(&[nifti(*b"n+1\0", 352.0), voxels(0)].concat()), &[0; 64]]),
    ] {
        assert_flagged(&path, 0);
    }
    // Voxels that end the file, whatever stands between them and the header.
    let image = surfometry::io::read_labels(folder.path().join("c.mha")).unwrap();
    let read: Vec<i64> = (0..VOXELS).map(|i| image.get(image.grid().index_of(i))).collect();
    assert_eq!(read, voxels(0).into_iter().map(i64::from).collect::<Vec<_>>());
}
