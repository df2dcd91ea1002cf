//! A later image of the same objects, with whose surfaces those of a run are compared.

use super::beside::{TOLD_SHARE, beside, flag_beside};
use super::called::with_name;
use super::fingerprint::Fingerprint;
use super::reading::{Voxels, grey_values};
use super::{BesideRole, InputObject, Opened, Plan, RunError};
use crate::Control;
use crate::accuracy::{Flag, FlagCode};
use crate::inputs::open;
use crate::measurement::Object;
use crate::surface::{Placed, Surface, SurfaceChange};
use crate::text::{SHOWN_LABELS, listed};
use crate::volume::{
    LabelGroup, LabelImage, LabelSelection, LabelTable, Mask, Segments, Selected, VolumeError,
};
use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

/// What of a later object's own flags bears on distances to its surface.
const DOUBTS: [FlagCode; 9] = [
    FlagCode::TouchesBorder,
    FlagCode::SurfaceLeavesField,
    FlagCode::NothingBetweenCuts,
    FlagCode::CompensationFailed,
    FlagCode::SurfaceVanished,
    FlagCode::EmptyBand,
    FlagCode::ThinForSigma,
    FlagCode::NarrowGap,
    FlagCode::DetailLost,
];
const NO_ORIGINAL: RunError = RunError::Unfit(
    "an object too thin for this sigma (flag compensation-failed) has no surface of before the blur, and no distance from it or to it; \
     choose a smaller sigma, or a scale for curvature",
);

/// A later image of the same objects in the same world, as of a scan that was registered: read once.
///
/// ```
/// use std::sync::Arc;
/// use surfometry::{Control, runs::{Against, Batch, Collected, Plan, SurfaceTask}};
/// let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
/// let plan = Plan { recover: false, ..Plan::default() };
/// let later = Against::open("phantom:ball?radius=7&shift=0.3,0,0", &plan, &control)?;
/// let task = SurfaceTask { plan, against: Some(Arc::new(later)) };
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let mut found = Collected::default();
/// batch.run(&task, &mut found)?;
/// let change = found.results[0].record.against.as_ref().expect("both have label 1").change;
/// assert!((change.distance_mm.mean - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Against {
    name: String,
    voxels: Voxels,
    segments: Option<Segments>,
    table: LabelTable,
    /// Of the image, whatever its objects.
    flags: Vec<Flag>,
    fingerprint: Arc<Fingerprint>,
    /// Labels that were compared.
    compared: Mutex<BTreeSet<i64>>,
}

/// How an object's surface has changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AgainstRecord {
    /// The later input as named.
    pub input: String,
    /// SHA-256 of it, as of an input.
    pub input_sha256: Option<String>,
    /// From the first surface to the later one.
    #[serde(flatten)]
    pub change: SurfaceChange,
}

impl Against {
    /// Reads an input by its name.
    ///
    /// # Errors
    /// [`RunError::Beside`].
    pub fn open(name: &str, plan: &Plan, control: &Control) -> Result<Self, RunError> {
        let source = open(name, &plan.open).map_err(|error| told_of(name, error.into()))?;
        Self::read(&Opened::new(name, None, source, control), plan)
    }

    /// Reads an input.
    ///
    /// # Errors
    /// [`RunError::Beside`].
    pub fn read(input: &Opened, plan: &Plan) -> Result<Self, RunError> {
        input.begin_hashing();
        let voxels = Voxels::of(input, plan.measurement.embedding);
        let voxels = voxels.map_err(|error| told_of(input.name, error))?;
        let mut flags = input.source.flags();
        if let Voxels::Labels(image) = &voxels {
            flags.extend(grey_values(image.summaries().len(), image.looks_grey()));
        }
        Ok(Self {
            name: input.name.to_owned(),
            voxels,
            flags,
            segments: input.source.segments(),
            table: input.source.label_table(),
            fingerprint: Arc::clone(&input.fingerprint),
            compared: Mutex::default(),
        })
    }

    /// Labels that the later image has and no object that was compared with it, the first of many; none of segments, whose
    /// values are no labels.
    pub fn not_compared(&self) -> Option<String> {
        let (Voxels::Labels(image), None) = (&self.voxels, &self.segments) else { return None };
        let compared = self.compared.lock().unwrap_or_else(PoisonError::into_inner);
        let labels = image.summaries().iter().map(|label| label.label);
        let left: Vec<i64> = labels.filter(|label| !compared.contains(label)).collect();
        (!left.is_empty()).then(|| listed(left.into_iter(), SHOWN_LABELS))
    }

    /// Compares the surface of an object with that of the later one of the same label, and keeps what there is at each vertex.
    /// What is doubtful about that becomes a flag of the object.
    ///
    /// # Errors
    /// [`RunError::Beside`] where there is no such label, nothing is left of it, or it lies elsewhere; [`RunError::Unfit`] where
    /// the object has no surface of before the blur.
    pub(super) fn change(&self, first: &mut InputObject) -> Result<AgainstRecord, RunError> {
        let is_refused = first.local.is_none() && lacks_original(&first.measured().flags);
        first.control().check()?;
        if is_refused {
            return Err(NO_ORIGINAL);
        }
        let (change, doubts) = self.change_of(first).map_err(|error| told_of(&self.name, error))?;
        first.flags_beside.extend(self.flag(&change, &doubts));
        Ok(AgainstRecord { input: self.name.clone(), input_sha256: self.fingerprint.text(), change })
    }

    fn change_of(&self, first: &mut InputObject) -> Result<(SurfaceChange, Vec<Flag>), RunError> {
        let later = self.object(first, first.local())?;
        let flags = match &first.local {
            Some(_) => self.object(first, &first.object)?.measure().flags,
            None => later.measure().flags,
        };
        first.control().check()?;
        if first.local.is_none() && lacks_original(&flags) {
            return Err(NO_ORIGINAL);
        }
        let surface = later.surface();
        first.control().check()?;
        let (local, known) = (first.local(), later.field_of_view());
        let noise = [local.position_noise(), later.position_noise()];
        let here =
            Placed { surface: first.surface(), noise: noise[0].as_ref(), known: local.field_of_view() };
        let there = Placed { surface: &surface, noise: noise[1].as_ref(), known };
        let changes = Surface::changes_to(here, there).ok_or(RunError::NoSurface)?;
        // Of the way back only distances are wanted.
        let [here, there] = [here, there].map(|placed| Placed { noise: None, ..placed });
        let from_later = Surface::changes_to(there, here).ok_or(RunError::NoSurface)?;
        if [&changes, &from_later].into_iter().any(|changes| changes.iter().all(|c| c.distance.is_nan())) {
            let (here, there) = local.place().zip(known).ok_or(RunError::NoSurface)?;
            return Err(RunError::apart(here, there));
        }
        let first = first.surface_mut().ok_or(RunError::NoSurface)?;
        first.set_changes(&changes);
        Ok((first.change(&surface, &from_later).ok_or(RunError::NoSurface)?, flags))
    }

    /// What the later image does not tell of an object, and what is doubtful about what it tells; `None` where nothing is.
    fn flag(&self, change: &SurfaceChange, of_object: &[Flag]) -> Option<Flag> {
        let share = change.share_without_distance;
        let unknown = format!(
            "{:.1} % of the area has no distance and is in no mean, for it lies outside the later image, or as near to where an image cuts \
             the object as the cut is told (3 sigma): compare with an image of the same part",
            100.0 * share
        );
        let of_object = of_object.iter().filter(|flag| DOUBTS.contains(&flag.code));
        let quoted = |flag: &Flag| format!("its flag {}: {}", flag.code, flag.message);
        let told = (share > TOLD_SHARE).then_some(unknown);
        let told = told.into_iter().chain(self.flags.iter().chain(of_object).map(quoted));
        flag_beside(BesideRole::Later, &self.name, told)
    }

    /// The object of the same label, looked at as the first is when it is set up like this.
    fn object(&self, first: &InputObject, like: &Object) -> Result<Object, RunError> {
        let measurement = like.comparable();
        let object = match &self.voxels {
            Voxels::Field(field) => measurement.prepare_field(field)?,
            Voxels::Probability(image) => measurement.prepare_probability(image)?,
            Voxels::Labels(image) => {
                let label = first.label.as_ref().ok_or(RunError::NoSurface)?;
                measurement.prepare(self.mask(image, label)?)?
            }
        };
        Ok(object.under(first.control()))
    }

    fn mask(&self, image: &LabelImage, label: &LabelGroup) -> Result<Mask, RunError> {
        let selection = LabelSelection::Groups(vec![label.clone()]);
        let found = Selected::of(&selection, image, self.segments.as_ref()).map_err(|error| match error {
            VolumeError::NoSuchLabel { missing, present } => RunError::NoLaterLabel { missing, present },
            other => with_name(other, &self.table),
        })?;
        self.compared.lock().unwrap_or_else(PoisonError::into_inner).extend(label.labels());
        let values = found.into_iter().next().map_or_else(|| label.clone(), |object| object.values);
        Ok(image.group_mask(&values))
    }
}

/// An error of the later input.
fn told_of(name: &str, error: RunError) -> RunError {
    beside(BesideRole::Later, name, error)
}

/// Whether compensation for the blur failed, on which distances rest.
fn lacks_original(flags: &[Flag]) -> bool {
    flags.iter().any(|flag| flag.code == FlagCode::CompensationFailed)
}
