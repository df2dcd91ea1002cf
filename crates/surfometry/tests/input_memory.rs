//! Memory that an input may take, however small its file: one test, because the peak is the process'.

use std::io::Write;
use std::path::Path;
use surfometry::io::{read_labels, read_mesh};

#[global_allocator]
static PEAK: peak_alloc::PeakAlloc = peak_alloc::PeakAlloc;

fn peak<T>(work: impl FnOnce() -> T) -> (T, usize) {
    PEAK.reset_peak_usage();
    let before = PEAK.current_usage();
    let result = work();
    (result, PEAK.peak_usage() - before)
}

#[test]
fn memory_of_inputs() {
    let folder = tempfile::tempdir().unwrap();
    a_mesh_takes_little_more_than_itself(folder.path());
    slices_of_four_voxels(folder.path());
    xml_of_comments_and_text(folder.path());
    pages_of_one_strip(folder.path());
}

/// A binary PLY with what scanners add: normals, colours, and elements of no use here.
fn a_mesh_takes_little_more_than_itself(folder: &Path) {
    let side = 500u32;
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\nproperty list uchar int vertex_indices\nelement edge 1000\nproperty int vertex1\nproperty int vertex2\nend_header\n",
        side * side,
        2 * (side - 1) * (side - 1)
    )
    .into_bytes();
    for n in 0..side * side {
        let place = [(n % side) as f32, (n / side) as f32, 0.5, 0.0, 0.0, 1.0];
        file.extend(place.iter().flat_map(|v| v.to_le_bytes()));
        file.extend([1, 2, 3]);
    }
    for y in 0..side - 1 {
        for x in 0..side - 1 {
            let corner = y * side + x;
            for triangle in
                [[corner, corner + 1, corner + side], [corner + 1, corner + side + 1, corner + side]]
            {
                file.push(3);
                file.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
            }
        }
    }
    file.extend([0; 8000]);
    let path = folder.join("scan.ply");
    std::fs::write(&path, &file).unwrap();
    drop(file);
    let (mesh, used) = peak(|| read_mesh(&path).unwrap());
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (250_000, 498_002));
    assert_eq!((mesh.vertices[501], mesh.triangles[1]), ([1.0, 1.0, 0.5], [1, 501, 500]));
    let itself = 24 * mesh.vertices.len() + 12 * mesh.triangles.len();
    println!("{used} bytes for a mesh of {itself}");
    assert!(used < 4 * itself, "{used} bytes for a mesh of {itself}");
}

/// As many slices as an image may have, of four voxels each, from a file of some kilobytes; more are refused
/// before any is read.
fn slices_of_four_voxels(folder: &Path) {
    let write = |slices: i64| {
        let mut header = vec![0u8; 544];
        let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, &540i32.to_le_bytes());
        put(4, b"n+2\0\r\n\x1a\n");
        put(12, &2i16.to_le_bytes());
        [3, 2, 2, slices].iter().enumerate().for_each(|(i, n)| put(16 + 8 * i, &n.to_le_bytes()));
        (0..4).for_each(|i| put(104 + 8 * i, &1f64.to_le_bytes()));
        put(168, &544i64.to_le_bytes());
        let path = folder.join("flat.nii.gz");
        let file = std::fs::File::create(&path).unwrap();
        let mut encoder = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
        encoder.write_all(&header).unwrap();
        let voxels = vec![1u8; 1 << 20];
        let mut left = 4 * slices as usize;
        while left > 0 {
            left -= encoder.write(&voxels[..left.min(voxels.len())]).unwrap();
        }
        encoder.finish().unwrap();
        path
    };
    let most = write(1 << 20);
    let (image, used) = peak(|| read_labels(&most).unwrap());
    assert_eq!(image.summaries()[0].voxels, 4 << 20);
    println!("{used} bytes for 2^20 slices");
    assert!(used < 400 << 20, "{used} bytes");
    let more = write(47_000_000);
    let (refused, used) = peak(|| read_labels(&more).unwrap_err().to_string());
    assert!(refused.contains("47000000 voxels along axis 2") && used < 1 << 20, "{refused}: {used} bytes");
}

fn gzip(path: &Path, parts: &[(&[u8], usize)]) {
    let file = std::fs::File::create(path).unwrap();
    let mut encoder = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    for (bytes, times) in parts {
        (0..*times).for_each(|_| encoder.write_all(bytes).unwrap());
    }
    encoder.finish().unwrap();
}

/// XML whose comments, or texts, unpack to hundreds of megabytes: neither is held.
fn xml_of_comments_and_text(folder: &Path) {
    let blank = vec![b' '; 1 << 20];
    let head = b"<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 3 0 4 0 5\" Spacing=\"1 1 1\"><Piece><PointData>\
        <DataArray type=\"UInt8\" format=\"ascii\">";
    let tail = b"</DataArray></PointData></Piece></ImageData></VTKFile>";
    let text = folder.join("text.vti.gz");
    gzip(&text, &[(head, 1), (b"1 ", 60), (&blank, 200), (b"1 ", 60), (tail, 1)]);
    let comment = folder.join("comment.vti.gz");
    gzip(&comment, &[(b"<!-- ", 1), (&blank, 200), (b"-->", 1), (head, 1), (b"1 ", 120), (tail, 1)]);
    let quotes = vec![b'A'; 1 << 20];
    let elements = folder.join("elements.vti.gz");
    gzip(&elements, &[(b"<VTKFile a=\"", 1), (&quotes, 200), (b"\"/>", 1)]);
    for path in [&text, &comment] {
        let (image, used) = peak(|| read_labels(path).unwrap());
        assert_eq!(image.summaries()[0].voxels, 120);
        assert!(used < 16 << 20, "{}: {used} bytes", path.display());
    }
    let (refused, used) = peak(|| read_labels(&elements).unwrap_err().to_string());
    assert!(refused.contains("no image's") && used < 16 << 20, "{refused}: {used} bytes");
}

/// A page of a TIFF may have its pixels where another one has them: thousands of pages, and no more memory for it.
fn pages_of_one_strip(folder: &Path) {
    let (side, pages) = (128u32, 20_000u32);
    let mut file = b"II*\0\x08\0\0\0".to_vec();
    let strip = 8 + pages * (2 + 12 * 9 + 4);
    for page in 1..=pages {
        let tags: [(u16, u16, u32); 9] = [
            (256, 4, side),
            (257, 4, side),
            (258, 3, 8),
            (259, 3, 1),
            (262, 3, 1),
            (273, 4, strip),
            (277, 3, 1),
            (278, 4, side),
            (279, 4, side * side),
        ];
        file.extend((tags.len() as u16).to_le_bytes());
        for (tag, kind, value) in tags {
            file.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
            file.extend([1u32.to_le_bytes(), value.to_le_bytes()].concat());
        }
        let next = if page == pages { 0 } else { file.len() as u32 + 4 };
        file.extend(next.to_le_bytes());
    }
    file.extend((0..side * side).map(|i| u8::from((i / 11) % 3 == 0)));
    let path = folder.join("pages.tif");
    std::fs::write(&path, &file).unwrap();
    drop(file);
    let options = surfometry::io::ReadOptions { spacing: Some([1.0; 3]) };
    let (count, used) = peak(|| {
        let mut slabs = surfometry::io::VoxelStream::open(&path, options).unwrap();
        let mut count = 0;
        while let Some(slab) = surfometry::volume::SlabReader::next_slab(&mut slabs).unwrap() {
            count += slab.slices.len();
        }
        count
    });
    println!("{used} bytes for {count} pages");
    assert!(count == pages as usize && used < 64 << 20, "{used} bytes");
}
