//! Everything that a run's numbers depend on beside its inputs.

use super::{CalledObjects, ExplainTopology, LabelScales, Plan, RegionImage, ScaleLedger};
use crate::Measurement;
use crate::inputs::{OpenOptions, Preparation};
use crate::io::RawLayout;
use crate::measurement::CurvatureScale;
use crate::volume::{LabelGroup, LabelSelection, LabelTable};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Everything that a run's numbers depend on beside its inputs, as a value that can be written and compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of a run")]
pub struct Settings {
    #[serde(flatten)]
    measurement: Measurement,
    spacing: Option<[f64; 3]>,
    #[serde(default)]
    preparation: Preparation,
    /// How files without a header are read.
    #[serde(default)]
    raw: Option<RawLayout>,
    /// `None` where all labels are measured.
    label: Option<Vec<LabelGroup>>,
    /// What is called by names.
    #[serde(default, skip_serializing_if = "CalledObjects::is_empty")]
    called: CalledObjects,
    /// Names that were given for labels.
    #[serde(default, skip_serializing_if = "LabelTable::is_empty")]
    names: LabelTable,
    per_component: bool,
    explain: bool,
    recover: bool,
    /// Lengths of labels that have their own.
    #[serde(default, skip_serializing_if = "LabelScales::is_empty")]
    scales: LabelScales,
    /// The image of regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    regions: Option<String>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    interfaces: bool,
}

impl Settings {
    /// Those of a plan.
    pub fn of(plan: &Plan) -> Self {
        Self {
            measurement: plan.measurement,
            spacing: plan.open.spacing,
            preparation: plan.open.preparation,
            raw: plan.open.raw,
            label: match &plan.labels {
                LabelSelection::All => None,
                LabelSelection::Groups(groups) => Some(groups.clone()),
            },
            called: plan.called.clone(),
            names: plan.open.names.clone(),
            per_component: plan.per_component,
            explain: plan.explain_topology == ExplainTopology::Always,
            recover: plan.recover,
            scales: plan.scales.clone(),
            regions: plan.regions.as_ref().map(|regions| regions.file().to_owned()),
            interfaces: plan.interfaces,
        }
    }

    /// Those that a document states.
    ///
    /// # Errors
    /// What is wrong with them; also a field that this version does not know, which would make other numbers in silence.
    pub(super) fn stated(document: &Value) -> Result<Self, String> {
        let settings: Self = serde_json::from_value(document.clone()).map_err(|error| error.to_string())?;
        let own = serde_json::to_value(&settings).map_err(|error| error.to_string())?;
        match unknown_field(document, &own) {
            Some(name) => Err(format!(
                "`settings.{name}` is no setting of this version, {}; correct its name or take it out",
                env!("CARGO_PKG_VERSION")
            )),
            None => Ok(settings),
        }
    }

    /// What measures so.
    pub fn plan(&self) -> Plan {
        Plan {
            measurement: self.measurement,
            scales: self.scales.clone(),
            scale_ledger: ScaleLedger::default(),
            open: OpenOptions {
                spacing: self.spacing,
                raw: self.raw,
                preparation: self.preparation,
                names: self.names.clone(),
            },
            labels: self.label.clone().map_or(LabelSelection::All, LabelSelection::Groups),
            called: self.called.clone(),
            curvature: CurvatureScale::AsMeasured,
            per_component: self.per_component,
            explain_topology: if self.explain { ExplainTopology::Always } else { ExplainTopology::default() },
            recover: self.recover,
            regions: self.regions.clone().map(RegionImage::of),
            interfaces: self.interfaces,
            samples: Vec::new(),
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
        // What is the default may not be written.
        let mut names = own.as_object()?.keys().chain(others.as_object()?.keys());
        let differing = names.find(|name| own[name.as_str()] != others[name.as_str()]);
        let said = |value: &Value| if value.is_null() { "the default".to_owned() } else { value.to_string() };
        differing.map(|name| format!("{name}: {} and {}", said(&own[name]), said(&others[name])))
    }
}

/// The first field of a document that what was read of it does not have. What is empty says nothing.
fn unknown_field(stated: &Value, known: &Value) -> Option<String> {
    let is_empty = |value: &Value| match value {
        Value::Null => true,
        Value::Object(fields) => fields.values().all(Value::is_null),
        Value::Array(items) => items.is_empty(),
        _ => false,
    };
    stated.as_object()?.iter().find_map(|(name, value)| match known.get(name) {
        Some(own) => unknown_field(value, own).map(|inner| format!("{name}.{inner}")),
        None => (!is_empty(value)).then(|| name.clone()),
    })
}
