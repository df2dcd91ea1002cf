//! Files of XML with arrays of numbers in them.

use super::super::super::base64_text;
use super::super::super::header::ByteOrder;
use super::Outcome;
use super::unpack::most_unpacked;
use super::words::Words;
use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node, ParsingOptions};
use std::io::Read;

/// More elements than a mesh's file has: each takes more memory than text.
const MOST_NODES: u32 = 1 << 18;

pub(super) fn parse(text: &str) -> Outcome<Document<'_>> {
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| format!("it is no XML: {error}"))
}

/// The text of an element itself, without that of elements in it.
pub(super) fn own_text(node: Node<'_, '_>) -> String {
    node.children().filter(Node::is_text).filter_map(|text| text.text()).collect()
}

/// The children of a name.
pub(super) fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.has_tag_name(name))
}

/// Numbers of a text.
pub(super) fn text_numbers(text: &str) -> Outcome<Vec<f64>> {
    let mut words = Words::new(text.as_bytes());
    let mut numbers = Vec::new();
    while words.clone().next().is_some() {
        numbers.push(words.number()?);
    }
    Ok(numbers)
}

/// Order of bytes by its name.
pub(super) fn byte_order(name: &str) -> Outcome<ByteOrder> {
    match name {
        "LittleEndian" => Ok(ByteOrder::Little),
        "BigEndian" => Ok(ByteOrder::Big),
        _ => Err(format!("byte order `{name}` is not known")),
    }
}

/// Bytes out of base 64, of which several pieces may stand one behind the other, each with its padding.
pub(super) fn from_base64(text: &[u8]) -> Outcome<Vec<u8>> {
    let digits: Vec<u8> = text.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
    base64_text::from_base64(&digits).ok_or_else(|| "its base 64 is damaged".to_owned())
}

/// Unpacks zlib's data; from a file of so many bytes not more than a mesh has.
pub(super) fn inflated(packed: &[u8], into: &mut Vec<u8>, file: usize) -> Outcome<()> {
    let most = most_unpacked(file).saturating_sub(into.len());
    let read = ZlibDecoder::new(packed).take(most as u64).read_to_end(into);
    match read {
        Ok(bytes) if bytes == most => {
            Err("its packed arrays are too large for the file: write them unpacked".to_owned())
        }
        Ok(_) => Ok(()),
        Err(error) => Err(format!("its packed arrays are damaged ({error})")),
    }
}
