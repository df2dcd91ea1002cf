//! Which chunks of an array are there: those that are not have the fill value, so that a grid may have any number of them.

use super::node::error;
use crate::io::ReadError;
use std::collections::BTreeMap;
use std::path::Path;
use zarrs::array::{Array, ArrayShardedExt};
use zarrs::filesystem::FilesystemStore;

/// What is unpacked at once of a chunk, whatever its file; and how many times the bytes of its file.
const ANY_CHUNK: u64 = 1 << 28;
const UNPACKED_A_BYTE: u64 = 1 << 10;

pub(super) type Opened = Array<FilesystemStore>;
/// A chunk's place in the grid, an index an axis.
pub(super) type Place = Vec<u64>;

/// The chunks that are files, found by one walk over the folder.
#[derive(Debug, Default)]
pub(super) struct StoredChunks {
    /// By their index along the slowest axis of space.
    layers: BTreeMap<u64, Vec<Place>>,
    /// Bytes of all their files.
    pub(super) bytes: u64,
}

impl StoredChunks {
    /// Those of an array; `slowest` is the slowest axis of space, `width` the bytes of a voxel.
    ///
    /// # Errors
    /// [`ReadError`] where there is none, for one that is no file, or claims more voxels than it can hold.
    pub(super) fn find(
        folder: &Path,
        array: &Opened,
        slowest: usize,
        width: usize,
    ) -> Result<Self, ReadError> {
        let mut chunks = Self::default();
        // Of shards their own chunks are unpacked one by one.
        let inner = array.effective_subchunk_shape().filter(|_| array.is_exclusively_sharded());
        let unit = |place: &Place| {
            let shape = inner.clone().or_else(|| array.chunk_shape(place).ok()).unwrap_or_default();
            shape.iter().fold(width as u64, |product, n| product.saturating_mul(n.get()))
        };
        let grid = array.chunk_grid_shape();
        files_below(folder, "", grid.len() + 1, &mut |key, path| {
            let Some(place) = place_of(key, grid.len()) else { return Ok(()) };
            if place.iter().zip(grid).any(|(at, of)| at >= of) || array.chunk_key(&place).as_str() != key {
                return Ok(());
            }
            let file = path.metadata().map_err(|e| ReadError::io(path, e))?;
            if !file.is_file() {
                return Err(ReadError::not_a_file(path, &file));
            }
            if unit(&place) > ANY_CHUNK.max(file.len().saturating_mul(UNPACKED_A_BYTE)) {
                return Err(error(format!(
                    "{}: {} bytes, which cannot be a chunk of {} bytes of voxels; save the array in smaller chunks",
                    path.display(),
                    file.len(),
                    unit(&place)
                )));
            }
            chunks.bytes = chunks.bytes.saturating_add(file.len());
            chunks.layers.entry(place[slowest]).or_default().push(place);
            Ok(())
        })?;
        if chunks.layers.is_empty() {
            return Err(error(format!(
                "none of its {} chunks is stored, so that every voxel has the fill value: nothing is segmented in it, or the folder was not copied \
                 whole; copy or export it again",
                grid.iter().fold(1u64, |product, &n| product.saturating_mul(n))
            )));
        }
        Ok(chunks)
    }

    /// Those of some layers of the grid.
    pub(super) fn in_layers(&self, layers: std::ops::RangeInclusive<u64>) -> Vec<&Place> {
        self.layers.range(layers).flat_map(|(_, places)| places).collect()
    }
}

/// Hands on what lies in a folder, by its path there, as keys of chunks have it: folders only as deep as chunks may lie.
fn files_below(
    folder: &Path,
    key: &str,
    deepest: usize,
    found: &mut dyn FnMut(&str, &Path) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    for entry in folder.read_dir().map_err(|e| ReadError::io(folder, e))? {
        let entry = entry.map_err(|e| ReadError::io(folder, e))?;
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        let (path, key) = (entry.path(), format!("{key}{name}"));
        let is_layer = deepest > 0 && (name == "c" || name.parse::<u64>().is_ok());
        if is_layer && path.is_dir() {
            files_below(&path, &format!("{key}/"), deepest - 1, found)?;
        } else {
            found(&key, &path)?;
        }
    }
    Ok(())
}

/// The place that a chunk's key names: `c/0/1/2`, `0.1.2` and whatever else has a number an axis.
fn place_of(key: &str, rank: usize) -> Option<Place> {
    let place: Place = key.split(['/', '.']).filter_map(|part| part.parse().ok()).collect();
    (place.len() == rank).then_some(place)
}
