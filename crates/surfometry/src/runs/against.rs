//! A later image of the same objects, with whose surfaces those of a run are compared.

use super::beside::beside;
use super::called::with_name;
use super::fingerprint::Fingerprint;
use super::reading::Voxels;
use super::{InputObject, Opened, Plan, RunError};
use crate::Control;
use crate::inputs::open;
use crate::measurement::Object;
use crate::surface::{Placed, Surface, SurfaceChange};
use crate::volume::{LabelGroup, LabelImage, LabelSelection, LabelTable, Mask, Segments, Selected};
use serde::Serialize;
use std::sync::Arc;

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
    fingerprint: Arc<Fingerprint>,
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
        Ok(Self {
            name: input.name.to_owned(),
            voxels: voxels.map_err(|error| told_of(input.name, error))?,
            segments: input.source.segments(),
            table: input.source.label_table(),
            fingerprint: Arc::clone(&input.fingerprint),
        })
    }

    /// Compares the surface of an object with that of the later one of the same label, and keeps what there is at each vertex.
    ///
    /// # Errors
    /// [`RunError::Beside`] where there is no such label, or nothing is left of it.
    pub(super) fn change(&self, first: &mut InputObject) -> Result<AgainstRecord, RunError> {
        let change = self.change_of(first).map_err(|error| told_of(&self.name, error))?;
        Ok(AgainstRecord { input: self.name.clone(), input_sha256: self.fingerprint.text(), change })
    }

    fn change_of(&self, first: &mut InputObject) -> Result<SurfaceChange, RunError> {
        let later = self.object(first)?;
        let surface = later.surface();
        first.control().check()?;
        let noise = [first.local().position_noise(), later.position_noise()];
        let here = Placed { surface: first.surface(), noise: noise[0].as_ref() };
        let there = Placed { surface: &surface, noise: noise[1].as_ref() };
        let changes = Surface::changes_to(here, there).ok_or(RunError::NoSurface)?;
        // Of the way back only distances are wanted.
        let [here, there] = [here, there].map(|placed| Placed { noise: None, ..placed });
        let from_later = Surface::changes_to(there, here).ok_or(RunError::NoSurface)?;
        let first = first.surface_mut().ok_or(RunError::NoSurface)?;
        first.set_changes(&changes);
        first.change(&surface, &from_later).ok_or(RunError::NoSurface)
    }

    /// The object of the same label, looked at as the first is.
    fn object(&self, first: &InputObject) -> Result<Object, RunError> {
        let measurement = first.local().comparable();
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
        let found = Selected::of(&selection, image, self.segments.as_ref())
            .map_err(|error| with_name(error, &self.table))?;
        let values = found.into_iter().next().map_or_else(|| label.clone(), |object| object.values);
        Ok(image.group_mask(&values))
    }
}

/// An error of the later input.
fn told_of(name: &str, error: RunError) -> RunError {
    beside("the later image", name, error)
}
