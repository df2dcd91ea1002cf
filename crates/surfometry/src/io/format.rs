//! Which format a file has.

use super::ReadError;
#[cfg(feature = "dicom")]
use super::dicom;
use super::{foreign, mask_folder, stack, unread};
use std::path::Path;

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
    /// FreeSurfer: .mgh, .mgz.
    Mgh,
    /// Scanco AIM: .aim, also with a version behind it (`.AIM;1`).
    Aim,
    /// Scanco ISQ: .isq.
    Isq,
    /// DICOM: a file, a folder of a series; by content, whatever its name.
    #[cfg(feature = "dicom")]
    Dicom,
    /// A folder of masks, a class a file.
    MaskFolder,
    /// TIFF: .tif, .tiff.
    Tiff,
    /// Legacy VTK, structured points: .vtk.
    LegacyVtk,
    /// VTK's XML image data: .vti.
    Vti,
    /// Voxels without a header.
    Raw,
    /// A folder of slices, each a TIFF or PNG file.
    Slices,
    /// Zarr and OME-Zarr: a folder.
    #[cfg(feature = "zarr")]
    Zarr,
}

const SUPPORTED: &str = "supported are NIfTI (.nii, .nii.gz, .hdr/.img), MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr, .seg.nrrd), NumPy (.npy), DICOM (by content), FreeSurfer (.mgh, .mgz), Scanco (.aim, .isq), TIFF (.tif), VTK (.vtk, .vti), OME-Zarr (.zarr), and folders of TIFF or PNG slices, of masks, or of a DICOM series";

/// Endings of files that are compressed as a whole.
pub(crate) const PACKED: [&str; 2] = [".gz", ".bz2"];

/// Endings of NIfTI's pairs of files.
const PAIRED: [&str; 2] = [".hdr", ".img"];

impl Format {
    /// How names of its files end.
    pub(crate) const ENDINGS: [(Self, &[&str]); 10] = [
        (Self::Nifti, &[".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"]),
        (Self::MetaImage, &[".mha", ".mhd"]),
        (Self::Nrrd, &[".nrrd", ".nhdr"]),
        (Self::Npy, &[".npy"]),
        (Self::Mgh, &[".mgh", ".mgz"]),
        (Self::Aim, &[".aim"]),
        (Self::Isq, &[".isq"]),
        (Self::Tiff, &[".tif", ".tiff"]),
        (Self::LegacyVtk, &[".vtk"]),
        (Self::Vti, &[".vti"]),
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
            return Self::of_folder(path);
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
        let known = Self::of_name(path).or_else(|| Self::of_content(path));
        known.ok_or_else(|| unread::of_file(path).unwrap_or_else(|| unknown(path)))
    }

    /// The format of a file whose name tells nothing.
    #[cfg(feature = "dicom")]
    fn of_content(path: &Path) -> Option<Self> {
        dicom::is_dicom(path).then_some(Self::Dicom)
    }

    #[cfg(not(feature = "dicom"))]
    fn of_content(_: &Path) -> Option<Self> {
        None
    }

    /// The format of a folder, by what it holds.
    fn of_folder(path: &Path) -> Result<Self, ReadError> {
        #[cfg(feature = "zarr")]
        if super::zarr::is_zarr(path) {
            return Ok(Self::Zarr);
        }
        // In front of slices: TotalSegmentator puts a picture beside its masks.
        if !mask_folder::masks(path)?.is_empty() {
            return Ok(Self::MaskFolder);
        }
        if stack::holds_slices(path) {
            return Ok(Self::Slices);
        }
        #[cfg(feature = "dicom")]
        if !dicom::files(path)?.is_empty() {
            return Ok(Self::Dicom);
        }
        if let Some(error) = unread::of_folder(path)? {
            return Err(error);
        }
        let message = "a folder that is no Zarr, and without slices, masks or DICOM files";
        Err(ReadError::UnknownFormat(format!("{message}; {SUPPORTED}")))
    }

    /// By the name's ending, in front of that of a file compressed as a whole.
    pub(super) fn of_name(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let name = without_version(&name);
        let of = |name: &str| Self::ENDINGS.iter().find(|(_, list)| list.iter().any(|e| name.ends_with(e)));
        let unpacked = PACKED.iter().find_map(|packed| name.strip_suffix(packed));
        of(name).or_else(|| of(unpacked?)).map(|(format, _)| *format)
    }

    /// Whether a file holds header and voxels, whatever stands in it: others may name further files.
    pub(crate) fn stands_alone(path: &Path) -> bool {
        match Self::of_name(path) {
            Some(Self::Nifti) => !PAIRED.iter().any(|ending| unpacked_name(path).ends_with(ending)),
            Some(Self::Npy | Self::Mgh | Self::Aim | Self::Isq | Self::LegacyVtk | Self::Vti) => true,
            _ => false,
        }
    }

    /// Whether a name for people is that of the format.
    pub(super) fn is_called(self, name: &str) -> bool {
        self.name() == name
    }

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nifti => "NIfTI",
            Self::MetaImage => "MetaImage",
            Self::Nrrd => "NRRD",
            Self::Npy => "NumPy",
            Self::Mgh => "FreeSurfer MGH",
            Self::Aim => "Scanco AIM",
            Self::Isq => "Scanco ISQ",
            #[cfg(feature = "dicom")]
            Self::Dicom => "DICOM",
            Self::MaskFolder => "masks",
            Self::Tiff => "TIFF",
            Self::LegacyVtk => "legacy VTK",
            Self::Vti => "VTK image data",
            Self::Raw => "raw",
            Self::Slices => "slices",
            #[cfg(feature = "zarr")]
            Self::Zarr => "Zarr",
        }
    }

    /// How many bytes the format itself may put behind the last voxel.
    pub(super) fn trailer(self) -> u64 {
        match self {
            // Parameters of the scan and tags; data that belong to the image; what the places in the header tell apart.
            Self::Mgh | Self::Aim | Self::Tiff | Self::LegacyVtk => u64::MAX,
            // The rest of a block of VMS.
            Self::Isq => 511,
            _ => 0,
        }
    }
}

/// Why a file is not read whose name tells nothing.
fn unknown(path: &Path) -> ReadError {
    let unknown = "the file's ending names no format that is read";
    match foreign::content(path) {
        Some(kind) => ReadError::UnknownFormat(format!("{unknown} (it is {kind}); {SUPPORTED}")),
        None => ReadError::UnknownContent(format!("{unknown}; {SUPPORTED}")),
    }
}

/// A name without the version that VMS puts behind it: `MASK.AIM;1`.
pub(super) fn without_version(name: &str) -> &str {
    match name.rsplit_once(';') {
        Some((stem, version)) if version.bytes().all(|b| b.is_ascii_digit()) => stem,
        _ => name,
    }
}

/// A file's name in lower case, without the ending of one that is compressed as a whole.
fn unpacked_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    PACKED.iter().find_map(|packed| name.strip_suffix(packed)).unwrap_or(&name).to_owned()
}
