//! Whether a file has all bytes that its elements claim, which readers make room for before they look.

use super::error;
use crate::io::ReadError;
use crate::io::packed::open_file;
use dicom_core::VR;
use dicom_core::dictionary::{DataDictionary, DataDictionaryEntry};
use dicom_dictionary_std::StandardDataDictionary;
use dicom_object::Tag;
use std::io::{BufReader, ErrorKind, Read};
use std::path::Path;

/// Where the elements begin: behind preamble and mark.
const START: u64 = 132;
const PIXEL_DATA: Tag = Tag(0x7FE0, 0x0010);
const ITEM_END: Tag = Tag(0xFFFE, 0xE00D);
const SEQUENCE_END: Tag = Tag(0xFFFE, 0xE0DD);
/// Sequences and items within each other that are walked through; readers call themselves for each.
const DEEPEST: usize = 64;
/// The length of what goes on until it says that it ends.
const UNDEFINED: u32 = u32::MAX;
/// Explicit and implicit little-endian; others are explicit, and big-endian ones are out of use.
const IMPLICIT: &str = "1.2.840.10008.1.2";
const BIG_ENDIAN: &str = "1.2.840.10008.1.2.2";
const DEFLATED: &str = "1.2.840.10008.1.2.1.99";

/// Refuses a file in which an element claims more bytes than follow.
pub(super) fn check(path: &Path) -> Result<(), ReadError> {
    let failed = |e| ReadError::io(path, e);
    let (file, bytes) = open_file(path)?;
    let mut walk = Walk { file: BufReader::new(file), at: 0, bytes, syntax: String::new(), open: Vec::new() };
    walk.skip(START).map_err(failed)?;
    match walk.all_elements() {
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
    /// Where the sequences and items end that are being walked through.
    open: Vec<u64>,
}

impl Walk {
    /// Element by element, into sequences and their items, to the end of the file or to what is not understood, which the
    /// reader of elements has its own words for.
    fn all_elements(&mut self) -> std::io::Result<Result<(), ReadError>> {
        let mut in_fragments = false;
        while self.at + 8 <= self.bytes {
            let group = u16::from_le_bytes(self.take()?);
            let element = u16::from_le_bytes(self.take()?);
            let tag = Tag(group, element);
            if group != 2 && matches!(self.syntax.as_str(), BIG_ENDIAN | DEFLATED) {
                return Ok(Ok(()));
            }
            let (length, is_sequence) = self.length(tag)?;
            // Compressed pixels are items that hold no elements.
            in_fragments |= tag == PIXEL_DATA && length == UNDEFINED;
            if self.depth(tag, length, is_sequence) > DEEPEST {
                return Ok(Err(error(format!(
                    "sequences within sequences, more than {DEEPEST} deep: the file is damaged; export it again"
                ))));
            }
            if length == UNDEFINED || is_sequence && !in_fragments {
                continue;
            }
            let left = self.bytes - self.at.min(self.bytes);
            if u64::from(length) > left {
                return Ok(Err(error(format!(
                    "element {tag} claims {length} bytes and {left} follow: the file is truncated or damaged; copy or export it again"
                ))));
            }
            if tag == Tag(2, 0x10) {
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

    /// How long an element is, and whether others are in it.
    fn length(&mut self, tag: Tag) -> std::io::Result<(u32, bool)> {
        if tag.group() == 0xFFFE {
            return Ok((u32::from_le_bytes(self.take()?), true));
        }
        if tag.group() != 2 && self.syntax == IMPLICIT {
            let representation = StandardDataDictionary.by_tag(tag).map(|entry| entry.vr().relaxed());
            return Ok((u32::from_le_bytes(self.take()?), representation == Some(VR::SQ)));
        }
        // As the reader of elements takes one that there is not.
        let representation = VR::from_binary(self.take()?).unwrap_or(VR::UN);
        if is_long(representation) {
            let _: [u8; 2] = self.take()?;
            return Ok((u32::from_le_bytes(self.take()?), representation == VR::SQ));
        }
        Ok((u16::from_le_bytes(self.take()?).into(), false))
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
