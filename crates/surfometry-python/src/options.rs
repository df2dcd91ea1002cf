//! Options by their names, in the words of the command line.

use crate::errors::{of_run, raise, warn};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::str::FromStr;
use surfometry::Choice;
use surfometry::io::{label_names_of_text, read_label_names_warning};
use surfometry::measurement::CurvatureScale;
use surfometry::runs::words::{curvature_scale, fraction, padding, positive, spacing};
use surfometry::runs::{Choices, ExplainTopology, Plan};
use surfometry::volume::LabelTable;

/// Names and words.
pub(crate) type Options = BTreeMap<String, String>;

/// The choices that options stand for.
pub(crate) fn choices(py: Python, options: &Options) -> PyResult<Choices> {
    let mut choices = Choices::default();
    for (name, text) in options {
        let word = |error: &dyn Display| wrong(py, name, text, error);
        match name.as_str() {
            "label" => choices.labels = text.parse().map_err(|e| word(&e))?,
            "names" => {
                let (names, warning) = label_names(text).map_err(|e| word(&e))?;
                choices.names = names;
                warning.map_or(Ok(()), |message| warn(py, &message))?;
            }
            "spacing" => choices.spacing = Some(spacing(text).map_err(|e| word(&e))?),
            "sigma" => choices.sigma = text.parse().map_err(|e| word(&e))?,
            "thickness" => choices.thickness = text.parse().map_err(|e| word(&e))?,
            "epsilon" => choices.epsilon = Some(positive(text).map_err(|e| word(&e))?),
            "level" => choices.level = Some(fraction(text).map_err(|e| word(&e))?),
            "embedding" => choices.embedding = Some(chosen(py, name, text)?),
            "derivatives" => choices.derivatives = Some(chosen(py, name, text)?),
            "quadrature" => choices.quadrature = Some(chosen(py, name, text)?),
            "delta" => choices.delta = Some(chosen(py, name, text)?),
            "clip" => choices.clip = chosen(py, name, text)?,
            "padding" => choices.padding = Some(padding(text).map_err(|e| word(&e))?),
            "paper" => choices.paper = bool::from_str(text).map_err(|e| word(&e))?,
            "threshold" => choices.preparation.threshold = Some(text.parse().map_err(|e| word(&e))?),
            "fill_cavities" => {
                choices.preparation.fill_cavities = bool::from_str(text).map_err(|e| word(&e))?;
            }
            "largest_component" => {
                choices.preparation.largest_component = bool::from_str(text).map_err(|e| word(&e))?;
            }
            "regions" => choices.regions = Some(text.clone()),
            "interfaces" => choices.interfaces = bool::from_str(text).map_err(|e| word(&e))?,
            "sample" => {
                choices.samples =
                    text.lines().map(str::parse).collect::<Result<_, _>>().map_err(|e| word(&e))?;
            }
            "explain" | "per_component" => {}
            _ => return Err(word(&"there is no such option")),
        }
    }
    Ok(choices)
}

/// Names of labels: a mapping, as JSON, or the name of a file; and what is to be said of it.
fn label_names(text: &str) -> Result<(LabelTable, Option<String>), String> {
    if text.starts_with('{') {
        return Ok((label_names_of_text(text)?, None));
    }
    let mut warning = None;
    let table = read_label_names_warning(text, |message| warning = Some(message.to_owned()));
    Ok((table.map_err(|error| error.to_string())?, warning))
}

/// The plan that options stand for.
pub(crate) fn plan(py: Python, options: &Options, curvature: CurvatureScale) -> PyResult<Plan> {
    let is_on = |name: &str| options.get(name).is_some_and(|word| word == "true");
    let checked = choices(py, options)?.plan(curvature).and_then(|plan| {
        let explain_topology = if is_on("explain") { ExplainTopology::Always } else { plan.explain_topology };
        let plan = Plan { explain_topology, per_component: is_on("per_component"), ..plan };
        plan.check()?;
        Ok(plan)
    });
    checked.map_err(|error| of_run(py, None, &error))
}

/// One of the library's named values.
pub(crate) fn chosen<T: Choice>(py: Python, name: &str, text: &str) -> PyResult<T> {
    T::of_word(text).map_err(|error| wrong(py, name, text, &error))
}

/// The scale at which surfaces are mapped; that of the measurement where nothing is said.
pub(crate) fn curvature(py: Python, text: Option<&str>) -> PyResult<CurvatureScale> {
    text.map_or(Ok(CurvatureScale::AsMeasured), |text| {
        curvature_scale(text).map_err(|error| wrong(py, "curvature_sigma", text, &error))
    })
}

/// An option that says nothing that makes sense.
pub(crate) fn wrong(py: Python, name: &str, text: &str, error: &dyn Display) -> PyErr {
    raise(py, "ParameterError", &format!("{name}={text}: {error}"), &[("field", Some(name))])
}
