//! glTF 2.0 in one binary file (Khronos, "glTF 2.0 Specification"; section numbers below are its).
//!
//! The format's own world is in metres with y up; ours are RAS and mm, and stay so, without a transforming
//! node: numbers that are read back are the ones measured. A viewer shows the object lying down, which its
//! orbit control undoes.

use super::MeshDocument;
use super::document::flat;
use super::little_endian::{write_f32, write_indices};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::io::{self, Write};

/// componentType of f32 and u32 (3.6.2.2), target of vertex and index buffers (5.11.5).
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A vertex attribute. All are f32, so each one begins and ends at a multiple of 4 bytes, as 3.6.2.4 wants.
struct Attribute<'a> {
    semantic: String,
    components: usize,
    values: Cow<'a, [f64]>,
}

pub(super) fn write(out: &mut dyn Write, document: &MeshDocument<'_>) -> io::Result<()> {
    let triangles = &document.mesh.triangles;
    let attributes = attributes(document);
    let mut text = serde_json::to_vec(&description(document, &attributes))?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary = 4 * (attributes.iter().map(|a| a.values.len()).sum::<usize>() + 3 * triangles.len());
    // Headers of the file (12 bytes) and of its two chunks (8 each): 4.4.
    let total = 12 + 8 + text.len() + 8 + binary;
    let too_large = |_| super::invalid("a GLB file holds at most 4 GiB: write VTP or PLY");
    let total = u32::try_from(total).map_err(too_large)?;
    out.write_all(b"glTF")?;
    [2, total].iter().try_for_each(|v: &u32| out.write_all(&v.to_le_bytes()))?;
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&(binary as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    attributes.iter().try_for_each(|attribute| write_f32(out, &attribute.values))?;
    write_indices(out, triangles)
}

fn attributes<'a>(document: &MeshDocument<'a>) -> Vec<Attribute<'a>> {
    let vector = |semantic: &str, values: Cow<'a, [f64]>| Attribute {
        semantic: semantic.to_owned(),
        components: 3,
        values,
    };
    let positions = vector("POSITION", document.mesh.vertices.as_flattened().into());
    let normals = document.normals().map(|normals| vector("NORMAL", normals.as_flattened().into()));
    let colors = document.colors.map(|colors| vector("COLOR_0", linear(colors).into()));
    // An attribute that is the application's own begins with an underscore (3.7.2.1).
    let own = document.other_arrays().filter_map(|array| {
        let (values, components) = flat(array);
        // Not a number is none of glTF's values (3.6.2.2), and no other one would stand for that there is none.
        values.iter().all(|v| !v.is_nan()).then(|| Attribute {
            semantic: format!("_{}", array.name.to_ascii_uppercase()),
            components,
            values: values.into(),
        })
    });
    [positions].into_iter().chain(normals).chain(colors).chain(own).collect()
}

/// Colours are linear in glTF (3.9.2): the inverse of IEC 61966-2-1's transfer function. As floats, since 8
/// bits of linear light are too few in the dark, and not every reader normalises 16.
fn linear(colors: &[[u8; 3]]) -> Vec<f64> {
    let table: [f64; 256] = std::array::from_fn(|i| {
        let c = i as f64 / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
    });
    colors.as_flattened().iter().map(|&c| table[usize::from(c)]).collect()
}

fn description(document: &MeshDocument<'_>, attributes: &[Attribute<'_>]) -> Value {
    let (mut views, mut accessors, mut offset) = (Vec::new(), Vec::new(), 0);
    let mut view = |bytes: usize, target: u32| {
        views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes, "target": target}));
        offset += bytes;
    };
    let mut by_name = Map::new();
    for (i, attribute) in attributes.iter().enumerate() {
        view(4 * attribute.values.len(), ARRAY_BUFFER);
        let kind = if attribute.components == 1 { "SCALAR" } else { "VEC3" };
        let count = attribute.values.len() / attribute.components;
        let mut accessor = json!({"bufferView": i, "componentType": FLOAT, "count": count, "type": kind});
        if attribute.semantic == "POSITION" {
            accessor["min"] = json!(extremes(&document.mesh.vertices, f32::min));
            accessor["max"] = json!(extremes(&document.mesh.vertices, f32::max));
        }
        accessors.push(accessor);
        by_name.insert(attribute.semantic.clone(), json!(i));
    }
    let (indices, count) = (attributes.len(), 3 * document.mesh.triangles.len());
    view(4 * count, ELEMENT_ARRAY_BUFFER);
    accessors.push(
        json!({"bufferView": indices, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR"}),
    );
    let extras = json!({"title": document.ascii_title(), "space": "RAS", "unit": "mm"});
    json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("surfometry ", env!("CARGO_PKG_VERSION")),
            "extras": extras,
        },
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": by_name, "indices": indices, "material": 0}]}],
        "materials": [{
            "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.8},
            "doubleSided": true,
        }],
        "buffers": [{"byteLength": offset}],
        "bufferViews": views,
        "accessors": accessors,
    })
}

/// Least or greatest coordinates, in the precision in which they are stored, as 3.6.2.5 wants.
fn extremes(vertices: &[[f64; 3]], pick: fn(f32, f32) -> f32) -> Option<[f32; 3]> {
    let single = vertices.iter().map(|v| v.map(|c| c as f32));
    single.reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i])))
}

#[cfg(test)]
mod tests {
    use super::super::test_meshes::{f32_at, tetrahedron, u32_at};
    use super::*;
    use crate::surface::VertexValues;

    #[test]
    fn chunks_accessors_and_values() {
        let mut bytes = Vec::new();
        write(&mut bytes, &tetrahedron().document()).unwrap();
        assert_eq!((&bytes[..4], u32_at(&bytes, 4)), (&b"glTF"[..], 2));
        assert_eq!(u32_at(&bytes, 8) as usize, bytes.len());
        let length = u32_at(&bytes, 12) as usize;
        assert_eq!((length % 4, &bytes[16..20]), (0, &b"JSON"[..]));
        let root: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
        let start = 20 + length + 8;
        assert_eq!(u32_at(&bytes, start - 8) as usize, bytes.len() - start);
        assert_eq!(root["buffers"][0]["byteLength"], bytes.len() - start);
        let primitive = &root["meshes"][0]["primitives"][0];
        let offset = |accessor: &Value| {
            let accessor = &root["accessors"][accessor.as_u64().unwrap() as usize];
            let view = &root["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
            start + view["byteOffset"].as_u64().unwrap() as usize
        };
        let attribute = |name: &str| offset(&primitive["attributes"][name]);
        assert_eq!(f32_at(&bytes, attribute("POSITION") + 12), 1.5);
        assert_eq!(f32_at(&bytes, attribute("NORMAL") + 12), 1.0);
        assert_eq!(f32_at(&bytes, attribute("_MEAN_CURVATURE_PER_MM") + 12), 2.0);
        assert_eq!(f32_at(&bytes, attribute("_DIRECTION_1") + 16), 1.0);
        assert_eq!(u32_at(&bytes, offset(&primitive["indices"]) + 4), 2);
        // Half of full scale in sRGB is 21.6 % of the light.
        let green = f32_at(&bytes, attribute("COLOR_0") + 16);
        assert!((green - 0.215_861).abs() < 1e-6);
        let positions = &root["accessors"][0];
        assert_eq!(positions["max"], json!([1.5, 0.0, 3.1f32]));
        assert_eq!(positions["min"], json!([0.5, -1.0, 2.0]));
    }

    /// What lacks values is left out, and all else is where it was.
    #[test]
    fn not_a_number_is_in_no_attribute() {
        let mut owned = tetrahedron();
        owned.arrays[1].values = VertexValues::Scalar(vec![0.0, f64::NAN, 0.0, 0.0]);
        let semantics: Vec<String> = attributes(&owned.document()).into_iter().map(|a| a.semantic).collect();
        assert!(semantics.contains(&"_DIRECTION_1".to_owned()), "{semantics:?}");
        assert!(!semantics.contains(&"_MEAN_CURVATURE_PER_MM".to_owned()), "{semantics:?}");
    }
}
