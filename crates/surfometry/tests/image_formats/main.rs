//! Image files made here, byte by byte as their formats' specifications have them, are read as they are meant;
//! `tests/oracles` does the same with files of the formats' own libraries.

mod mgh;
mod scanco;
mod series;
mod tiff;
mod vtk;
#[cfg(feature = "zarr")]
mod zarr;

use std::path::{Path, PathBuf};
use surfometry::io::{ReadOptions, read_labels_with};
use surfometry::volume::{Affine, LabelImage};
use tempfile::TempDir;

/// Odd along two axes, so that nothing fits by accident.
pub(crate) const SIZE: [usize; 3] = [7, 5, 6];
pub(crate) const SPACING: [f64; 3] = [0.5, 0.75, 2.0];

/// An object that is no mirror image of itself, clear of the border by one voxel.
pub(crate) fn label(x: usize, y: usize, z: usize) -> u8 {
    let inside = (1..6).contains(&x) && (1..4).contains(&y) && (1..5).contains(&z);
    u8::from(inside && x + 2 * y + 3 * z > 8)
}

/// All voxels, x fastest.
pub(crate) fn voxels() -> Vec<u8> {
    let [nx, ny, nz] = SIZE;
    (0..nx * ny * nz).map(|i| label(i % nx, i / nx % ny, i / nx / ny)).collect()
}

/// A file of these bytes in a folder of its own.
pub(crate) fn file(name: &str, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// The file holds [`voxels`] times `value`, at these places.
#[track_caller]
pub(crate) fn assert_read(path: &Path, spacing: Option<[f64; 3]>, value: i64, affine: Affine) {
    let image = read_labels_with(path, ReadOptions { spacing }).unwrap();
    assert_labels(&image, value);
    for corner in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        let (found, expected) = (image.grid().affine().apply(corner), affine.apply(corner));
        let near = found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-5);
        assert!(near, "{corner:?} at {found:?}, not {expected:?}");
    }
}

#[track_caller]
pub(crate) fn assert_labels(image: &LabelImage, value: i64) {
    assert_eq!(image.grid().dimensions(), SIZE);
    for (i, voxel) in voxels().into_iter().enumerate() {
        let index = image.grid().index_of(i);
        assert_eq!(image.get(index), i64::from(voxel) * value, "{index:?}");
    }
}

/// What is said of a file that is refused.
#[track_caller]
pub(crate) fn refusal(path: &Path) -> String {
    read_labels_with(path, ReadOptions::default()).map(drop).unwrap_err().to_string()
}

/// Refused in these words.
#[track_caller]
pub(crate) fn assert_refused(path: &Path, words: &[&str]) {
    let said = refusal(path);
    assert!(words.iter().all(|word| said.contains(word)), "{said}");
}

/// With gzip around it.
pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    // Stored blocks: no compression, but all of gzip's frame.
    let mut packed = vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255];
    for (number, block) in bytes.chunks(0xffff).enumerate() {
        let last = (number + 1) * 0xffff >= bytes.len();
        let size = block.len() as u16;
        packed.push(u8::from(last));
        packed.extend(size.to_le_bytes());
        packed.extend((!size).to_le_bytes());
        packed.extend(block);
    }
    packed.extend(crc32(bytes).to_le_bytes());
    packed.extend((bytes.len() as u32).to_le_bytes());
    packed
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}
