//! Images that are read beside the inputs: regions that objects are split by, volumes that are put on their surfaces.

use super::{BesideRole, InputObject, Plan, RunError, WordError};
use crate::accuracy::{Flag, FlagCode};
use crate::inputs::{InputError, OpenOptions, input_title, open};
use crate::io::ReadError;
use crate::io::known_stem;
use crate::measurement::{Interface, RegionPart, Regions};
use crate::surface::{SampledVolume, VertexArray};
use crate::volume::{FieldOfView, LabelGroup, LabelImage, VolumeError};
use std::path::Path;
use std::str::FromStr;
use std::sync::{Arc, Mutex, PoisonError};

/// An image that is read once, when it is first wanted.
#[derive(Debug, Clone)]
struct Once<T>(Arc<Mutex<Option<Arc<T>>>>);

impl<T> Default for Once<T> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

impl<T> Once<T> {
    fn get(&self, read: impl FnOnce() -> Result<T, RunError>) -> Result<Arc<T>, RunError> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*known {
            Some(image) => Ok(Arc::clone(image)),
            None => Ok(Arc::clone(known.insert(Arc::new(read()?)))),
        }
    }
}

/// A label image whose labels are regions, on a lattice of its own.
#[derive(Debug, Clone, Default)]
pub struct RegionImage {
    file: String,
    image: Once<Regions>,
}

impl RegionImage {
    /// Of an input by its name.
    pub fn of(file: impl Into<String>) -> Self {
        Self { file: file.into(), image: Once::default() }
    }

    /// The input.
    pub fn file(&self) -> &str {
        &self.file
    }

    fn read(&self) -> Result<Arc<Regions>, RunError> {
        let read = || {
            let source = open(&self.file, &OpenOptions::default())?;
            let image = LabelImage::from_slabs(&mut source.slabs()?).map_err(no_regions)?;
            if source.segments().is_some_and(|segments| segments.overlap()) {
                return Err(RunError::Unfit(
                    "its segments overlap, and a place has one region: write them as one label image",
                ));
            }
            if image.looks_grey() {
                return Err(NO_REGIONS);
            }
            if image.summaries().is_empty() {
                return Err(RunError::Unfit("it holds no region: all of its voxels are 0"));
            }
            Ok(Regions::new(image, source.label_table())?)
        };
        self.image.get(read).map_err(|error| beside(BesideRole::Regions, &self.file, error))
    }
}

const NO_REGIONS: RunError = RunError::Unfit(
    "its values are no labels, but grey values or fractions; regions are the labels of an image, as of an atlas: make one of it",
);

/// An error of an image as one of regions: what makes labels of an input makes none of it.
fn no_regions(error: InputError) -> RunError {
    match error {
        InputError::Read(ReadError::Volume(
            VolumeError::GreyValues { .. }
            | VolumeError::Fractional { .. }
            | VolumeError::FaintForeground { .. },
        )) => NO_REGIONS,
        other => other.into(),
    }
}

/// Share of an object's area that an image beside it tells nothing of from which on a flag says so.
pub(super) const TOLD_SHARE: f64 = 0.0005;

/// The warning of an image beside the input, of all that there is to be told of it; `None` where that is nothing.
pub(super) fn flag_beside(what: BesideRole, name: &str, told: impl Iterator<Item = String>) -> Option<Flag> {
    let told: Vec<String> = told.collect();
    let message = || format!("{what} {name}: {}", told.join("; "));
    (!told.is_empty()).then(|| Flag::new(FlagCode::ImageBeside, message()))
}

/// The warning of an object none of which is in a region.
pub(super) fn without_region(parts: &[RegionPart]) -> Option<Flag> {
    let message = "no part of the object lies in a region: all of it is in region 0; check that the regions are in the same world coordinates";
    if parts.iter().all(|part| part.region == 0) {
        return Some(Flag::new(FlagCode::ImageBeside, message));
    }
    let area = share_of_none(parts, |part| part.values.surface_area_mm2)?;
    let volume = share_of_none(parts, |part| part.values.volume_mm3)?;
    let message = || {
        format!(
            "region 0, where no region is, has {:.0} % of the surface and {:.1} % of the volume: the regions end below the object's \
             surface, so that their areas and curvatures are too small; let them reach its voxels, or beyond",
            100.0 * area,
            100.0 * volume
        )
    };
    let ends_inside = area > LEAST_AREA && area > SKIN * volume;
    ends_inside.then(|| Flag::new(FlagCode::ImageBeside, message()))
}

/// The least share of the surface in no region, and how many times that of the volume, by which regions end below it: a part
/// that is cut off by a plane has up to a few times.
const LEAST_AREA: f64 = 0.05;
const SKIN: f64 = 4.0;

/// Which share of a number is in no region.
fn share_of_none(parts: &[RegionPart], of: fn(&RegionPart) -> Option<f64>) -> Option<f64> {
    let all: f64 = parts.iter().map(of).sum::<Option<f64>>()?;
    let none = parts.iter().find(|part| part.region == 0).map_or(Some(0.0), of)?;
    (all > 0.0).then(|| none / all)
}

/// A volume that is put on surfaces, on a lattice of its own, as it is written: `FILE`, or `NAME=FILE`.
#[derive(Debug, Clone)]
pub struct SampleImage {
    name: String,
    file: String,
    volume: Once<SampledVolume>,
}

impl FromStr for SampleImage {
    type Err = WordError;

    fn from_str(text: &str) -> Result<Self, WordError> {
        let named =
            text.split_once('=').filter(|(name, _)| !name.contains(['/', ':']) && !Path::new(text).exists());
        let file = named.map_or(text, |(_, file)| file);
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let title = || known_stem(&input_title(file)).replace(|c: char| !is_plain(c), "_");
        let name = named.map_or_else(title, |(name, _)| name.to_owned());
        if name.is_empty()
            || file.is_empty()
            || !name.chars().all(is_plain)
            || VertexArray::is_own_name(&name)
        {
            return Err(WordError(format!(
                "`{text}`: write FILE, or NAME=FILE with a name of letters, digits and _ that no other array has"
            )));
        }
        Ok(Self { name, file: file.to_owned(), volume: Once::default() })
    }
}

impl SampleImage {
    /// The array's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its file.
    pub fn file(&self) -> &str {
        &self.file
    }

    fn read(&self) -> Result<Arc<SampledVolume>, RunError> {
        let read = || {
            let source = open(&self.file, &OpenOptions::default())?;
            Ok(SampledVolume::from_slabs(self.name.clone(), &mut source.slabs()?)?)
        };
        self.volume.get(read).map_err(|error| beside(BesideRole::Sample, &self.file, error))
    }
}

/// An error of such an image; that the run was told to stop is none.
pub(super) fn beside(what: BesideRole, file: &str, error: RunError) -> RunError {
    if error.is_stop() {
        return error;
    }
    RunError::Beside { what, file: file.to_owned(), source: Box::new(error) }
}

/// What is known beside an input's objects.
#[derive(Debug, Default)]
pub(super) struct Beside {
    pub(super) regions: Option<Arc<Regions>>,
    pub(super) samples: Vec<Arc<SampledVolume>>,
    pub(super) interfaces: Option<Vec<Interface>>,
}

impl Beside {
    /// What a plan asks for, but for interfaces.
    pub(super) fn read(plan: &Plan) -> Result<Self, RunError> {
        Ok(Self {
            regions: plan.regions.as_ref().map(RegionImage::read).transpose()?,
            samples: plan.samples.iter().map(SampleImage::read).collect::<Result<_, _>>()?,
            interfaces: None,
        })
    }

    /// That regions are not all elsewhere than the objects.
    pub(super) fn check_regions(&self, plan: &Plan, objects: Option<FieldOfView>) -> Result<(), RunError> {
        let regions = self.regions.as_ref().and_then(|regions| regions.place());
        match (objects, regions, &plan.regions) {
            (Some(here), Some(there), Some(image)) if !here.may_meet(&there) => {
                Err(beside(BesideRole::Regions, image.file(), RunError::apart(here, there)))
            }
            _ => Ok(()),
        }
    }

    /// Of each volume that has no value anywhere on an object's surface, why.
    pub(super) fn without_values(&self, plan: &Plan, object: &InputObject) -> Vec<RunError> {
        let (surface, place) = (object.surface(), object.local().place());
        let error = |volume: &SampledVolume| match place.zip(volume.place()) {
            Some((here, there)) if !here.may_meet(&there) => RunError::apart(here, there),
            _ => RunError::Unfit(
                "it has no value anywhere on the surface: the surface lies beyond it, or its voxels there are NaN",
            ),
        };
        let all = plan.samples.iter().zip(&self.samples).zip(&surface.samples);
        all.filter(|(_, sample)| !surface.is_empty() && sample.values.iter().all(|v| v.is_nan()))
            .map(|((image, volume), _)| beside(BesideRole::Sample, &image.file, error(volume)))
            .collect()
    }

    /// The interfaces of an object; `None` where they are not asked for.
    pub(super) fn interfaces_of(&self, object: &LabelGroup) -> Option<Vec<Interface>> {
        let is_own = |interface: &&Interface| interface.labels.contains(object);
        self.interfaces.as_ref().map(|all| all.iter().filter(is_own).cloned().collect())
    }
}
