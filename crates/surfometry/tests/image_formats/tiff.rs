//! TIFF stacks, written here: every page is one strip.

use crate::{SIZE, SPACING, assert_read, assert_refused, file, gzip, voxels};
use surfometry::volume::Affine;

/// One directory: tag, type (2 text, 3 short, 4 long, 5 rational), values.
type Tags = Vec<(u16, u16, Vec<u32>)>;

/// In Latin-1.
fn text(words: &str) -> Vec<u32> {
    words.chars().chain(['\0']).map(u32::from).collect()
}

/// A little-endian file: pages of tags and pixels.
fn write(pages: &[(Tags, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = b"II*\0\0\0\0\0".to_vec();
    let mut link = 4;
    for (tags, pixels) in pages {
        let at = bytes.len() as u32;
        bytes.extend(pixels);
        let mut tags = tags.clone();
        tags.extend([(273, 4, vec![at]), (279, 4, vec![pixels.len() as u32])]);
        tags.sort_by_key(|tag| tag.0);
        let values: Vec<Vec<u8>> = tags
            .iter()
            .map(|(_, kind, values)| match kind {
                2 => values.iter().map(|&v| v as u8).collect(),
                3 => values.iter().flat_map(|&v| (v as u16).to_le_bytes()).collect(),
                _ => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            })
            .collect();
        let mut places = Vec::new();
        for value in &values {
            places.push(bytes.len() as u32);
            if value.len() > 4 {
                bytes.extend(value);
            }
        }
        let directory = (bytes.len() as u32).to_le_bytes();
        bytes[link..link + 4].copy_from_slice(&directory);
        bytes.extend((tags.len() as u16).to_le_bytes());
        for (i, (tag, kind, numbers)) in tags.iter().enumerate() {
            let count = if *kind == 5 { numbers.len() / 2 } else { numbers.len() };
            bytes.extend(tag.to_le_bytes());
            bytes.extend(kind.to_le_bytes());
            bytes.extend((count as u32).to_le_bytes());
            let mut inline = values[i].clone();
            inline.resize(4, 0);
            bytes.extend(if values[i].len() > 4 { places[i].to_le_bytes().to_vec() } else { inline });
        }
        link = bytes.len();
        bytes.extend([0; 4]);
    }
    bytes
}

fn tags(bits: u32) -> Tags {
    let [nx, ny, _] = SIZE.map(|n| n as u32);
    vec![
        (256, 4, vec![nx]),
        (257, 4, vec![ny]),
        (258, 3, vec![bits]),
        (259, 3, vec![1]),
        (262, 3, vec![1]),
        (277, 3, vec![1]),
        (278, 4, vec![ny]),
    ]
}

fn described(words: &str) -> Tags {
    // 1 / 0.5 and 1 / 0.75 pixels a unit.
    [tags(8), vec![(270, 2, text(words)), (282, 5, vec![2, 1]), (283, 5, vec![4, 3])]].concat()
}

fn pages() -> Vec<Vec<u8>> {
    voxels().chunks(SIZE[0] * SIZE[1]).map(<[u8]>::to_vec).collect()
}

fn stack(tags: &Tags) -> Vec<u8> {
    write(&pages().into_iter().map(|page| (tags.clone(), page)).collect::<Vec<_>>())
}

#[test]
fn a_slice_a_page_or_all_behind_one() {
    let image_j = "ImageJ=1.54f\nimages=6\nslices=6\nunit=mm\nspacing=2.0\n";
    let (_folder, path) = file("a.tif", &stack(&described(image_j)));
    assert_read(&path, None, 1, Affine::diagonal(SPACING));
    // One page, the slices behind its pixels.
    let first = (described(image_j), voxels());
    let mut whole = write(&[first]);
    let strip = whole.windows(12).position(|entry| entry[..4] == [0x17, 1, 4, 0]).unwrap();
    whole[strip + 8..strip + 12].copy_from_slice(&35u32.to_le_bytes());
    let (_folder, path) = file("a.tiff", &whole);
    assert_read(&path, None, 1, Affine::diagonal(SPACING));
}

/// Old versions of ImageJ write `µm` in Latin-1.
#[test]
fn micrometres_in_latin_1() {
    let image_j = "ImageJ=1.54f\nimages=6\nslices=6\nunit=\u{b5}m\nspacing=2.0\n";
    let (_folder, path) = file("a.tif", &stack(&described(image_j)));
    assert_read(&path, None, 1, Affine::diagonal(SPACING.map(|length| length / 1000.0)));
}

/// A description that says nothing of z, or resolution alone, is no spacing.
#[test]
fn what_is_not_told_is_asked_for() {
    for words in ["", "ImageJ=1.54f\nimages=6\nunit=mm\n", "made by a microscope"] {
        let (_folder, path) = file("a.tif", &stack(&described(words)));
        assert_refused(&path, &["no voxel spacing"]);
        assert_read(&path, Some(SPACING), 1, Affine::diagonal(SPACING));
    }
    let (_folder, path) =
        file("a.tif", &stack(&described("ImageJ=1.54f\nimages=6\nunit=furlong\nspacing=2.0\n")));
    assert_refused(&path, &["`furlong`"]);
}

/// Rows of one bit begin a byte each; the pages that a decoder gives are packed.
#[test]
fn bits() {
    let packed = |bits: usize| {
        let row = |row: &[u8]| {
            let mut bytes = vec![0u8; (SIZE[0] * bits).div_ceil(8)];
            row.iter().enumerate().for_each(|(x, v)| bytes[x * bits / 8] |= v << (8 - bits - x * bits % 8));
            bytes
        };
        let page = |page: Vec<u8>| (tags(bits as u32), page.chunks(SIZE[0]).flat_map(row).collect());
        write(&pages().into_iter().map(page).collect::<Vec<_>>())
    };
    for bits in [1, 4] {
        let (_folder, path) = file("a.tif", &packed(bits));
        assert_read(&path, Some(SPACING), 1, Affine::diagonal(SPACING));
    }
}

/// A reduced copy of a page is none of the slices; another size is a fault.
#[test]
fn pages_of_other_sizes() {
    let small: Tags = vec![
        (254, 4, vec![1]),
        (256, 4, vec![3]),
        (257, 4, vec![2]),
        (258, 3, vec![8]),
        (259, 3, vec![1]),
        (262, 3, vec![1]),
        (277, 3, vec![1]),
        (278, 4, vec![2]),
    ];
    let mut all: Vec<_> =
        pages().into_iter().flat_map(|page| [(tags(8), page), (small.clone(), vec![9; 6])]).collect();
    let (_folder, path) = file("a.tif", &write(&all));
    assert_read(&path, Some(SPACING), 1, Affine::diagonal(SPACING));
    all[3].0[0] = (254, 4, vec![0]);
    let (_folder, path) = file("a.tif", &write(&all));
    let said =
        surfometry::io::read_labels_with(&path, surfometry::io::ReadOptions { spacing: Some(SPACING) })
            .unwrap_err();
    assert!(said.to_string().contains("page 4 is 3 x 2 of 8 bits, the first one 7 x 5"), "{said}");
}

#[test]
fn damage_and_what_is_no_stack_are_refused() {
    let refused = |bytes: &[u8], words: &[&str]| {
        let (_folder, path) = file("a.tif", bytes);
        assert_refused(&path, words);
    };
    let whole = stack(&described("ImageJ=1.54f\nimages=6\nslices=6\nunit=mm\nspacing=2.0\n"));
    refused(&gzip(&whole), &["compressed as a whole", "gunzip"]);
    refused(&whole[..whole.len() / 2], &["damaged"]);
    refused(b"II*\0", &["TIFF"]);
    refused(
        &stack(&described("ImageJ=1.54f\nimages=9\nslices=9\nunit=mm\nspacing=2.0\n")),
        &["9 slices", "6 pages"],
    );
    refused(&write(&[(tags(8), pages()[0].clone())]), &["3-D"]);
    let mut colour = tags(8);
    colour[4] = (262, 3, vec![3]);
    refused(&stack(&colour), &["palette pixels"]);
    let mut jpeg = tags(8);
    jpeg[3] = (259, 3, vec![7]);
    refused(&stack(&jpeg), &["compression 7 is not read"]);
    // A page that its few bytes cannot be: nothing is allocated for it.
    let mut huge = tags(8);
    huge[0] = (256, 4, vec![1 << 15]);
    huge[1] = (257, 4, vec![1 << 15]);
    huge[3] = (259, 3, vec![5]);
    huge[6] = (278, 4, vec![1 << 15]);
    let (_folder, path) = file("a.tif", &stack(&huge));
    let said =
        surfometry::io::read_labels_with(&path, surfometry::io::ReadOptions { spacing: Some(SPACING) })
            .unwrap_err();
    assert!(said.to_string().contains("claims 32768 x 32768 x 6 voxels"), "{said}");
    // The same of a page that is small enough to be held.
    (huge[0], huge[1], huge[6]) = ((256, 4, vec![1 << 13]), (257, 4, vec![1 << 14]), (278, 4, vec![1 << 14]));
    let (_folder, path) = file("a.tif", &stack(&huge));
    let said =
        surfometry::io::read_labels_with(&path, surfometry::io::ReadOptions { spacing: Some(SPACING) })
            .unwrap_err();
    assert!(said.to_string().contains("cannot be a page"), "{said}");
}

#[test]
fn a_folder_of_slices() {
    let folder = tempfile::tempdir().unwrap();
    for (z, page) in pages().into_iter().enumerate() {
        std::fs::write(folder.path().join(format!("s{}.tif", 8 + z)), write(&[(tags(8), page)])).unwrap();
    }
    std::fs::write(folder.path().join("notes.txt"), "not a slice").unwrap();
    assert_read(folder.path(), Some(SPACING), 1, Affine::diagonal(SPACING));
    let mut other = tags(8);
    other[1] = (257, 4, vec![4]);
    std::fs::write(folder.path().join("s14.tif"), write(&[(other, vec![0; 28])])).unwrap();
    let said = surfometry::io::read_labels_with(
        folder.path(),
        surfometry::io::ReadOptions { spacing: Some(SPACING) },
    )
    .unwrap_err();
    assert!(said.to_string().contains("s14.tif is 7 x 4"), "{said}");
    std::fs::remove_file(folder.path().join("s10.tif")).unwrap();
    assert_refused(folder.path(), &["between s9.tif and s11.tif"]);
}

/// What follows the slice's number may have numbers too, as long as they stay the same.
#[test]
fn slices_with_a_number_behind_theirs() {
    let folder = tempfile::tempdir().unwrap();
    let write_channel = |channel: usize| {
        for (z, page) in pages().into_iter().enumerate() {
            let name = format!("Series003_z{}_ch{channel:02}.tif", 8 + z);
            std::fs::write(folder.path().join(name), write(&[(tags(8), page)])).unwrap();
        }
    };
    write_channel(0);
    assert_read(folder.path(), Some(SPACING), 1, Affine::diagonal(SPACING));
    write_channel(1);
    assert_refused(folder.path(), &["differ in 2 numbers (_z8 to _z13, _ch00 to _ch01)", "each channel"]);
}
