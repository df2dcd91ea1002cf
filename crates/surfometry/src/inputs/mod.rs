//! Everything that can be measured, behind one door: [`open`] makes a [`Source`] of whatever a name stands
//! for.
//!
//! A new kind of input is a file here and an arm of [`Kind`]: nobody else asks what an input is.

mod error;
mod file;
mod mesh;
mod named;
mod names;
mod phantom;
mod preparation;
mod prepared;
mod slabs;

pub use error::InputError;
pub use named::named;
pub use names::{distinct_parts, grey_image_warning, input_title, shown_name, with_parts};
pub use preparation::{Changes, Preparation, Preparations, PreparedObject, Threshold, ThresholdError};
pub use prepared::prepared;

use crate::accuracy::Flag;
use crate::io::{Format, RawLayout};
use crate::phantoms::{Phantom, Truth};
use crate::volume::{Grid, LabelTable, Segments, SlabReader};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Something that can be measured: its lattice, its voxels as often as they are wanted, and what is known of
/// it beside.
///
/// ```
/// use surfometry::inputs::{OpenOptions, open};
/// use surfometry::volume::LabelImage;
/// let source = open("phantom:ball?radius=6", &OpenOptions::default())?;
/// let image = LabelImage::from_slabs(&mut source.slabs()?)?;
/// assert_eq!(image.grid().dimensions(), source.grid().dimensions());
/// # Ok::<(), surfometry::inputs::InputError>(())
/// ```
pub trait Source: Send + Sync {
    /// The lattice.
    fn grid(&self) -> &Grid;

    /// The voxels, front to back; each call begins again.
    ///
    /// # Errors
    /// [`InputError`] for whatever shows before the first slab.
    fn slabs(&self) -> Result<Slabs<'_>, InputError>;

    /// What the header says of how voxels are stored.
    fn header(&self) -> HeaderFacts;

    /// Exact integrals, of built-in shapes.
    fn truth(&self) -> Option<Truth> {
        None
    }

    /// Whether its voxels are an object by the way in which they are made, so that they can be no field.
    fn is_object(&self) -> bool {
        false
    }

    /// Names and colours of labels, where the input has any.
    fn label_table(&self) -> LabelTable {
        LabelTable::default()
    }

    /// The names alone.
    fn label_names(&self) -> BTreeMap<i64, String> {
        self.label_table().names()
    }

    /// Which segments the values of voxels stand for, of an input whose segments may overlap: known as far as its voxels
    /// have gone by. `None` where values are labels.
    fn segments(&self) -> Option<Segments> {
        None
    }

    /// The files that it rests on: header and data, where they are apart; none of a built-in shape.
    fn files(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// Warnings that come with it.
    fn flags(&self) -> Vec<Flag> {
        Vec::new()
    }

    /// What was done to its voxels, known once they were read; `None` where nothing is.
    fn preparations(&self) -> Option<Arc<Preparations>> {
        None
    }
}

/// The voxels of a source.
pub type Slabs<'a> = Box<dyn SlabReader<Error = InputError> + 'a>;

/// How voxels are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HeaderFacts {
    /// Name of the format, for people.
    pub format: &'static str,
    /// Type of a voxel, as NumPy names it.
    pub voxel_type: &'static str,
}

/// What the caller knows better than the input.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OpenOptions {
    /// Spacing in mm, fastest axis first: replaces the input's, or supplies what it lacks.
    pub spacing: Option<[f64; 3]>,
    /// What is done to its voxels before anything is measured of them.
    pub preparation: Preparation,
    /// Names and colours of labels, which win over the input's own.
    pub names: LabelTable,
    /// How voxels are stored in image files, which then have no header.
    pub raw: Option<RawLayout>,
}

/// Opens whatever a name stands for.
///
/// # Errors
/// [`InputError`] for whatever shows before its voxels are read.
pub fn open(name: &str, options: &OpenOptions) -> Result<Box<dyn Source>, InputError> {
    if names::shows_bytes(name) && !Path::new(name).exists() {
        return Err(InputError::Unfit(
            "the file's name is not UTF-8 (its odd bytes are shown as \\x..), and is not opened: rename the file",
        ));
    }
    let source: Box<dyn Source> = match Kind::of(name) {
        Kind::Phantom => Box::new(phantom::PhantomSource::open(name, options)?),
        Kind::Mesh => Box::new(mesh::MeshSource::open(Path::new(name), options)?),
        Kind::File => Box::new(file::FileSource::open(Path::new(name), options)?),
    };
    Ok(named(prepared(source, options.preparation), options))
}

/// The files that an input rests on, without its voxels being looked at: header, data, what a mesh names. Of what
/// cannot be opened the one that is named.
pub fn files_of(name: &str) -> Vec<PathBuf> {
    let found = match Kind::of(name) {
        Kind::Phantom => Ok(Vec::new()),
        Kind::Mesh => mesh::files(Path::new(name)),
        Kind::File if Format::stands_alone(Path::new(name)) => Ok(vec![PathBuf::from(name)]),
        Kind::File => open(name, &OpenOptions { spacing: Some([1.0; 3]), ..OpenOptions::default() })
            .map(|source| source.files()),
    };
    found.unwrap_or_else(|_| vec![PathBuf::from(name)])
}

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A built-in shape: `phantom:NAME?key=value&...`.
    Phantom,
    /// A closed surface in a file.
    Mesh,
    /// An image in a file.
    File,
}

impl Kind {
    /// By the name; of a `.vtk` file, which may be either, by what it holds.
    pub fn of(name: &str) -> Self {
        if Phantom::is_spec(name) {
            Self::Phantom
        } else if crate::io::is_mesh(Path::new(name)) {
            Self::Mesh
        } else {
            Self::File
        }
    }

    /// Whether the name is that of a file.
    pub fn is_path(self) -> bool {
        self != Self::Phantom
    }
}
