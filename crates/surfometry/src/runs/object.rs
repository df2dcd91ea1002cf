//! One object of an input, ready for whatever is asked of it.

use super::beside::{Beside, without_region};
use super::fingerprint::Fingerprint;
use super::{ExplainTopology, Failure, Plan, Record, RunError};
use crate::accuracy::{Flag, FlagCode};
use crate::inputs::{Preparations, PreparedObject, input_title};
use crate::measurement::{Looked, Measured, Object, RegionMembership, Regions, again};
use crate::phantoms::Truth;
use crate::surface::Surface;
use crate::tiling::WorkTime;
use crate::volume::LabelGroup;
use crate::{Control, Measurement};
use std::sync::{Arc, OnceLock};

/// What all objects of an input share.
#[derive(Debug)]
pub(super) struct InputFacts {
    /// The input as named.
    pub(super) input: String,
    /// Whether it holds several labels, so that an object's name needs its own.
    pub(super) many_labels: bool,
    pub(super) flags: Vec<Flag>,
    /// What was done to its voxels.
    pub(super) preparations: Option<Arc<Preparations>>,
    pub(super) read_seconds: f64,
    pub(super) explain: ExplainTopology,
    pub(super) beside: Beside,
    pub(super) control: Control,
    pub(super) fingerprint: Arc<Fingerprint>,
}

/// One object of an input, ready to be measured, mapped and shown. It owns what it needs.
pub struct InputObject {
    pub(super) facts: Arc<InputFacts>,
    /// Label, or labels that were united; `None` for a field.
    pub label: Option<LabelGroup>,
    /// The label's name, where the input holds one, or the names of united ones.
    pub name: Option<String>,
    /// Its colour in sRGB, where the input holds one.
    pub colour: Option<[u8; 3]>,
    /// What tells its files from those of the input's other objects; `None` where it is the only one.
    #[cfg_attr(not(feature = "pictures"), allow(dead_code))]
    pub(super) file_part: Option<String>,
    /// Which of the label's pieces, the largest being 1; `None` where all are one object.
    pub component: Option<u64>,
    /// How many labels, or unions of labels, the input's objects come from.
    pub count: usize,
    /// The object.
    pub object: Object,
    /// The same in the embedding that its surface is mapped in, where that is another one.
    pub(super) local: Option<Object>,
    /// The sigma of all of its surface, mm, where each vertex was to have one of its own and the mask may be noisy.
    pub(super) one_scale_mm: Option<f64>,
    /// The same in the embedding that its numbers are of, where that is another one than its volume is shown in.
    pub(super) numbered: Option<Object>,
    /// How it is measured again where that is doubtful; `None` where the blur is the caller's own choice.
    pub(super) recovering: Option<Measurement>,
    pub(super) surface: OnceLock<Surface>,
    /// Its numbers, where they had to be known to choose the embedding.
    pub(super) measured: Option<Measured>,
    pub(super) truth: Option<Truth>,
    /// Warnings of what was found in images beside the input.
    pub(super) flags_beside: Vec<Flag>,
}

impl InputObject {
    /// The input as named.
    pub fn input(&self) -> &str {
        &self.facts.input
    }

    /// Its name for people: the file's without its folders, and the label where the image holds several.
    pub fn title(&self) -> String {
        let name = input_title(self.input());
        match &self.label {
            Some(label) if self.facts.many_labels => {
                format!("{name}, label {label}{}{}", self.bracketed_name(), self.piece_name())
            }
            _ => name + &self.bracketed_name() + &self.piece_name(),
        }
    }

    fn bracketed_name(&self) -> String {
        self.name.as_ref().map_or_else(String::new, |name| format!(" ({name})"))
    }

    fn piece_name(&self) -> String {
        self.component.map_or_else(String::new, |piece| format!(", component {piece}"))
    }

    /// The object in the embedding in which its local curvature is measured.
    pub fn local(&self) -> &Object {
        self.local.as_ref().unwrap_or(&self.object)
    }

    /// Its surface, extracted when it is first asked for.
    pub fn surface(&self) -> &Surface {
        self.surface.get_or_init(|| {
            let mut surface = self.local().surface();
            let samples = &self.facts.beside.samples;
            surface.samples = samples.iter().map(|volume| volume.on(&surface.mesh)).collect();
            surface
        })
    }

    /// Of each volume that was to be put on its surface and has no value there, why.
    pub(super) fn without_values(&self, plan: &Plan) -> Vec<RunError> {
        self.facts.beside.without_values(plan, self)
    }

    /// The regions that it is split by, where there are any.
    pub(super) fn regions(&self) -> Option<&Regions> {
        self.facts.beside.regions.as_deref()
    }

    /// Where its surface and voxels belong.
    pub(super) fn membership<'a>(&'a self, regions: &'a Regions) -> RegionMembership<'a> {
        self.object.membership(regions)
    }

    /// The same, to keep more at its vertices.
    pub(super) fn surface_mut(&mut self) -> Option<&mut Surface> {
        self.surface();
        self.surface.get_mut()
    }

    pub(super) fn control(&self) -> &Control {
        &self.facts.control
    }

    /// Its surface, of which nothing else is wanted any more.
    pub fn into_surface(mut self) -> Surface {
        self.surface();
        self.surface.take().unwrap_or_default()
    }

    /// What is said where something of it could not be had: with its label, where there are several.
    pub fn failure(&self, error: &impl std::fmt::Display) -> Failure {
        match &self.label {
            Some(label) if self.count > 1 || self.component.is_some() => Failure::new(
                self.input(),
                &format!("label {label}{}{}: {error}", self.bracketed_name(), self.piece_name()),
            ),
            _ => Failure::new(self.input(), error),
        }
    }

    /// The same in the embedding in which it is to be measured and shown: the one that gives it back where the blur loses
    /// detail.
    pub(super) fn settled(mut self) -> Result<Self, RunError> {
        if let Some(recovered) = self.recovered()? {
            self.object = recovered;
        }
        Ok(self)
    }

    /// The same with the numbers of the embedding in which it is to be measured, and shown as it was: the surface of one
    /// that is mapped at scales of its own is not that of the blur, and so are its numbers and warnings.
    pub(super) fn settled_beside_map(mut self) -> Result<Self, RunError> {
        if self.local.is_some() {
            self.numbered = self.recovered()?;
        }
        Ok(self)
    }

    /// Measures it, and again where that is doubtful; the object by which it is known then, where that is another one.
    fn recovered(&mut self) -> Result<Option<Object>, RunError> {
        let Some(choices) = self.recovering else { return Ok(None) };
        let measured = self.measured.take().unwrap_or_else(|| self.object.measure());
        let found = again(&choices, &self.object, &measured)?;
        self.facts.control.check()?;
        let (object, recovered) = found.unzip();
        self.measured = Some(recovered.unwrap_or(measured));
        Ok(object)
    }

    /// The object that its numbers are of.
    fn numbered(&self) -> &Object {
        self.numbered.as_ref().unwrap_or(&self.object)
    }

    /// Its numbers, and where its topology changes, as far as that is asked.
    pub(super) fn explained(&self) -> Measured {
        let mut measured = self.measured.clone().unwrap_or_else(|| self.object.measure());
        if let Some(looked) = what_is_explained(&mut measured, self.facts.explain) {
            explain_topology(self.numbered(), &mut measured, looked);
        }
        measured
    }

    /// Its numbers without explanations, which are kept.
    pub(super) fn measured(&mut self) -> &Measured {
        self.measured.get_or_insert_with(|| self.object.measure())
    }

    /// What was done to its voxels before.
    fn preparation(&self) -> Option<PreparedObject> {
        self.facts.preparations.as_ref().map(|all| all.of(self.label.as_ref()))
    }

    /// Warnings that come with its input, and with what was done to its voxels.
    pub(super) fn input_flags(&self) -> impl Iterator<Item = Flag> {
        self.facts.flags.iter().cloned().chain(prepared_flags(self.preparation()))
    }

    /// That its surface has one scale, with what is said of noise already.
    fn tell_of_one_scale(&self, flags: &mut Vec<Flag>) {
        let Some(sigma) = self.one_scale_mm else { return };
        let told = format!(
            "the surface is mapped at one scale, sigma {sigma:.3} mm, not at one that suits each place"
        );
        match flags.iter_mut().find(|flag| flag.code == FlagCode::NoisyMask) {
            Some(flag) => flag.message = format!("{}; {told}", flag.message),
            None => flags.push(Flag::new(FlagCode::NoisyMask, format!("the mask may be noisy: {told}"))),
        }
    }

    /// Measures it.
    pub fn record(&self) -> Record {
        let mut measured = self.explained();
        let beside = &self.facts.beside;
        let regions = beside.regions.as_ref().map(|regions| self.numbered().regions(&measured, regions));
        measured.flags.splice(0..0, self.input_flags());
        self.tell_of_one_scale(&mut measured.flags);
        measured.flags.extend(self.flags_beside.iter().cloned());
        measured.flags.extend(regions.as_deref().and_then(without_region));
        Record {
            input: self.facts.input.clone(),
            label: self.label.clone(),
            name: self.name.clone(),
            component: self.component,
            truth: self.truth,
            preparation: self.preparation(),
            regions,
            interfaces: self.label.as_ref().and_then(|label| beside.interfaces_of(label)),
            curvature_sigma_mm: self.local.as_ref().and_then(|local| local.parameters().sigma_mm),
            input_sha256: self.facts.fingerprint.text(),
            read_seconds: Some(self.facts.read_seconds),
            seconds: measured.timings.integrals,
            measured,
        }
    }
}

/// Warnings that come with what was done to an object's voxels.
pub(super) fn prepared_flags(preparation: Option<PreparedObject>) -> impl Iterator<Item = Flag> {
    preparation.into_iter().flat_map(|prepared| prepared.flags())
}

/// Voxels that the blur puts on the other side up to which they are looked at without being asked: a share of
/// the band's, so that it takes no longer than measuring them did; a few in any case, and 16 bytes each at
/// most.
fn most_explained(measured: &Measured) -> usize {
    let area = measured.blurred.surface_area_mm2.unwrap_or_default();
    let band = area * measured.parameters.thickness_mm / measured.grid.spacing_mm.iter().product::<f64>();
    ((band / 8.0) as usize).clamp(1 << 14, 1 << 22)
}

/// Whether there are places at which an object's topology changes: the voxels' topology is that of the whole object, not
/// of the part between the cuts.
fn can_be_explained(measured: &Measured) -> bool {
    measured.clip.is_none() && measured.parameters.embedding.is_blur()
}

/// What is looked at where an object's topology changes. `None` where nothing is.
pub(super) fn looked_at(measured: &Measured, when: ExplainTopology) -> Option<Looked> {
    match when {
        _ if !can_be_explained(measured) => None,
        ExplainTopology::Disagreements if measured.blur_changed_topology() => Some(Looked::Blur),
        ExplainTopology::Never | ExplainTopology::Disagreements => None,
        ExplainTopology::Always => Some(Looked::BlurAndBand),
    }
}

/// The same; where something is left that could be, the flags say so.
pub(super) fn what_is_explained(measured: &mut Measured, when: ExplainTopology) -> Option<Looked> {
    let looked = looked_at(measured, when);
    if looked.is_none() && can_be_explained(measured) && when == ExplainTopology::Disagreements {
        measured.leave_unexplained();
    }
    looked
}

/// Says where the topology changed, or, where too many voxels would have to be looked at, that it was not
/// looked into.
pub(super) fn explain_topology(object: &Object, measured: &mut Measured, looked: Looked) {
    let most = if looked == Looked::Blur { most_explained(measured) } else { usize::MAX };
    let time = WorkTime::default();
    match object.explain_topology_of(looked, most, &time) {
        Some(explanation) => measured.explain(explanation),
        None => measured.leave_unexplained(),
    }
    measured.timings.explain = time.total().as_secs_f64();
}

impl InputFacts {
    pub(super) fn new(input: &super::Opened, plan: &Plan, many_labels: bool, read_seconds: f64) -> Self {
        Self {
            input: input.name.to_owned(),
            many_labels,
            fingerprint: Arc::clone(&input.fingerprint),
            flags: input.source.flags(),
            preparations: input.source.preparations(),
            read_seconds,
            explain: plan.explain_topology,
            beside: Beside::default(),
            control: input.control.clone(),
        }
    }
}
