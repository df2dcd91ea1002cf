//! Images in files.

use super::slabs::Reader;
use super::{HeaderFacts, InputError, OpenOptions, Slabs, Source};
use crate::accuracy::{Flag, FlagCode};
use crate::io::{ImageHeader, VoxelStream, read_header, read_raw_header};
use crate::volume::{Grid, LabelTable, Segments};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// An image in a file, or in two: header and data.
pub(super) struct FileSource {
    path: PathBuf,
    header: ImageHeader,
    grid: Grid,
    replaced: bool,
    /// Bytes behind the last voxel: of compressed data known once they were read.
    surplus: Arc<AtomicU64>,
}

impl FileSource {
    pub(super) fn open(path: &Path, options: &OpenOptions) -> Result<Self, InputError> {
        let header = match options.raw {
            Some(layout) => read_raw_header(path, layout)?,
            None => read_header(path)?,
        };
        let grid = header.grid(options.spacing)?;
        let surplus = Arc::new(AtomicU64::new(header.raw_surplus()));
        Ok(Self { path: path.to_owned(), header, grid, replaced: options.spacing.is_some(), surplus })
    }
}

impl Source for FileSource {
    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn slabs(&self) -> Result<Slabs<'_>, InputError> {
        Ok(Box::new(Reader(VoxelStream::of_header(
            self.header.clone(),
            self.grid,
            Arc::clone(&self.surplus),
        )?)))
    }

    fn header(&self) -> HeaderFacts {
        HeaderFacts { format: self.header.format.name(), voxel_type: self.header.scalar.name() }
    }

    fn files(&self) -> Vec<PathBuf> {
        let data = self.header.data.files();
        // A folder is what is in it, of a Zarr perhaps a million files.
        if self.path.is_dir() && self.header.path.is_dir() {
            return data;
        }
        let named = [self.path.clone(), self.header.path.clone()].into_iter().chain(data);
        // The same file under another name counts once.
        let mut known = HashSet::new();
        named.filter(|file| !file.is_dir() && known.insert(file.canonicalize().ok())).collect()
    }

    fn label_table(&self) -> LabelTable {
        self.header.labels.clone()
    }

    fn segments(&self) -> Option<Segments> {
        self.header.data.segments()
    }

    fn flags(&self) -> Vec<Flag> {
        let conflict = conflict_flag(&self.header).filter(|_| !self.replaced);
        conflict.into_iter().chain(surplus_flag(self.surplus.load(Ordering::Relaxed))).collect()
    }
}

/// A warning where the header names two spacings.
fn conflict_flag(header: &ImageHeader) -> Option<Flag> {
    let (affine, other) = (header.affine?, header.other_spacing?);
    let used = affine.column_lengths();
    let message = format!(
        "the header's affine says spacing {used:.6?} mm, its pixdim {other:.6?} mm; the affine is used: check which is \
         right, and give the spacing where it is the other"
    );
    Some(Flag::new(FlagCode::SpacingConflict, message))
}

/// A warning where bytes follow the last voxel.
fn surplus_flag(bytes: u64) -> Option<Flag> {
    let message = format!(
        "the data hold {bytes} bytes more than the header needs: is there an unknown header in front of the voxels, so that all are read in the wrong \
         place, or are the dimensions wrong?"
    );
    (bytes > 0).then(|| Flag::new(FlagCode::SurplusData, message))
}
