//! A DICOM file's elements, as far as they are wanted.

use super::error;
use super::lengths::{Parts, checked};
use crate::io::ReadError;
use crate::io::packed::open_file;
use dicom_dictionary_std::tags;
use dicom_dictionary_std::uids::DEFLATED_EXPLICIT_VR_LITTLE_ENDIAN;
use dicom_object::{DefaultDicomObject, FileMetaTable, InMemDicomObject, OpenFileOptions, Tag};
use std::io::{BufReader, Read};
use std::ops::Range;
use std::path::Path;

/// Segmentation and label map segmentation storage.
const SEGMENTATIONS: [&str; 2] = ["1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7"];

/// Compressions of pixel data, by how their identifiers begin.
const COMPRESSED: [(&str, &str); 11] = [
    ("1.2.840.10008.1.2.1.98", "frames that are wrapped up"),
    ("1.2.840.10008.1.2.4.11", "JPEG XL"),
    ("1.2.840.10008.1.2.7", "SMPTE ST 2110"),
    ("1.2.840.10008.1.2.8", "deflate, each frame"),
    ("1.2.840.10008.1.2.4.5", "JPEG"),
    ("1.2.840.10008.1.2.4.7", "JPEG lossless"),
    ("1.2.840.10008.1.2.4.8", "JPEG-LS"),
    ("1.2.840.10008.1.2.4.9", "JPEG 2000"),
    ("1.2.840.10008.1.2.4.10", "MPEG"),
    ("1.2.840.10008.1.2.4.20", "HTJ2K"),
    ("1.2.840.10008.1.2.5", "RLE"),
];

/// Out of use, so that the dictionary warns of it, and read all the same.
const BIG_ENDIAN: &str = "1.2.840.10008.1.2.2";

/// Bytes in front of DICOM's mark.
pub(super) const PREAMBLE: usize = 128;

/// Whether a file has DICOM's mark behind its preamble.
pub(in crate::io) fn is_dicom(path: &Path) -> bool {
    let mut start = [0; PREAMBLE + 4];
    open_file(path).is_ok_and(|(mut file, _)| file.read_exact(&mut start).is_ok()) && start.ends_with(b"DICM")
}

/// The elements of a file.
pub(super) struct DataSet {
    object: DefaultDicomObject,
}

impl DataSet {
    /// All elements in front of the pixels.
    pub(super) fn header(path: &Path) -> Result<Self, ReadError> {
        let parts = checked(path, Some(tags::PIXEL_DATA))?;
        Self::read(path, parts, OpenFileOptions::new().read_until(tags::PIXEL_DATA))
    }

    /// All elements up to the pixels.
    pub(super) fn whole(path: &Path) -> Result<Self, ReadError> {
        Self::read(path, checked(path, None)?, OpenFileOptions::new())
    }

    fn read(path: &Path, parts: Vec<Range<u64>>, options: OpenFileOptions) -> Result<Self, ReadError> {
        let (file, _) = open_file(path)?;
        let object = options.from_reader(Parts::new(file, parts)).map_err(|e| unreadable(path, &e))?;
        Ok(Self { object })
    }

    pub(super) fn is_segmentation(&self) -> bool {
        self.text(tags::SOP_CLASS_UID).is_some_and(|class| SEGMENTATIONS.contains(&class.as_str()))
    }

    /// Refuses pixels that are compressed.
    pub(super) fn check_pixels_are_plain(&self) -> Result<(), ReadError> {
        let syntax = self.object.meta().transfer_syntax();
        match COMPRESSED.iter().filter(|(uid, _)| syntax.starts_with(uid)).max_by_key(|(uid, _)| uid.len()) {
            Some((_, name)) => Err(error(format!(
                "the pixels are compressed with {name} (transfer syntax {syntax}), which is not read; `gdcmconv --raw IN OUT` \
                 unpacks a file"
            ))),
            None => Ok(()),
        }
    }

    /// The bytes of the pixels, little-endian; to be asked of a whole data set.
    pub(super) fn pixels(&self) -> Result<Vec<u8>, ReadError> {
        self.check_pixels_are_plain()?;
        // Words of 16 bits are turned, and whether the two of a pixel are as well, writers do not agree on.
        let is_big_endian = self.object.meta().transfer_syntax() == BIG_ENDIAN;
        if is_big_endian && self.whole_number(tags::BITS_ALLOCATED) == Some(32) {
            return Err(error(
                "32 bits a pixel in big-endian order, which programs write in two ways, are not read; `dcmconv +te IN OUT` writes \
                 a file in the usual order",
            ));
        }
        let element = self.object.get(tags::PIXEL_DATA).ok_or_else(|| error("no pixels (7FE0,0010)"))?;
        let bytes = element.to_bytes().map_err(|e| error(format!("the pixels cannot be read: {e}")))?;
        Ok(bytes.into_owned())
    }
}

/// What can be asked of a data set and of the items of its sequences.
pub(super) trait Elements {
    fn elements(&self) -> &InMemDicomObject;

    /// Text without the padding; `None` where there is none.
    fn text(&self, tag: Tag) -> Option<String> {
        let text = self.elements().get(tag)?.to_str().ok()?;
        let text = text.trim_matches([' ', '\0']);
        (!text.is_empty()).then(|| text.to_owned())
    }

    fn whole_number(&self, tag: Tag) -> Option<i64> {
        self.elements().get(tag)?.to_int().ok()
    }

    fn numbers<const N: usize>(&self, tag: Tag) -> Option<[f64; N]> {
        let numbers = self.elements().get(tag)?.to_multi_float64().ok()?;
        numbers.try_into().ok().filter(|numbers: &[f64; N]| numbers.iter().all(|v| v.is_finite()))
    }

    fn whole_numbers<const N: usize>(&self, tag: Tag) -> Option<[i64; N]> {
        self.elements().get(tag)?.to_multi_int().ok()?.try_into().ok()
    }

    fn items(&self, tag: Tag) -> &[InMemDicomObject] {
        self.elements().get(tag).and_then(|element| element.items()).unwrap_or_default()
    }
}

impl Elements for DataSet {
    fn elements(&self) -> &InMemDicomObject {
        &self.object
    }
}

impl Elements for InMemDicomObject {
    fn elements(&self) -> &InMemDicomObject {
        self
    }
}

/// Of a file whose elements cannot be read: which are compressed, all but those that say so, or damaged.
fn unreadable(path: &Path, cause: &dyn std::error::Error) -> ReadError {
    if is_deflated(path) {
        return error(format!(
            "the whole file is compressed with deflate (transfer syntax {DEFLATED_EXPLICIT_VR_LITTLE_ENDIAN}), which is not read; \
             `dcmconv +te IN OUT` of DCMTK unpacks it"
        ));
    }
    error(format!("{}; copy or export the file again", causes(cause)))
}

fn is_deflated(path: &Path) -> bool {
    let Ok((mut file, _)) = open_file(path) else { return false };
    let skipped = file.read_exact(&mut [0; PREAMBLE]);
    let meta = skipped.ok().and_then(|()| FileMetaTable::from_reader(BufReader::new(file)).ok());
    meta.is_some_and(|meta| meta.transfer_syntax() == DEFLATED_EXPLICIT_VR_LITTLE_ENDIAN)
}

/// An error and what is behind it.
fn causes(error: &dyn std::error::Error) -> String {
    let chain = std::iter::successors(Some(error), |error| error.source());
    chain.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
