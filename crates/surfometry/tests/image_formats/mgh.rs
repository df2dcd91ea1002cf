//! FreeSurfer images.

use crate::{SIZE, SPACING, assert_read, assert_refused, file, gzip, voxels};
use surfometry::inputs::{OpenOptions, open};
use surfometry::volume::{Affine, LabelImage};

/// The directions of FreeSurfer's conformed images: x to the left, y to the feet, z to the front.
const DIRECTIONS: [[f64; 3]; 3] = [[-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
const CENTRE: [f64; 3] = [3.5, -20.25, 11.0];

fn header(frames: i32, kind: i32, good: i16) -> Vec<u8> {
    let mut bytes = Vec::new();
    let sizes = SIZE.map(|n| n as i32);
    for number in [1, sizes[0], sizes[1], sizes[2], frames, kind, 0] {
        bytes.extend(number.to_be_bytes());
    }
    bytes.extend(good.to_be_bytes());
    for number in SPACING.iter().chain(DIRECTIONS.iter().flatten()).chain(&CENTRE) {
        bytes.extend((*number as f32).to_be_bytes());
    }
    bytes.resize(284, 0);
    bytes
}

/// Voxel (n / 2) lies at the centre: here 3.5, 2.5 and 3 voxels along the axes.
fn affine() -> Affine {
    let from_centre = [3.5 * SPACING[0], -3.0 * SPACING[2], 2.5 * SPACING[1]];
    let origin = std::array::from_fn(|w| CENTRE[w] + from_centre[w]);
    Affine::from_directions(DIRECTIONS, SPACING, origin)
}

#[test]
fn every_type_and_its_place() {
    let wide = |bytes: fn(u8) -> Vec<u8>| voxels().into_iter().flat_map(bytes).collect::<Vec<u8>>();
    let kinds = [
        (0, voxels()),
        (1, wide(|v| i32::from(v).to_be_bytes().to_vec())),
        (3, wide(|v| f32::from(v).to_be_bytes().to_vec())),
        (4, wide(|v| i16::from(v).to_be_bytes().to_vec())),
        (10, wide(|v| u16::from(v).to_be_bytes().to_vec())),
    ];
    for (kind, data) in kinds {
        let whole = [header(1, kind, 1), data].concat();
        let (_folder, path) = file("a.mgh", &whole);
        assert_read(&path, None, 1, affine());
        let (_folder, path) = file("a.mgz", &gzip(&whole));
        assert_read(&path, None, 1, affine());
    }
}

/// FreeSurfer writes parameters and tags behind the voxels: those are no surplus.
#[test]
fn what_follows_the_voxels_is_not_flagged() {
    let tags = [0x40; 77];
    let whole = [&header(1, 0, 1)[..], &voxels(), &tags].concat();
    for (name, bytes) in [("a.mgh", whole.clone()), ("a.mgz", gzip(&whole))] {
        let (_folder, path) = file(name, &bytes);
        let source = open(path.to_str().unwrap(), &OpenOptions::default()).unwrap();
        LabelImage::from_slabs(&mut source.slabs().unwrap()).unwrap();
        assert_eq!(source.flags(), []);
    }
}

#[test]
fn without_a_place_the_spacing_is_asked_for() {
    let (_folder, path) = file("a.mgh", &[header(1, 0, 0), voxels()].concat());
    assert_refused(&path, &["no voxel spacing"]);
    assert_read(&path, Some(SPACING), 1, Affine::diagonal(SPACING));
}

#[test]
fn damage_is_refused() {
    let whole = [header(1, 0, 1), voxels()].concat();
    let (_folder, path) = file("a.mgh", &whole[..whole.len() - 1]);
    assert_refused(&path, &["end after 209 of 210 bytes"]);
    let (_folder, path) = file("a.mgh", &whole[..50]);
    assert_refused(&path, &["ends after 50 bytes", "header alone has 90"]);
    let (_folder, path) = file("a.mgh", &[header(2, 0, 1), voxels(), voxels()].concat());
    assert_refused(&path, &["2 volumes"]);
    let (_folder, path) = file("a.mgh", &[header(1, 7, 1), voxels()].concat());
    assert_refused(&path, &["FreeSurfer 7"]);
    let mut packed = gzip(&[&whole[..], &[0x40; 77]].concat());
    let voxel = packed.len() - 100;
    packed[voxel] ^= 1;
    let (_folder, path) = file("a.mgz", &packed);
    assert_refused(&path, &["damaged"]);
    let mut negative = whole;
    negative[4] = 0x80;
    let (_folder, path) = file("a.mgh", &negative);
    assert_refused(&path, &["width is -2147483641"]);
}
