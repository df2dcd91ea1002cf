//! Images that are read beside the inputs: regions that objects are split by, volumes that are put on their surfaces.

use super::{Plan, RunError, WordError};
use crate::Choice;
use crate::inputs::{OpenOptions, input_title, known_stem, open};
use crate::measurement::{Interface, Regions};
use crate::surface::{LocalQuantity, SampledVolume};
use crate::volume::{FieldImage, LabelGroup, LabelImage};
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
            let image = LabelImage::from_slabs(&mut source.slabs()?)?;
            Ok(Regions::new(image, source.label_table())?)
        };
        self.image.get(read).map_err(|error| beside("regions", &self.file, error))
    }
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
        let (name, file) = named.unwrap_or(("", text));
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let title = || known_stem(&input_title(file)).replace(|c: char| !is_plain(c), "_");
        let name = if name.is_empty() { title() } else { name.to_owned() };
        let is_taken = |quantity: &LocalQuantity| name == quantity.name();
        if file.is_empty() || !name.chars().all(is_plain) || LocalQuantity::ALL.iter().any(is_taken) {
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

    fn read(&self) -> Result<Arc<SampledVolume>, RunError> {
        let read = || {
            let source = open(&self.file, &OpenOptions::default())?;
            let field = FieldImage::from_slabs(&mut source.slabs()?)?;
            let no_place = RunError::Unfit("its voxels lie in one place: mend its affine");
            SampledVolume::new(self.name.clone(), field).ok_or(no_place)
        };
        self.volume.get(read).map_err(|error| beside("sample", &self.file, error))
    }
}

/// An error of such an image; that the run was told to stop is none.
pub(super) fn beside(what: &'static str, file: &str, error: RunError) -> RunError {
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

    /// The interfaces of an object; `None` where they are not asked for.
    pub(super) fn interfaces_of(&self, object: &LabelGroup) -> Option<Vec<Interface>> {
        let is_own = |interface: &&Interface| interface.labels.contains(object);
        self.interfaces.as_ref().map(|all| all.iter().filter(is_own).cloned().collect())
    }
}
