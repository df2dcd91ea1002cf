//! The objects of one input, one after the other.

use super::input::{field_input, open_labels};
use super::{ExplainTopology, Failure, InputError, InputOptions, Record, input_title};
use crate::accuracy::Flag;
use crate::measurement::{CurvatureScale, EmbeddingKind, Measured, Measurement, Object};
use crate::phantoms::Truth;
use crate::surface::Surface;
use crate::topology::{ComponentLabels, Connectivity};
use crate::volume::LabelGroup;
use std::cell::OnceCell;

/// One object of an input, ready to be measured, mapped and shown.
pub struct InputObject<'a> {
    /// The input as named.
    pub input: &'a str,
    /// Label, or labels that were united; `None` for a field.
    pub label: Option<LabelGroup>,
    /// Which of the label's pieces, the largest being 1; `None` where all are one object.
    pub component: Option<u64>,
    /// Its place among the input's objects.
    pub number: usize,
    /// How many labels, or unions of labels, the input's objects come from.
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
    options: &'a InputOptions,
    read_seconds: f64,
}

impl InputObject<'_> {
    /// Its name for people: the file's without its folders, and the label where the image holds several.
    pub fn title(&self) -> String {
        let name = input_title(self.input);
        match &self.label {
            Some(label) if self.among_others => format!("{name}, label {label}{}", self.piece_name()),
            _ => name + &self.piece_name(),
        }
    }

    fn piece_name(&self) -> String {
        self.component.map_or_else(String::new, |piece| format!(", component {piece}"))
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
            Some(label) if self.count > 1 || self.component.is_some() => {
                Failure::new(self.input, &format!("label {label}{}: {error}", self.piece_name()))
            }
            _ => Failure::new(self.input, error),
        }
    }

    /// Measures it.
    pub fn record(&self) -> Record {
        let mut measured = self.object.measure();
        explain_topology(&self.object, &mut measured, self.options);
        measured.parameters.curvature_sigma_mm =
            self.local.as_ref().and_then(|local| local.parameters().sigma_mm);
        measured.flags.splice(0..0, self.flags.iter().cloned());
        let (input, label) = (self.input.to_owned(), self.label.clone());
        let (seconds, read_seconds) = (measured.timings.integrals, Some(self.read_seconds));
        let (component, truth) = (self.component, self.truth);
        Record { input, label, component, name: None, measured, truth, read_seconds, seconds }
    }
}

/// Voxels of an object's box up to which a disagreement about its topology is looked into: the whole field is held for it, half a gigabyte.
const MOST_EXPLAINED: usize = 1 << 27;

/// Whether it is looked into where an object's topology changes.
fn to_be_explained(measured: &Measured, options: &InputOptions) -> bool {
    match options.explain_topology {
        // The voxels' topology is that of the whole object, not of the part between the cuts.
        _ if measured.clip.is_some() => false,
        ExplainTopology::Never => false,
        ExplainTopology::Disagreements => {
            measured.topology_disagrees() && measured.voxels.box_voxels() <= MOST_EXPLAINED
        }
        ExplainTopology::Always => true,
    }
}

/// Says where the topology changed, where that is wanted.
fn explain_topology(object: &Object, measured: &mut Measured, options: &InputOptions) {
    let wanted = to_be_explained(measured, options);
    if let Some(explanation) = wanted.then(|| object.explain_topology()).flatten() {
        measured.explain(explanation);
    }
}

/// The same for objects that were measured in a stream, whose input is read again for it.
///
/// # Errors
/// [`InputError`].
pub(super) fn explain_records(
    input: &str,
    measurement: &Measurement,
    options: &InputOptions,
    records: &mut [Record],
) -> Result<(), InputError> {
    if !records.iter().any(|record| to_be_explained(&record.measured, options)) {
        return Ok(());
    }
    let source = open_labels(input, options.spacing)?;
    for Record { label, measured, .. } in records {
        if let Some(label) = label.as_ref().filter(|_| to_be_explained(measured, options)) {
            let mask = source.image.group_mask(label);
            explain_topology(&measurement.prepare(&mask)?, measured, options);
        }
    }
    Ok(())
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
        if options.per_component {
            return Err(InputError::Unfit(
                "a field has no labels whose pieces could be told apart: leave --per-component out with --embedding given",
            ));
        }
        let source = field_input(input, options)?;
        return visit(&InputObject {
            input,
            label: None,
            component: None,
            number: 0,
            count: 1,
            among_others: false,
            object: measurement.prepare_field(&source.field)?,
            local: None,
            surface: OnceCell::new(),
            truth: None,
            flags: &source.flags,
            options,
            read_seconds: source.read_seconds,
        });
    }
    let source = open_labels(input, options.spacing)?;
    let groups = options.labels.resolve(&source.image).map_err(crate::measurement::MeasureError::from)?;
    let count = groups.len();
    let mut number = 0;
    for label in groups {
        let whole = source.image.group_mask(&label);
        let pieces = if options.per_component {
            ComponentLabels::of(&whole, Connectivity::Foreground26).masks(&whole)
        } else {
            vec![whole]
        };
        let truth = source.truth.filter(|_| pieces.len() == 1);
        for (piece, mask) in (1..).zip(pieces) {
            let cut = measurement.cut(&mask)?;
            let local = match options.curvature {
                CurvatureScale::AsMeasured => None,
                scale => Some(measurement.for_local_curvature(&mask, scale)?),
            };
            let local_cut = local.map(|local| local.cut(&mask)).transpose()?.flatten();
            visit(&InputObject {
                input,
                label: Some(label.clone()),
                component: options.per_component.then_some(piece),
                number,
                count,
                among_others: source.image.summaries().len() > 1,
                object: measurement.prepare_cut(&mask, cut.as_ref())?,
                local: local.map(|local| local.prepare_cut(&mask, local_cut.as_ref())).transpose()?,
                surface: OnceCell::new(),
                truth,
                flags: &source.flags,
                options,
                read_seconds: source.read_seconds,
            })?;
            number += 1;
        }
    }
    Ok(())
}
