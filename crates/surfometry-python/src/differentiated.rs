//! Integrals of a batch of images, and their derivatives by every voxel.

use crate::arrays::array_of;
use crate::errors::{Name, of_run};
use crate::options::{Options, plan};
use crate::session::unlocked;
use numpy::{Element, PyReadonlyArray2, PyReadonlyArray4, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use surfometry::differentiable::{Differentiable, IntegralValues};
use surfometry::measurement::{CurvatureScale, MeasureError};
use surfometry::volume::Grid;

/// How integrals of images are taken: options by their names, the spacing of each image, x first, mm.
#[derive(FromPyObject)]
pub(crate) struct Integration {
    options: Options,
    spacings: Vec<[f64; 3]>,
    threads: usize,
}

/// Numbers of the type that an image has.
trait Real: Element + Copy + Into<f64> + Send + Sync {
    fn rounded(value: f64) -> Self;
}

impl Real for f32 {
    fn rounded(value: f64) -> Self {
        value as f32
    }
}

impl Real for f64 {
    fn rounded(value: f64) -> Self {
        value
    }
}

/// The integrals of each image of a batch (n, z, y, x), in the order of their names.
#[pyfunction]
pub(crate) fn integrals<'py>(
    py: Python<'py>,
    images: &Bound<'py, PyAny>,
    integration: Integration,
) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(images) = images.extract::<PyReadonlyArray4<f32>>() {
        return values_of(py, &images, &integration);
    }
    values_of(py, &images.extract::<PyReadonlyArray4<f64>>()?, &integration)
}

/// Derivatives by each voxel of each image of the integrals' sum weighted by `weights` (n, 5), in the type of the
/// images.
#[pyfunction]
pub(crate) fn integrals_vjp<'py>(
    py: Python<'py>,
    images: &Bound<'py, PyAny>,
    weights: PyReadonlyArray2<'py, f64>,
    integration: Integration,
) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(images) = images.extract::<PyReadonlyArray4<f32>>() {
        return gradients_of(py, &images, &weights, &integration);
    }
    gradients_of(py, &images.extract::<PyReadonlyArray4<f64>>()?, &weights, &integration)
}

fn values_of<'py, T: Real>(
    py: Python<'py>,
    images: &PyReadonlyArray4<'py, T>,
    integration: &Integration,
) -> PyResult<Bound<'py, PyAny>> {
    let mut all = Vec::new();
    each(py, images, integration, |integrals, image, _| {
        all.extend(integrals.values(image)?.to_array());
        Ok(())
    })?;
    array_of(py, all, [images.shape()[0], IntegralValues::NAMES.len()])
}

fn gradients_of<'py, T: Real>(
    py: Python<'py>,
    images: &PyReadonlyArray4<'py, T>,
    weights: &PyReadonlyArray2<'py, f64>,
    integration: &Integration,
) -> PyResult<Bound<'py, PyAny>> {
    let weights = weights.as_slice()?;
    let mut all: Vec<T> = Vec::with_capacity(images.len());
    each(py, images, integration, |integrals, image, number| {
        let own = &weights[number * IntegralValues::NAMES.len()..];
        let own = IntegralValues::from_array(std::array::from_fn(|n| own[n]));
        all.extend(integrals.gradient(image, &own)?.into_iter().map(T::rounded));
        Ok(())
    })?;
    let shape: [usize; 4] = std::array::from_fn(|axis| images.shape()[axis]);
    array_of(py, all, shape)
}

/// Does something with each image, without the interpreter's lock. Neighbours of one spacing share what is set up.
fn each<T: Real>(
    py: Python,
    images: &PyReadonlyArray4<T>,
    Integration { options, spacings, threads }: &Integration,
    mut work: impl FnMut(&Differentiable, &[T], usize) -> Result<(), MeasureError> + Send,
) -> PyResult<()> {
    let measurement = plan(py, options, CurvatureScale::AsMeasured)?.measurement;
    let &[count, nz, ny, nx] = images.shape() else {
        return Err(PyTypeError::new_err("images are a batch of three axes"));
    };
    let voxels = images.as_slice()?;
    let size = nz * ny * nx;
    let done = unlocked(py, *threads, || {
        let mut known: Option<([f64; 3], Differentiable)> = None;
        for (number, &spacing) in (0..count).zip(spacings.iter().cycle()) {
            let integrals = match known.take().filter(|(of, _)| *of == spacing) {
                Some((_, integrals)) => integrals,
                None => Differentiable::new(&measurement, Grid::axis_aligned([nx, ny, nz], spacing)?)?,
            };
            work(&integrals, &voxels[number * size..][..size], number)?;
            known = Some((spacing, integrals));
        }
        Ok(())
    })?;
    let name = Name { name: "image", is_in_memory: true };
    done.map_err(|error: MeasureError| of_run(py, Some(&name), &error.into()))
}
