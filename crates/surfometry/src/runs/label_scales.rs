//! Blur and thickness of some labels that differ from the others'.

use super::RunError;
use crate::measurement::Measurement;
use crate::text::{SHOWN_LABELS, listed};
use crate::volume::LabelGroup;
use serde::{Deserialize, Serialize};

/// Lengths in mm of some objects in the place of those that all have; `None` stands for the automatic one. The
/// paper has one standard deviation for each tissue class.
///
/// ```
/// use surfometry::runs::{LabelScales, Plan, records_of};
/// use surfometry::volume::LabelGroup;
/// let sigma_mm = vec![(LabelGroup::single(1), Some(1.5))];
/// let plan = Plan { scales: LabelScales { sigma_mm, ..LabelScales::default() }, ..Plan::default() };
/// let records = records_of("phantom:ball?radius=8", &plan)?;
/// assert_eq!(records[0].measured.parameters.sigma_mm, Some(1.5));
/// # Ok::<(), surfometry::runs::RunError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LabelScales {
    /// Blurs.
    pub sigma_mm: Vec<(LabelGroup, Option<f64>)>,
    /// Thicknesses of the band.
    pub thickness_mm: Vec<(LabelGroup, Option<f64>)>,
}

impl LabelScales {
    /// Whether all objects have the same.
    pub fn is_empty(&self) -> bool {
        self.sigma_mm.is_empty() && self.thickness_mm.is_empty()
    }

    /// The objects that have their own.
    pub fn labels(&self) -> impl Iterator<Item = &LabelGroup> {
        self.sigma_mm.iter().chain(&self.thickness_mm).map(|(label, _)| label)
    }

    /// How an object is measured, where all others are by `measurement`.
    #[must_use]
    pub fn of(&self, label: &LabelGroup, measurement: Measurement) -> Measurement {
        let own = |lengths: &[(LabelGroup, Option<f64>)]| {
            lengths.iter().find(|(of, _)| of.is_same(label)).map(|&(_, length)| length)
        };
        let sigma = own(&self.sigma_mm).map_or(measurement, |sigma| measurement.sigma_mm(sigma));
        own(&self.thickness_mm).map_or(sigma, |thickness| sigma.thickness_mm(thickness))
    }

    /// Refuses lengths of what is not among the objects.
    ///
    /// # Errors
    /// [`RunError::UnusedScale`].
    pub fn check(&self, objects: &[LabelGroup]) -> Result<(), RunError> {
        match self.labels().find(|&label| !label.is_among(objects)) {
            Some(label) => Err(RunError::UnusedScale {
                label: label.clone(),
                objects: listed(objects.iter(), SHOWN_LABELS),
                cure: cure(label, objects),
            }),
            None => Ok(()),
        }
    }
}

/// What may have been meant.
fn cure(label: &LabelGroup, objects: &[LabelGroup]) -> String {
    let holds = |object: &&LabelGroup| object.labels().iter().any(|part| label.labels().contains(part));
    match objects.iter().find(holds) {
        Some(object) => format!("write {object}=MM"),
        None => "name one of these, as LABEL=MM, or leave that length out".to_owned(),
    }
}
