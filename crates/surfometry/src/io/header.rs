//! What every format's header comes down to.

use super::ReadError;
use crate::volume::{Affine, Grid, ScalarType, Spacing, VolumeError};
use std::fs::File;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A supported file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// NIfTI-1 and NIfTI-2: .nii, .nii.gz, .hdr + .img.
    Nifti,
    /// MetaImage: .mha, .mhd + raw.
    MetaImage,
    /// NRRD: .nrrd, .nhdr + raw.
    Nrrd,
    /// NumPy: .npy.
    Npy,
}

const SUPPORTED: &str = "supported are NIfTI (.nii, .nii.gz, .hdr/.img), MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr) and NumPy (.npy)";

impl Format {
    /// How names of its files end.
    pub(crate) const ENDINGS: [(Self, &[&str]); 4] = [
        (Self::Nifti, &[".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"]),
        (Self::MetaImage, &[".mha", ".mhd"]),
        (Self::Nrrd, &[".nrrd", ".nhdr"]),
        (Self::Npy, &[".npy"]),
    ];

    /// The format of a file, by its name.
    ///
    /// # Errors
    /// [`ReadError`] for a folder, a missing or empty file, or an unknown ending.
    pub fn detect(path: &Path) -> Result<Self, ReadError> {
        let pattern = path.to_string_lossy().contains(['*', '?', '[']);
        let metadata = path.metadata().map_err(|e| match e.kind() {
            std::io::ErrorKind::NotFound if pattern => {
                ReadError::UnknownFormat("no file matches this pattern".into())
            }
            _ => ReadError::io(path, e),
        })?;
        if metadata.is_dir() {
            let message = format!("a folder: DICOM series and OME-Zarr are not read yet; {SUPPORTED}");
            return Err(ReadError::UnknownFormat(message));
        }
        if !metadata.is_file() {
            return Err(ReadError::UnknownFormat(
                "a device or pipe, not a file; copy its contents to a file first".into(),
            ));
        }
        if metadata.len() == 0 {
            return Err(ReadError::UnknownFormat(
                "the file is empty (0 bytes); copy or export it again".into(),
            ));
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let known = Self::ENDINGS.iter().find(|(_, list)| list.iter().any(|e| name.ends_with(e)));
        known.map(|(format, _)| *format).ok_or_else(|| {
            ReadError::UnknownFormat(format!("the file's ending names no format that is read; {SUPPORTED}"))
        })
    }

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nifti => "NIfTI",
            Self::MetaImage => "MetaImage",
            Self::Nrrd => "NRRD",
            Self::Npy => "NumPy",
        }
    }
}

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
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
    /// A second spacing that the file names and that is not the affine's, mm.
    pub other_spacing: Option<[f64; 3]>,
    pub(crate) data: VoxelData,
}

impl ImageHeader {
    /// The lattice, with the spacing replaced where the caller gave one.
    ///
    /// # Errors
    /// [`VolumeError`] for a missing or impossible spacing, a sheared affine or an impossible size.
    pub fn grid(&self, spacing: Option<[f64; 3]>) -> Result<Grid, VolumeError> {
        if self.affine.is_some() && spacing.is_none() {
            self.stated_spacing.map(Spacing::new).transpose()?;
        }
        Grid::of_known(self.dimensions, self.affine, spacing)
    }
}

impl ImageHeader {
    /// Bytes that the voxels take.
    pub(crate) fn voxel_bytes(&self) -> u64 {
        self.dimensions.iter().map(|&n| n as u64).product::<u64>() * self.scalar.bytes() as u64
    }

    /// Bytes of the data file behind the last voxel of raw data; none where the voxels are said to end the
    /// file, or cannot be found.
    pub(crate) fn raw_surplus(&self) -> u64 {
        let size = self.data.path.metadata().map_or(0, |metadata| metadata.len());
        match (self.data.encoding, self.data.offset) {
            (Encoding::Raw, DataOffset::Stored(start)) => {
                size.saturating_sub(start).saturating_sub(self.voxel_bytes())
            }
            _ => 0,
        }
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
        count => Err(ReadError::SeveralVolumes { dimensions: stored.to_vec(), count }),
    }
}

/// Opens a file, and says how many bytes it has. A pipe, a device or a folder is refused before it is
/// touched: opening a pipe waits for who writes to it.
pub(crate) fn open_file(path: &Path) -> Result<(File, u64), ReadError> {
    let failed = |e| ReadError::io(path, e);
    let metadata = path.metadata().map_err(failed)?;
    if !metadata.is_file() {
        let kind = if metadata.is_dir() { "a folder" } else { "a device or pipe" };
        return Err(ReadError::NotAFile { path: path.to_owned(), kind });
    }
    Ok((File::open(path).map_err(failed)?, metadata.len()))
}

/// Reads the start of a file, at most `limit` bytes.
pub(crate) fn read_start(path: &Path, limit: u64) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let (file, _) = open_file(path)?;
    file.take(limit).read_to_end(&mut bytes).map_err(|e| ReadError::io(path, e))?;
    Ok(bytes)
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
