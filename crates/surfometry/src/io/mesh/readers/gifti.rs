//! GIFTI surfaces (Harwell et al., "GIFTI Surface Data Format", 2011): a set of points and the triangles between them.

use super::Outcome;
use super::numbers::{numbers, places};
use super::surface::{Surface, corner};
use super::xml::{byte_order, children, from_base64, inflated, own_text, parse, text_numbers};
use crate::volume::ScalarType;
use roxmltree::{Document, Node};

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    let text = String::from_utf8_lossy(bytes);
    let document = parse(&text)?;
    let (points, triangles) = (only(&document, "POINTSET")?, only(&document, "TRIANGLE")?);
    let mut surface = Surface::default();
    surface.vertices = places(&values(points, bytes.len())?)?.to_vec();
    to_scanner(points, &mut surface.vertices)?;
    for corners in places(&values(triangles, bytes.len())?)? {
        surface.polygon(&[corner(corners[0])?, corner(corners[1])?, corner(corners[2])?]);
    }
    Ok(surface)
}

/// The array of a kind, of which there is one.
fn only<'a, 'i>(document: &'a Document<'i>, kind: &str) -> Outcome<Node<'a, 'i>> {
    let intent = format!("NIFTI_INTENT_{kind}");
    let mut found = children(document.root_element(), "DataArray")
        .filter(|array| array.attribute("Intent") == Some(intent.as_str()));
    match (found.next(), found.next()) {
        (Some(array), None) => Ok(array),
        (None, _) => {
            Err(format!("it has no {kind}: name the surface, .surf.gii, not the data that belong to one"))
        }
        (Some(_), Some(_)) => {
            Err(format!("it has several {kind}s: write each surface into a file of its own"))
        }
    }
}

/// The numbers of an array, row by row.
fn values(array: Node<'_, '_>, file: usize) -> Outcome<Vec<f64>> {
    let attribute = |name: &str| array.attribute(name).unwrap_or_default();
    let text = child_text(array, "Data");
    let mut bytes = Vec::new();
    match attribute("Encoding") {
        "ASCII" => {
            let values = text_numbers(&text)?;
            return Ok(if has_rows(&text) { values } else { rows(values, attribute("ArrayIndexingOrder")) });
        }
        "Base64Binary" => bytes = from_base64(text.as_bytes())?,
        // Named after gzip, the encoding is zlib's format.
        "GZipBase64Binary" => inflated(&from_base64(text.as_bytes())?, &mut bytes, file)?,
        other => return Err(format!("its arrays are stored as `{other}`: write them into the file itself")),
    }
    let scalar = match attribute("DataType") {
        "NIFTI_TYPE_UINT8" => ScalarType::U8,
        "NIFTI_TYPE_INT16" => ScalarType::I16,
        "NIFTI_TYPE_INT32" => ScalarType::I32,
        "NIFTI_TYPE_UINT32" => ScalarType::U32,
        "NIFTI_TYPE_INT64" => ScalarType::I64,
        "NIFTI_TYPE_FLOAT32" => ScalarType::F32,
        "NIFTI_TYPE_FLOAT64" => ScalarType::F64,
        other => return Err(format!("type `{other}` is not read")),
    };
    let values = numbers(scalar, byte_order(attribute("Endian"))?, &bytes);
    let stated: usize =
        ["Dim0", "Dim1"].iter().filter_map(|name| attribute(name).parse::<usize>().ok()).product();
    if values.len() != stated {
        return Err(format!("an array has {} numbers where its dimensions say {stated}", values.len()));
    }
    Ok(rows(values, attribute("ArrayIndexingOrder")))
}

/// Whether a text has a line a row: nibabel writes it so, and reads it, whatever it says of the order.
fn has_rows(text: &str) -> bool {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.all(|line| line.split_whitespace().count() == 3)
}

/// Threes of numbers one behind the other, which may be stored as three columns.
fn rows(values: Vec<f64>, order: &str) -> Vec<f64> {
    if order != "ColumnMajorOrder" {
        return values;
    }
    let count = values.len() / 3;
    (0..3 * count).map(|n| values[n / 3 + n % 3 * count]).collect()
}

fn child_text(node: Node<'_, '_>, name: &'static str) -> String {
    children(node, name).map(own_text).collect()
}

/// Brings points to where the scanner saw them, where the file says how.
fn to_scanner(points: Node<'_, '_>, places: &mut [[f64; 3]]) -> Outcome<()> {
    let is_scanner = |node, name| child_text(node, name).trim() == "NIFTI_XFORM_SCANNER_ANAT";
    let mut systems = children(points, "CoordinateSystemTransformMatrix");
    let Some(system) =
        systems.find(|&system| is_scanner(system, "TransformedSpace") && !is_scanner(system, "DataSpace"))
    else {
        return Ok(());
    };
    let matrix = text_numbers(&child_text(system, "MatrixData"))?;
    let (rows, []) = matrix.as_chunks::<4>() else { return Err("its matrix is not 4 x 4".to_owned()) };
    let [x, y, z, [0.0, 0.0, 0.0, 1.0]] = *rows else { return Err("its matrix is no affine one".to_owned()) };
    for place in places {
        *place = [x, y, z].map(|row| row[0] * place[0] + row[1] * place[1] + row[2] * place[2] + row[3]);
    }
    Ok(())
}
