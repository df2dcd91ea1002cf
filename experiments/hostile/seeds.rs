//! Small files that are right, of every kind that is read. Another format is a line of [`files`].

use bzip2::write::BzEncoder;
use flate2::write::{GzEncoder, ZlibEncoder};
use std::io::Write;

/// A file by its ending.
#[derive(Debug, Clone)]
pub(crate) struct Seed {
    pub(crate) ending: &'static str,
    pub(crate) bytes: Vec<u8>,
}

const SIZE: [usize; 3] = [9, 8, 7];

/// A body of two labels, mixed enough that compressed it has some hundred bytes.
fn voxels() -> Vec<u8> {
    let [nx, ny, nz] = SIZE;
    let label = |n: usize| match [n % nx, n / nx % ny, n / nx / ny] {
        [x, y, z] if x == 0 || y == 0 || z == 0 || x + 1 == nx || y + 1 == ny || z + 1 == nz => 0,
        [x, y, z] if (7 * x * y + 13 * y * z + 5 * z * x) % 11 < 6 => 1,
        _ => 3,
    };
    (0..nx * ny * nz).map(label).collect()
}

/// Images, meshes and tables.
pub(crate) fn files() -> Vec<Seed> {
    let seed = |ending, bytes| Seed { ending, bytes };
    let (nifti_1, nifti_2) = (nifti_1(), nifti_2());
    vec![
        seed("nii.gz", gzip(&nifti_1)),
        seed("nii.gz", gzip(&nifti_2)),
        seed("nii", nifti_1),
        seed("nii", nifti_2),
        seed("mha", meta("False", &voxels())),
        seed("mha", meta("True", &zlib(&voxels()))),
        seed("nrrd", nrrd("raw", &voxels())),
        seed("nrrd", nrrd("gzip", &gzip(&voxels()))),
        seed("nrrd", nrrd("bzip2", &bzip2(&voxels()))),
        seed("npy", npy()),
        seed("stl", stl_text().into_bytes()),
        seed("stl", stl_binary()),
        seed("ply", ply_text().into_bytes()),
        seed("ply", ply_binary()),
        seed("csv", table(',').into_bytes()),
        seed("tsv", table('\t').into_bytes()),
    ]
}

/// The compressed ones, of which no flipped bit may give other voxels.
pub(crate) fn compressed() -> Vec<Seed> {
    let is_packed = |seed: &Seed| {
        seed.ending == "nii.gz"
            || ["CompressedData = True", "encoding: gzip", "encoding: bzip2"]
                .iter()
                .any(|words| has(&seed.bytes, words))
    };
    files().into_iter().filter(is_packed).collect()
}

fn has(bytes: &[u8], words: &str) -> bool {
    bytes.windows(words.len()).any(|window| window == words.as_bytes())
}

fn put(header: &mut [u8], offset: usize, bytes: &[u8]) {
    header[offset..offset + bytes.len()].copy_from_slice(bytes);
}

fn nifti_1() -> Vec<u8> {
    let mut header = vec![0; 352];
    put(&mut header, 0, &348i32.to_le_bytes());
    for (place, n) in [3, SIZE[0], SIZE[1], SIZE[2], 1, 1, 1, 1].into_iter().enumerate() {
        put(&mut header, 40 + 2 * place, &(n as i16).to_le_bytes());
    }
    put(&mut header, 70, &2i16.to_le_bytes());
    put(&mut header, 72, &8i16.to_le_bytes());
    for (place, h) in [1f32, 0.8, 1.0, 1.5].into_iter().enumerate() {
        put(&mut header, 76 + 4 * place, &h.to_le_bytes());
    }
    put(&mut header, 108, &352f32.to_le_bytes());
    header[123] = 2;
    put(&mut header, 252, &1i16.to_le_bytes());
    put(&mut header, 344, b"n+1\0");
    header.extend(voxels());
    header
}

fn nifti_2() -> Vec<u8> {
    let mut header = vec![0; 544];
    put(&mut header, 0, &540i32.to_le_bytes());
    put(&mut header, 4, b"n+2\0\r\n\x1a\n");
    put(&mut header, 12, &2i16.to_le_bytes());
    for (place, n) in [3, SIZE[0], SIZE[1], SIZE[2], 1, 1, 1, 1].into_iter().enumerate() {
        put(&mut header, 16 + 8 * place, &(n as i64).to_le_bytes());
    }
    for (place, h) in [1.0, 0.8, 1.0, 1.5].into_iter().enumerate() {
        put(&mut header, 104 + 8 * place, &f64::to_le_bytes(h));
    }
    put(&mut header, 168, &544i64.to_le_bytes());
    put(&mut header, 348, &1i32.to_le_bytes());
    for (place, v) in [(400, 0.8), (440, 1.0), (480, 1.5)] {
        put(&mut header, place, &f64::to_le_bytes(v));
    }
    put(&mut header, 500, &2i32.to_le_bytes());
    header.extend(voxels());
    header
}

fn meta(packed: &str, data: &[u8]) -> Vec<u8> {
    let [x, y, z] = SIZE;
    let header = format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = {packed}\nCompressedDataSize = {}\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 0.8 1 1.5\nDimSize = {x} {y} {z}\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
        data.len()
    );
    [header.as_bytes(), data].concat()
}

fn nrrd(encoding: &str, data: &[u8]) -> Vec<u8> {
    let [x, y, z] = SIZE;
    let header = format!(
        "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: {x} {y} {z}\nspace directions: (0.8,0,0) (0,1,0) (0,0,1.5)\nkinds: domain domain domain\nendian: little\nencoding: {encoding}\nspace origin: (1,2,3)\n\n"
    );
    [header.as_bytes(), data].concat()
}

fn npy() -> Vec<u8> {
    let mut text = format!(
        "{{'descr': '|u1', 'fortran_order': True, 'shape': ({}, {}, {}), }}",
        SIZE[0], SIZE[1], SIZE[2]
    );
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.into_bytes());
    bytes.extend(voxels());
    bytes
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 4.0]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

fn stl_text() -> String {
    let corner = |n: usize| CORNERS[n].map(|v| v.to_string()).join(" ");
    let facet = |face: &[usize; 3]| {
        format!(
            "facet normal 0 0 0\nouter loop\nvertex {}\nvertex {}\nvertex {}\nendloop\nendfacet\n",
            corner(face[0]),
            corner(face[1]),
            corner(face[2])
        )
    };
    format!("solid a\n{}endsolid a\n", FACES.iter().map(facet).collect::<String>())
}

fn stl_binary() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((FACES.len() as u32).to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|&n| CORNERS[n]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment small\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn ply_text() -> String {
    let line = |words: Vec<String>| words.join(" ") + "\n";
    let corners = CORNERS.iter().map(|c| line(c.map(|v| v.to_string()).to_vec()));
    let faces = FACES.iter().map(|f| format!("3 {}", line(f.map(|v| v.to_string()).to_vec())));
    corners.chain(faces).fold(ply_header("ascii"), |text, line| text + &line)
}

fn ply_binary() -> Vec<u8> {
    let mut bytes = ply_header("binary_little_endian").into_bytes();
    bytes.extend(CORNERS.iter().flatten().flat_map(|v| v.to_le_bytes()));
    for face in FACES {
        bytes.push(3);
        bytes.extend(face.iter().flat_map(|&n| (n as i32).to_le_bytes()));
    }
    bytes
}

fn table(separator: char) -> String {
    let lines = ["input,label,volume_mm3,surface_area_mm2,euler_characteristic,flags,error"]
        .into_iter()
        .map(str::to_owned);
    let row = |n: u32| {
        format!("S{n}.nii.gz,1,{}.5,{}.25,2,touches-border;thin-for-sigma,", 100 + 7 * n, 90 + 3 * n)
    };
    lines.chain((1..8).map(row)).map(|line| line.replace(',', &separator.to_string()) + "\n").collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("memory takes all")
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("memory takes all")
}

fn bzip2(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = BzEncoder::new(Vec::new(), bzip2::Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("memory takes all")
}
