//! The voxels of an array, chunk by chunk.

use super::node::{Stored, error};
use super::stored::{Opened, Place, StoredChunks};
use crate::io::ReadError;
use crate::io::assembled::{AssembleVoxels, Pieces};
use rayon::prelude::*;
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

/// Where they are.
#[derive(Debug)]
pub(super) struct ZarrVoxels {
    folder: PathBuf,
    /// Files of the array's and its groups' metadata.
    metadata: Vec<PathBuf>,
    pieces: Arc<ArrayPieces>,
    /// Slices of a piece: whole chunks, unless these are large.
    thickness: usize,
}

impl ZarrVoxels {
    /// Opens an array of which `axes` are space, fastest first.
    pub(super) fn open(
        folder: &Path,
        axes: [usize; 3],
        stored: &Stored,
        metadata: Vec<PathBuf>,
    ) -> Result<Self, ReadError> {
        let width = stored.scalar.bytes();
        let chunk = stored.chunks.iter().fold(width as u64, |product, &n| product.saturating_mul(n as u64));
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
        let slice = stored.shape[axes[0]].saturating_mul(stored.shape[axes[1]]).saturating_mul(width).max(1);
        let whole_chunks = stored.chunks[slowest];
        let thickness = if whole_chunks.saturating_mul(slice) <= 4 * A_PIECE {
            whole_chunks * (A_PIECE / (whole_chunks * slice)).max(1)
        } else {
            (A_PIECE / slice).max(1)
        };
        let chunks = StoredChunks::find(folder, &array, slowest, width)?;
        let pieces = ArrayPieces { array, chunks, slowest, depth: whole_chunks, width };
        Ok(Self { folder: folder.to_owned(), metadata, pieces: Arc::new(pieces), thickness })
    }
}

impl AssembleVoxels for ZarrVoxels {
    /// Those of the metadata, then all chunks that are stored, in the order of their names.
    fn files(&self) -> Vec<PathBuf> {
        let path = |place: &Place| self.folder.join(self.pieces.array.chunk_key(place).as_str());
        let mut chunks: Vec<PathBuf> =
            self.pieces.chunks.in_layers(0..=u64::MAX).into_iter().map(path).collect();
        chunks.sort();
        self.metadata.iter().cloned().chain(chunks).collect()
    }

    fn stored_bytes(&self) -> u64 {
        self.pieces.chunks.bytes
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let (pieces, folder, thickness) = (Arc::clone(&self.pieces), self.folder.clone(), self.thickness);
        let all = pieces.array.shape()[pieces.slowest] as usize;
        let mut next = 0;
        Ok(Box::new(Pieces::new(move || {
            if next >= all {
                return Ok(None);
            }
            let slices = next..all.min(next.saturating_add(thickness));
            next = slices.end;
            pieces.slices(slices).map(Some).map_err(|reason| ReadError::damaged(&folder, &reason))
        })))
    }
}

/// An array, of which pieces are put together from the chunks that are stored.
#[derive(Debug)]
struct ArrayPieces {
    array: Opened,
    chunks: StoredChunks,
    /// The slowest axis of space, and the voxels of a chunk along it.
    slowest: usize,
    depth: usize,
    /// Bytes of a voxel.
    width: usize,
}

impl ArrayPieces {
    /// Voxels of some slices, in the order of the axes: the fastest of space is the fastest.
    fn slices(&self, slices: Range<usize>) -> Result<Vec<u8>, String> {
        let layers = (slices.start / self.depth) as u64..=((slices.end - 1) / self.depth) as u64;
        let range = |(axis, &size): (usize, &u64)| {
            if axis == self.slowest { slices.start as u64..slices.end as u64 } else { 0..size }
        };
        let ranges: Vec<Range<u64>> = self.array.shape().iter().enumerate().map(range).collect();
        let piece = ArraySubset::new_with_ranges(&ranges);
        let mut voxels = self.array.fill_value().as_ne_bytes().repeat(piece.num_elements_usize());
        let parts = self.chunks.in_layers(layers).into_par_iter().map(|place| self.part(place, &piece));
        for (part, bytes) in parts.collect::<Result<Vec<_>, _>>()? {
            let rows = part.contiguous_linearised_indices(piece.shape()).map_err(|e| e.to_string())?;
            let row = rows.contiguous_elements_usize() * self.width;
            for ((at, _), stored) in rows.iter().zip(bytes.chunks_exact(row)) {
                let at = at as usize * self.width;
                voxels[at..at + row].copy_from_slice(stored);
            }
        }
        if cfg!(target_endian = "big") {
            voxels.chunks_exact_mut(self.width).for_each(<[u8]>::reverse);
        }
        Ok(voxels)
    }

    /// What of a chunk lies in a piece: where there, and its voxels.
    fn part(&self, place: &Place, piece: &ArraySubset) -> Result<(ArraySubset, Vec<u8>), String> {
        let told = |e: &dyn std::fmt::Display| e.to_string();
        let chunk = self.array.chunk_subset(place).map_err(|e| told(&e))?;
        let part = chunk.overlap(piece).map_err(|e| told(&e))?;
        let in_chunk = part.relative_to(chunk.start()).map_err(|e| told(&e))?;
        let bytes: ArrayBytes = self.array.retrieve_chunk_subset(place, &in_chunk).map_err(|e| told(&e))?;
        let bytes = bytes.into_fixed().map_err(|e| told(&e))?.into_owned();
        let in_piece = part.relative_to(piece.start()).map_err(|e| told(&e))?;
        if bytes.len() == in_piece.num_elements_usize() * self.width {
            Ok((in_piece, bytes))
        } else {
            Err(format!("chunk {place:?} has {} bytes of voxels", bytes.len()))
        }
    }
}
