//! The voxels of an array, chunk by chunk.

use super::node::{Stored, error};
use crate::io::ReadError;
use crate::io::assembled::{AssembleVoxels, Pieces};
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use zarrs::array::{Array, ArrayBytes, ArraySubset};
use zarrs::filesystem::FilesystemStore;

/// Most bytes of a chunk, so that damage costs no memory; and about as many are taken at once.
const LARGEST_CHUNK: u64 = 1 << 31;
const A_PIECE: usize = 1 << 26;

type Opened = Array<FilesystemStore>;

/// Where they are.
#[derive(Debug)]
pub(super) struct ZarrVoxels {
    folder: PathBuf,
    array: Arc<Opened>,
    /// All axes, slowest first, and which of them is the slowest of space.
    shape: Vec<usize>,
    slowest: usize,
    /// Slices of a piece: whole chunks, unless these are large.
    thickness: usize,
}

impl ZarrVoxels {
    /// Opens an array of which `axes` are space, fastest first.
    pub(super) fn open(folder: &Path, axes: [usize; 3], stored: &Stored) -> Result<Self, ReadError> {
        let bytes = stored.scalar.bytes();
        let chunk = stored.chunks.iter().fold(bytes as u64, |product, &n| product.saturating_mul(n as u64));
        if chunk > LARGEST_CHUNK || stored.chunks.contains(&0) {
            return Err(error(format!(
                "chunks of {:?} voxels; save the array in smaller ones",
                stored.chunks
            )));
        }
        let unreadable = |e: &dyn std::fmt::Display| {
            error(format!("{e}; save the array with blosc, Zstandard, gzip or without compression"))
        };
        let store = FilesystemStore::new(folder).map_err(|e| unreadable(&e))?;
        let array = Array::open(Arc::new(store), "/").map_err(|e| unreadable(&e))?;
        let slowest = axes[2];
        let slice = stored.shape[axes[0]].saturating_mul(stored.shape[axes[1]]).saturating_mul(bytes).max(1);
        let whole_chunks = stored.chunks[slowest];
        let thickness = if whole_chunks.saturating_mul(slice) <= 4 * A_PIECE {
            whole_chunks * (A_PIECE / (whole_chunks * slice)).max(1)
        } else {
            (A_PIECE / slice).max(1)
        };
        let (folder, shape) = (folder.to_owned(), stored.shape.clone());
        Ok(Self { folder, array: Arc::new(array), shape, slowest, thickness })
    }
}

impl AssembleVoxels for ZarrVoxels {
    /// Those of the metadata; the chunks may be millions.
    fn files(&self) -> Vec<PathBuf> {
        let files = ["zarr.json", ".zarray"].map(|name| self.folder.join(name));
        files.into_iter().filter(|file| file.is_file()).collect()
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let (array, folder, shape) = (Arc::clone(&self.array), self.folder.clone(), self.shape.clone());
        let (slowest, thickness) = (self.slowest, self.thickness);
        let mut next = 0;
        Ok(Box::new(Pieces::new(move || {
            if next >= shape[slowest] {
                return Ok(None);
            }
            let slices = next..shape[slowest].min(next.saturating_add(thickness));
            next = slices.end;
            slices_of(&array, &shape, slowest, slices)
                .map(Some)
                .map_err(|reason| ReadError::damaged(&folder, &reason))
        })))
    }
}

/// Voxels of some slices, in the order of the axes: the fastest of space is the fastest.
fn slices_of(
    array: &Opened,
    shape: &[usize],
    slowest: usize,
    slices: Range<usize>,
) -> Result<Vec<u8>, String> {
    let range = |axis: usize| {
        if axis == slowest { slices.start as u64..slices.end as u64 } else { 0..shape[axis] as u64 }
    };
    let subset = ArraySubset::new_with_ranges(&(0..shape.len()).map(range).collect::<Vec<_>>());
    let bytes: ArrayBytes = array.retrieve_array_subset(&subset).map_err(|e| e.to_string())?;
    let mut bytes = bytes.into_fixed().map_err(|e| e.to_string())?.into_owned();
    if cfg!(target_endian = "big") {
        let size = bytes.len() / subset.num_elements_usize().max(1);
        bytes.chunks_exact_mut(size.max(1)).for_each(<[u8]>::reverse);
    }
    Ok(bytes)
}
