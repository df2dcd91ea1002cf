//! Meshes from PLY files: the header and single elements are read by `ply-rs-bw`, which keeps whole files in
//! maps of names.

use super::super::ReadError;
use crate::surface::Mesh;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::io::{BufRead, Read};

const AXES: [&str; 3] = ["x", "y", "z"];
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads a file of `size` bytes.
pub(super) fn read(file: impl BufRead, size: u64) -> Result<Mesh, ReadError> {
    let mut reader = Reader::new(file);
    let header = Parser::<Skipped>::new()
        .read_header(&mut reader)
        .map_err(|error| ReadError::damaged_mesh("PLY", &error))?;
    let mut payload = Payload { file: reader.into_inner(), encoding: header.encoding, size };
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new() };
    // One past the largest number of a vertex that a face names: faces may come before vertices.
    let mut named = 0;
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => {
                if !AXES.iter().all(|axis| element.properties.contains_key(*axis)) {
                    return Err(ReadError::damaged_mesh("PLY", &"a vertex has no x, y and z"));
                }
                payload.elements(element, |Vertex(place)| mesh.vertices.push(place))?;
            }
            "face" => {
                if !CORNERS.iter().any(|name| element.properties.contains_key(*name)) {
                    return Err(ReadError::damaged_mesh("PLY", &"a face has no vertex_indices"));
                }
                payload.elements(element, |Face(corners)| {
                    named = corners.iter().fold(named, |named, &corner| named.max(u64::from(corner) + 1));
                    let fan = (2..corners.len()).map(|n| [corners[0], corners[n - 1], corners[n]]);
                    mesh.triangles.extend(fan);
                })?;
            }
            _ => payload.elements(element, |_: Skipped| {})?,
        }
    }
    if named > mesh.vertices.len() as u64 {
        return Err(ReadError::damaged_mesh("PLY", &"a face names vertices that are not there"));
    }
    Ok(mesh)
}

/// What follows the header.
struct Payload<R> {
    file: R,
    encoding: Encoding,
    size: u64,
}

impl<R: BufRead> Payload<R> {
    /// Hands on all elements of a kind, one after the other.
    fn elements<E: PropertyAccess>(
        &mut self,
        kind: &ElementDef,
        mut found: impl FnMut(E),
    ) -> Result<(), ReadError> {
        let bytes = least_bytes(kind, self.encoding);
        let claimed = bytes.saturating_mul(kind.count as u64);
        if claimed > self.size {
            let ElementDef { name, count, .. } = kind;
            let size = self.size;
            let reason = format!(
                "the header claims {count} elements `{name}` of {bytes} bytes or more, the file has {size} bytes"
            );
            return Err(ReadError::damaged_mesh("PLY", &reason));
        }
        // Elements without properties take no room in binary files.
        let count = if bytes > 0 { kind.count } else { 0 };
        for _ in 0..count {
            found(self.element(kind).map_err(|error| ReadError::damaged_mesh("PLY", &error))?);
        }
        Ok(())
    }

    fn element<E: PropertyAccess>(&mut self, kind: &ElementDef) -> Result<E, ParseError> {
        let parser = Parser::<E>::new();
        match self.encoding {
            Encoding::Ascii => {
                let mut line = String::new();
                // A line has no end in a file that has none.
                self.file.by_ref().take(self.size).read_line(&mut line)?;
                parser.read_ascii_element(&line, kind)
            }
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(&mut self.file, kind),
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.file, kind),
        }
    }
}

/// Bytes that an element takes at least: of a list, those of its length.
fn least_bytes(kind: &ElementDef, encoding: Encoding) -> u64 {
    let binary = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let properties = kind.properties.values().map(|property| match &property.data_type {
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => binary(scalar),
    });
    match encoding {
        // A digit and what ends it; the last line may lack its end.
        Encoding::Ascii => (2 * kind.properties.len() as u64).saturating_sub(1).max(1),
        Encoding::BinaryLittleEndian | Encoding::BinaryBigEndian => properties.sum(),
    }
}

/// A vertex's place; what else it has is left.
struct Vertex([f64; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([f64::NAN; 3])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(axis) = AXES.iter().position(|axis| *axis == name) else {
            return PropertyAccessResult::Ignored;
        };
        let Some(value) = number(&property) else { return PropertyAccessResult::UnsupportedType };
        self.0[axis] = value;
        PropertyAccessResult::Set
    }
}

/// A face's corners.
struct Face(Vec<u32>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        let Some(corners) = indices(&property) else { return PropertyAccessResult::UnsupportedType };
        self.0 = corners;
        PropertyAccessResult::Set
    }
}

/// An element that says nothing of a surface.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

fn number(property: &Property) -> Option<f64> {
    match property {
        Property::Float(v) => Some(f64::from(*v)),
        Property::Double(v) => Some(*v),
        Property::Char(v) => Some(f64::from(*v)),
        Property::UChar(v) => Some(f64::from(*v)),
        Property::Short(v) => Some(f64::from(*v)),
        Property::UShort(v) => Some(f64::from(*v)),
        Property::Int(v) => Some(f64::from(*v)),
        Property::UInt(v) => Some(f64::from(*v)),
        _ => None,
    }
}

fn indices(property: &Property) -> Option<Vec<u32>> {
    fn all<T: Copy + TryInto<u32>>(values: &[T]) -> Option<Vec<u32>> {
        values.iter().map(|&v| v.try_into().ok()).collect()
    }
    match property {
        Property::ListInt(v) => all(v),
        Property::ListUInt(v) => all(v),
        Property::ListShort(v) => all(v),
        Property::ListUShort(v) => all(v),
        Property::ListChar(v) => all(v),
        Property::ListUChar(v) => all(v),
        _ => None,
    }
}
