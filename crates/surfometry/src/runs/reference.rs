//! Objects by the classical methods.

use super::{InputError, InputOptions, LabelInput, Output, open_labels};
use crate::phantoms::Truth;
use crate::reference_methods::{BoneValues, ReferenceMethod, ReferenceValues};
use crate::volume::LabelGroup;
use serde::Serialize;

/// Name and version of the format.
pub const REFERENCE_SCHEMA: &str = "surfometry.reference/1";

/// One object by one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceRecord {
    /// The input as named.
    pub input: String,
    /// Label, or labels that were united.
    pub label: LabelGroup,
    /// The method's name.
    pub method: &'static str,
    /// What it gives.
    #[serde(flatten)]
    pub values: ReferenceValues,
    /// In the volume of the image.
    #[serde(flatten)]
    pub bone: BoneValues,
    /// Exact integrals, for phantoms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth>,
}

impl Output<ReferenceRecord> {
    /// A document of classical methods.
    pub fn of_reference(results: Vec<ReferenceRecord>, failures: Vec<super::Failure>) -> Self {
        Self { schema: REFERENCE_SCHEMA, version: env!("CARGO_PKG_VERSION"), results, failures }
    }
}

/// Measures every selected object of an input by each of some methods.
///
/// # Errors
/// [`InputError`].
pub fn reference_input(
    input: &str,
    methods: &[&dyn ReferenceMethod],
    options: &InputOptions,
) -> Result<Vec<ReferenceRecord>, InputError> {
    let LabelInput { image, truth, .. } = open_labels(input, options.spacing)?;
    let grid = *image.grid();
    let total_volume = grid.index_box().voxels() as f64 * grid.spacing().cell_volume();
    let groups = options.labels.resolve(&image)?;
    let records = groups.into_iter().flat_map(|label| {
        let mask = image.group_mask(&label);
        let record = move |method: &&dyn ReferenceMethod| {
            let values = method.measure(&mask);
            let bone = BoneValues::new(&values, total_volume);
            ReferenceRecord {
                input: input.to_owned(),
                label: label.clone(),
                method: method.name(),
                values,
                bone,
                truth,
            }
        };
        methods.iter().map(record).collect::<Vec<_>>()
    });
    Ok(records.collect())
}
