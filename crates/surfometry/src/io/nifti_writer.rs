//! Writes label images and voxel maps as NIfTI-1, or NIfTI-2 where an axis is too long for it.

use super::write_whole;
use crate::volume::{Affine, Grid, LabelImage};
use flate2::{Compression, write::GzEncoder};
use std::io::{self, Write};
use std::path::Path;

/// Writes a label image as .nii, or .nii.gz where the name says so, with sform and qform set. Labels are
/// stored in the smallest integer type that holds them. The file appears whole or not at all.
///
/// # Errors
/// Whatever the file system says.
pub fn write_labels(path: impl AsRef<Path>, image: &LabelImage) -> io::Result<()> {
    write_nifti(path.as_ref(), |out| write_image(out, image))
}

/// Writes one number a voxel, x fastest, in single precision, with its name in the header's description.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] where the number of values is not the grid's; whatever the file system
/// says.
pub fn write_voxel_map(path: impl AsRef<Path>, grid: &Grid, values: &[f32], name: &str) -> io::Result<()> {
    if values.len() != grid.voxel_count() {
        let message = format!("{} values for {} voxels", values.len(), grid.voxel_count());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    write_nifti(path.as_ref(), |out| {
        out.write_all(&header(grid, FLOAT32, 4, name))?;
        // A piece at a time: a map is as large as its image.
        values.chunks(1 << 16).try_for_each(|piece| {
            out.write_all(&piece.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
        })
    })
}

fn write_nifti(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let compressed = path.to_string_lossy().to_lowercase().ends_with(".gz");
    write_whole(path, |out| {
        if compressed {
            let mut encoder = GzEncoder::new(out, Compression::new(4));
            write(&mut encoder)?;
            encoder.finish().map(drop)
        } else {
            write(out)
        }
    })
}

/// NIfTI's code for 32-bit floats.
const FLOAT32: i16 = 16;

/// An integer type of NIfTI: code, bytes, and the range that it holds.
const TYPES: [(i16, usize, i64, i64); 5] = [
    (2, 1, 0, u8::MAX as i64),
    (4, 2, i16::MIN as i64, i16::MAX as i64),
    (512, 2, 0, u16::MAX as i64),
    (8, 4, i32::MIN as i64, i32::MAX as i64),
    (1024, 8, i64::MIN, i64::MAX),
];

fn write_image(out: &mut dyn Write, image: &LabelImage) -> io::Result<()> {
    let labels = || image.summaries().iter().map(|s| s.label);
    let (low, high) = (labels().min().unwrap_or(0).min(0), labels().max().unwrap_or(0).max(0));
    let fits = |t: &&(i16, usize, i64, i64)| t.2 <= low && high <= t.3;
    let &(code, bytes, ..) = TYPES.iter().find(fits).expect("i64 holds every label");
    out.write_all(&header(image.grid(), code, bytes, "labels"))?;
    let [nx, ny, nz] = image.grid().dimensions();
    for (y, z) in (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z))) {
        for x in 0..nx {
            out.write_all(&image.get([x, y, z]).to_le_bytes()[..bytes])?;
        }
    }
    Ok(())
}

/// Bytes of a header under construction.
struct Header(Vec<u8>);

impl Header {
    fn put<const N: usize>(&mut self, offset: usize, bytes: [u8; N]) {
        self.0[offset..offset + N].copy_from_slice(&bytes);
    }

    /// The description's 80 bytes, the last of which stays 0.
    fn describe(&mut self, offset: usize, name: &str) {
        let text = &name.as_bytes()[..name.len().min(79)];
        self.0[offset..offset + text.len()].copy_from_slice(text);
    }
}

fn header(grid: &Grid, datatype: i16, bytes: usize, name: &str) -> Vec<u8> {
    if grid.dimensions().iter().all(|&n| i16::try_from(n).is_ok()) {
        header_1(grid, datatype, bytes, name)
    } else {
        header_2(grid, datatype, bytes, name)
    }
}

/// Scanner coordinates: the code of both forms.
const SCANNER: i16 = 1;
/// Millimetres.
const MM: u8 = 2;

fn header_1(grid: &Grid, datatype: i16, bytes: usize, name: &str) -> Vec<u8> {
    let mut h = Header(vec![0; 352]);
    let form = Form::of(grid);
    h.put(0, 348i32.to_le_bytes());
    for (i, n) in [3].into_iter().chain(grid.dimensions()).chain([1; 4]).enumerate() {
        h.put(40 + 2 * i, (n as i16).to_le_bytes());
    }
    h.put(70, datatype.to_le_bytes());
    h.put(72, (8 * bytes as i16).to_le_bytes());
    let single = |v: f64| (v as f32).to_le_bytes();
    form.pixdim(grid).into_iter().enumerate().for_each(|(i, v)| h.put(76 + 4 * i, single(v)));
    h.put(108, 352f32.to_le_bytes());
    h.put(112, 1f32.to_le_bytes());
    h.put(123, [MM]);
    h.describe(148, name);
    h.put(252, SCANNER.to_le_bytes());
    h.put(254, SCANNER.to_le_bytes());
    form.numbers().into_iter().enumerate().for_each(|(i, v)| h.put(256 + 4 * i, single(v)));
    h.put(344, *b"n+1\0");
    h.0
}

fn header_2(grid: &Grid, datatype: i16, bytes: usize, name: &str) -> Vec<u8> {
    let mut h = Header(vec![0; 544]);
    let form = Form::of(grid);
    h.put(0, 540i32.to_le_bytes());
    h.put(4, *b"n+2\0\r\n\x1a\n");
    h.put(12, datatype.to_le_bytes());
    h.put(14, (8 * bytes as i16).to_le_bytes());
    for (i, n) in [3].into_iter().chain(grid.dimensions()).chain([1; 4]).enumerate() {
        h.put(16 + 8 * i, (n as i64).to_le_bytes());
    }
    form.pixdim(grid).into_iter().enumerate().for_each(|(i, v)| h.put(104 + 8 * i, v.to_le_bytes()));
    h.put(168, 544i64.to_le_bytes());
    h.put(176, 1f64.to_le_bytes());
    h.describe(240, name);
    h.put(344, i32::from(SCANNER).to_le_bytes());
    h.put(348, i32::from(SCANNER).to_le_bytes());
    form.numbers().into_iter().enumerate().for_each(|(i, v)| h.put(352 + 8 * i, v.to_le_bytes()));
    h.put(500, i32::from(MM).to_le_bytes());
    h.0
}

/// Orientation, as NIfTI wants it.
struct Form {
    affine: Affine,
    qfac: f64,
    quaternion: [f64; 3],
}

impl Form {
    fn of(grid: &Grid) -> Self {
        let affine = *grid.affine();
        let qfac = affine.determinant().signum();
        let spacing = grid.spacing().mm();
        let unit = |w: usize, a: usize| affine.linear[w][a] / spacing[a] * if a == 2 { qfac } else { 1.0 };
        let r = std::array::from_fn(|w| std::array::from_fn(|a| unit(w, a)));
        Self { affine, qfac, quaternion: quaternion(&r) }
    }

    /// qfac, spacings, and ones for the axes that are not there.
    fn pixdim(&self, grid: &Grid) -> Vec<f64> {
        [self.qfac].into_iter().chain(grid.spacing().mm()).chain([1.0; 4]).collect()
    }

    /// Quaternion, its offset, then the three rows of the sform: the order of both header versions.
    fn numbers(&self) -> Vec<f64> {
        let rows = (0..3).flat_map(|w| self.affine.linear[w].into_iter().chain([self.affine.origin[w]]));
        self.quaternion.into_iter().chain(self.affine.origin).chain(rows).collect()
    }
}

/// The vector part of a rotation's unit quaternion with a scalar part that is not negative; from the largest
/// of the four, which keeps the division safe.
fn quaternion(r: &[[f64; 3]; 3]) -> [f64; 3] {
    let squares = [
        1.0 + r[0][0] + r[1][1] + r[2][2],
        1.0 + r[0][0] - r[1][1] - r[2][2],
        1.0 - r[0][0] + r[1][1] - r[2][2],
        1.0 - r[0][0] - r[1][1] + r[2][2],
    ];
    let largest = (0..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let twice = libm::sqrt(squares[largest]);
    let sums = [
        [squares[0], r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]],
        [r[2][1] - r[1][2], squares[1], r[0][1] + r[1][0], r[0][2] + r[2][0]],
        [r[0][2] - r[2][0], r[0][1] + r[1][0], squares[2], r[1][2] + r[2][1]],
        [r[1][0] - r[0][1], r[0][2] + r[2][0], r[1][2] + r[2][1], squares[3]],
    ];
    let q = sums[largest].map(|s| 0.5 * s / twice);
    let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
    [q[1] * sign, q[2] * sign, q[3] * sign]
}
