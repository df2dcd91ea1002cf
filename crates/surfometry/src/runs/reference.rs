//! Objects by the classical methods.

use super::columns::{REFERENCE, columns};
use super::object::prepared_flags;
use super::reading::labelled_masks;
use super::{Item, Opened, Plan, Row, RunError, Task};
use crate::accuracy::{Flag, FlagCode, taken_as_perpendicular, thick_slices};
use crate::phantoms::Truth;
use crate::reference_methods::{BoneValues, ReferenceMethod, ReferenceValues, SampleValues, cut_areas};
use crate::volume::{LabelGroup, Mask};
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
    /// The label's name, where the input holds one, or the names of united ones.
    #[serde(default)]
    pub name: Option<String>,
    /// What it gives.
    #[serde(flatten)]
    pub values: ReferenceValues,
    /// The same where the image's cuts are no part of the object.
    #[serde(flatten, default)]
    pub sample: SampleValues,
    /// In the volume of the image.
    #[serde(flatten)]
    pub bone: BoneValues,
    /// What can be doubtful.
    #[serde(default)]
    pub flags: Vec<Flag>,
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
        let methods: Vec<_> =
            self.methods.iter().map(|&method| (method, method.prepared(grid.spacing()))).collect();
        let masks = labelled_masks(input, &self.plan)?;
        let truth = input.source.truth();
        for (name, label, mask) in masks {
            let prepared = input.source.preparations().map(|all| all.of(Some(&label)));
            let of_input = input.source.flags().into_iter().chain(prepared_flags(prepared));
            let of_object: Vec<Flag> = of_input.chain(object_flags(&mask)).collect();
            for (method, measure) in &methods {
                input.control.check()?;
                let values = measure(&mask);
                let sample = SampleValues::new(*method, measure, &mask, &values);
                out(Item::Row(ReferenceRecord {
                    input: input.name.to_owned(),
                    label: label.clone(),
                    method: method.name().to_owned(),
                    name: name.clone(),
                    values,
                    sample,
                    bone: BoneValues::of_sample(&values, &sample, total_volume),
                    flags: of_object.iter().cloned().chain(vanished(&values)).collect(),
                    truth,
                }));
            }
        }
        Ok(())
    }
}

/// What is doubtful by any method.
fn object_flags(mask: &Mask) -> impl Iterator<Item = Flag> {
    let cuts: f64 = cut_areas(mask).as_flattened().iter().sum();
    let cut = (cuts > 0.0).then(|| {
        let message = format!(
            "the edge of the image cuts the object in {cuts:.1} mm2: area, mean curvature, SMI and chi are those of the piece, closed there \
             with a flat cap; of a sample of something larger, the values without cuts and with edge correction are meant"
        );
        Flag::new(FlagCode::TouchesBorder, message)
    });
    cut.into_iter().chain(thick_slices(mask.grid().spacing())).chain(taken_as_perpendicular(mask.grid()))
}

/// Smoothing leaves nothing of objects of a few voxels.
fn vanished(values: &ReferenceValues) -> Option<Flag> {
    let message = "the method's smoothing leaves nothing of the object, so it has no numbers";
    (*values == ReferenceValues::default()).then(|| Flag::new(FlagCode::SurfaceVanished, message))
}
