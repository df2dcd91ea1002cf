//! Whether a file has all bytes that its elements claim, which the reader of elements makes room for before it looks.
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
use dicom_object::{FileMetaTable, Tag};
use dicom_parser::dataset::DataToken;
use dicom_parser::stateful::decode::{Error, Result as Decoded};
use dicom_parser::{DataSetReader, DynStatefulDecoder, StatefulDecode};
use dicom_transfer_syntax_registry::entries::EXPLICIT_VR_LITTLE_ENDIAN;
use dicom_transfer_syntax_registry::{TransferSyntaxIndex, TransferSyntaxRegistry};
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

const MARK: u64 = 4;
const ITEM: Tag = Tag(0xFFFE, 0xE000);
/// Sequences and items within each other that are walked through; the reader of elements calls itself for each.
const DEEPEST: usize = 64;

/// Refuses a file in which an element, in front of one or anywhere, claims more bytes than follow. What is not understood is left
/// to the reader of elements, which has its own words.
pub(super) fn check(path: &Path, until: Option<Tag>) -> Result<(), ReadError> {
    let failed = |e| ReadError::io(path, e);
    let (file, bytes) = open_file(path)?;
    let mut file = BufReader::new(file);
    file.seek(SeekFrom::Start(PREAMBLE as u64 + MARK)).map_err(failed)?;
    check_meta(&mut file, bytes.saturating_sub(PREAMBLE as u64 + MARK))?;
    file.seek(SeekFrom::Start(PREAMBLE as u64)).map_err(failed)?;
    let Ok(meta) = FileMetaTable::from_reader(&mut file) else { return Ok(()) };
    let syntax = TransferSyntaxRegistry.get(meta.transfer_syntax()).filter(|syntax| !syntax.is_unsupported());
    let Some(syntax) = syntax else { return Ok(()) };
    let follow = bytes.saturating_sub(file.stream_position().map_err(failed)?);
    let Ok(decoder) = DynStatefulDecoder::new_with_ts(file, syntax, 0) else { return Ok(()) };
    let mut bounded = Bounded { decoder, bytes: follow, refusal: None };
    check_depth(DataSetReader::new(&mut bounded, Default::default()), until)?;
    bounded.refusal.map_or(Ok(()), Err)
}

/// The elements that say how the others are written, as many bytes as the first one claims.
fn check_meta(file: impl Read, bytes: u64) -> Result<(), ReadError> {
    let explicit = EXPLICIT_VR_LITTLE_ENDIAN.erased();
    let Ok(decoder) = DynStatefulDecoder::new_with_ts(file, &explicit, 0) else { return Ok(()) };
    let mut bounded = Bounded { decoder, bytes, refusal: None };
    let _: Decoded<()> = bounded.skip_meta();
    bounded.refusal.map_or(Ok(()), Err)
}

/// Walks through all elements.
fn check_depth<D: StatefulDecode>(
    elements: DataSetReader<&mut Bounded<D>>,
    until: Option<Tag>,
) -> Result<(), ReadError> {
    let mut depth = 0_usize;
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
        match token {
            DataToken::SequenceStart { .. } | DataToken::PixelSequenceStart | DataToken::ItemStart { .. } => {
                depth += 1
            }
            DataToken::SequenceEnd | DataToken::ItemEnd => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > DEEPEST {
            return Err(error(format!(
                "sequences within sequences, more than {DEEPEST} deep: the file is damaged; export it again"
            )));
        }
    }
    Ok(())
}

/// A decoder that looks at what is claimed, and skips it.
struct Bounded<D> {
    decoder: D,
    /// How many there are, from where the decoder began.
    bytes: u64,
    refusal: Option<ReadError>,
}

impl<D: StatefulDecode> Bounded<D> {
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
        let header = self.decoder.decode_header()?;
        self.claim(header.tag, header.len, unit(header.vr))?;
        Ok(header)
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
