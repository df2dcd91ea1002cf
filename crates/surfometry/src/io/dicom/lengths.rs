//! Whether a file has all bytes that its elements claim, which readers make room for before they look.

use super::data_set::PREAMBLE;
use super::error;
use crate::io::ReadError;
use crate::io::packed::open_file;
use dicom_core::VR;
use dicom_core::dictionary::{DataDictionary, DataDictionaryEntry};
use dicom_dictionary_std::StandardDataDictionary;
use dicom_dictionary_std::uids::{DEFLATED_EXPLICIT_VR_LITTLE_ENDIAN, IMPLICIT_VR_LITTLE_ENDIAN};
use dicom_object::Tag;
use std::io::{BufReader, ErrorKind, Read};
use std::path::Path;

/// Where the elements begin: behind preamble and mark.
const START: u64 = PREAMBLE as u64 + 4;
const PIXEL_DATA: Tag = Tag(0x7FE0, 0x0010);
const ITEM_END: Tag = Tag(0xFFFE, 0xE00D);
const SEQUENCE_END: Tag = Tag(0xFFFE, 0xE0DD);
/// Sequences and items within each other that are walked through; readers call themselves for each.
const DEEPEST: usize = 64;
/// The length of what goes on until it says that it ends.
const UNDEFINED: u32 = u32::MAX;
/// Out of use, so that the dictionary warns of it, and read all the same.
pub(super) const BIG_ENDIAN: &str = "1.2.840.10008.1.2.2";
/// How long the elements are that say how the others are written.
const META_LENGTH: Tag = Tag(2, 0);
const SYNTAX: Tag = Tag(2, 0x10);

/// Refuses a file in which an element claims more bytes than follow.
pub(super) fn check(path: &Path) -> Result<(), ReadError> {
    let failed = |e| ReadError::io(path, e);
    let (file, bytes) = open_file(path)?;
    let (file, syntax) = (BufReader::new(file), String::new());
    let mut walk = Walk { file, at: 0, bytes, syntax, is_meta: true, open: Vec::new() };
    walk.skip(START).map_err(failed)?;
    match walk.whole_file() {
        // An element's head is cut off, and it claims nothing; the reader of elements says so.
        Err(e) if e.kind() == ErrorKind::UnexpectedEof => Ok(()),
        walked => walked.map_err(failed)?,
    }
}

struct Walk {
    file: BufReader<std::fs::File>,
    at: u64,
    bytes: u64,
    syntax: String,
    /// Whether what is walked through says how the rest is written.
    is_meta: bool,
    /// Where the sequences and items end that are being walked through.
    open: Vec<u64>,
}

/// How long an element is, whether others are in it, and how long each of its numbers is.
struct Claim {
    length: u32,
    is_sequence: bool,
    unit: u32,
}

impl Claim {
    fn of(length: u32, representation: VR) -> Self {
        let unit = match representation {
            VR::SS | VR::US | VR::OW => 2,
            VR::AT | VR::FL | VR::SL | VR::UL | VR::OF | VR::OL => 4,
            VR::FD | VR::SV | VR::UV | VR::OD | VR::OV => 8,
            _ => 1,
        };
        Self { length, is_sequence: representation == VR::SQ, unit }
    }
}

impl Walk {
    fn whole_file(&mut self) -> std::io::Result<Result<(), ReadError>> {
        let Some(end) = self.end_of_meta()? else { return Ok(Ok(())) };
        let meta = self.all_elements(end)?;
        self.is_meta = false;
        if meta.is_err() || self.syntax == DEFLATED_EXPLICIT_VR_LITTLE_ENDIAN {
            Ok(meta)
        } else {
            self.all_elements(self.bytes)
        }
    }

    /// Where the elements end that say how the others are written, whatever their group is, as the first one claims; `None`
    /// where the reader of elements refuses that one.
    fn end_of_meta(&mut self) -> std::io::Result<Option<u64>> {
        let tag = self.tag()?;
        let claim = self.claim(tag)?;
        let is_known = tag == META_LENGTH && claim.length == 4;
        Ok(if is_known { Some(u64::from(self.four_bytes()?) + self.at) } else { None })
    }

    /// Element by element, into sequences and their items, to an end or to what is not understood, which the reader of elements
    /// has its own words for.
    fn all_elements(&mut self, end: u64) -> std::io::Result<Result<(), ReadError>> {
        let mut in_fragments = false;
        while self.at < end && self.at + 8 <= self.bytes {
            let tag = self.tag()?;
            let Claim { length, is_sequence, unit } = self.claim(tag)?;
            // Compressed pixels are items that hold no elements.
            in_fragments |= tag == PIXEL_DATA && length == UNDEFINED;
            if self.depth(tag, length, is_sequence) > DEEPEST {
                return Ok(Err(error(format!(
                    "sequences within sequences, more than {DEEPEST} deep: the file is damaged; export it again"
                ))));
            }
            if length == UNDEFINED {
                continue;
            }
            let left = self.bytes - self.at.min(self.bytes);
            // Also of an item: one that is in no sequence is read as an element.
            if u64::from(length) > left {
                return Ok(Err(error(format!(
                    "element {tag} claims {length} bytes and {left} follow: the file is truncated or damaged; copy or export it again"
                ))));
            }
            // The reader of elements leaves what is over, and takes it for the next element.
            if length % unit != 0 {
                return Ok(Err(error(format!(
                    "element {tag} claims {length} bytes of numbers of {unit} bytes each: the file is damaged; copy or export it again"
                ))));
            }
            if is_sequence && !in_fragments {
                continue;
            }
            if self.is_meta && tag == SYNTAX {
                let mut syntax = vec![0; length as usize];
                self.file.read_exact(&mut syntax)?;
                self.at += u64::from(length);
                String::from_utf8_lossy(&syntax).trim_matches([' ', '\0']).clone_into(&mut self.syntax);
            } else {
                self.skip(length.into())?;
            }
        }
        Ok(Ok(()))
    }

    /// How many sequences and items lie around what follows an element's head.
    fn depth(&mut self, tag: Tag, length: u32, is_sequence: bool) -> usize {
        while self.open.last().is_some_and(|end| *end <= self.at) {
            self.open.pop();
        }
        if tag == ITEM_END || tag == SEQUENCE_END {
            self.open.pop();
        } else if length == UNDEFINED {
            self.open.push(u64::MAX);
        } else if is_sequence && length > 0 {
            self.open.push(self.at + u64::from(length));
        }
        self.open.len()
    }

    /// What an element's head says.
    fn claim(&mut self, tag: Tag) -> std::io::Result<Claim> {
        if tag.group() == 0xFFFE {
            return Ok(Claim { length: self.four_bytes()?, is_sequence: true, unit: 1 });
        }
        if !self.is_meta && self.syntax == IMPLICIT_VR_LITTLE_ENDIAN {
            let representation = StandardDataDictionary.by_tag(tag).map(|entry| entry.vr().relaxed());
            return Ok(Claim::of(self.four_bytes()?, representation.unwrap_or(VR::UN)));
        }
        // As the reader of elements takes one that there is not.
        let representation = VR::from_binary(self.take()?).unwrap_or(VR::UN);
        let length = if is_long(representation) {
            let _: [u8; 2] = self.take()?;
            self.four_bytes()?
        } else {
            self.two_bytes()?.into()
        };
        Ok(Claim::of(length, representation))
    }

    fn tag(&mut self) -> std::io::Result<Tag> {
        Ok(Tag(self.two_bytes()?, self.two_bytes()?))
    }

    fn two_bytes(&mut self) -> std::io::Result<u16> {
        let bytes = self.take()?;
        Ok(if self.is_big_endian() { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
    }

    fn four_bytes(&mut self) -> std::io::Result<u32> {
        let bytes = self.take()?;
        Ok(if self.is_big_endian() { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    fn is_big_endian(&self) -> bool {
        !self.is_meta && self.syntax == BIG_ENDIAN
    }

    fn take<const N: usize>(&mut self) -> std::io::Result<[u8; N]> {
        let mut taken = [0; N];
        self.file.read_exact(&mut taken)?;
        self.at += N as u64;
        Ok(taken)
    }

    fn skip(&mut self, bytes: u64) -> std::io::Result<()> {
        self.at += bytes;
        self.file.seek_relative(bytes as i64)
    }
}

/// Whether the length takes four bytes, behind two that are reserved.
fn is_long(representation: VR) -> bool {
    use VR::{OB, OD, OF, OL, OV, OW, SQ, SV, UC, UN, UR, UT, UV};
    matches!(representation, OB | OD | OF | OL | OV | OW | SQ | SV | UC | UN | UR | UT | UV)
}
