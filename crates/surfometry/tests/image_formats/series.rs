//! MetaImage and NRRD headers that name a file a slice.

use crate::{SIZE, SPACING, assert_read, assert_refused, gzip, voxels};
use std::path::Path;
use surfometry::volume::Affine;

/// Slices of big-endian int16 as files of their own, each behind three bytes; how many.
fn slices(folder: &Path, packed: bool) {
    for (z, slice) in voxels().chunks(SIZE[0] * SIZE[1]).enumerate() {
        let bytes: Vec<u8> = slice.iter().flat_map(|&v| (i16::from(v) * 300).to_be_bytes()).collect();
        let bytes = if packed { gzip(&bytes) } else { [b"abc", &bytes[..]].concat() };
        std::fs::write(folder.join(format!("s{z:02}.raw")), bytes).unwrap();
    }
}

const NAMES: &str = "s00.raw\ns01.raw\ns02.raw\ns03.raw\ns04.raw\ns05.raw\n";

#[test]
fn lists_and_patterns() {
    for packed in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        slices(folder.path(), packed);
        let mut headers = Vec::new();
        for files in [format!("LIST\n{NAMES}"), "LIST 2\n".to_owned() + NAMES, "s%02d.raw 0 5 1\n".to_owned()]
        {
            let encoding = if packed { "gzip" } else { "raw\nbyte skip: 3" };
            headers.push(("a.nhdr", format!("NRRD0004\ntype: short\ndimension: 3\nsizes: 7 5 6\nspacings: 0.5 0.75 2\nendian: big\nencoding: {encoding}\ndata file: {files}")));
            if !packed {
                headers.push(("a.mhd", format!("NDims = 3\nDimSize = 7 5 6\nElementSpacing = 0.5 0.75 2\nElementType = MET_SHORT\nHeaderSize = 3\nElementByteOrderMSB = True\nElementDataFile = {files}")));
            }
        }
        for (name, header) in headers {
            let path = folder.path().join(name);
            std::fs::write(&path, header).unwrap();
            // MetaImage's world is LPS, and so is that of a NRRD without a space, as ITK has it.
            assert_read(&path, None, 300, Affine::diagonal(SPACING).with_lps_swapped());
        }
    }
}

#[test]
fn faults_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    slices(folder.path(), false);
    let path = folder.path().join("a.mhd");
    let header = |rest: &str| {
        let text = format!(
            "NDims = 3\nDimSize = 7 5 6\nElementSpacing = 0.5 0.75 2\nElementType = MET_SHORT\nElementByteOrderMSB = True\n{rest}"
        );
        std::fs::write(&path, text).unwrap();
    };
    header(&format!("ElementDataFile = LIST\n{NAMES}"));
    assert_refused(&path, &["s00.raw", "73 bytes or more", "70"]);
    header("HeaderSize = 3\nElementDataFile = s%02d.raw 0 3 1\n");
    assert_refused(&path, &["4 data files for 6 slices"]);
    header("HeaderSize = 3\nElementDataFile = s%02d.raw 1 6 1\n");
    assert_refused(&path, &["s06.raw"]);
    header("HeaderSize = 3\nElementDataFile = s%s.raw 1 6 1\n");
    assert_refused(&path, &["no pattern"]);
}
