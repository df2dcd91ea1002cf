//! Whether a file has all bytes that its elements claim, which the reader of elements makes room for before it looks; and which parts
//! of it are to be read.
//!
//! It is walked through by that reader's own grammar (`DataSetReader`), on a decoder that skips values in place of reading them, so
//! that the two cannot go different ways in a damaged file.

use super::data_set::PREAMBLE;
use super::error;
use crate::io::ReadError;
use crate::io::packed::open_file;
use dicom_core::header::{DataElementHeader, Length, SequenceItemHeader};
use dicom_core::{PrimitiveValue, VR};
use dicom_dictionary_std::tags;
use dicom_dictionary_std::uids::IMPLICIT_VR_LITTLE_ENDIAN;
use dicom_object::{FileMetaTable, Tag};
use dicom_parser::dataset::DataToken;
use dicom_parser::dataset::read::DataSetReaderOptions;
use dicom_parser::stateful::decode::{Error, Result as Decoded};
use dicom_parser::{DataSetReader, DynStatefulDecoder, StatefulDecode};
use dicom_transfer_syntax_registry::entries::EXPLICIT_VR_LITTLE_ENDIAN;
use dicom_transfer_syntax_registry::{TransferSyntaxIndex, TransferSyntaxRegistry};
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

const MARK: u64 = 4;
const ITEM: Tag = Tag(0xFFFE, 0xE000);
const ITEM_END: Tag = Tag(0xFFFE, 0xE00D);
const SEQUENCE_END: Tag = Tag(0xFFFE, 0xE0DD);
/// Sequences and items within each other that are walked through; the reader of elements calls itself for each.
const DEEPEST: usize = 64;

/// The parts of a file that its elements up to one, or to the pixels, are in: what follows pixels is padding. Sequences of no known
/// representation are left out.
///
/// Refuses a file in which an element claims more bytes than follow. What is not understood is left to the reader of elements, which
/// has its own words.
pub(super) fn checked(path: &Path, until: Option<Tag>) -> Result<Vec<Range<u64>>, ReadError> {
    let failed = |e| ReadError::io(path, e);
    let (file, bytes) = open_file(path)?;
    let mut file = BufReader::new(file);
    file.seek(SeekFrom::Start(PREAMBLE as u64 + MARK)).map_err(failed)?;
    check_meta(&mut file, bytes.saturating_sub(PREAMBLE as u64 + MARK))?;
    file.seek(SeekFrom::Start(PREAMBLE as u64)).map_err(failed)?;
    let whole = || Ok(std::iter::once(0..bytes).collect());
    let Ok(meta) = FileMetaTable::from_reader(&mut file) else { return whole() };
    let syntax = TransferSyntaxRegistry.get(meta.transfer_syntax()).filter(|syntax| !syntax.is_unsupported());
    let Some(syntax) = syntax else { return whole() };
    let start = file.stream_position().map_err(failed)?;
    let Ok(decoder) = DynStatefulDecoder::new_with_ts(file, syntax, 0) else { return whole() };
    let is_explicit = syntax.uid() != IMPLICIT_VR_LITTLE_ENDIAN;
    let mut bounded = Bounded::new(decoder, bytes.saturating_sub(start), is_explicit);
    let has_pixels = walk(DataSetReader::new(&mut bounded, DataSetReaderOptions::default()), until)?;
    let end = if has_pixels { start + bounded.position() } else { bytes };
    match bounded.refusal {
        Some(refusal) => Err(refusal),
        None => Ok(between(&bounded.left_out, start, end)),
    }
}

/// What lies between parts that are left out, which are counted from the start of the elements.
fn between(left_out: &[Range<u64>], start: u64, end: u64) -> Vec<Range<u64>> {
    let begins = std::iter::once(0).chain(left_out.iter().map(|part| start + part.end));
    let ends = left_out.iter().map(|part| start + part.start).chain([end]);
    begins.zip(ends).map(|(begin, end)| begin..end).collect()
}

/// The elements that say how the others are written, as many bytes as the first one claims.
fn check_meta(file: impl Read, bytes: u64) -> Result<(), ReadError> {
    let explicit = EXPLICIT_VR_LITTLE_ENDIAN.erased();
    let Ok(decoder) = DynStatefulDecoder::new_with_ts(file, &explicit, 0) else { return Ok(()) };
    let mut bounded = Bounded::new(decoder, bytes, false);
    let _: Decoded<()> = bounded.skip_meta();
    bounded.refusal.map_or(Ok(()), Err)
}

/// Walks through all elements up to one, or to the end of the pixels; whether it came to that.
fn walk<D: StatefulDecode>(
    elements: DataSetReader<&mut Bounded<D>>,
    until: Option<Tag>,
) -> Result<bool, ReadError> {
    let (mut depth, mut in_pixels) = (0_usize, false);
    for token in elements.map_while(Result::ok) {
        let element = match token {
            DataToken::ElementHeader(DataElementHeader { tag, .. })
            | DataToken::SequenceStart { tag, .. } => Some(tag),
            DataToken::PixelSequenceStart => Some(tags::PIXEL_DATA),
            _ => None,
        };
        if depth == 0 && element.zip(until).is_some_and(|(element, until)| element >= until) {
            break;
        }
        in_pixels |= depth == 0 && element == Some(tags::PIXEL_DATA);
        match token {
            DataToken::SequenceStart { .. } | DataToken::PixelSequenceStart | DataToken::ItemStart { .. } => {
                depth += 1;
            }
            DataToken::SequenceEnd | DataToken::ItemEnd => depth = depth.saturating_sub(1),
            _ => {}
        }
        let ends = matches!(token, DataToken::PrimitiveValue(_) | DataToken::SequenceEnd);
        if in_pixels && depth == 0 && ends {
            return Ok(true);
        }
        if depth > DEEPEST {
            return Err(error(format!(
                "sequences within sequences, more than {DEEPEST} deep: the file is damaged; export it again"
            )));
        }
    }
    Ok(false)
}

/// A decoder that looks at what is claimed, and skips it.
struct Bounded<D> {
    decoder: D,
    /// How many there are, from where the decoder began.
    bytes: u64,
    refusal: Option<ReadError>,
    /// Whether elements have representations, so that sequences without one are written otherwise than the rest.
    is_explicit: bool,
    /// Where such sequences are.
    left_out: Vec<Range<u64>>,
}

impl<D: StatefulDecode> Bounded<D> {
    fn new(decoder: D, bytes: u64, is_explicit: bool) -> Self {
        Self { decoder, bytes, refusal: None, is_explicit, left_out: Vec::new() }
    }

    fn skip_meta(&mut self) -> Decoded<()> {
        let first = self.decode_header()?;
        if first.tag != tags::FILE_META_INFORMATION_GROUP_LENGTH || first.len != Length(4) {
            return Ok(());
        }
        let mut length = Vec::new();
        self.decoder.read_u32_to_vec(4, &mut length)?;
        let end = self.position() + length.iter().map(|length| u64::from(*length)).sum::<u64>();
        while self.position() < end {
            let header = self.decode_header()?;
            self.skip(header.len)?;
        }
        Ok(())
    }

    /// Leaves out a sequence whose representation whoever wrote the file did not know, as of private ones: its items are in
    /// little-endian order without representations, whatever the file's are (DICOM PS3.5, 6.2.2), which the reader of elements does not
    /// know.
    fn skip_unknown(&mut self, start: u64) -> Decoded<()> {
        let mut depth = 1_u64;
        while depth > 0 {
            let mut head = Vec::new();
            self.decoder.read_to_vec(8, &mut head)?;
            // Cut off: whoever reads on says so.
            let Ok([a, b, c, d, length @ ..]) = <[u8; 8]>::try_from(head) else { break };
            let tag = Tag(u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
            let length = Length(u32::from_le_bytes(length));
            match tag {
                SEQUENCE_END => depth -= 1,
                ITEM_END => {}
                _ if length.is_undefined() => depth += u64::from(tag != ITEM),
                _ => {
                    self.claim(tag, length, 1)?;
                    self.skip(length)?;
                }
            }
        }
        self.left_out.push(start..self.position());
        Ok(())
    }

    /// Refuses more bytes than follow, and numbers that are not whole: the reader of elements leaves what is over, and takes it for
    /// the next element.
    fn claim(&mut self, tag: Tag, length: Length, unit: u32) -> Decoded<()> {
        let Some(length) = length.get() else { return Ok(()) };
        let left = self.bytes.saturating_sub(self.position());
        let wrong = if u64::from(length) > left {
            format!("{length} bytes and {left} follow: the file is truncated or damaged")
        } else if length % unit != 0 {
            format!("{length} bytes of numbers of {unit} bytes each: the file is damaged")
        } else {
            return Ok(());
        };
        self.refusal = Some(error(format!("element {tag} claims {wrong}; copy or export it again")));
        Err(Error::AllocateValueData { len: length })
    }

    fn skip(&mut self, length: Length) -> Decoded<()> {
        length.get().map_or(Ok(()), |length| self.decoder.skip_bytes(length))
    }

    fn no_value(&mut self, header: &DataElementHeader) -> Decoded<PrimitiveValue> {
        self.skip(header.len).map(|()| PrimitiveValue::Empty)
    }
}

impl<D: StatefulDecode> StatefulDecode for Bounded<D> {
    type Reader = D::Reader;

    fn decode_header(&mut self) -> Decoded<DataElementHeader> {
        loop {
            let start = self.position();
            let header = self.decoder.decode_header()?;
            let is_unknown = self.is_explicit && header.vr == VR::UN && header.len.is_undefined();
            if !is_unknown || header.tag == tags::PIXEL_DATA {
                self.claim(header.tag, header.len, unit(header.vr))?;
                return Ok(header);
            }
            self.skip_unknown(start)?;
        }
    }

    fn decode_item_header(&mut self) -> Decoded<SequenceItemHeader> {
        let header = self.decoder.decode_item_header()?;
        if let SequenceItemHeader::Item { len } = header {
            self.claim(ITEM, len, 1)?;
        }
        Ok(header)
    }

    fn read_value(&mut self, header: &DataElementHeader) -> Decoded<PrimitiveValue> {
        self.no_value(header)
    }

    fn read_value_preserved(&mut self, header: &DataElementHeader) -> Decoded<PrimitiveValue> {
        self.no_value(header)
    }

    fn read_value_bytes(&mut self, header: &DataElementHeader) -> Decoded<PrimitiveValue> {
        self.no_value(header)
    }

    fn read_to_vec(&mut self, length: u32, _: &mut Vec<u8>) -> Decoded<()> {
        self.skip_bytes(length)
    }

    fn read_u32_to_vec(&mut self, length: u32, _: &mut Vec<u32>) -> Decoded<()> {
        self.claim(ITEM, Length(length), 4)?;
        self.skip_bytes(length)
    }

    fn read_to<W: Write>(&mut self, length: u32, out: W) -> Decoded<()> {
        self.decoder.read_to(length, out)
    }

    fn skip_bytes(&mut self, length: u32) -> Decoded<()> {
        self.decoder.skip_bytes(length)
    }

    fn seek(&mut self, position: u64) -> Decoded<()>
    where
        Self::Reader: Seek,
    {
        self.decoder.seek(position)
    }

    fn position(&self) -> u64 {
        self.decoder.position()
    }
}

/// Bytes of each of a value's numbers, as the reader of elements takes them.
fn unit(representation: VR) -> u32 {
    match representation {
        VR::SS | VR::US | VR::OW => 2,
        VR::AT | VR::FL | VR::SL | VR::UL | VR::OF | VR::OL => 4,
        VR::FD | VR::SV | VR::UV | VR::OD | VR::OV => 8,
        _ => 1,
    }
}

/// Parts of a file, one after the other.
pub(super) struct Parts {
    file: BufReader<File>,
    at: u64,
    /// The next one last.
    left: Vec<Range<u64>>,
}

impl Parts {
    pub(super) fn new(file: File, mut parts: Vec<Range<u64>>) -> Self {
        parts.reverse();
        Self { file: BufReader::new(file), at: 0, left: parts }
    }
}

impl Read for Parts {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        while let Some(part) = self.left.last() {
            if self.at < part.start {
                self.file.seek_relative((part.start - self.at) as i64)?;
                self.at = part.start;
            }
            if self.at < part.end {
                let wanted = (part.end - self.at).min(buffer.len() as u64) as usize;
                let read = self.file.read(&mut buffer[..wanted])?;
                self.at += read as u64;
                return Ok(read);
            }
            self.left.pop();
        }
        Ok(0)
    }
}
