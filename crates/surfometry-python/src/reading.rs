//! Inputs as arrays.

use crate::arrays::array_of;
use crate::input::{Held, rows_of_affine};
use crate::options::{Options, choices};
use crate::session::Session;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use surfometry::inputs::{InputError, Source};
use surfometry::runs::RunError;
use surfometry::volume::{Affine, Samples};
use surfometry::{Control, Stopped};

/// The voxels of an input as an array (z, y, x) of the type that it stores, its affine, and what else is known.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    name: &str,
    options: Options,
    session: Session,
) -> PyResult<Bound<'py, PyDict>> {
    let open_options = choices(py, &options)?.open();
    let (source, samples) = session.run(py, &Held::Name(name.to_owned()), move |control, prepared| {
        let (_, source) = prepared.opened(&open_options)?;
        let samples = all_samples(&*source, control)?;
        Ok::<_, RunError>((source, samples))
    })?;
    let given = PyDict::new(py);
    given.set_item("voxels", as_array(py, samples, source.grid().dimensions())?)?;
    given.set_item("affine", rows_of_affine(source.grid().affine()))?;
    given.set_item("label_names", source.label_names())?;
    given.set_item("flags", json!(source.flags()).to_string())?;
    given.set_item("truth", json!(source.truth()).to_string())?;
    Ok(given)
}

fn all_samples(source: &dyn Source, control: &Control) -> Result<Samples, InputError> {
    let mut slabs = source.slabs()?;
    let mut all: Option<Samples> = None;
    while let Some(slab) = slabs.next_slab()? {
        control.check().map_err(|Stopped| InputError::Stopped(Stopped))?;
        match &mut all {
            None => all = Some(slab.samples),
            Some(all) => append(all, slab.samples),
        }
    }
    Ok(all.unwrap_or(Samples::U8(Vec::new())))
}

macro_rules! for_each_type {
    ($($variant:ident),+) => {
        fn append(all: &mut Samples, more: Samples) {
            match (all, more) {
                $((Samples::$variant(all), Samples::$variant(more)) => all.extend(more),)+
                // A source stores all of its voxels in one type.
                _ => {}
            }
        }

        fn as_array(
            py: Python<'_>,
            samples: Samples,
            [nx, ny, nz]: [usize; 3],
        ) -> PyResult<Bound<'_, PyAny>> {
            match samples {
                $(Samples::$variant(values) => array_of(py, values, (nz, ny, nx)),)+
            }
        }
    };
}
for_each_type!(U8, I8, U16, I16, U32, I32, U64, I64, F32, F64);

/// The affine (rows, RAS) of an image that states directions, one an axis, x first.
#[pyfunction]
pub(crate) fn affine_of_directions(
    directions: [[f64; 3]; 3],
    spacing: [f64; 3],
    origin: [f64; 3],
    lps: bool,
) -> [[f64; 4]; 3] {
    let affine = Affine::from_directions(directions, spacing, origin);
    rows_of_affine(&if lps { affine.with_lps_swapped() } else { affine })
}
