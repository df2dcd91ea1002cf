//! What Python hands over to be measured.

use crate::array_source::{ArraySource, Ask, Borrowed, Voxels};
use crate::errors::Name;
use crate::options::Options;
use crate::session::Session;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use surfometry::inputs::{InputError, OpenOptions, Source, named, open, prepared};
use surfometry::volume::{Affine, Grid};

/// What is asked: attributes of the Python layer's request.
#[derive(FromPyObject)]
pub(crate) struct Request<'py> {
    pub(crate) image: Input<'py>,
    pub(crate) options: Options,
    pub(crate) session: Session<'py>,
}

/// Something to measure: the name of an input, or an image in memory.
#[derive(FromPyObject)]
pub(crate) enum Input<'py> {
    /// A file or a built-in shape.
    Name(String),
    /// An image.
    Image(ImageInput<'py>),
}

/// The attributes of the Python layer's image.
#[derive(FromPyObject)]
pub(crate) struct ImageInput<'py> {
    /// An array of three axes, (z, y, x), native and aligned.
    voxels: Bound<'py, PyAny>,
    /// From index (x, y, z) to world (RAS), mm: rows of a matrix; `None` where nothing is known.
    affine: Option<[[f64; 4]; 3]>,
    /// What its results are called.
    name: String,
    label_names: BTreeMap<i64, String>,
}

/// An input whose array is held.
pub(crate) enum Held<'py> {
    Name(String),
    Image {
        borrowed: Borrowed<'py>,
        affine: Option<Affine>,
        name: String,
        label_names: BTreeMap<i64, String>,
    },
}

/// An input for another thread, which has nothing of Python's.
pub(crate) enum Prepared {
    Name(String),
    Image {
        dimensions: [usize; 3],
        type_name: &'static str,
        bytes_a_voxel: usize,
        affine: Option<Affine>,
        name: String,
        label_names: BTreeMap<i64, String>,
        ask: Ask,
    },
}

impl<'py> Input<'py> {
    /// Holds the array.
    pub(crate) fn held(self) -> PyResult<Held<'py>> {
        Ok(match self {
            Self::Name(name) => Held::Name(name),
            Self::Image(ImageInput { voxels, affine, name, label_names }) => Held::Image {
                borrowed: Borrowed::of(&voxels)?,
                affine: affine.map(affine_of_rows),
                name,
                label_names,
            },
        })
    }
}

impl Held<'_> {
    /// What its results are called.
    pub(crate) fn name(&self) -> Name<'_> {
        match self {
            Self::Name(name) => Name { name, is_in_memory: false },
            Self::Image { name, .. } => Name { name, is_in_memory: true },
        }
    }

    /// The voxels of an image in memory.
    pub(crate) fn voxels(&self) -> Option<Voxels<'_>> {
        match self {
            Self::Name(_) => None,
            Self::Image { borrowed, .. } => Some(borrowed.voxels()),
        }
    }

    /// The same for another thread, which asks for its voxels.
    pub(crate) fn prepared(&self, ask: Ask) -> Prepared {
        match self {
            Self::Name(name) => Prepared::Name(name.clone()),
            Self::Image { borrowed, affine, name, label_names } => {
                let voxels = borrowed.voxels();
                Prepared::Image {
                    dimensions: voxels.dimensions(),
                    type_name: voxels.type_name(),
                    bytes_a_voxel: voxels.bytes_a_voxel(),
                    affine: *affine,
                    name: name.clone(),
                    label_names: label_names.clone(),
                    ask,
                }
            }
        }
    }
}

impl Prepared {
    /// What its results are called.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Name(name) | Self::Image { name, .. } => name,
        }
    }

    /// Opens it; its name, and the source.
    pub(crate) fn opened(self, options: &OpenOptions) -> Result<(String, Box<dyn Source>), InputError> {
        match self {
            Self::Name(name) => {
                let source = open(&name, options)?;
                Ok((name, source))
            }
            Self::Image { dimensions, type_name, bytes_a_voxel, affine, name, label_names, ask } => {
                let grid = Grid::of_known(dimensions, affine, options.spacing)?;
                let source = ArraySource { grid, type_name, bytes_a_voxel, label_names, ask };
                Ok((name, named(prepared(Box::new(source), options.preparation), options)))
            }
        }
    }
}

/// An affine from the rows of its matrix.
pub(crate) fn affine_of_rows(rows: [[f64; 4]; 3]) -> Affine {
    Affine { linear: rows.map(|[a, b, c, _]| [a, b, c]), origin: rows.map(|row| row[3]) }
}

/// The rows of an affine's matrix.
pub(crate) fn rows_of_affine(affine: &Affine) -> [[f64; 4]; 3] {
    std::array::from_fn(|w| {
        let [a, b, c] = affine.linear[w];
        [a, b, c, affine.origin[w]]
    })
}
