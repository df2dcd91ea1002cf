//! What every format's header comes down to.

use super::assembled::Assembled;
use super::packed::open_file;
use super::{Format, ReadError};
use crate::volume::{Affine, Grid, LabelTable, ScalarType, Segments, Spacing, VolumeError};
use std::fs::File;
use std::io::Seek;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// Numbers of so many bytes as little-endian ones.
    pub(crate) fn to_little(self, mut bytes: Vec<u8>, width: usize) -> Vec<u8> {
        if self == Self::Big {
            bytes.chunks_exact_mut(width).for_each(<[u8]>::reverse);
        }
        bytes
    }
}

/// How voxel data are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Raw,
    /// One or several gzip members.
    Gzip,
    Zlib,
    Bzip2,
}

/// Where the voxel data start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DataOffset {
    /// Bytes to skip before decoding.
    Stored(u64),
    /// Bytes to skip after decoding, as in a compressed file that holds header and data.
    Decoded(u64),
    /// The data are the file's last bytes.
    FromEnd,
}

/// The voxels of an image, in one piece of a file or as their format puts them together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Voxels {
    /// One stretch of bytes in a file, compressed or not.
    Stored(VoxelData),
    /// Whatever else: tiles, pages, a file a slice, packed bits.
    Assembled(Assembled),
}

impl Voxels {
    /// The files that hold them.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Stored(data) => vec![data.path.clone()],
            Self::Assembled(assembled) => assembled.0.files(),
        }
    }

    /// Byte order of what is read.
    pub(crate) fn order(&self) -> ByteOrder {
        match self {
            Self::Stored(data) => data.order,
            Self::Assembled(_) => ByteOrder::Little,
        }
    }

    /// Which segments the values stand for, as far as they were read, where segments may overlap.
    pub(crate) fn segments(&self) -> Option<Segments> {
        match self {
            Self::Stored(_) => None,
            Self::Assembled(assembled) => assembled.0.segments(),
        }
    }

    /// value = slope * stored + intercept.
    pub(crate) fn scaling(&self) -> Option<(f64, f64)> {
        match self {
            Self::Stored(data) => data.scaling,
            Self::Assembled(assembled) => assembled.0.scaling(),
        }
    }
}

/// Where and how voxels are stored.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VoxelData {
    pub(crate) path: PathBuf,
    pub(crate) opened: OpenedFile,
    pub(crate) encoding: Encoding,
    pub(crate) offset: DataOffset,
    pub(crate) order: ByteOrder,
    /// value = slope * stored + intercept.
    pub(crate) scaling: Option<(f64, f64)>,
}

/// A file as it was opened for its header, if it was: the first reading of its voxels goes on with it, so
/// that it is opened once, and header and voxels are the same file's whatever the name stands for by then.
#[derive(Debug, Clone, Default)]
pub(crate) struct OpenedFile(Arc<Mutex<Option<File>>>);

impl OpenedFile {
    pub(crate) fn keep(file: File) -> Self {
        Self(Arc::new(Mutex::new(Some(file))))
    }

    fn take(&self) -> Option<File> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Headers are equal whether their files are still open or not.
impl PartialEq for OpenedFile {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl VoxelData {
    /// The file, at its beginning, and how many bytes it has.
    pub(crate) fn file(&self) -> Result<(File, u64), ReadError> {
        let Some(mut file) = self.opened.take() else { return open_file(&self.path) };
        let failed = |e| ReadError::io(&self.path, e);
        file.rewind().map_err(failed)?;
        let bytes = file.metadata().map_err(failed)?.len();
        Ok((file, bytes))
    }
}

/// A header, whatever its format.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageHeader {
    /// The file that it stands in.
    pub path: PathBuf,
    /// Format of the file.
    pub format: Format,
    /// Voxels along x, y, z.
    pub dimensions: [usize; 3],
    /// Type of the stored voxels.
    pub scalar: ScalarType,
    /// Index-to-world transform in mm (RAS); `None` where the file has no spacing.
    pub affine: Option<Affine>,
    /// The spacing as written, where the affine was made from it; it may be impossible.
    pub(crate) stated_spacing: Option<[f64; 3]>,
    /// The file's unit of length, where it is none that is known; lengths are then as they are written.
    pub(crate) unknown_unit: Option<String>,
    /// A second spacing that the file names and that is not the affine's, mm.
    pub other_spacing: Option<[f64; 3]>,
    /// Names and colours of labels, where the file has any.
    pub labels: LabelTable,
    pub(crate) data: Voxels,
}

impl ImageHeader {
    /// The lattice, with the spacing replaced where the caller gave one.
    ///
    /// # Errors
    /// [`VolumeError`] for a missing or impossible spacing, a sheared affine or an impossible size.
    pub fn grid(&self, spacing: Option<[f64; 3]>) -> Result<Grid, VolumeError> {
        if self.affine.is_some() && spacing.is_none() {
            if let Some(unit) = self.unknown_unit.clone() {
                return Err(VolumeError::UnknownUnit { unit });
            }
            self.stated_spacing.map(Spacing::new).transpose()?;
        }
        Grid::of_known(self.dimensions, self.affine, spacing)
    }
}

impl ImageHeader {
    /// Of an image of which nothing else is known.
    pub(crate) fn new(
        path: &Path,
        format: Format,
        dimensions: [usize; 3],
        scalar: ScalarType,
        data: Voxels,
    ) -> Self {
        Self {
            path: path.to_owned(),
            format,
            dimensions,
            scalar,
            affine: None,
            stated_spacing: None,
            unknown_unit: None,
            other_spacing: None,
            labels: LabelTable::default(),
            data,
        }
    }

    /// Bytes that the voxels take.
    pub(crate) fn voxel_bytes(&self) -> u64 {
        let of = |product: u64, &n: &usize| product.saturating_mul(n as u64);
        self.dimensions.iter().fold(self.scalar.bytes() as u64, of)
    }

    /// Bytes of the data file behind the last voxel of raw data; none where the voxels are said to end the
    /// file, or cannot be found.
    pub(crate) fn raw_surplus(&self) -> u64 {
        let Voxels::Stored(data) = &self.data else { return 0 };
        let size = data.path.metadata().map_or(0, |metadata| metadata.len());
        match (data.encoding, data.offset) {
            (Encoding::Raw, DataOffset::Stored(start)) => {
                self.beyond_trailer(size.saturating_sub(start).saturating_sub(self.voxel_bytes()))
            }
            _ => 0,
        }
    }

    /// Of bytes behind the last voxel those that the format does not account for.
    pub(crate) fn beyond_trailer(&self, bytes: u64) -> u64 {
        if bytes > self.format.trailer() { bytes } else { 0 }
    }
}

/// Three dimensions out of a header's list: trailing axes of one voxel are dropped, anything else is refused.
pub(crate) fn three_dimensions(stored: &[usize]) -> Result<[usize; 3], ReadError> {
    if stored.contains(&0) || stored.is_empty() {
        return Err(VolumeError::EmptyAxis { dimensions: stored.to_vec() }.into());
    }
    refuse_several(stored, stored.iter().skip(3))?;
    let volume = &stored[..stored.len().min(3)];
    if volume.len() < 3 || volume.contains(&1) {
        let cure = "stack the slices of a 2-D series into one volume first";
        return Err(VolumeError::NotThreeDimensional { dimensions: stored.to_vec(), cure }.into());
    }
    Ok([volume[0], volume[1], volume[2]])
}

/// Refuses more than one sample along the axes that are not space.
pub(crate) fn refuse_several<'a>(
    stored: &[usize],
    other_axes: impl Iterator<Item = &'a usize>,
) -> Result<(), ReadError> {
    match other_axes.fold(1usize, |product, &n| product.saturating_mul(n)) {
        0 | 1 => Ok(()),
        _ if stored.len() == 4 && stored[0] == 1 => {
            Err(ReadError::ChannelFirst { dimensions: stored.to_vec() })
        }
        count => Err(ReadError::SeveralVolumes { dimensions: stored.to_vec(), count }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_three() {
        assert_eq!(three_dimensions(&[4, 5, 6, 1, 1]).unwrap(), [4, 5, 6]);
        assert!(matches!(three_dimensions(&[4, 5, 6, 2]), Err(ReadError::SeveralVolumes { count: 2, .. })));
        for flat in [&[4, 5][..], &[4, 5, 1], &[4, 5, 1, 1]] {
            let error = three_dimensions(flat);
            assert!(
                matches!(error, Err(ReadError::Volume(VolumeError::NotThreeDimensional { .. }))),
                "{flat:?}"
            );
        }
        assert!(matches!(
            three_dimensions(&[4, 0, 5]),
            Err(ReadError::Volume(VolumeError::EmptyAxis { .. }))
        ));
    }
}
