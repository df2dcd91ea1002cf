//! Compressed voxels: damage is refused wherever the codec itself notices it, padding is not damage, and what
//! goes on without end is left.

use std::io::{Read, Write};
use std::path::Path;
use surfometry::io::{ReadError, read_labels};

const DIMENSIONS: [usize; 3] = [40, 38, 32];

/// A ball of some labels: runs, as segmentations have, and enough of them for several codes of each length.
fn voxels() -> Vec<u8> {
    let [nx, ny, nz] = DIMENSIONS;
    let square = |i: usize, n: usize| (i as f64 - 0.47 * n as f64).powi(2);
    let mut voxels = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            let inside = |x: usize| square(x, nx) + square(y, ny) + square(z, nz) < 190.0;
            voxels.extend((0..nx).map(|x| u8::from(inside(x)) * (1 + ((x * y + 7 * z) / 40 % 3) as u8)));
        }
    }
    voxels
}

/// A codec's stream of some bytes, by its library; and what the library makes of a whole stream.
#[derive(Clone, Copy)]
enum Codec {
    Gzip,
    Zlib,
    Bzip2,
}

impl Codec {
    fn encode(self, bytes: &[u8]) -> Vec<u8> {
        let level = flate2::Compression::default();
        let mut out = Vec::new();
        match self {
            Self::Gzip => flate2::write::GzEncoder::new(&mut out, level).write_all(bytes).unwrap(),
            Self::Zlib => flate2::write::ZlibEncoder::new(&mut out, level).write_all(bytes).unwrap(),
            Self::Bzip2 => {
                bzip2::write::BzEncoder::new(&mut out, bzip2::Compression::best()).write_all(bytes).unwrap();
            }
        }
        out
    }

    fn decode(self, stream: &[u8]) -> Option<Vec<u8>> {
        let mut decoded = Vec::new();
        let outcome = match self {
            Self::Gzip => flate2::read::GzDecoder::new(stream).read_to_end(&mut decoded),
            Self::Zlib => flate2::read::ZlibDecoder::new(stream).read_to_end(&mut decoded),
            Self::Bzip2 => bzip2::read::BzDecoder::new(stream).read_to_end(&mut decoded),
        };
        outcome.ok().map(|_| decoded)
    }
}

/// A format that holds compressed voxels: what stands before the stream and in it.
struct Container {
    name: &'static str,
    codec: Codec,
    header: Vec<u8>,
    stored: Vec<u8>,
}

fn containers() -> [Container; 4] {
    let [nx, ny, nz] = DIMENSIONS;
    let nrrd = |encoding: &str| {
        format!(
            "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {nx} {ny} {nz}\nspacings: 1 1 1.5\nencoding: {encoding}\n\n"
        )
    };
    let meta = format!(
        "ObjectType = Image\nNDims = 3\nDimSize = {nx} {ny} {nz}\nElementSpacing = 1 1 1.5\nElementType = MET_UCHAR\nCompressedData = True\nElementDataFile = LOCAL\n"
    );
    let container =
        |name, codec, header: String| Container { name, codec, header: header.into(), stored: voxels() };
    [
        Container { name: "a.nii.gz", codec: Codec::Gzip, header: Vec::new(), stored: nifti() },
        container("a.nrrd", Codec::Gzip, nrrd("gzip")),
        container("b.nrrd", Codec::Bzip2, nrrd("bzip2")),
        container("a.mha", Codec::Zlib, meta),
    ]
}

fn nifti() -> Vec<u8> {
    let mut file = vec![0u8; 352];
    let mut put = |offset: usize, bytes: &[u8]| file[offset..offset + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    put(40, &3i16.to_le_bytes());
    (0..3).for_each(|a| put(42 + 2 * a, &(DIMENSIONS[a] as i16).to_le_bytes()));
    put(70, &2i16.to_le_bytes());
    [1f32, 1.0, 1.0, 1.5].iter().enumerate().for_each(|(i, v)| put(76 + 4 * i, &v.to_le_bytes()));
    put(108, &352f32.to_le_bytes());
    put(344, b"n+1\0");
    file.extend(voxels());
    file
}

/// Reads a file of some bytes: its spacing and its labels.
fn read(folder: &Path, name: &str, parts: &[&[u8]]) -> Result<([f64; 3], Vec<i64>), ReadError> {
    let path = folder.join(name);
    std::fs::write(&path, parts.concat()).unwrap();
    let image = read_labels(path)?;
    let grid = image.grid();
    let count = grid.dimensions().iter().product();
    Ok((grid.spacing().mm(), (0..count).map(|i| image.get(grid.index_of(i))).collect()))
}

fn original() -> ([f64; 3], Vec<i64>) {
    ([1.0, 1.0, 1.5], voxels().into_iter().map(i64::from).collect())
}

/// Any flipped bit: the voxels as they were, or a refusal; and refused is only what the codec refuses or
/// decodes to something else.
#[test]
fn a_flipped_bit_is_refused_or_harmless() {
    let folder = tempfile::tempdir().unwrap();
    for Container { name, codec, header, stored } in containers() {
        let stream = codec.encode(&stored);
        let (mut refused, mut longer) = (0, 0);
        for flip in 0..400 {
            // Spread over the whole stream, and over the bits of its bytes.
            let bit = flip * (8 * stream.len() - 1) / 399;
            let mut damaged = stream.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let whole = codec.decode(&damaged);
            match read(folder.path(), name, &[&header, &damaged]) {
                Ok(found) => assert_eq!(found, original(), "{name}: bit {bit}"),
                Err(error) => {
                    assert_ne!(whole.as_deref(), Some(&stored[..]), "{name}: bit {bit}: {error}");
                    refused += 1;
                }
            }
            longer += usize::from(decodes_to_all_voxels(codec, &damaged, stored.len()) && whole.is_none());
        }
        assert!(refused > 300, "{name}: {refused} of 400 refused");
        assert!(longer > 20, "{name}: of {longer} only the end of the stream shows the damage");
    }
}

/// Whether as many bytes as the voxels need come out of a stream before the codec notices anything.
fn decodes_to_all_voxels(codec: Codec, stream: &[u8], bytes: usize) -> bool {
    let mut found = vec![0; bytes];
    match codec {
        Codec::Gzip => flate2::read::GzDecoder::new(stream).read_exact(&mut found).is_ok(),
        Codec::Zlib => flate2::read::ZlibDecoder::new(stream).read_exact(&mut found).is_ok(),
        Codec::Bzip2 => bzip2::read::BzDecoder::new(stream).read_exact(&mut found).is_ok(),
    }
}

/// A stream that lacks its end lacks its checksum.
#[test]
fn a_stream_without_its_end_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for Container { name, codec, header, stored } in containers() {
        let stream = codec.encode(&stored);
        for lost in [1, 2, 4, 7] {
            let error = read(folder.path(), name, &[&header, &stream[..stream.len() - lost]]).unwrap_err();
            assert!(error.to_string().contains("export"), "{name} less {lost}: {error}");
        }
    }
}

/// Also where the voxels are whole: bytes may follow them, and their checksum is compared nonetheless, in
/// every member.
#[test]
fn checksums_count_behind_the_last_voxel() {
    let folder = tempfile::tempdir().unwrap();
    for Container { name, codec, header, stored } in containers() {
        let longer = [&stored[..], &[1; 5]].concat();
        let mut stream = codec.encode(&longer);
        assert_eq!(read(folder.path(), name, &[&header, &stream]).unwrap(), original(), "{name}");
        // In the checksum itself, of bzip2 behind bits that fill the last byte.
        let place = stream.len() - if matches!(codec, Codec::Gzip) { 8 } else { 3 };
        stream[place] ^= 4;
        let error = read(folder.path(), name, &[&header, &stream]).unwrap_err();
        assert!(matches!(error, ReadError::Decompression { .. }), "{name}: {error}");
        if matches!(codec, Codec::Zlib) {
            continue;
        }
        let members = [&header[..], &codec.encode(&stored), &stream].concat();
        let error = read(folder.path(), name, &[&members]).unwrap_err();
        assert!(matches!(error, ReadError::Decompression { .. }), "{name}: {error}");
    }
}

/// The header of a pair has a stream of its own.
#[test]
fn a_pairs_header_is_compared_too() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.img"), voxels()).unwrap();
    let mut header = nifti()[..352].to_vec();
    header[344..348].copy_from_slice(b"ni1\0");
    header[108..112].fill(0);
    let stream = Codec::Gzip.encode(&header);
    assert_eq!(read(folder.path(), "a.hdr.gz", &[&stream]).unwrap(), original());
    for bit in 0..8 * stream.len() {
        let mut damaged = stream.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        if let Ok(found) = read(folder.path(), "a.hdr.gz", &[&damaged]) {
            assert_eq!(found, original(), "bit {bit}");
        }
    }
}

/// Zeros behind a whole stream, as blocks of tapes and discs leave them, and anything else that is no stream.
#[test]
fn padding_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    for Container { name, codec, header, stored } in containers() {
        let stream = codec.encode(&stored);
        let mut paddings: Vec<Vec<u8>> = (0..=12).chain([512, 300_000]).map(|n| vec![0; n]).collect();
        paddings.extend([b"\x1f".to_vec(), b"B".to_vec(), b"BZ".to_vec(), b"something else".to_vec()]);
        for padding in paddings {
            let found = read(folder.path(), name, &[&header, &stream, &padding]);
            assert_eq!(found.unwrap(), original(), "{name} and {} bytes", padding.len());
        }
    }
}

/// Streams that follow each other are one, with zeros between them too (Python's gzip), wherever the buffer
/// ends.
#[test]
fn streams_may_be_many() {
    let folder = tempfile::tempdir().unwrap();
    for Container { name, codec, header, stored } in containers() {
        if matches!(codec, Codec::Zlib) {
            continue;
        }
        for (size, zeros) in [(20_000, 0), (97, 0), (20_000, 3), (7_000, 262_139), (7_000, 262_140)] {
            let mut file = header.clone();
            for part in stored.chunks(size) {
                file.extend(codec.encode(part));
                file.extend(vec![0; zeros]);
            }
            assert_eq!(read(folder.path(), name, &[&file]).unwrap(), original(), "{name}: {size}, {zeros}");
        }
    }
}

/// Voxels that go on for gigabytes behind those that the header promises.
#[test]
fn endless_data_are_left() {
    let folder = tempfile::tempdir().unwrap();
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(&nifti()).unwrap();
    let zeros = vec![0; 1 << 20];
    (0..300).for_each(|_| encoder.write_all(&zeros).unwrap());
    let error = read(folder.path(), "a.nii.gz", &[&encoder.finish().unwrap()]).unwrap_err();
    assert!(matches!(error, ReadError::Endless { expected: 48_640, .. }), "{error}");
}

/// Compressed once more, by any codec, is said, whatever the image.
#[test]
fn packed_twice_is_said() {
    let folder = tempfile::tempdir().unwrap();
    for (outer, inner, words) in [
        (Codec::Gzip, Codec::Gzip, "gzip within gzip"),
        (Codec::Gzip, Codec::Bzip2, "bzip2 within gzip"),
        (Codec::Bzip2, Codec::Gzip, "gzip within bzip2"),
    ] {
        for name in ["a.nii.gz", "a.nii", "a.mha.gz", "a.stl.gz"] {
            let twice = outer.encode(&inner.encode(&nifti()));
            let path = folder.path().join(name);
            std::fs::write(&path, twice).unwrap();
            let error = if surfometry::io::is_mesh(&path) {
                surfometry::io::read_mesh(&path).map(drop).unwrap_err()
            } else {
                read_labels(&path).map(drop).unwrap_err()
            };
            let said = error.to_string();
            assert!(said.contains(words) && said.contains("unpack it once"), "{name}: {said}");
        }
    }
}
