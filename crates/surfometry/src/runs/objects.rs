//! The objects of one input, one after the other.

use super::input::{field_input, open_labels};
use super::{ExplainTopology, Failure, InputError, InputOptions, Record, input_title};
use crate::accuracy::Flag;
use crate::measurement::{CurvatureScale, EmbeddingKind, Measured, Measurement, Object};
use crate::phantoms::Truth;
use crate::surface::Surface;
use crate::tiling::WorkTime;
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
        if let Some(most) = most_explained(&measured, self.options) {
            explain_topology(&self.object, &mut measured, most);
        }
        measured.read_seconds = Some(self.read_seconds);
        measured.truth = self.truth;
        measured.parameters.curvature_sigma_mm =
            self.local.as_ref().and_then(|local| local.parameters().sigma_mm);
        measured.flags.splice(0..0, self.flags.iter().cloned());
        let (input, label) = (self.input.to_owned(), self.label.clone());
        Record { input, label, component: self.component, name: None, measured }
    }
}

/// Voxels of the band, and others that the blur puts on the other side, up to which a disagreement about an object's topology is looked into
/// without being asked. They have their turn one after the other, so that more threads help little: a second, and 16 bytes a voxel.
const MOST_EXPLAINED: usize = 1 << 22;

/// Up to how many such voxels it is looked into where an object's topology changes; `None` where it is not.
fn most_explained(measured: &Measured, options: &InputOptions) -> Option<usize> {
    // The voxels' topology is that of the whole object, not of the part between the cuts.
    let comparable = measured.parameters.embedding.is_blur() && measured.clip.is_none();
    match options.explain_topology {
        _ if !comparable => None,
        ExplainTopology::Never => None,
        ExplainTopology::Disagreements => measured.topology_disagrees().then_some(MOST_EXPLAINED),
        ExplainTopology::Always => Some(usize::MAX),
    }
}

/// Says where the topology changed, or, of an object that is too large for that, that it was not looked for.
fn explain_topology(object: &Object, measured: &mut Measured, most: usize) {
    let time = WorkTime::default();
    match object.explain_topology_of(most, &time) {
        Some(explanation) => measured.explain(explanation),
        None => measured.leave_unexplained(),
    }
    measured.timings.explain = time.total().as_secs_f64();
}

/// The same for objects that were measured in a stream, whose input is read again for it; how long that took, s.
///
/// # Errors
/// [`InputError`].
pub(super) fn explain_records(
    input: &str,
    measurement: &Measurement,
    options: &InputOptions,
    records: &mut [Record],
) -> Result<f64, InputError> {
    let reading = WorkTime::default();
    let mut source = None;
    for Record { label, measured, .. } in records {
        let Some((most, label)) = most_explained(measured, options).zip(label.as_ref()) else { continue };
        if measured.band_voxels() > most {
            measured.leave_unexplained();
            continue;
        }
        if source.is_none() {
            source = Some(reading.of(|| open_labels(input, options.spacing))?);
        }
        if let Some(source) = &source {
            let mask = reading.of(|| source.image.group_mask(label));
            explain_topology(&measurement.prepare(&mask)?, measured, most);
        }
    }
    Ok(reading.total().as_secs_f64())
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
