//! What Python hands over to be measured.

use crate::array_source::{ArraySource, Borrowed, Voxels};
use crate::options::Options;
use crate::session::Session;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use surfometry::inputs::{InputError, OpenOptions, Source, open};
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

/// An input that can be given to another thread.
pub(crate) enum Prepared<'a> {
    Name(&'a str),
    Image {
        voxels: Voxels<'a>,
        affine: Option<Affine>,
        name: &'a str,
        label_names: &'a BTreeMap<i64, String>,
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
    /// The same for another thread, as long as it is held.
    pub(crate) fn prepared(&self) -> Prepared<'_> {
        match self {
            Self::Name(name) => Prepared::Name(name),
            Self::Image { borrowed, affine, name, label_names } => {
                Prepared::Image { voxels: borrowed.voxels(), affine: *affine, name, label_names }
            }
        }
    }
}

impl<'a> Prepared<'a> {
    /// What its results are called.
    pub(crate) fn name(&self) -> &'a str {
        match self {
            Self::Name(name) | Self::Image { name, .. } => name,
        }
    }

    /// Whether it is an image in memory.
    pub(crate) fn is_in_memory(&self) -> bool {
        matches!(self, Self::Image { .. })
    }

    /// Opens it.
    pub(crate) fn source(self, options: &OpenOptions) -> Result<Box<dyn Source + 'a>, InputError> {
        match self {
            Self::Name(name) => Ok(open(name, options)?),
            Self::Image { voxels, affine, label_names, .. } => {
                let grid = Grid::of_known(voxels.dimensions(), affine, options.spacing)?;
                Ok(Box::new(ArraySource { grid, voxels, label_names: label_names.clone() }))
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
