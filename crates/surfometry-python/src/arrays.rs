//! Values as NumPy arrays, without a copy.

use numpy::ndarray::{Array, IntoDimension};
use numpy::{Element, IntoPyArray};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// An array of some shape, the last axis fastest.
pub(crate) fn array_of<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    shape: impl IntoDimension,
) -> PyResult<Bound<'_, PyAny>> {
    let array = Array::from_shape_vec(shape.into_dimension(), values);
    Ok(array.map_err(|error| PyRuntimeError::new_err(error.to_string()))?.into_pyarray(py).into_any())
}
