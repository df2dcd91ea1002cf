//! Images in files.

use super::slabs::Reader;
use super::{HeaderFacts, InputError, OpenOptions, Slabs, Source};
use crate::accuracy::{Flag, FlagCode};
use crate::io::{ImageHeader, VoxelStream, read_header};
use crate::volume::Grid;
use std::path::{Path, PathBuf};

/// An image in a file, or in two: header and data.
pub(super) struct FileSource {
    path: PathBuf,
    header: ImageHeader,
    grid: Grid,
    replaced: bool,
}

impl FileSource {
    pub(super) fn open(path: &Path, options: &OpenOptions) -> Result<Self, InputError> {
        let header = read_header(path)?;
        let grid = header.grid(options.spacing)?;
        Ok(Self { path: path.to_owned(), header, grid, replaced: options.spacing.is_some() })
    }
}

impl Source for FileSource {
    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn slabs(&self) -> Result<Slabs<'_>, InputError> {
        Ok(Box::new(Reader(VoxelStream::of_header(self.header.clone(), self.grid)?)))
    }

    fn header(&self) -> HeaderFacts {
        HeaderFacts { format: self.header.format.name(), voxel_type: self.header.scalar.name() }
    }

    fn files(&self) -> Vec<PathBuf> {
        let data = &self.header.data.path;
        // The same file under another name counts once.
        let apart = data.canonicalize().ok() != self.path.canonicalize().ok();
        [&self.path].into_iter().chain(apart.then_some(data)).cloned().collect()
    }

    fn flags(&self) -> Vec<Flag> {
        if self.replaced { Vec::new() } else { conflict_flag(&self.header).into_iter().collect() }
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
