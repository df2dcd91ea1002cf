//! Objects to voxel maps, kept in memory.

use super::{Item, Opened, Plan, Reading, Record, RunError, Task};
use crate::measurement::{Outside, VoxelQuantity};

/// Maps quantities of every selected object of an input on the input's own lattice, as
/// [`MapTask`](super::MapTask) does, without files.
///
/// ```
/// use surfometry::{Control, measurement::VoxelQuantity, runs::{Batch, Collected, Plan, VoxelMapTask}};
/// let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let plan = Plan { recover: false, ..Plan::default() };
/// let mut found = Collected::default();
/// let quantities = vec![VoxelQuantity::Phi];
/// batch.run(&VoxelMapTask { plan, quantities, outside: Default::default() }, &mut found)?;
/// assert!(found.results[0].maps[0].iter().any(|&phi| phi < 0.0));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct VoxelMapTask {
    /// What is asked.
    pub plan: Plan,
    /// What the maps show.
    pub quantities: Vec<VoxelQuantity>,
    /// What those of curvature have outside the band.
    pub outside: Outside,
}

/// Maps of one object.
#[derive(Debug, Clone, PartialEq)]
pub struct VoxelMaps {
    /// Its numbers.
    pub record: Record,
    /// A value a voxel of the whole image, x fastest; a map a quantity.
    pub maps: Vec<Vec<f32>>,
}

impl Task for VoxelMapTask {
    type Row = VoxelMaps;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<VoxelMaps>)) -> Result<(), RunError> {
        let reading = Reading::of(input, &self.plan)?;
        for object in reading.objects() {
            let object = object?;
            let region = object.object.grid().index_box();
            let map = |&quantity: &VoxelQuantity| {
                let map = object.local().voxel_map_on(quantity, &region, self.outside.value());
                let map = map.ok_or(RunError::NoSurface)?;
                input.control.check()?;
                Ok(map.into_storage())
            };
            let maps = self.quantities.iter().map(map).collect::<Result<_, RunError>>()?;
            out(Item::Row(VoxelMaps { record: object.record(), maps }));
        }
        Ok(())
    }
}
