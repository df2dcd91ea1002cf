//! glTF 2.0 in one binary file (Khronos, "glTF 2.0 Specification"): triangles, strips and fans of its meshes, where no
//! node moves them.

use super::super::super::header::ByteOrder;
use super::Outcome;
use super::numbers::{number, places};
use super::surface::{Surface, corner};
use crate::volume::ScalarType;
use serde_json::Value;

pub(super) fn read(bytes: &[u8]) -> Outcome<Surface> {
    let file = Glb::new(bytes)?;
    file.check()?;
    let mut surface = Surface::default();
    let space = file.root["asset"]["extras"]["space"].as_str().unwrap_or_default();
    surface.comment(format!("SPACE={space}").as_bytes())?;
    for node in list(&file.root["nodes"]) {
        let Some(mesh) = node["mesh"].as_u64() else { continue };
        for primitive in list(&file.root["meshes"][mesh as usize]["primitives"]) {
            file.primitive(primitive, &mut surface)?;
        }
    }
    for image in list(&file.root["images"]) {
        surface
            .beside
            .extend(image["uri"].as_str().filter(|uri| !uri.starts_with("data:")).map(str::to_owned));
    }
    Ok(surface)
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// The two chunks of a file: what it holds, and the numbers.
struct Glb<'a> {
    root: Value,
    binary: &'a [u8],
}

impl<'a> Glb<'a> {
    fn new(bytes: &'a [u8]) -> Outcome<Self> {
        let chunk = |at: usize, kind: &[u8]| {
            let (length, behind) = bytes.get(at..)?.split_first_chunk::<4>()?;
            let (found, data) = behind.split_first_chunk::<4>()?;
            let data = data.get(..u32::from_le_bytes(*length) as usize)?;
            (found == kind).then_some(data)
        };
        if !bytes.starts_with(b"glTF\x02\0\0\0") {
            return Err("it does not begin as glTF 2.0 does".to_owned());
        }
        let json = chunk(12, b"JSON").ok_or("its first part is cut off, or is not JSON")?;
        let binary = chunk(20 + json.len(), b"BIN\0").unwrap_or_default();
        let root = serde_json::from_slice(json).map_err(|error| format!("its JSON is damaged: {error}"))?;
        Ok(Self { root, binary })
    }

    /// Refuses what would put triangles elsewhere than their numbers say.
    fn check(&self) -> Outcome<()> {
        if let Some(name) = list(&self.root["extensionsRequired"]).first() {
            return Err(format!("it needs the extension {name}, which is not read"));
        }
        let moves = |node: &&Value| {
            let identity = |name: &str, values: &[f64]| {
                let stated: Vec<f64> = list(&node[name]).iter().filter_map(Value::as_f64).collect();
                stated.is_empty() || stated == values
            };
            let matrix: Vec<f64> = (0..16).map(|n| f64::from(u8::from(n % 5 == 0))).collect();
            let still = identity("matrix", &matrix)
                && identity("translation", &[0.0; 3])
                && identity("scale", &[1.0; 3])
                && identity("rotation", &[0.0, 0.0, 0.0, 1.0]);
            !still || !node["skin"].is_null()
        };
        match list(&self.root["nodes"]).iter().position(|node| moves(&node)) {
            Some(node) => Err(format!("its node {node} moves, turns or scales meshes: apply that to them")),
            None => Ok(()),
        }
    }

    fn primitive(&self, primitive: &Value, surface: &mut Surface) -> Outcome<()> {
        let first = surface.vertices.len();
        let at = |value: &Value| value.as_u64().ok_or("a mesh names no array of its places or corners");
        let positions = self.numbers(at(&primitive["attributes"]["POSITION"])?, "VEC3")?;
        surface.vertices.extend(places(&positions)?);
        let corners = match &primitive["indices"] {
            Value::Null => (first..surface.vertices.len()).map(|n| n as u32).collect::<Vec<_>>(),
            indices => {
                let indices = self.numbers(at(indices)?, "SCALAR")?;
                indices.into_iter().map(|n| corner(n + first as f64)).collect::<Outcome<_>>()?
            }
        };
        match primitive["mode"].as_u64().unwrap_or(4) {
            4 => corners.chunks_exact(3).for_each(|triangle| surface.polygon(triangle)),
            5 => surface.strip(&corners),
            6 => surface.polygon(&corners),
            // Points and lines are no surface.
            _ => {}
        }
        Ok(())
    }

    /// The numbers of an accessor.
    fn numbers(&self, accessor: u64, kind: &str) -> Outcome<Vec<f64>> {
        let found = &self.root["accessors"][accessor as usize];
        let view = found["bufferView"].as_u64().map(|view| &self.root["bufferViews"][view as usize]);
        let refused = |what: &str| format!("array {accessor} {what}");
        let view = view.filter(|_| found["sparse"].is_null() && found["type"] == kind);
        let view = view.ok_or_else(|| refused("is stored in a way that is not read"))?;
        let scalar = match found["componentType"].as_u64() {
            Some(5121) => ScalarType::U8,
            Some(5123) => ScalarType::U16,
            Some(5125) => ScalarType::U32,
            Some(5126) => ScalarType::F32,
            _ => return Err(refused("has numbers of a type that is not read")),
        };
        let size = |value: &Value| value.as_u64().unwrap_or_default() as usize;
        let components = if kind == "VEC3" { 3 } else { 1 };
        let width = components * scalar.bytes();
        let stride = view["byteStride"].as_u64().map_or(width, |stride| stride as usize);
        let inside = size(&view["buffer"]) == 0 && self.root["buffers"][0]["uri"].is_null();
        let begin = size(&view["byteOffset"]).saturating_add(size(&found["byteOffset"]));
        let bytes = self.binary.get(begin..).filter(|_| inside && stride >= width);
        let bytes = bytes.ok_or_else(|| refused("lies outside of the file"))?;
        let count = size(&found["count"]);
        if count > 0 && (count - 1).saturating_mul(stride).saturating_add(width) > bytes.len() {
            return Err(refused("is longer than the file"));
        }
        let rows = (0..count).flat_map(|row| (0..components).map(move |n| row * stride + n * scalar.bytes()));
        Ok(rows.map(|at| number(scalar, ByteOrder::Little, &bytes[at..])).collect())
    }
}
