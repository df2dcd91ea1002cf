//! Scanco AIM and ISQ files. Codes of types, layouts and run lengths are AimIO's.

use crate::{SIZE, SPACING, assert_read, assert_refused, file, gzip, voxels};
use surfometry::volume::Affine;

const CHAR: i32 = 0x1_0001;
const SHORT: i32 = 0x2_0002;
const FLOAT: i32 = 0x4_0004;
const BITS: i32 = 0x6_0001;
const TWO_VALUED: i32 = 0x15_0001;
const VALUED: i32 = 0x8_0002;
const POSITION: [i64; 3] = [3, -5, 7];

fn affine() -> Affine {
    let origin = std::array::from_fn(|a| POSITION[a] as f64 * SPACING[a]);
    Affine { origin, ..Affine::diagonal(SPACING) }
}

/// An F-float of a VAX.
fn vax(value: f32) -> [u8; 4] {
    let [a, b, c, d] = (value * 4.0).to_le_bytes();
    [c, d, a, b]
}

fn longs(values: [i64; 3]) -> Vec<u8> {
    values.into_iter().flat_map(i64::to_le_bytes).collect()
}

fn ints(values: [i64; 3]) -> Vec<u8> {
    values.into_iter().flat_map(|v| (v as i32).to_le_bytes()).collect()
}

const LOG: &[u8] = b"! Processing Log\0";
const ZERO: [i64; 3] = [0; 3];

fn dim() -> [i64; 3] {
    SIZE.map(|n| n as i64)
}

/// Version 030, with data behind the voxels.
fn v030(kind: i32, border: [i64; 3], data: &[u8]) -> Vec<u8> {
    let mut image: Vec<u8> = [24, 0, 0, kind].into_iter().flat_map(i32::to_le_bytes).collect();
    let nanometres = SPACING.map(|mm| (mm * 1e6) as i64);
    for triple in [POSITION, dim(), border, ZERO, ZERO, ZERO, ZERO, nanometres] {
        image.extend(longs(triple));
    }
    image.resize(224, 0);
    let mut file = b"AIMDATA_V030   \0".to_vec();
    for size in [40, image.len(), LOG.len(), data.len(), 5] {
        file.extend((size as i64).to_le_bytes());
    }
    [&file[..], &image, LOG, data, b"assoc"].concat()
}

/// Version 020: narrow numbers, spacing as VAX floats.
fn v020(kind: i32, border: [i64; 3], data: &[u8]) -> Vec<u8> {
    let mut image: Vec<u8> = [16, 0, 0, 0, 0, kind].into_iter().flat_map(i32::to_le_bytes).collect();
    for triple in [POSITION, dim(), border, ZERO, ZERO, ZERO, ZERO] {
        image.extend(ints(triple));
    }
    image.extend(SPACING.iter().flat_map(|mm| vax(*mm as f32)));
    image.resize(140, 0);
    parts(&image, data)
}

/// Version 010: dim, off, subdim, pos, one spacing.
fn v010(data: &[u8]) -> Vec<u8> {
    let mut image: Vec<u8> = [0, 0, 0, 0, CHAR].into_iter().flat_map(i32::to_le_bytes).collect();
    for triple in [dim(), ZERO, ZERO, POSITION] {
        image.extend(ints(triple));
    }
    image.extend(vax(0.082));
    image.resize(92, 0);
    parts(&image, data)
}

fn parts(image: &[u8], data: &[u8]) -> Vec<u8> {
    let sizes = [20, image.len(), LOG.len(), data.len(), 0];
    let list: Vec<u8> = sizes.into_iter().flat_map(|size| (size as i32).to_le_bytes()).collect();
    [&list[..], image, LOG, data].concat()
}

/// Voxels without one voxel of border.
fn inner() -> Vec<u8> {
    let [nx, ny, nz] = SIZE;
    let at = |i: usize| [i % nx, i / nx % ny, i / nx / ny];
    let inside = |i: usize| (0..3).all(|a| (1..SIZE[a] - 1).contains(&at(i)[a]));
    (0..nx * ny * nz).filter(|&i| inside(i)).map(|i| voxels()[i]).collect()
}

/// Runs of equal values, none longer than `longest`.
fn runs(data: &[u8], longest: usize) -> Vec<(u8, u8)> {
    data.chunk_by(PartialEq::eq)
        .flat_map(|run| run.chunks(longest))
        .map(|run| (run[0], run.len() as u8))
        .collect()
}

fn sized(body: &[u8], wide: bool) -> Vec<u8> {
    let size = body.len() + if wide { 8 } else { 4 };
    let size = (size as i64).to_le_bytes();
    [&size[..if wide { 8 } else { 4 }], body].concat()
}

fn two_valued(data: &[u8], wide: bool) -> Vec<u8> {
    let runs = runs(data, 254);
    let mut body = vec![data[0] * 127, 127 - data[0] * 127];
    for (i, &(value, length)) in runs.iter().enumerate() {
        let goes_on = runs.get(i + 1).is_some_and(|next| next.0 == value);
        body.push(if goes_on { 255 } else { length });
    }
    sized(&body, wide)
}

fn valued(data: &[u8], wide: bool) -> Vec<u8> {
    // AimIO's writer puts an empty run in front.
    let runs = [(0, 0)].into_iter().chain(runs(data, 255));
    sized(&runs.flat_map(|(value, length)| [value * 9, length]).collect::<Vec<_>>(), wide)
}

fn bits(data: &[u8]) -> Vec<u8> {
    let [nx, ny, nz] = SIZE;
    let [bx, by, bz] = SIZE.map(|n| n.div_ceil(2));
    let mut packed = vec![0u8; bx * by * bz + 1];
    packed[bx * by * bz] = 127;
    for i in 0..nx * ny * nz {
        let [x, y, z] = [i % nx, i / nx % ny, i / nx / ny];
        packed[x / 2 + bx * (y / 2 + by * (z / 2))] |= data[i] << (4 * (z & 1) + 2 * (y & 1) + (x & 1));
    }
    packed
}

#[test]
fn every_coding_of_both_versions() {
    let shorts: Vec<u8> = voxels().into_iter().flat_map(|v| (i16::from(v) * 300).to_le_bytes()).collect();
    let floats: Vec<u8> = voxels().into_iter().flat_map(|v| vax(f32::from(v) * 5.0)).collect();
    for (wide, of) in [(true, v030 as fn(i32, [i64; 3], &[u8]) -> Vec<u8>), (false, v020)] {
        let cases = [
            (1, of(CHAR, ZERO, &voxels())),
            (300, of(SHORT, ZERO, &shorts)),
            (5, of(FLOAT, ZERO, &floats)),
            (127, of(BITS, ZERO, &bits(&voxels()))),
            (127, of(TWO_VALUED, ZERO, &two_valued(&voxels(), wide))),
            (127, of(TWO_VALUED, [1; 3], &two_valued(&inner(), wide))),
            (9, of(VALUED, ZERO, &valued(&voxels(), wide))),
            (9, of(VALUED, [1; 3], &valued(&inner(), wide))),
        ];
        for (value, bytes) in cases {
            // VMS puts a version behind the name, and its names are capitals.
            for (name, bytes) in
                [("M.AIM", bytes.clone()), ("M.AIM;1", bytes.clone()), ("m.aim.gz", gzip(&bytes))]
            {
                let (_folder, path) = file(name, &bytes);
                assert_read(&path, None, value, affine());
            }
        }
    }
}

/// Runs of more than 254 and 255 voxels are written in parts.
#[test]
fn long_runs_go_on() {
    let size = [20usize, 30, 4];
    let data: Vec<u8> = (0..2400).map(|i| u8::from((700..1900).contains(&i))).collect();
    for (kind, stored) in [(TWO_VALUED, two_valued(&data, true)), (VALUED, valued(&data, true))] {
        let mut bytes = v030(kind, ZERO, &stored);
        bytes[96..120].copy_from_slice(&longs(size.map(|n| n as i64)));
        let (_folder, path) = file("a.aim", &bytes);
        let image = surfometry::io::read_labels(&path).unwrap();
        assert_eq!(image.summaries()[0].voxels, 1200);
        assert_eq!(image.get([0, 5, 1]) != 0, data[700] == 1);
        assert_eq!(image.get([19, 4, 1]), 0);
    }
}

#[test]
fn the_first_version_has_one_spacing() {
    let (_folder, path) = file("a.aim", &v010(&voxels()));
    let origin = POSITION.map(|p| p as f64 * 0.082);
    assert_read(&path, None, 1, Affine { origin, ..Affine::diagonal([0.082; 3]) });
}

#[test]
fn damaged_aims_are_refused() {
    let whole = v030(TWO_VALUED, ZERO, &two_valued(&voxels(), true));
    let refused = |bytes: &[u8], words: &[&str]| {
        let (_folder, path) = file("a.aim", bytes);
        assert_refused(&path, words);
    };
    // The last run is cut off, with what follows it.
    refused(&whole[..whole.len() - 7], &["end after"]);
    refused(&whole[..100], &["ends after 100 bytes"]);
    refused(b"no image at all, but text that is long enough to be taken for a header if nobody looks at what it says in its first bytes", &["no list of sizes"]);
    refused(&v030(0x99, ZERO, &voxels()), &["Scanco AIM 0x99"]);
    refused(&v030(CHAR, ZERO, &voxels()[1..]), &["209 bytes of voxels", "[7, 5, 6]"]);
    refused(&v030(BITS, ZERO, &bits(&voxels())[1..]), &["cannot be those of dim"]);
    refused(&v030(TWO_VALUED, [9; 3], &two_valued(&voxels(), true)), &["off [9, 9, 9]"]);
    let longer = [voxels(), vec![0; 300]].concat();
    refused(&v030(TWO_VALUED, ZERO, &two_valued(&longer, true)), &["more voxels than dim"]);
    refused(&v030(VALUED, ZERO, &[valued(&voxels(), true), vec![1, 9, 1, 9]].concat()), &["more of them"]);
    // A hundred bytes cannot be runs of 2^60 voxels; nothing is made before that is seen.
    let mut huge = whole;
    huge[96..120].copy_from_slice(&longs([1 << 20; 3]));
    refused(&huge, &["cannot be those of dim"]);
}

fn isq(extra_blocks: i32) -> Vec<u8> {
    let mut header = vec![0u8; 512 * (1 + extra_blocks as usize)];
    header[..16].copy_from_slice(b"CTDATA-HEADER_V1");
    let mut put = |at: usize, value: i32| header[at..at + 4].copy_from_slice(&value.to_le_bytes());
    // The number of bytes overflows in large files, and is not looked at.
    put(20, -1);
    for a in 0..3 {
        put(44 + 4 * a, SIZE[a] as i32);
        put(56 + 4 * a, (SPACING[a] * 1000.0) as i32 * SIZE[a] as i32);
    }
    put(508, extra_blocks);
    header
}

#[test]
fn isq_files() {
    let data: Vec<u8> = voxels().into_iter().flat_map(|v| (i16::from(v) * 4000).to_le_bytes()).collect();
    for blocks in [0, 4] {
        let mut whole = [isq(blocks), data.clone()].concat();
        whole.resize(whole.len().next_multiple_of(512), 0);
        for (name, bytes) in
            [("A.ISQ", whole.clone()), ("a.isq;12", whole.clone()), ("a.isq.gz", gzip(&whole))]
        {
            let (_folder, path) = file(name, &bytes);
            assert_read(&path, None, 4000, Affine::diagonal(SPACING));
        }
    }
    let (_folder, path) = file("a.isq", &[isq(0), data[..418].to_vec()].concat());
    assert_refused(&path, &["end after 418 of 420 bytes"]);
    let (_folder, path) = file("a.isq", &voxels().repeat(4));
    assert_refused(&path, &["CTDATA-HEADER_V1"]);
}
