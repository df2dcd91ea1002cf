//! A NumPy array as an input, where it lies: axes are (z, y, x), whatever the order in memory.
//!
//! The thread that measures asks the one that holds the array for slices, so that it can be left behind where a signal
//! ends the call: it has nothing of Python's.

use numpy::PyReadonlyArray3;
use numpy::ndarray::{ArrayView3, ArrayViewMut3, Axis};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::sync::mpsc::{Sender, channel};
use surfometry::Stopped;
use surfometry::inputs::{HeaderFacts, InputError, Slabs, Source};
use surfometry::volume::{Grid, LabelTable, Samples, Slab, SlabReader, VolumeError, slices_a_slab};

/// The same for every type of voxel.
macro_rules! voxel_types {
    ($($variant:ident: $type:ty = $name:literal, $samples:ident of $stored:ty;)+) => {
        /// An array that is held against changes by other Rust code.
        pub(crate) enum Borrowed<'py> {
            $($variant(PyReadonlyArray3<'py, $type>),)+
        }

        /// Its voxels.
        pub(crate) enum Voxels<'a> {
            $($variant(ArrayView3<'a, $type>),)+
        }

        impl<'py> Borrowed<'py> {
            /// Of a native, aligned array of three axes.
            pub(crate) fn of(array: &Bound<'py, PyAny>) -> PyResult<Self> {
                $(
                    if let Ok(array) = array.extract::<PyReadonlyArray3<$type>>() {
                        return Ok(Self::$variant(array));
                    }
                )+
                Err(pyo3::exceptions::PyTypeError::new_err("an array of this type is to be converted before"))
            }

            pub(crate) fn voxels(&self) -> Voxels<'_> {
                match self {
                    $(Self::$variant(array) => Voxels::$variant(array.as_array()),)+
                }
            }
        }

        impl Voxels<'_> {
            /// Voxels along x, y, z.
            pub(crate) fn dimensions(&self) -> [usize; 3] {
                let (nz, ny, nx) = match self {
                    $(Self::$variant(voxels) => voxels.dim(),)+
                };
                [nx, ny, nz]
            }

            pub(crate) fn type_name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $name,)+
                }
            }

            pub(crate) fn bytes_a_voxel(&self) -> usize {
                match self {
                    $(Self::$variant(_) => size_of::<$type>(),)+
                }
            }

            /// Whole slices, x fastest.
            pub(crate) fn slices(&self, first: usize, last: usize) -> Result<Samples, VolumeError> {
                match self {
                    $(Self::$variant(voxels) => {
                        let part = voxels.slice_axis(Axis(0), (first..last).into());
                        Ok(Samples::$samples(in_order(&part, |&value| <$stored>::from(value))?))
                    })+
                }
            }
        }
    };
}

voxel_types! {
    Bool: bool = "bool", U8 of u8;
    U8: u8 = "uint8", U8 of u8;
    I8: i8 = "int8", I8 of i8;
    U16: u16 = "uint16", U16 of u16;
    I16: i16 = "int16", I16 of i16;
    U32: u32 = "uint32", U32 of u32;
    I32: i32 = "int32", I32 of i32;
    U64: u64 = "uint64", U64 of u64;
    I64: i64 = "int64", I64 of i64;
    F32: f32 = "float32", F32 of f32;
    F64: f64 = "float64", F64 of f64;
}

/// Voxels with x fastest.
fn in_order<T, S: Clone + Default>(
    part: &ArrayView3<T>,
    stored: impl Fn(&T) -> S,
) -> Result<Vec<S>, VolumeError> {
    let (nz, ny, nx) = part.dim();
    let mut values = Vec::new();
    values.try_reserve_exact(part.len()).map_err(|_| VolumeError::TooLarge { dimensions: [nx, ny, nz] })?;
    values.resize(part.len(), S::default());
    if let Ok(mut all) = ArrayViewMut3::from_shape((nz, ny, nx), &mut values) {
        all.zip_mut_with(part, |to, from| *to = stored(from));
    }
    Ok(values)
}

/// Slices that are asked for, and where they go.
pub(crate) struct SlicesWanted {
    pub(crate) first: usize,
    pub(crate) last: usize,
    pub(crate) reply: Sender<Result<Samples, VolumeError>>,
}

/// Asks whoever holds the array; false where nobody does any more.
pub(crate) type Ask = Box<dyn Fn(SlicesWanted) -> bool + Send + Sync>;

/// An array that another thread holds, and what is known of it.
pub(crate) struct ArraySource {
    pub(crate) grid: Grid,
    pub(crate) type_name: &'static str,
    pub(crate) bytes_a_voxel: usize,
    pub(crate) label_names: BTreeMap<i64, String>,
    pub(crate) ask: Ask,
}

impl Source for ArraySource {
    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn slabs(&self) -> Result<Slabs<'_>, InputError> {
        Ok(Box::new(ArraySlabs { source: self, next: 0 }))
    }

    fn header(&self) -> HeaderFacts {
        HeaderFacts { format: "array", voxel_type: self.type_name }
    }

    fn label_table(&self) -> LabelTable {
        self.label_names.clone().into_iter().collect()
    }
}

struct ArraySlabs<'s> {
    source: &'s ArraySource,
    next: usize,
}

impl SlabReader for ArraySlabs<'_> {
    type Error = InputError;

    fn grid(&self) -> &Grid {
        &self.source.grid
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, InputError> {
        let dimensions = self.source.grid.dimensions();
        let first = self.next;
        if first == dimensions[2] {
            return Ok(None);
        }
        let last = (first + slices_a_slab(dimensions, self.source.bytes_a_voxel)).min(dimensions[2]);
        self.next = last;
        let (reply, answer) = channel();
        if !(self.source.ask)(SlicesWanted { first, last, reply }) {
            return Err(Stopped.into());
        }
        let samples = answer.recv().map_err(|_| Stopped)??;
        Ok(Some(Slab { slices: first..last, samples }))
    }
}
