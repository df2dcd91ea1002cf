//! The objects of one input, one after the other.

use super::input::{field_input, open_labels};
use super::{Failure, InputError, InputOptions, Record, input_title};
use crate::accuracy::Flag;
use crate::measurement::{CurvatureScale, EmbeddingKind, Measurement, Object};
use crate::phantoms::Truth;
use crate::surface::Surface;
use crate::volume::LabelGroup;
use std::cell::OnceCell;

/// One object of an input, ready to be measured, mapped and shown.
pub struct InputObject<'a> {
    /// The input as named.
    pub input: &'a str,
    /// Label, or labels that were united; `None` for a field.
    pub label: Option<LabelGroup>,
    /// Its place among the input's objects.
    pub number: usize,
    /// How many objects the input has.
    pub count: usize,
    /// The object.
    pub object: Object<'a>,
    /// The same in the embedding that its surface is mapped in, where that is another one ([`InputOptions::curvature`]).
    local: Option<Object<'a>>,
    /// Whether the image holds other labels, so that a name needs this one.
    among_others: bool,
    surface: OnceCell<Surface>,
    truth: Option<Truth>,
    flags: &'a [Flag],
    read_seconds: f64,
}

impl InputObject<'_> {
    /// Its name for people: the file's without its folders, and the label where the image holds several.
    pub fn title(&self) -> String {
        let name = input_title(self.input);
        match &self.label {
            Some(label) if self.among_others => format!("{name}, label {label}"),
            _ => name,
        }
    }

    /// The object in the embedding in which its local curvature is measured.
    pub fn local(&self) -> &Object<'_> {
        self.local.as_ref().unwrap_or(&self.object)
    }

    /// Its surface, extracted when it is first asked for.
    pub fn surface(&self) -> &Surface {
        self.surface.get_or_init(|| self.local().surface())
    }

    /// What is said where something of it could not be had: with its label, where there are several.
    pub fn failure(&self, error: &impl std::fmt::Display) -> Failure {
        match &self.label {
            Some(label) if self.count > 1 => Failure::new(self.input, &format!("label {label}: {error}")),
            _ => Failure::new(self.input, error),
        }
    }

    /// Measures it.
    pub fn record(&self) -> Record {
        let mut measured = self.object.measure();
        measured.read_seconds = Some(self.read_seconds);
        measured.truth = self.truth;
        measured.parameters.curvature_sigma_mm =
            self.local.as_ref().and_then(|local| local.parameters().sigma_mm);
        measured.flags.splice(0..0, self.flags.iter().cloned());
        Record { input: self.input.to_owned(), label: self.label.clone(), name: None, measured }
    }
}

/// Opens an input and hands its selected objects to `visit`, in order of label.
///
/// # Errors
/// [`InputError`], also that of `visit`, which ends the visit.
pub fn visit_objects(
    input: &str,
    measurement: &Measurement,
    options: &InputOptions,
    mut visit: impl FnMut(&InputObject) -> Result<(), InputError>,
) -> Result<(), InputError> {
    if measurement.embedding == EmbeddingKind::Given {
        if options.curvature != CurvatureScale::AsMeasured {
            return Err(InputError::Unfit(
                "a field has no blur of its own: leave --curvature-sigma out with --embedding given",
            ));
        }
        let source = field_input(input, options)?;
        return visit(&InputObject {
            input,
            label: None,
            number: 0,
            count: 1,
            among_others: false,
            object: measurement.prepare_field(&source.field)?,
            local: None,
            surface: OnceCell::new(),
            truth: None,
            flags: &source.flags,
            read_seconds: source.read_seconds,
        });
    }
    let source = open_labels(input, options.spacing)?;
    let groups = options.labels.resolve(&source.image).map_err(crate::measurement::MeasureError::from)?;
    let count = groups.len();
    for (number, label) in groups.into_iter().enumerate() {
        let mask = source.image.group_mask(&label);
        visit(&InputObject {
            input,
            label: Some(label),
            number,
            count,
            among_others: source.image.summaries().len() > 1,
            object: measurement.prepare(&mask)?,
            local: match options.curvature {
                CurvatureScale::AsMeasured => None,
                scale => Some(measurement.for_local_curvature(&mask, scale)?.prepare(&mask)?),
            },
            surface: OnceCell::new(),
            truth: source.truth,
            flags: &source.flags,
            read_seconds: source.read_seconds,
        })?;
    }
    Ok(())
}
