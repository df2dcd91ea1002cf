//! An input whose voxels are prepared before anybody sees them.

use super::preparation::{Changes, Preparation, Preparations, Threshold};
use super::{HeaderFacts, InputError, Slabs, Source};
use crate::accuracy::Flag;
use crate::phantoms::Truth;
use crate::topology::{ComponentLabels, Connectivity};
use crate::volume::{
    Grid, LabelImage, LabelRewrite, LabelSlabs, LabelTable, Samples, Scalar, Segments, Slab, SlabReader,
    VolumeError, collected, for_samples,
};
use rayon::prelude::*;
use std::collections::{BTreeMap, TryReserveError};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A source of prepared voxels: those of another one, or, where nothing is to be done, that one itself.
pub fn prepared<'a>(source: Box<dyn Source + 'a>, preparation: Preparation) -> Box<dyn Source + 'a> {
    if preparation.is_none() {
        return source;
    }
    let preparations = Preparations { asked: preparation, ..Preparations::default() };
    Box::new(Prepared { source, preparation, found: Mutex::new(Arc::new(preparations)) })
}

struct Prepared<'a> {
    source: Box<dyn Source + 'a>,
    preparation: Preparation,
    /// What the last reading changed.
    found: Mutex<Arc<Preparations>>,
}

impl Prepared<'_> {
    fn found(&self) -> Arc<Preparations> {
        Arc::clone(&self.found.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Source for Prepared<'_> {
    fn grid(&self) -> &Grid {
        self.source.grid()
    }

    fn slabs(&self) -> Result<Slabs<'_>, InputError> {
        let slabs = self.source.slabs()?;
        let mut slabs: Slabs = match self.preparation.threshold {
            Some(threshold) => Box::new(Thresholded { slabs, threshold, seen: None, found: false }),
            None => slabs,
        };
        if !self.preparation.needs_all() {
            return Ok(slabs);
        }
        let image = LabelImage::from_slabs(&mut slabs)?;
        if self.segments().is_some_and(|segments| segments.overlap()) {
            return Err(InputError::Unfit(
                "its segments overlap, so that pieces and cavities of one are not those of a label: measure each segment's own mask with these options",
            ));
        }
        if image.looks_grey() {
            return Err(VolumeError::GreyValues { labels: image.summaries().len() }.into());
        }
        let file_time = slabs.file_time();
        let (image, changes) = changed(image, self.preparation)?;
        let found = Preparations { asked: self.preparation, changes };
        *self.found.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(found);
        Ok(Box::new(Changed { slabs: LabelSlabs::of(image), file_time }))
    }

    fn header(&self) -> HeaderFacts {
        self.source.header()
    }

    fn truth(&self) -> Option<Truth> {
        self.source.truth().filter(|_| self.found().changed_nothing())
    }

    fn is_object(&self) -> bool {
        true
    }

    fn label_table(&self) -> LabelTable {
        if self.preparation.threshold.is_some() { LabelTable::default() } else { self.source.label_table() }
    }

    fn segments(&self) -> Option<Segments> {
        self.source.segments().filter(|_| self.preparation.threshold.is_none())
    }

    fn files(&self) -> Vec<PathBuf> {
        self.source.files()
    }

    fn flags(&self) -> Vec<Flag> {
        self.source.flags()
    }

    fn preparations(&self) -> Option<Arc<Preparations>> {
        Some(self.found())
    }
}

/// Slabs of an image that was changed as a whole.
struct Changed {
    slabs: LabelSlabs<'static>,
    file_time: Duration,
}

impl SlabReader for Changed {
    type Error = InputError;

    fn grid(&self) -> &Grid {
        self.slabs.grid()
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, InputError> {
        Ok(self.slabs.next_slab()?)
    }

    fn file_time(&self) -> Duration {
        self.file_time
    }
}

/// Slabs of grey values as those of the object that a threshold makes of them.
struct Thresholded<'a> {
    slabs: Slabs<'a>,
    threshold: Threshold,
    /// The least and the largest value so far.
    seen: Option<[f64; 2]>,
    /// Whether one was inside.
    found: bool,
}

impl Thresholded<'_> {
    /// What is inside, of values that are numbers or not.
    fn bits(&mut self, values: &[impl Scalar]) -> Result<Samples, TryReserveError> {
        let numbers = values.iter().map(|value| value.to_f64()).filter(|value| !value.is_nan());
        self.seen = numbers.fold(self.seen, |seen, value| {
            Some(seen.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]))
        });
        let bits = collected(values.iter().map(|value| u8::from(self.threshold.contains(value.to_f64()))))?;
        self.found |= bits.contains(&1);
        Ok(Samples::U8(bits))
    }
}

impl SlabReader for Thresholded<'_> {
    type Error = InputError;

    fn grid(&self) -> &Grid {
        self.slabs.grid()
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, InputError> {
        let Some(Slab { slices, samples }) = self.slabs.next_slab()? else { return Ok(None) };
        let dimensions = self.grid().dimensions();
        if matches!(samples, Samples::F32(_)) {
            // Of 0.1 the nearest number that voxels can have is meant.
            self.threshold = self.threshold.in_single_precision();
        }
        let bits = for_samples!(&samples, values => self.bits(values));
        let samples = bits.map_err(|_| VolumeError::TooLarge { dimensions })?;
        if slices.end == dimensions[2] && !self.found {
            let [lowest, highest] = self.seen.unwrap_or([f64::NAN; 2]);
            return Err(VolumeError::NothingWithin { lowest, highest }.into());
        }
        Ok(Some(Slab { slices, samples }))
    }

    fn file_time(&self) -> Duration {
        self.slabs.file_time()
    }
}

/// An image without small pieces and cavities, as far as that is asked, and what changed of each label that did.
fn changed(
    image: LabelImage,
    preparation: Preparation,
) -> Result<(LabelImage, BTreeMap<i64, Changes>), VolumeError> {
    let mut changes = BTreeMap::new();
    let mut image = image;
    if preparation.largest_component {
        let pieces: Vec<_> = each_label(&image, |label| small_pieces(&image, label));
        for (label, (count, runs)) in image.labels().zip(&pieces).filter(|(_, (count, _))| *count > 0) {
            let dropped_voxels = runs.iter().map(LabelRewrite::voxels).sum();
            changes.insert(label, Changes { dropped_pieces: *count, dropped_voxels, ..Changes::default() });
        }
        image = image.rewritten(pieces.into_iter().flat_map(|(_, runs)| runs).collect())?;
    }
    if preparation.fill_cavities {
        let enclosed: Vec<Vec<(u64, LabelRewrite)>> = each_label(&image, |label| enclosed_by(&image, label));
        let mut enclosed = enclosed.concat();
        // The first to claim a voxel has it: of cavities within another, the smaller one's label.
        enclosed.sort_by_key(|(size, run)| (*size, run.label));
        let filled = image.rewritten(enclosed.into_iter().map(|(_, run)| run).collect())?;
        for (before, after) in image.summaries().iter().zip(filled.summaries()) {
            if after.voxels > before.voxels {
                changes.entry(after.label).or_default().filled_voxels = after.voxels - before.voxels;
            }
        }
        image = filled;
    }
    Ok((image, changes))
}

/// What comes of each label, in their order.
fn each_label<T: Send>(image: &LabelImage, of: impl Fn(i64) -> T + Sync) -> Vec<T> {
    image.summaries().par_iter().map(|summary| of(summary.label)).collect()
}

/// How many pieces a label has beside its largest, and their runs as background.
fn small_pieces(image: &LabelImage, label: i64) -> (u64, Vec<LabelRewrite>) {
    let mask = image.mask(label);
    let mut pieces = ComponentLabels::of(&mask, Connectivity::Foreground26);
    let runs = pieces.beside_largest().into_iter();
    let dropped = runs.map(|((y, z), run)| LabelRewrite::new(run, y, z, 0)).collect();
    (pieces.count() - 1, dropped)
}

/// The runs that a label encloses, as its own, each with the size of the cavity that it is of.
fn enclosed_by(image: &LabelImage, label: i64) -> Vec<(u64, LabelRewrite)> {
    let mask = image.mask(label);
    let runs = ComponentLabels::of(&mask, Connectivity::Background6).enclosed().into_iter();
    runs.map(|(size, (y, z), run)| (size, LabelRewrite::new(run, y, z, label))).collect()
}
