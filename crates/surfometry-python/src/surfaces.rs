//! Surfaces and voxel maps as arrays.

use crate::arrays::array_of;
use crate::errors::{of_run, raise};
use crate::input::{Input, Prepared, Request};
use crate::measured::{collected, of_task, text};
use crate::options::{chosen, curvature, plan};
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;
use surfometry::Control;
use surfometry::io::{MeshDocument, write_mesh as write};
use surfometry::measurement::{Outside, VoxelQuantity};
use surfometry::pictures::color_scale;
use surfometry::runs::{
    Against, BesideRole, Collected, MapStyle, MappedSurface, Opened, Plan, RunError, SurfaceTask,
    VoxelMapTask,
};
use surfometry::surface::{Mesh, VertexArray, VertexValues};

/// A surface an object: record as JSON, title, vertices, triangles, colours, arrays by name; compared with that of a later
/// image, where there is one.
#[pyfunction]
pub(crate) fn surface<'py>(
    py: Python<'py>,
    request: Request,
    curvature_sigma: Option<&str>,
    against: Option<Input<'py>>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let plan = plan(py, &request.options, curvature(py, curvature_sigma)?)?;
    let found = match against {
        None => collected(py, request, plan.open.clone(), SurfaceTask { plan, against: None })?,
        Some(later) => {
            let (image, later) = (request.image.held()?, later.held()?);
            request
                .session
                .run_both(py, [&image, &later], move |control, both| compared(plan, both, control))?
        }
    };
    found.results.into_iter().map(|mapped| as_arrays(py, mapped)).collect()
}

/// The surfaces of an image, compared with those of a later one.
fn compared(
    plan: Plan,
    [image, later]: [Prepared; 2],
    control: &Control,
) -> Result<Collected<MappedSurface>, RunError> {
    let (open, name) = (plan.open.clone(), later.name().to_owned());
    let unread = |error| RunError::Beside {
        what: BesideRole::Later,
        file: name,
        source: Box::new(RunError::Input(error)),
    };
    let (name, source) = later.opened(&open).map_err(unread)?;
    let later = Against::read(&Opened::new(&name, None, source, control), &plan)?;
    of_task(&SurfaceTask { plan, against: Some(Arc::new(later)) }, image, &open, control)
}

fn as_arrays(py: Python<'_>, mapped: MappedSurface) -> PyResult<Bound<'_, PyDict>> {
    let MappedSurface { title, record, surface } = mapped;
    let quantity = MapStyle::default().picture.quantity;
    let scale = color_scale(&surface, quantity, None);
    let colors = surface.values(quantity).map(|values| scale.colors(&values)).unwrap_or_default();
    let (given, arrays) = (PyDict::new(py), PyDict::new(py));
    for array in surface.arrays() {
        match array.values {
            VertexValues::Scalar(values) => arrays.set_item(array.name, values.into_pyarray(py))?,
            VertexValues::Vector(values) => arrays.set_item(array.name, rows(py, values)?)?,
        }
    }
    given.set_item("record", text(&record)?)?;
    given.set_item("title", format!("surfometry {}: {title}", env!("CARGO_PKG_VERSION")))?;
    given.set_item("vertices", rows(py, surface.mesh.vertices)?)?;
    given.set_item("faces", rows(py, surface.mesh.triangles)?)?;
    given.set_item("colors", rows(py, colors)?)?;
    given.set_item("arrays", arrays)?;
    Ok(given)
}

/// Triples as an array of three columns, without a copy.
fn rows<T: numpy::Element>(py: Python<'_>, triples: Vec<[T; 3]>) -> PyResult<Bound<'_, PyAny>> {
    let shape = (triples.len(), 3);
    array_of(py, triples.into_flattened(), shape)
}

/// Maps an object: record as JSON, and arrays (z, y, x) by the name of the quantity.
#[pyfunction]
pub(crate) fn voxel_maps<'py>(
    py: Python<'py>,
    request: Request,
    curvature_sigma: Option<&str>,
    quantities: Vec<String>,
    outside: &str,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let named = |name: &String| chosen::<VoxelQuantity>(py, "quantities", name);
    let quantities = quantities.iter().map(named).collect::<PyResult<Vec<_>>>()?;
    let plan = plan(py, &request.options, curvature(py, curvature_sigma)?)?;
    let outside = chosen::<Outside>(py, "outside", outside)?;
    let task =
        VoxelMapTask { plan: Plan { recover: false, ..plan }, quantities: quantities.clone(), outside };
    let found = collected(py, request, task.plan.open.clone(), task)?;
    let as_arrays = |maps: surfometry::runs::VoxelMaps| {
        let [nx, ny, nz] = maps.record.measured.grid.dimensions;
        let (given, arrays) = (PyDict::new(py), PyDict::new(py));
        for (quantity, values) in quantities.iter().zip(maps.maps) {
            arrays.set_item(quantity.name(), array_of(py, values, (nz, ny, nx))?)?;
        }
        given.set_item("record", text(&maps.record)?)?;
        given.set_item("arrays", arrays)?;
        Ok(given)
    };
    found.results.into_iter().map(as_arrays).collect()
}

/// The attributes of the Python layer's surface.
#[derive(FromPyObject)]
pub(crate) struct MeshInput<'py> {
    vertices: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, u32>,
    colors: PyReadonlyArray2<'py, u8>,
    /// In the order in which they are written.
    arrays: Bound<'py, PyDict>,
    title: String,
}

/// Values at vertices.
#[derive(FromPyObject)]
pub(crate) enum Values<'py> {
    Scalar(PyReadonlyArray1<'py, f64>),
    Vector(PyReadonlyArray2<'py, f64>),
}

/// Writes a mesh with its arrays, in the format that the name's ending says; the files' names.
#[pyfunction]
pub(crate) fn write_mesh(py: Python, path: PathBuf, mesh: MeshInput) -> PyResult<Vec<PathBuf>> {
    let array = |(name, values): (Bound<PyAny>, Bound<PyAny>)| {
        let values = match values.extract::<Values>()? {
            Values::Scalar(values) => VertexValues::Scalar(values.as_array().to_vec()),
            Values::Vector(values) => VertexValues::Vector(triples(&values.as_array())),
        };
        Ok(VertexArray { name: name.extract::<String>()?.into(), values })
    };
    let arrays = mesh.arrays.iter().map(array).collect::<PyResult<Vec<_>>>()?;
    let colors = triples(&mesh.colors.as_array());
    let colors = (!colors.is_empty()).then_some(colors);
    let triangles =
        Mesh { vertices: triples(&mesh.vertices.as_array()), triangles: triples(&mesh.faces.as_array()) };
    let document =
        MeshDocument { mesh: &triangles, arrays: &arrays, colors: colors.as_deref(), title: &mesh.title };
    py.detach(|| write(&path, &document)).map_err(|source| match source.kind() {
        std::io::ErrorKind::InvalidInput => {
            let name = path.to_string_lossy();
            raise(py, "ParameterError", &format!("{name}: {source}"), &[("path", Some(&name))])
        }
        _ => of_run(py, None, &RunError::Write { path: path.clone(), source }),
    })
}

/// Rows of three. The Python layer has seen to it that there are three.
fn triples<T: Copy>(values: &numpy::ndarray::ArrayView2<T>) -> Vec<[T; 3]> {
    values.rows().into_iter().map(|row| std::array::from_fn(|axis| row[axis])).collect()
}
