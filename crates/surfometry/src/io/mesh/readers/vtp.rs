//! VTK XML poly data ("VTK XML Formats", docs.vtk.org): arrays in place, as text or base 64, or behind all of the XML;
//! as they are, or in blocks of zlib.

use super::super::super::header::ByteOrder;
use super::super::super::vtk::scalar_of_xml;
use super::Outcome;
use super::numbers::{number, numbers, places};
use super::space::Space;
use super::surface::{Surface, corner};
use super::xml::{byte_order, children, from_base64, inflated, own_text, parse, text_numbers};
use crate::volume::ScalarType;
use roxmltree::Node;
use std::borrow::Cow;

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    let (text, appended) = split(bytes)?;
    let document = parse(&text)?;
    let root = document.root_element();
    if !root.has_tag_name("VTKFile") || root.attribute("type") != Some("PolyData") {
        let kind = root.attribute("type").unwrap_or_else(|| root.tag_name().name());
        return Err(format!("it holds `{kind}`, not PolyData: extract its surface"));
    }
    let arrays = Arrays::of(root, appended, bytes.len())?;
    let mut surface = Surface::default();
    for array in root.descendants().filter(|node| node.attribute("Name") == Some("SPACE")) {
        // Letters by their codes, as VTK stores texts.
        let letters: Vec<u8> = arrays.numbers(array)?.into_iter().map(|code| code as u8).collect();
        if Space::of_letters(&letters).is_some() {
            surface.comment(&[b"SPACE=", letters.as_slice()].concat())?;
        }
    }
    for piece in root.descendants().filter(|node| node.has_tag_name("Piece")) {
        arrays.piece(piece, &mut surface)?;
    }
    Ok(surface)
}

/// The XML, and the arrays behind it.
fn split(bytes: &[u8]) -> Outcome<(Cow<'_, str>, &[u8])> {
    let tag = b"<AppendedData";
    let Some(start) = bytes.windows(tag.len()).position(|word| word == tag) else {
        return Ok((String::from_utf8_lossy(bytes), &[]));
    };
    let behind = &bytes[start..];
    let opened = behind.iter().position(|&byte| byte == b'>').map(|end| end + 1);
    let marker = opened.and_then(|end| Some(end + behind[end..].iter().position(|&byte| byte == b'_')? + 1));
    let (Some(end), Some(marker)) = (opened, marker) else {
        return Err("its appended data do not begin with `_`: it was cut off".to_owned());
    };
    let xml = String::from_utf8_lossy(&bytes[..start + end]);
    Ok((format!("{xml}</AppendedData></VTKFile>").into(), &behind[marker..]))
}

/// How arrays are stored.
struct Arrays<'a> {
    order: ByteOrder,
    /// Of the numbers of bytes in front of each.
    header: ScalarType,
    packed: bool,
    appended: &'a [u8],
    /// Whether what is appended is base 64.
    in_base64: bool,
    /// Bytes of the file.
    file: usize,
}

impl<'a> Arrays<'a> {
    fn of(root: Node<'_, '_>, appended: &'a [u8], file: usize) -> Outcome<Self> {
        let packed = match root.attribute("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(format!("its arrays are packed by {other}: write it with ZLib or without"));
            }
        };
        let header = match root.attribute("header_type") {
            None | Some("UInt32") => ScalarType::U32,
            Some("UInt64") => ScalarType::U64,
            Some(other) => return Err(format!("header_type `{other}` is not known")),
        };
        let encoding = children(root, "AppendedData").find_map(|node| node.attribute("encoding"));
        let in_base64 = encoding == Some("base64");
        let order = byte_order(root.attribute("byte_order").unwrap_or("LittleEndian"))?;
        Ok(Self { order, header, packed, appended, in_base64, file })
    }

    fn piece(&self, piece: Node<'_, '_>, surface: &mut Surface) -> Outcome<()> {
        let first = surface.vertices.len() as f64;
        if let Some(array) = children(piece, "Points").flat_map(|node| children(node, "DataArray")).next() {
            surface.vertices.extend(places(&self.numbers(array)?)?);
        }
        self.cells(piece, "Polys", first, |corners| surface.polygon(corners))?;
        self.cells(piece, "Strips", first, |corners| surface.strip(corners))
    }

    /// Hands on the corners of each cell of a kind.
    fn cells(
        &self,
        piece: Node<'_, '_>,
        kind: &'static str,
        first: f64,
        found: impl FnMut(&[u32]),
    ) -> Outcome<()> {
        let named = |name: &str| {
            let arrays = children(piece, kind).flat_map(|node| children(node, "DataArray"));
            let array = { arrays }.find(|array| array.attribute("Name") == Some(name));
            array.map_or(Ok(Vec::new()), |array| self.numbers(array))
        };
        cells_of(&named("offsets")?, &named("connectivity")?, first, found)
            .map_err(|error| format!("{kind}: {error}"))
    }

    /// The numbers of an array.
    fn numbers(&self, array: Node<'_, '_>) -> Outcome<Vec<f64>> {
        let name = array.attribute("Name").unwrap_or("without a name");
        self.array(array).map_err(|error| format!("array {name}: {error}"))
    }

    fn array(&self, array: Node<'_, '_>) -> Outcome<Vec<f64>> {
        let scalar = match array.attribute("type").unwrap_or_default() {
            "String" => ScalarType::I8,
            kind => scalar_of_xml(kind).ok_or_else(|| format!("type `{kind}` is not known"))?,
        };
        let bytes = match array.attribute("format") {
            None | Some("ascii") => return text_numbers(&own_text(array)),
            Some("binary") => self.block(&from_base64(own_text(array).as_bytes())?)?,
            Some("appended") => {
                let offset = array.attribute("offset").and_then(|offset| offset.trim().parse::<usize>().ok());
                let stored = offset.and_then(|offset| self.appended.get(offset..));
                let stored = stored.ok_or("it begins behind the end of the file")?;
                if self.in_base64 {
                    let end = stored.iter().position(|&byte| byte == b'<').unwrap_or(stored.len());
                    self.block(&from_base64(&stored[..end])?)?
                } else {
                    self.block(stored)?
                }
            }
            Some(other) => return Err(format!("format `{other}` is not known")),
        };
        Ok(numbers(scalar, self.order, &bytes))
    }

    /// The bytes of an array, in front of which their number stands; packed, the numbers of blocks and of their bytes.
    fn block(&self, stored: &[u8]) -> Outcome<Vec<u8>> {
        let cut = "the file ends within it";
        let width = self.header.bytes();
        let count = |at: usize| -> Outcome<usize> {
            let bytes = stored.get(at * width..).filter(|bytes| bytes.len() >= width).ok_or(cut)?;
            Ok(number(self.header, self.order, bytes) as usize)
        };
        if stored.is_empty() {
            return Ok(Vec::new());
        }
        if !self.packed {
            let bytes = &stored[width.min(stored.len())..];
            return Ok(bytes.get(..count(0)?).ok_or(cut)?.to_vec());
        }
        let blocks = count(0)?;
        let mut at = blocks.saturating_add(3).saturating_mul(width);
        let mut bytes = Vec::new();
        for block in 0..blocks {
            let size = count(3 + block)?;
            let packed = stored.get(at..at.saturating_add(size)).ok_or(cut)?;
            inflated(packed, &mut bytes, self.file)?;
            at += size;
        }
        Ok(bytes)
    }
}

/// Hands on the corners of each cell: offsets say where each ends in the list of all corners, numbers of vertices behind
/// the first.
pub(super) fn cells_of(
    offsets: &[f64],
    connectivity: &[f64],
    first: f64,
    mut found: impl FnMut(&[u32]),
) -> Outcome<()> {
    let mut begin = 0;
    let mut corners = Vec::new();
    for &offset in offsets {
        let end = offset as usize;
        let cell = connectivity.get(begin..end).filter(|_| offset >= 0.0);
        let cell = cell.ok_or_else(|| {
            format!("its offsets lead from {begin} to {offset}, of {} corners", connectivity.len())
        })?;
        corners.clear();
        for &number in cell {
            corners.push(corner(if number < 0.0 { number } else { number + first })?);
        }
        found(&corners);
        begin = end;
    }
    if begin < connectivity.len() {
        return Err(format!("its offsets end at {begin}, and there are {} corners", connectivity.len()));
    }
    Ok(())
}
