//! The metadata of a folder: an array or a group, of Zarr 2 or 3.

use crate::io::packed::open_file;
use crate::io::{Format, ReadError};
use crate::volume::ScalarType;
use serde_json::Value;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Files that make a folder a node.
const METADATA: [&str; 3] = ["zarr.json", ".zarray", ".zgroup"];

pub(super) fn error(reason: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::Zarr.name(), reason: reason.into() }
}

/// Whether a folder is an array or a group.
pub(in crate::io) fn is_zarr(folder: &Path) -> bool {
    METADATA.iter().any(|name| folder.join(name).is_file())
}

/// An array or a group.
pub(super) struct Node {
    pub(super) path: PathBuf,
    /// What zarr.json or .zarray says.
    array: Option<Value>,
    attributes: Value,
    version: u8,
}

/// What an array is made of.
pub(super) struct Stored {
    /// Slowest axis first.
    pub(super) shape: Vec<usize>,
    pub(super) chunks: Vec<usize>,
    pub(super) scalar: ScalarType,
}

impl Node {
    pub(super) fn read(path: &Path) -> Result<Self, ReadError> {
        let node = |array, attributes, version| Self { path: path.to_owned(), array, attributes, version };
        if let Some(document) = json(&path.join("zarr.json"))? {
            let attributes = document.get("attributes").cloned().unwrap_or_default();
            let is_array = document.get("node_type").and_then(Value::as_str) == Some("array");
            return Ok(node(is_array.then_some(document), attributes, 3));
        }
        let array = json(&path.join(".zarray"))?;
        let attributes = json(&path.join(".zattrs"))?.unwrap_or_default();
        if array.is_none() && !path.join(".zgroup").is_file() {
            return Err(error(
                "no zarr.json, .zarray or .zgroup in this folder; name the folder of an image or an array",
            ));
        }
        Ok(node(array, attributes, 2))
    }

    /// The files that say all this.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let names: &[&str] =
            if self.version == 2 { &[".zarray", ".zgroup", ".zattrs"] } else { &["zarr.json"] };
        names.iter().map(|name| self.path.join(name)).filter(|file| file.is_file()).collect()
    }

    pub(super) fn is_array(&self) -> bool {
        self.array.is_some()
    }

    /// An attribute of OME's: since 0.5 they have a place of their own.
    pub(super) fn ome(&self, key: &str) -> &Value {
        self.attributes.get("ome").unwrap_or(&self.attributes).get(key).unwrap_or(&Value::Null)
    }

    pub(super) fn array(&self) -> Result<Stored, ReadError> {
        let Some(array) = &self.array else { return Err(error("a group, where an array should be")) };
        let sizes = |value: Option<&Value>, key: &str| {
            let list = value
                .and_then(Value::as_array)
                .and_then(|list| list.iter().map(size).collect::<Option<Vec<_>>>());
            list.ok_or_else(|| error(format!("{key} is no list of sizes; copy or export the array again")))
        };
        let (key, chunks) = match self.version {
            2 => ("dtype", array.get("chunks")),
            _ => ("data_type", array.pointer("/chunk_grid/configuration/chunk_shape")),
        };
        let kind =
            array.get(key).ok_or_else(|| error(format!("no {key}; copy or export the array again")))?;
        let name = kind.as_str().map_or_else(|| kind.to_string(), str::to_owned);
        let scalar = scalar(&name).ok_or_else(|| ReadError::VoxelType(format!("Zarr {name}")))?;
        let (shape, chunks) = (sizes(array.get("shape"), "shape")?, sizes(chunks, "the chunks' shape")?);
        if shape.len() != chunks.len() {
            return Err(error(format!(
                "shape {shape:?} and chunks of {chunks:?}; copy or export the array again"
            )));
        }
        Ok(Stored { shape, chunks, scalar })
    }
}

fn size(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|n| n.try_into().ok())
}

/// By the names of Zarr 3 and, behind a byte order, of NumPy.
fn scalar(name: &str) -> Option<ScalarType> {
    Some(match name.trim_start_matches(['<', '>', '|', '=']) {
        "bool" | "b1" | "uint8" | "u1" => ScalarType::U8,
        "int8" | "i1" => ScalarType::I8,
        "uint16" | "u2" => ScalarType::U16,
        "int16" | "i2" => ScalarType::I16,
        "uint32" | "u4" => ScalarType::U32,
        "int32" | "i4" => ScalarType::I32,
        "uint64" | "u8" => ScalarType::U64,
        "int64" | "i8" => ScalarType::I64,
        "float32" | "f4" => ScalarType::F32,
        "float64" | "f8" => ScalarType::F64,
        _ => return None,
    })
}

/// `None` where there is nothing of that name.
fn json(path: &Path) -> Result<Option<Value>, ReadError> {
    if !path.exists() {
        return Ok(None);
    }
    let mut text = Vec::new();
    open_file(path)?.0.read_to_end(&mut text).map_err(|e| ReadError::io(path, e))?;
    let document = serde_json::from_slice(&text);
    document.map(Some).map_err(|e| error(format!("{}: {e}; copy or export the image again", path.display())))
}
