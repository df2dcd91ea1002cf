//! Objects by the classical methods.

use super::columns::{REFERENCE, columns};
use super::reading::labelled_masks;
use super::{Item, Opened, Plan, Row, RunError, Task};
use crate::phantoms::Truth;
use crate::reference_methods::{BoneValues, ReferenceMethod, ReferenceValues};
use crate::volume::LabelGroup;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const REFERENCE_SCHEMA: &str = "surfometry.reference/1";

/// One object by one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceRecord {
    /// The input as named.
    pub input: String,
    /// Label, or labels that were united.
    pub label: LabelGroup,
    /// The method's name.
    pub method: String,
    /// What it gives.
    #[serde(flatten)]
    pub values: ReferenceValues,
    /// In the volume of the image.
    #[serde(flatten)]
    pub bone: BoneValues,
    /// Exact integrals, for phantoms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth>,
}

impl Row for ReferenceRecord {
    const SCHEMA: &'static str = REFERENCE_SCHEMA;

    fn columns() -> Vec<String> {
        columns(&REFERENCE)
    }
}

/// Measures every selected object of an input by each of some methods.
///
/// ```
/// use surfometry::{Control, reference_methods::VoxelCounting};
/// use surfometry::runs::{Batch, Collected, Plan, ReferenceTask};
/// let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let mut found = Collected::default();
/// batch.run(&ReferenceTask { plan: Plan::default(), methods: vec![&VoxelCounting] }, &mut found)?;
/// assert!(found.results[0].values.volume_mm3.is_some());
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct ReferenceTask<'a> {
    /// What is asked: labels alone count.
    pub plan: Plan,
    /// The methods.
    pub methods: Vec<&'a dyn ReferenceMethod>,
}

impl Task for ReferenceTask<'_> {
    type Row = ReferenceRecord;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<ReferenceRecord>)) -> Result<(), RunError> {
        let grid = *input.source.grid();
        let total_volume = grid.index_box().voxels() as f64 * grid.spacing().cell_volume();
        let truth = input.source.truth();
        for (label, mask) in labelled_masks(input, &self.plan)? {
            for method in &self.methods {
                input.control.check()?;
                let values = method.measure(&mask);
                out(Item::Row(ReferenceRecord {
                    input: input.name.to_owned(),
                    label: label.clone(),
                    method: method.name().to_owned(),
                    values,
                    bone: BoneValues::new(&values, total_volume),
                    truth,
                }));
            }
        }
        Ok(())
    }
}
