//! What the page of a comparison shows.

use super::Provenance;
use crate::comparison::{Comparison, EulerAgreement, MeasureAgreement};
use crate::pictures::{AgreementChart, AgreementPanel, EulerHistogram, Figure};
use serde::Serialize;

/// A comparison with its pictures.
#[derive(Debug, Clone, Serialize)]
pub struct ComparisonPage {
    /// The numbers.
    pub comparison: Comparison,
    /// Regression and Bland-Altman plots as SVG; none where no measure could be compared.
    pub chart: Option<String>,
    /// A histogram of the raw characteristics, for each of the comparison's.
    pub histograms: Vec<String>,
    /// How, from what and by what it was made.
    pub provenance: Provenance,
}

impl ComparisonPage {
    /// Draws the pictures.
    pub fn new(comparison: Comparison, provenance: Provenance) -> Self {
        let chart = comparison_chart(&comparison).map(|figure| figure.svg().to_owned());
        let histograms = comparison.euler.iter().map(|euler| histogram(&comparison, euler)).collect();
        Self { comparison, chart, histograms, provenance }
    }
}

/// Regression and Bland-Altman plots of all measures that could be compared; `None` without any.
pub fn comparison_chart(comparison: &Comparison) -> Option<Figure> {
    let pairs = |measure: &MeasureAgreement| -> Vec<(f64, f64)> {
        measure.values.iter().map(|value| (value.method, value.standard)).collect()
    };
    let objects = |measure: &MeasureAgreement| -> Vec<String> {
        measure.values.iter().map(|value| value.object.to_string()).collect()
    };
    let shown: Vec<_> = comparison
        .measures
        .iter()
        .filter_map(|m| m.agreement.as_ref().map(|a| (m.column.as_str(), pairs(m), objects(m), a)))
        .collect();
    let panels: Vec<AgreementPanel> = shown
        .iter()
        .map(|(name, pairs, objects, agreement)| AgreementPanel { name, pairs, objects, agreement })
        .collect();
    let chart =
        AgreementChart { method: &comparison.method, standard: &comparison.standard, panels: &panels };
    (!panels.is_empty()).then(|| chart.figure())
}

fn histogram(comparison: &Comparison, euler: &EulerAgreement) -> String {
    let values = |value: fn(&crate::comparison::PairedValue) -> f64| euler.values.iter().map(value).collect();
    let (method, standard): (Vec<f64>, Vec<f64>) = (values(|v| v.method), values(|v| v.standard));
    let series = [(comparison.method.as_str(), method), (comparison.standard.as_str(), standard)];
    EulerHistogram { series: &series }.figure().svg().to_owned()
}
