//! Objects to their surfaces, kept in memory.

use super::{Against, Item, Opened, Plan, Reading, RunError, SurfaceRecord, Task};
use crate::surface::Surface;
use std::sync::Arc;

/// Maps every selected object of an input, as [`MapTask`](super::MapTask) does, without files.
///
/// ```
/// use surfometry::{Control, runs::{Batch, Collected, Plan, SurfaceTask}};
/// let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let mut found = Collected::default();
/// batch.run(&SurfaceTask { plan: Plan::default(), against: None }, &mut found)?;
/// assert!(found.results[0].surface.mesh.is_closed());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SurfaceTask {
    /// What is asked.
    pub plan: Plan,
    /// A later image, with whose surfaces they are compared.
    pub against: Option<Arc<Against>>,
}

/// A surface and what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MappedSurface {
    /// The object's name for people.
    pub title: String,
    /// Its numbers, and how curvature is distributed.
    pub record: SurfaceRecord,
    /// The surface, in world coordinates (RAS, mm).
    pub surface: Surface,
}

impl Task for SurfaceTask {
    type Row = MappedSurface;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<MappedSurface>)) -> Result<(), RunError> {
        input.begin_hashing();
        let reading = Reading::of(input, &self.plan)?;
        for object in reading.mapped_objects() {
            let mut object = object?;
            object.surface();
            input.control.check()?;
            object.without_values(&self.plan).into_iter().next().map_or(Ok(()), Err)?;
            let against = self.against.as_ref().map(|later| later.change(&mut object)).transpose()?;
            let (title, record) = (object.title(), SurfaceRecord::of(&object));
            let record = SurfaceRecord { against, ..record };
            input.control.check()?;
            out(Item::Row(MappedSurface { title, record, surface: object.into_surface() }));
        }
        Ok(())
    }
}
