//! Everything that a run's numbers depend on beside its inputs.

use super::{ExplainTopology, Plan};
use crate::Measurement;
use crate::volume::{LabelGroup, LabelSelection};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Everything that a run's numbers depend on beside its inputs, as a value that can be written and compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    #[serde(flatten)]
    measurement: Measurement,
    spacing: Option<[f64; 3]>,
    /// How files without a header are read.
    #[serde(default)]
    raw: Option<String>,
    /// `None` where all labels are measured.
    label: Option<Vec<LabelGroup>>,
    per_component: bool,
    explain: bool,
    recover: bool,
}

impl Settings {
    /// Those of a plan.
    pub(super) fn of(plan: &Plan) -> Self {
        Self {
            measurement: plan.measurement,
            spacing: plan.open.spacing,
            raw: plan.open.raw.map(|layout| layout.to_string()),
            label: match &plan.labels {
                LabelSelection::All => None,
                LabelSelection::Groups(groups) => Some(groups.clone()),
            },
            per_component: plan.per_component,
            explain: plan.explain_topology == ExplainTopology::Always,
            recover: plan.recover,
        }
    }

    /// Whether it was asked where topology changes.
    pub fn explain(&self) -> bool {
        self.explain
    }

    /// Whether the blur follows each image's spacing.
    pub fn sigma_is_automatic(&self) -> bool {
        self.measurement.embedding.is_blur() && self.measurement.sigma.is_none()
    }

    /// The first choice in which two differ, in words.
    pub(super) fn difference(&self, other: &Self) -> Option<String> {
        let words = |settings: &Self| serde_json::to_value(settings).unwrap_or_default();
        let (own, others) = (words(self), words(other));
        let differing = own.as_object()?.iter().find(|(name, value)| others.get(name) != Some(value));
        let said = |value: &Value| if value.is_null() { "the default".to_owned() } else { value.to_string() };
        differing.map(|(name, value)| format!("{name}: {} and {}", said(value), said(&others[name])))
    }
}
