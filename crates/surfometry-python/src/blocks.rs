//! Images that are measured block by block, by processes that see a part of them each.

use crate::array_source::Borrowed;
use crate::errors::{of_run, raise};
use crate::input::{Held, affine_of_rows};
use crate::measured::text;
use crate::options::{Options, plan};
use crate::session::Session;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use surfometry::measurement::{CurvatureScale, DecodeError, PartialMeasurement};
use surfometry::runs::{Blockwise, Record, RunError};
use surfometry::tiling::IndexBox;
use surfometry::volume::{Grid, LabelBlock, LabelBlockBuilder, VolumeError};

/// First voxel of a box and one past the last, x first.
type Corners = ([i64; 3], [i64; 3]);

/// An image of which the lattice is known, and how it is measured.
#[pyclass(frozen)]
pub(crate) struct Blocks {
    run: Arc<Blockwise>,
    grid: Grid,
    name: String,
}

/// The labels in a box of an image, slices of which are added.
#[pyclass(frozen)]
pub(crate) struct Part {
    /// The image's.
    name: String,
    builder: Mutex<Option<LabelBlockBuilder>>,
}

#[pymethods]
impl Blocks {
    /// `dimensions` are x first.
    #[new]
    fn new(
        py: Python,
        dimensions: [usize; 3],
        affine: Option<[[f64; 4]; 3]>,
        name: String,
        label_names: BTreeMap<i64, String>,
        options: Options,
    ) -> PyResult<Self> {
        let plan = plan(py, &options, CurvatureScale::AsMeasured)?;
        let grid = Grid::of_known(dimensions, affine.map(affine_of_rows), plan.open.spacing);
        let made = grid.map_err(RunError::from).and_then(|grid| {
            let run = Arc::new(Blockwise::new(plan, grid, &name, label_names)?);
            Ok((run, grid))
        });
        let held = Held::Name(name.clone());
        let (run, grid) = made.map_err(|error| of_run(py, Some(&held.name()), &error))?;
        Ok(Self { run, grid, name })
    }

    /// The voxels that must be known to measure a block; none where no sums belong to it.
    fn needed(&self, py: Python, lower: [i64; 3], upper: [i64; 3]) -> PyResult<Corners> {
        let share = self.run.share(IndexBox::new(lower, upper)).map_err(|error| of_run(py, None, &error))?;
        let needed = if share.owned.is_empty() { IndexBox::EMPTY } else { share.needed };
        Ok((needed.lower, needed.upper))
    }

    /// None of the slices yet of a box.
    fn part(&self, py: Python, lower: [i64; 3], upper: [i64; 3]) -> PyResult<Part> {
        let builder = LabelBlockBuilder::new(self.grid, IndexBox::new(lower, upper));
        let builder = builder.map_err(|error| self.error(py, error))?;
        Ok(Part { name: self.name.clone(), builder: Mutex::new(Some(builder)) })
    }

    /// What a block adds, as bytes; of a part that holds what the block needs.
    fn partial<'py>(
        &self,
        py: Python<'py>,
        part: Option<&Part>,
        lower: [i64; 3],
        upper: [i64; 3],
        session: Session,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let block = part.map(|part| self.block(py, part)).transpose()?;
        let (run, region) = (Arc::clone(&self.run), IndexBox::new(lower, upper));
        let bytes = session.run(py, &self.held(), move |control, _| {
            let partial = match &block {
                Some(block) => run.partial(block, region, control)?,
                None => run.nothing()?,
            };
            control.check()?;
            Ok(partial.to_bytes())
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Records and whether each object is to be looked at as a whole, as JSON, of all blocks' sum.
    fn records(&self, py: Python, whole: PyBackedBytes, session: Session) -> PyResult<String> {
        let whole = read(py, &whole)?;
        let run = Arc::clone(&self.run);
        let found = session.run(py, &self.held(), move |_, _| run.records(&whole))?;
        let (records, wanted): (Vec<_>, Vec<_>) =
            found.into_iter().map(|found| (found.record, found.wants_whole)).unzip();
        text(&json!({ "records": records, "wants_whole": wanted }))
    }

    /// Records, as JSON, of objects of which a part holds all voxels.
    fn looked_again(&self, py: Python, records: &str, part: &Part, session: Session) -> PyResult<String> {
        let records: Vec<Record> = serde_json::from_str(records)
            .map_err(|error| raise(py, "InternalError", &error.to_string(), &[]))?;
        let (run, block) = (Arc::clone(&self.run), self.block(py, part)?);
        let found =
            session.run(py, &self.held(), move |control, _| run.looked_again(records, &block, control))?;
        text(&found)
    }
}

impl Blocks {
    fn held(&self) -> Held<'static> {
        Held::Name(self.name.clone())
    }

    fn error(&self, py: Python, error: VolumeError) -> PyErr {
        of_run(py, Some(&self.held().name()), &error.into())
    }

    /// What was added to a part, which is used up.
    fn block(&self, py: Python, part: &Part) -> PyResult<LabelBlock> {
        let builder = part.builder.lock().unwrap_or_else(PoisonError::into_inner).take();
        let builder =
            builder.ok_or_else(|| raise(py, "InternalError", "the part was measured before", &[]))?;
        builder.finish().map_err(|error| self.error(py, error))
    }
}

#[pymethods]
impl Part {
    /// Adds the next slices: a native, aligned array (z, y, x).
    fn push(&self, py: Python, slices: &Bound<'_, PyAny>) -> PyResult<()> {
        let borrowed = Borrowed::of(slices)?;
        let voxels = borrowed.voxels();
        let last = voxels.dimensions()[2];
        let pushed = py.detach(|| {
            let samples = voxels.slices(0, last)?;
            let mut builder = self.builder.lock().unwrap_or_else(PoisonError::into_inner);
            builder.as_mut().map_or(Ok(()), |builder| builder.push(&samples))
        });
        let held = Held::Name(self.name.clone());
        pushed.map_err(|error| of_run(py, Some(&held.name()), &error.into()))
    }
}

/// The values of disjoint blocks as one.
#[pyfunction]
pub(crate) fn merged(py: Python<'_>, partials: Vec<PyBackedBytes>) -> PyResult<Bound<'_, PyBytes>> {
    let mut all: Option<PartialMeasurement> = None;
    for partial in &partials {
        let partial = read(py, partial)?;
        all = Some(match all {
            None => partial,
            Some(all) => all.merged(partial).map_err(|error| wrong(py, &error))?,
        });
    }
    let none = || raise(py, "InternalError", "there is nothing to merge", &[]);
    Ok(PyBytes::new(py, &all.ok_or_else(none)?.to_bytes()))
}

fn read(py: Python, bytes: &[u8]) -> PyResult<PartialMeasurement> {
    PartialMeasurement::from_bytes(bytes).map_err(|error: DecodeError| wrong(py, &error))
}

fn wrong(py: Python, error: &dyn std::error::Error) -> PyErr {
    raise(py, "InputError", &error.to_string(), &[])
}
