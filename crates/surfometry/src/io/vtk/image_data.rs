//! VTK's XML image data.
//!
//! # References
//! <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use super::data_array::{DataArray, Form, SharedArray};
use super::outline::Outline;
use super::{GHOSTS, lattice, scalar_of_xml};
use crate::io::assembled::Assembled;
use crate::io::header::{ByteOrder, ImageHeader, Voxels, three_dimensions};
use crate::io::text_header::numbers;
use crate::io::{Format, ReadError};
use crate::volume::{Affine, ScalarType};
use roxmltree::{Document, Node, ParsingOptions};
use std::path::Path;
use std::sync::Arc;

pub(super) fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::Vti.name(), reason: reason.into() }
}

/// Reads the header of a .vti file.
pub(in crate::io) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let Outline { elements, texts, appended } = Outline::read(path)?;
    let text =
        String::from_utf8(elements).map_err(|_| error("text that is no UTF-8; export the image again"))?;
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options)
        .map_err(|e| error(format!("{e}; the file ends early or is damaged: copy or export it again")))?;
    header(path, &document, |array| texts.get(&array.range().start).copied(), appended)
}

/// Of a document without its texts; `text` says where an array's is in the file.
fn header(
    path: &Path,
    document: &Document,
    text: impl Fn(Node) -> Option<(u64, u64)>,
    appended: Option<(u64, bool)>,
) -> Result<ImageHeader, ReadError> {
    let file = document.root_element();
    let image = child(file, "ImageData").ok_or_else(|| error("no ImageData; is this a VTK image?"))?;
    let pieces: Vec<Node> = image.children().filter(|node| node.has_tag_name("Piece")).collect();
    let whole: [i64; 6] =
        list(image, "WholeExtent")?.ok_or_else(|| error("no WholeExtent; export the image again"))?;
    let [piece] = pieces[..] else {
        return Err(error(format!("{} pieces; save the image as one", pieces.len())));
    };
    if list(piece, "Extent")?.is_some_and(|extent: [i64; 6]| extent != whole) {
        return Err(error("a piece that is not the whole image; save the image as one"));
    }
    let points = points(whole)?;
    let spacing = list(image, "Spacing")?.unwrap_or([1.0; 3]);
    let origin = list(image, "Origin")?.unwrap_or([0.0; 3]);
    let (array, cells) = array(piece)?;
    let (dimensions, first) = lattice(points, [0.0; 3], spacing, cells);
    let dimensions = three_dimensions(&dimensions)?;
    let kind = array.attribute("type").unwrap_or_default();
    let scalar = scalar_of_xml(kind).ok_or_else(|| ReadError::VoxelType(format!("VTK {kind}")))?;
    let stored = stored(array, text(array), appended)?;
    let data = data_array(path, file, stored, scalar, dimensions)?;
    let affine = affine(image, whole, spacing, origin, first)?;
    Ok(ImageHeader {
        affine: Some(affine),
        stated_spacing: Some(spacing),
        ..ImageHeader::new(
            path,
            Format::Vti,
            dimensions,
            scalar,
            Voxels::Assembled(Assembled(Arc::new(SharedArray(Arc::new(data))))),
        )
    })
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn list<T: std::str::FromStr, const N: usize>(node: Node, key: &str) -> Result<Option<[T; N]>, ReadError> {
    let Some(text) = node.attribute(key) else { return Ok(None) };
    let values = numbers(text).and_then(|list: Vec<T>| list.try_into().ok());
    values
        .map(Some)
        .ok_or_else(|| error(format!("{key}=\"{text}\" is not {N} numbers; export the image again")))
}

fn points(extent: [i64; 6]) -> Result<[usize; 3], ReadError> {
    let along = |a: usize| extent[2 * a + 1].checked_sub(extent[2 * a])?.checked_add(1)?.try_into().ok();
    match [along(0), along(1), along(2)] {
        [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
        _ => Err(error(format!("WholeExtent {extent:?} is impossible; export the image again"))),
    }
}

/// World = origin + direction (spacing (index + extent's first)); `first` is the place of the first value in it.
fn affine(
    image: Node,
    extent: [i64; 6],
    spacing: [f64; 3],
    origin: [f64; 3],
    first: [f64; 3],
) -> Result<Affine, ReadError> {
    let rows: [f64; 9] = list(image, "Direction")?.unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let directions = std::array::from_fn(|a| std::array::from_fn(|w| rows[3 * w + a]));
    let turned = Affine::from_directions(directions, spacing, origin);
    let index = std::array::from_fn(|a| {
        extent[2 * a] as f64 + if spacing[a] == 0.0 { 0.0 } else { first[a] / spacing[a] }
    });
    Ok(Affine { origin: turned.apply(index), ..turned })
}

/// The array that is meant, and whether it is one of cells: that which is called the scalars of the points or, where these
/// have none, of the cells; else the first one of either.
fn array<'a>(piece: Node<'a, 'a>) -> Result<(Node<'a, 'a>, bool), ReadError> {
    let data = |(kind, cells): (&str, bool)| Some((child(piece, kind)?, cells));
    let kinds: Vec<(Node, bool)> =
        [("PointData", false), ("CellData", true)].into_iter().filter_map(data).collect();
    let scalars = kinds.iter().find_map(|&(data, cells)| {
        let name = data.attribute("Scalars")?;
        Some((arrays(data).find(|array| array.attribute("Name") == Some(name))?, cells))
    });
    let first = || kinds.iter().find_map(|&(data, cells)| Some((arrays(data).find(is_of_voxels)?, cells)));
    let (array, cells) = scalars
        .or_else(first)
        .ok_or_else(|| error("no DataArray of points or cells; the file holds no voxels"))?;
    let components = array.attribute("NumberOfComponents").unwrap_or("1");
    if components != "1" {
        return Err(error(format!("{components} components a voxel; save the label image alone, with one")));
    }
    Ok((array, cells))
}

fn arrays<'a>(data: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    data.children().filter(|node| node.has_tag_name("DataArray"))
}

/// Not one that says which points or cells count.
fn is_of_voxels(array: &Node) -> bool {
    array.attribute("Name") != Some(GHOSTS)
}

/// How an array is stored, from which byte of the file on, and in how many.
type StoredArray = (Form, u64, u64);

/// `text` is what stands behind the array's tag.
fn stored(
    array: Node,
    text: Option<(u64, u64)>,
    appended: Option<(u64, bool)>,
) -> Result<StoredArray, ReadError> {
    match array.attribute("format").unwrap_or("ascii") {
        "appended" => {
            let offset: u64 = array
                .attribute("offset")
                .and_then(|offset| offset.trim().parse().ok())
                .ok_or_else(|| error("an appended array without offset"))?;
            let (start, base64) = appended
                .ok_or_else(|| error("no AppendedData, where the voxels should be; the file ends early"))?;
            let form = if base64 { Form::Base64 } else { Form::Raw };
            Ok((form, start.saturating_add(offset), u64::MAX))
        }
        form @ ("ascii" | "binary") => {
            let (at, size) = text.ok_or_else(|| error("an array without voxels; export the image again"))?;
            Ok((if form == "ascii" { Form::Text } else { Form::Base64 }, at, size))
        }
        other => Err(error(format!("format {other} of an array is not known"))),
    }
}

fn data_array(
    path: &Path,
    file: Node,
    (form, at, size): StoredArray,
    scalar: ScalarType,
    dimensions: [usize; 3],
) -> Result<DataArray, ReadError> {
    let compressed = match file.attribute("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => return Err(error(format!("compressor {other}; save the image with zlib or without"))),
    };
    let order = match file.attribute("byte_order") {
        Some("BigEndian") => ByteOrder::Big,
        _ => ByteOrder::Little,
    };
    let wide = file.attribute("header_type") == Some("UInt64");
    let voxels = dimensions.iter().fold(1u64, |product, &n| product.saturating_mul(n as u64));
    Ok(DataArray { path: path.to_owned(), at, size, form, compressed, wide, order, scalar, voxels })
}
