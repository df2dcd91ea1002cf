//! An input that was read as a whole: one reading serves all that is asked of it.

use super::beside::Beside;
use super::called::{Asked, with_name};
use super::fingerprint::Fingerprint;
use super::object::InputFacts;
use super::object_names::ObjectNames;
use super::{InputObject, LabelScales, Opened, Plan, RunError};
use crate::accuracy::{Flag, FlagCode};
use crate::inputs::{InputError, Source};
use crate::measurement::{Clip, CurvatureScale, EmbeddingKind, Interface, Measured};
use crate::phantoms::Truth;
use crate::tiling::IndexBox;
use crate::topology::{ComponentLabels, Connectivity};
use crate::volume::{
    FieldImage, FieldOfView, LabelGroup, LabelImage, LabelSelection, LabelTable, Mask, ProbabilityImage,
    Segments, Selected, Slab, SlabReader,
};
use crate::{Control, Event, Stopped};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// An input that was read as a whole.
pub struct Reading<'a> {
    plan: &'a Plan,
    control: &'a Control,
    facts: Arc<InputFacts>,
    /// Blur and thickness of objects that have their own, whatever the plan that they are measured by.
    scales: LabelScales,
    content: Content,
}

/// All voxels of an input, as an embedding takes them.
#[derive(Debug)]
pub(super) enum Voxels {
    Labels(Box<LabelImage>),
    Probability(Arc<ProbabilityImage>),
    Field(Arc<FieldImage>),
}

impl Voxels {
    /// Reads an input: labels, or, for the embeddings that are of such, a field or a soft segmentation.
    pub(super) fn of(input: &Opened, embedding: EmbeddingKind) -> Result<Self, RunError> {
        let source = &*input.source;
        let mut slabs = Watched { slabs: source.slabs()?, input: input.name, control: input.control };
        Ok(match embedding {
            EmbeddingKind::Given => Self::Field(field(source, &mut slabs)?),
            EmbeddingKind::Probability => {
                Self::Probability(Arc::new(ProbabilityImage::from_slabs(&mut slabs)?))
            }
            _ => Self::Labels(Box::new(LabelImage::from_slabs(&mut slabs)?)),
        })
    }
}

enum Content {
    Labels(Box<Labelled>),
    Probability { image: Arc<ProbabilityImage>, truth: Option<Truth> },
    Field(Arc<FieldImage>),
}

impl Content {
    /// Where the selected objects lie; `None` without any.
    fn place(&self) -> Option<FieldOfView> {
        let (grid, voxels) = match self {
            Self::Labels(labelled) => {
                let labels = labelled.objects.iter().flat_map(|object| object.values.labels());
                let bounds = labels.filter_map(|label| Some(labelled.image.summary(*label)?.bounds));
                (labelled.image.grid(), bounds.fold(IndexBox::EMPTY, |all, some| all.hull(&some)))
            }
            Self::Probability { image, .. } => (image.grid(), image.grid().index_box()),
            Self::Field(field) => (field.grid(), field.grid().index_box()),
        };
        FieldOfView::new(grid, &voxels).filter(|_| !voxels.is_empty())
    }
}

/// A label image, and what was selected of it.
struct Labelled {
    image: LabelImage,
    /// Whether there are several labels or segments, selected or not.
    many: bool,
    objects: Vec<Selected>,
    names: ObjectNames,
    truth: Option<Truth>,
}

impl<'a> Reading<'a> {
    /// Reads an input: labels, or, for the embeddings that are of such, a field or a soft segmentation.
    ///
    /// # Errors
    /// [`RunError`], also for labels that do not occur.
    pub fn of(input: &Opened<'a>, plan: &'a Plan) -> Result<Self, RunError> {
        let start = Instant::now();
        let source = &*input.source;
        let mut scales = LabelScales::default();
        let content = match Voxels::of(input, plan.measurement.embedding)? {
            Voxels::Field(field) => Content::Field(field),
            Voxels::Probability(image) => Content::Probability { image, truth: source.truth() },
            Voxels::Labels(image) => {
                let (asked, objects, table) = selected(input, plan, &image)?;
                let labels: Vec<LabelGroup> = objects.iter().map(|object| object.label.clone()).collect();
                scales = match input.part {
                    // Of several, others may have what one lacks.
                    Some(_) => {
                        plan.scale_ledger.note(&asked, input.name, &labels);
                        asked.scales
                    }
                    None => asked.check(&labels)?,
                };
                let segments = source.segments();
                if plan.labels == LabelSelection::All {
                    tell_of_empty(input, segments.as_ref(), &table);
                }
                let many =
                    segments.map_or(image.summaries().len(), |segments| segments.present().count()) > 1;
                let (names, truth) = (ObjectNames::new(table, &labels), source.truth());
                Content::Labels(Box::new(Labelled { image: *image, many, objects, names, truth }))
            }
        };
        let many_labels = matches!(&content, Content::Labels(labelled) if labelled.many);
        let mut facts = InputFacts::new(input, plan, many_labels, start.elapsed().as_secs_f64());
        if let Content::Labels(labelled) = &content {
            facts.flags.extend(grey_values(labelled.image.summaries().len(), labelled.image.looks_grey()));
        }
        facts.beside = Beside { interfaces: interfaces(source, plan, &content)?, ..Beside::read(plan)? };
        facts.beside.check_regions(plan, content.place())?;
        let facts = Arc::new(facts);
        Ok(Self { plan, control: input.control, facts, scales, content })
    }

    /// Some objects of an image of which only the part is known in which they are.
    pub(super) fn of_part(
        name: &str,
        plan: &'a Plan,
        control: &'a Control,
        image: LabelImage,
        groups: Vec<LabelGroup>,
    ) -> Self {
        let facts = InputFacts {
            input: name.to_owned(),
            many_labels: image.summaries().len() > 1,
            flags: Vec::new(),
            preparations: None,
            read_seconds: 0.0,
            explain: plan.explain_topology,
            beside: Beside::default(),
            control: control.clone(),
            fingerprint: Arc::new(Fingerprint::none()),
        };
        let objects = groups.into_iter().map(Selected::of_labels).collect();
        let many = facts.many_labels;
        let labelled = Labelled { image, many, objects, names: ObjectNames::default(), truth: None };
        let (facts, content) = (Arc::new(facts), Content::Labels(Box::new(labelled)));
        Self { plan, control, facts, scales: LabelScales::default(), content }
    }

    /// The numbers of an object that was measured while its slices went by, or block by block, now that it is known as a
    /// whole: in the embedding that gives it back, and with what is to be said of its topology.
    pub(super) fn looked_again(&self, number: usize, measured: Measured) -> Result<Measured, RunError> {
        let mut known = measured;
        for object in self.objects_at(number, self.plan) {
            known = settled(InputObject { measured: Some(known), ..object? }, self.plan)?.explained();
        }
        self.control.check()?;
        Ok(known)
    }

    /// The selected objects, one after the other in order of label.
    pub fn objects(&self) -> impl Iterator<Item = Result<InputObject, RunError>> + '_ {
        self.objects_of(self.plan)
    }

    /// The same objects by another plan.
    pub(crate) fn objects_of<'s>(
        &'s self,
        plan: &'s Plan,
    ) -> impl Iterator<Item = Result<InputObject, RunError>> + 's {
        self.each(plan, settled)
    }

    /// The same objects in the embedding that was chosen, which is what a map is of.
    pub(super) fn mapped_objects(&self) -> impl Iterator<Item = Result<InputObject, RunError>> + '_ {
        self.each(self.plan, settled_beside_map)
    }

    fn each<'s>(
        &'s self,
        plan: &'s Plan,
        settled: fn(InputObject, &Plan) -> Result<InputObject, RunError>,
    ) -> impl Iterator<Item = Result<InputObject, RunError>> + 's {
        let count = self.count();
        let tell = move |number: usize| {
            let input = &self.facts.input;
            self.control.tell(&Event::Object { input, number: number + 1, of: count });
            self.control.check().map_err(RunError::from)
        };
        (0..count).flat_map(move |number| {
            if let Err(error) = tell(number) {
                return vec![Err(error)];
            }
            let objects = self.objects_at(number, plan).into_iter();
            objects.map(|object| settled(object?, plan)).collect()
        })
    }

    /// How many labels, or unions of labels, were selected.
    pub fn count(&self) -> usize {
        match &self.content {
            Content::Labels(labelled) => labelled.objects.len(),
            Content::Probability { .. } | Content::Field(_) => 1,
        }
    }

    /// The selected labels, or segments, in their order; none of a field or soft segmentation.
    pub(super) fn labels(&self) -> Vec<LabelGroup> {
        match &self.content {
            Content::Labels(labelled) => labelled.objects.iter().map(|object| object.label.clone()).collect(),
            Content::Probability { .. } | Content::Field(_) => Vec::new(),
        }
    }

    /// What tells the files of an object from those of the others.
    #[cfg(feature = "pictures")]
    pub(super) fn file_part(&self, label: &LabelGroup) -> Option<String> {
        match &self.content {
            Content::Labels(labelled) => labelled.names.file_part(label),
            Content::Probability { .. } | Content::Field(_) => None,
        }
    }

    /// One of them, or its pieces.
    pub(super) fn objects_at(&self, number: usize, plan: &Plan) -> Vec<Result<InputObject, RunError>> {
        match &self.content {
            Content::Field(field) => vec![self.of_field(field, plan)],
            Content::Probability { image, truth } => {
                let object = self.of_probability(image, plan);
                vec![object.map(|object| InputObject { truth: *truth, ..object })]
            }
            Content::Labels(labelled) => {
                let Labelled { image, objects, names, truth, .. } = &**labelled;
                let Selected { label, values } = &objects[number];
                let whole = image.group_mask(values);
                let pieces = if plan.per_component {
                    ComponentLabels::of(&whole, Connectivity::Foreground26).masks(&whole)
                } else {
                    vec![whole]
                };
                let truth = truth.filter(|_| pieces.len() == 1);
                let object = |(piece, mask): (u64, Mask)| {
                    let component = plan.per_component.then_some(piece);
                    self.of_mask(mask, label, plan).map(|object| InputObject {
                        label: Some(label.clone()),
                        name: names.of(label),
                        colour: names.colour_of(label),
                        file_part: names.file_part(label),
                        component,
                        truth,
                        ..object
                    })
                };
                (1..).zip(pieces).map(object).collect()
            }
        }
    }

    fn of_mask(&self, mask: Mask, label: &LabelGroup, plan: &Plan) -> Result<InputObject, RunError> {
        let (mask, measurement) = (Arc::new(mask), self.scales.of(label, plan.measurement));
        let local = match plan.curvature {
            CurvatureScale::AsMeasured => None,
            scale => Some(measurement.for_local_curvature(&mask, scale)?.prepare(&mask)?.under(self.control)),
        };
        let object = measurement.prepare(mask)?;
        let recovering = measurement.recovering();
        let of_vertices = matches!(plan.curvature, CurvatureScale::Auto | CurvatureScale::Local)
            && measurement.clip != Clip::Exclude;
        let one_scale = local.as_ref().filter(|local| of_vertices && !local.has_scales_of_vertices());
        let one_scale_mm = one_scale.and_then(|local| local.parameters().sigma_mm);
        Ok(InputObject { local, one_scale_mm, recovering, ..self.bare(object) })
    }

    fn of_probability(&self, image: &Arc<ProbabilityImage>, plan: &Plan) -> Result<InputObject, RunError> {
        let local = match plan.curvature {
            CurvatureScale::AsMeasured => None,
            scale => {
                let local = plan.measurement.for_local_curvature_of_probability(image, scale)?;
                Some(local.prepare_probability(image)?.under(self.control))
            }
        };
        Ok(InputObject { local, ..self.bare(plan.measurement.prepare_probability(image)?) })
    }

    fn of_field(&self, field: &Arc<FieldImage>, plan: &Plan) -> Result<InputObject, RunError> {
        Ok(self.bare(plan.measurement.prepare_field(field)?))
    }

    fn bare(&self, object: crate::measurement::Object) -> InputObject {
        InputObject {
            facts: Arc::clone(&self.facts),
            label: None,
            name: None,
            colour: None,
            file_part: None,
            component: None,
            count: self.count(),
            object: object.under(self.control),
            local: None,
            numbered: None,
            recovering: None,
            one_scale_mm: None,
            surface: OnceLock::new(),
            measured: None,
            truth: None,
            flags_beside: Vec::new(),
        }
    }
}

/// An object in the embedding in which a plan measures and shows it.
fn settled(object: InputObject, plan: &Plan) -> Result<InputObject, RunError> {
    if plan.recover { object.settled() } else { Ok(object) }
}

/// An object in the embedding that was chosen, with the numbers by which a plan knows it.
fn settled_beside_map(object: InputObject, plan: &Plan) -> Result<InputObject, RunError> {
    if plan.recover { object.settled_beside_map() } else { Ok(object) }
}

/// The interfaces of what was selected, with the names of their labels; `None` where they are not asked for.
fn interfaces(
    source: &dyn Source,
    plan: &Plan,
    content: &Content,
) -> Result<Option<Vec<Interface>>, RunError> {
    let Content::Labels(labelled) = content else { return Ok(None) };
    if !plan.interfaces {
        return Ok(None);
    }
    if source.segments().is_some() {
        return Err(RunError::Unfit(
            "segments may overlap, and have no interfaces then: write them as one label image, or leave the interfaces out",
        ));
    }
    let objects: Vec<LabelGroup> = labelled.objects.iter().map(|object| object.label.clone()).collect();
    let table = source.label_table();
    let mut found = plan.measurement.interfaces(&labelled.image, &objects)?;
    for interface in &mut found {
        interface.names = interface.labels.each_ref().map(|label| table.name_of(label));
    }
    Ok(Some(found))
}

fn field(
    source: &dyn Source,
    slabs: &mut impl SlabReader<Error = InputError>,
) -> Result<Arc<FieldImage>, RunError> {
    if source.is_object() {
        return Err(RunError::Unfit(
            "these voxels are an object; a given embedding wants a file that holds a field",
        ));
    }
    Ok(Arc::new(FieldImage::from_slabs(slabs)?))
}

/// The warning of an image whose labels are none.
pub(super) fn grey_values(labels: usize, looks_grey: bool) -> Option<Flag> {
    let message = format!(
        "the image has {labels} values, which lie all over it: grey values rather than labels, as where an object keeps them and all else is 0; say \
         with a threshold which are the object, and fill the cavities that values of 0 leave in it"
    );
    looks_grey.then(|| Flag::new(FlagCode::GreyValues, message))
}

/// Says which segments have no voxels, for they have no results either.
fn tell_of_empty(input: &Opened, segments: Option<&Segments>, table: &LabelTable) {
    let name = |segment| table.name_of(&LabelGroup::single(segment)).unwrap_or_else(|| segment.to_string());
    let empty: Vec<String> = segments.into_iter().flat_map(Segments::empty).map(name).collect();
    if !empty.is_empty() {
        let text = format!("without voxels, and so without results: {}", empty.join(", "));
        input.control.tell(&Event::Note { input: input.name, text: &text });
    }
}

/// What a plan asks of an image that was read to its end, and the objects that this selects.
fn selected(
    input: &Opened,
    plan: &Plan,
    image: &LabelImage,
) -> Result<(Asked, Vec<Selected>, LabelTable), RunError> {
    let table = input.source.label_table();
    let mut asked = Asked::of(plan, &table)?;
    input.lacks(asked.missing.drain(..))?;
    let (objects, missing) = Selected::found(&asked.labels, image, input.source.segments().as_ref())
        .map_err(|error| with_name(error, &table))?;
    input.lacks(missing.into_iter().map(|error| with_name(error, &table)))?;
    Ok((asked, objects, table))
}

/// The voxels of each selected object of an input that is read as a whole, one after the other, with its name and label.
pub(super) fn labelled_masks(
    input: &Opened,
    plan: &Plan,
) -> Result<impl Iterator<Item = (Option<String>, LabelGroup, Mask)>, RunError> {
    let mut slabs = Watched { slabs: input.source.slabs()?, input: input.name, control: input.control };
    let image = LabelImage::from_slabs(&mut slabs)?;
    let (_, objects, table) = selected(input, plan, &image)?;
    Ok(objects.into_iter().map(move |Selected { label, values }| {
        let mask = image.group_mask(&values);
        (table.name_of(&label), label, mask)
    }))
}

/// Slabs of an input: whoever listens hears of each, and may stop the run after it.
pub(super) struct Watched<'a, R> {
    pub(super) slabs: R,
    pub(super) input: &'a str,
    pub(super) control: &'a Control,
}

impl<R: SlabReader<Error = InputError>> SlabReader for Watched<'_, R> {
    type Error = InputError;

    fn grid(&self) -> &crate::volume::Grid {
        self.slabs.grid()
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, InputError> {
        self.control.check().map_err(|Stopped| InputError::Stopped(Stopped))?;
        let slab = self.slabs.next_slab()?;
        if let Some(slab) = &slab {
            let (done, of) = (slab.slices.end, self.slabs.grid().dimensions()[2]);
            self.control.tell(&Event::Slices { input: self.input, done, of, labels: 0 });
        }
        Ok(slab)
    }

    fn file_time(&self) -> Duration {
        self.slabs.file_time()
    }
}
