//! Images that are never held: objects are summed over while their slices go by.

use super::box_sums::Labels;
use super::boxes::{PartialMeasurement, reach};
use super::scheme::Scheme;
use super::setup::Setup;
use super::{MeasureError, Measured, Measurement};
use crate::Control;
use crate::tiling::{IndexBox, TILE};
use crate::volume::{LabelGroup, LabelImage, LabelRuns, LabelSelection, RunEncoder, SlabReader, VolumeError};
use std::time::{Duration, Instant};
use thiserror::Error;

/// How far a stream has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Slices that were read.
    pub slices: usize,
    /// Slices of the image.
    pub of_slices: usize,
    /// Labels that have occurred so far, background left out.
    pub labels: usize,
}

/// Why a stream could not be measured.
#[derive(Debug, Error)]
pub enum StreamError<E: std::error::Error> {
    /// The source.
    #[error(transparent)]
    Read(E),
    /// The measurement.
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

/// What a stream gave.
#[derive(Debug, Clone)]
pub struct Streamed {
    /// The objects.
    pub results: Vec<(LabelGroup, Measured)>,
    /// [`VolumeError::NoSuchLabel`] for each selected object that does not occur.
    pub missing: Vec<VolumeError>,
    /// Time that the source took, s.
    pub source_seconds: f64,
    /// Time that finding the labels' runs took, s.
    pub encode_seconds: f64,
}

impl Measurement {
    /// Measures the selected labels of an image as its slabs go by, in the memory of a layer of tiles with
    /// the slices around it. The numbers are those of [`Measurement::run_labels`], bit by bit, for slabs of
    /// any size.
    ///
    /// # Errors
    /// [`StreamError`]: the source's own; an image without foreground, or without any of the selected labels; parameters
    /// that make no sense. Where only some occur, the others are in [`Streamed::missing`].
    pub fn run_slabs<R: SlabReader>(
        &self,
        reader: &mut R,
        selection: &LabelSelection,
        progress: impl Fn(Progress),
    ) -> Result<Streamed, StreamError<R::Error>>
    where
        R::Error: std::error::Error,
    {
        self.run_slabs_under(&Control::default(), reader, selection, progress)
    }

    /// The same under a control: once that says stop, it ends early, and what comes of it is not to be used.
    /// [`Control::check`] tells.
    ///
    /// # Errors
    /// As of [`Measurement::run_slabs`].
    pub fn run_slabs_under<R: SlabReader>(
        &self,
        control: &Control,
        reader: &mut R,
        selection: &LabelSelection,
        progress: impl Fn(Progress),
    ) -> Result<Streamed, StreamError<R::Error>>
    where
        R::Error: std::error::Error,
    {
        let grid = *reader.grid();
        let setup = Setup { control: control.clone(), ..Setup::of_masks(self, grid)? };
        if Scheme::check_reach(&setup).is_err() || self.needs_whole_objects() {
            // Corrections need whole objects. A blur so wide is refused, unless it is known to leave nothing: for that objects must be known
            // as a whole. So must those that the image cuts, to be continued beyond it.
            let start = Instant::now();
            let image = LabelImage::from_slabs(reader).map_err(StreamError::Read)?;
            let source_seconds = start.elapsed().as_secs_f64();
            let found = selection.find(&image).map_err(MeasureError::from)?;
            let (selection, missing) = (LabelSelection::Groups(found.groups), found.missing);
            let results = self.run_labels(&image, &selection, |_, _| {})?;
            return Ok(Streamed { results, missing, source_seconds, encode_seconds: 0.0 });
        }
        let mut stream = Stream::new(&setup, selection);
        let (mut source, mut encode) = (Duration::ZERO, Duration::ZERO);
        loop {
            let start = Instant::now();
            let slab = reader.next_slab().map_err(StreamError::Read)?;
            let arrived = Instant::now();
            let ended = slab.is_none();
            if let Some(slab) = slab {
                let encoded = stream.encoder.push(&slab, &mut stream.window);
                // Thousands of values that lie all over the image would take hours.
                let grey =
                    || if *selection == LabelSelection::All { stream.encoder.check_labels() } else { Ok(()) };
                encoded.and_then(|()| grey()).map_err(|error| StreamError::Read(error.into()))?;
            }
            source += arrived - start;
            encode += arrived.elapsed();
            progress(Progress {
                slices: stream.window.end(),
                of_slices: grid.dimensions()[2],
                labels: stream.encoder.labels().len() - 1,
            });
            if ended {
                stream
                    .encoder
                    .check_complete()
                    .and_then(|()| stream.encoder.check_foreground())
                    .map_err(|error| StreamError::Read(error.into()))?;
            }
            stream.advance(ended);
            if ended {
                break;
            }
        }
        let (results, missing) = stream.sum.into_results()?;
        Ok(Streamed {
            results,
            missing,
            source_seconds: source.as_secs_f64(),
            encode_seconds: encode.as_secs_f64(),
        })
    }
}

/// The slices in work, and what was summed so far.
struct Stream<'a> {
    setup: Setup,
    selection: &'a LabelSelection,
    encoder: RunEncoder,
    window: LabelRuns,
    /// Slices around a layer that its sums depend on.
    reach: i64,
    /// The layer of tiles that is summed next.
    layer: IndexBox,
    sum: PartialMeasurement,
}

impl<'a> Stream<'a> {
    fn new(setup: &Setup, selection: &'a LabelSelection) -> Self {
        let image = setup.grid.index_box();
        Self {
            setup: setup.clone(),
            selection,
            encoder: RunEncoder::new(image),
            window: LabelRuns::new(setup.grid, &image),
            reach: reach(setup)[2],
            layer: layer_at(&image, 0),
            sum: PartialMeasurement::empty(setup, selection),
        }
    }

    /// Sums over the layers for which enough slices are there.
    fn advance(&mut self, ended: bool) {
        let image = self.setup.grid.index_box();
        while !self.layer.is_empty()
            && (ended || self.layer.upper[2] + self.reach <= self.window.end() as i64)
        {
            self.sum_layer();
            self.layer = layer_at(&image, self.layer.upper[2]);
            self.window.forget_before((self.layer.lower[2] - self.reach).max(0) as usize);
        }
    }

    fn sum_layer(&mut self) {
        let codes = self.encoder.labels();
        let bounds = self.window.bounds(codes.len());
        let coded = codes.iter().zip(bounds).enumerate().skip(1);
        let coded = coded.map(|(code, (&label, bounds))| (label, code, bounds)).collect();
        let labels = Labels::new(&self.window, coded);
        let layer = PartialMeasurement::of_box(&self.setup, self.layer, &labels, self.selection);
        self.sum.merge(layer).expect("layers of one measurement do not overlap");
    }
}

/// The layer of tiles of an image that begins at a slice; empty behind the last.
fn layer_at(image: &IndexBox, slice: i64) -> IndexBox {
    let mut layer = *image;
    layer.lower[2] = slice;
    layer.upper[2] = (slice + TILE[2]).min(image.upper[2]);
    IndexBox::new(layer.lower, layer.upper)
}
