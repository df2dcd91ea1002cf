//! Images that are never held: objects are summed over while their slices go by.

use super::pass::{ObjectSums, Pass};
use super::scheme::Scheme;
use super::setup::{Setup, Totals};
use super::{Clip, MeasureError, Measured, Measurement};
use crate::tiling::{IndexBox, TILE};
use crate::volume::{LabelGroup, LabelImage, LabelRuns, LabelSelection, Mask, RunEncoder, SlabReader};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
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
    /// Time that the source took, s.
    pub source_seconds: f64,
    /// Time that finding the labels' runs took, s.
    pub encode_seconds: f64,
}

impl Measurement {
    /// Measures the selected labels of an image as its slabs go by, in the memory of a layer of tiles with the slices around it. The
    /// numbers are those of [`Measurement::run_labels`], bit by bit, for slabs of any size.
    ///
    /// # Errors
    /// [`StreamError`]: the source's own; a label that does not occur, an image without foreground, parameters that make no sense.
    pub fn run_slabs<R: SlabReader>(
        &self,
        reader: &mut R,
        selection: &LabelSelection,
        progress: impl Fn(Progress),
    ) -> Result<Streamed, StreamError<R::Error>>
    where
        R::Error: std::error::Error,
    {
        let grid = *reader.grid();
        let setup = Setup::of_masks(self, grid)?;
        if Scheme::check_reach(&setup).is_err() || self.clip == Clip::Exclude {
            // A blur so wide is refused, unless it is known to leave nothing: for that objects must be known as a whole. So must those that
            // the image cuts, to be continued beyond it.
            let start = Instant::now();
            let image = LabelImage::from_slabs(reader).map_err(StreamError::Read)?;
            let source_seconds = start.elapsed().as_secs_f64();
            let results = self.run_labels(&image, selection, |_, _| {})?;
            return Ok(Streamed { results, source_seconds, encode_seconds: 0.0 });
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
                encoded.map_err(|error| StreamError::Read(error.into()))?;
            }
            source += arrived - start;
            encode += arrived.elapsed();
            progress(Progress {
                slices: stream.window.end(),
                of_slices: grid.dimensions()[2],
                labels: stream.encoder.labels().len() - 1,
            });
            if ended {
                stream.encoder.check_complete().map_err(|error| StreamError::Read(error.into()))?;
            }
            stream.advance(ended);
            if ended {
                break;
            }
        }
        Ok(Streamed {
            results: stream.results()?,
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
    /// The slices of the layer that is summed next.
    layer: Range<i64>,
    /// By number of the selected group, or by code where all labels are selected.
    totals: BTreeMap<usize, Totals>,
}

impl<'a> Stream<'a> {
    fn new(setup: &Setup, selection: &'a LabelSelection) -> Self {
        let nothing = Mask::empty(setup.grid);
        let reach = Scheme::of_part(setup, &nothing).reach(setup);
        let first = (-reach).div_euclid(TILE[2]) * TILE[2];
        Self {
            setup: setup.clone(),
            selection,
            encoder: RunEncoder::new(setup.grid),
            window: LabelRuns::new(setup.grid),
            reach,
            layer: first..first + TILE[2],
            totals: BTreeMap::new(),
        }
    }

    /// Sums over the layers for which enough slices are there.
    fn advance(&mut self, ended: bool) {
        let slices = self.setup.grid.dimensions()[2] as i64;
        while (ended && self.layer.start < slices + self.reach)
            || self.layer.end + self.reach <= self.window.end() as i64
        {
            self.sum_layer();
            self.layer = self.layer.end..self.layer.end + TILE[2];
            self.window.forget_before((self.layer.start - self.reach).max(0) as usize);
        }
    }

    /// Groups of codes that the window may hold, by the number under which they are summed.
    fn groups(&self) -> Vec<(usize, Vec<usize>)> {
        match self.selection {
            LabelSelection::All => (1..self.encoder.labels().len()).map(|code| (code, vec![code])).collect(),
            LabelSelection::Groups(groups) => {
                let codes = |group: &LabelGroup| {
                    let mut codes: Vec<usize> =
                        group.labels().iter().filter_map(|&label| self.encoder.code_of(label)).collect();
                    codes.sort_unstable();
                    codes
                };
                groups.iter().map(codes).enumerate().collect()
            }
        }
    }

    fn sum_layer(&mut self) {
        let bounds = self.window.bounds(self.encoder.labels().len());
        let mut groups = self.groups();
        groups.retain(|(_, codes)| codes.iter().any(|&code| !bounds[code].is_empty()));
        let mut totals: Vec<(usize, Vec<usize>, Totals)> = groups
            .into_iter()
            .map(|(key, codes)| (key, codes, self.totals.remove(&key).unwrap_or_default()))
            .collect();
        totals.par_iter_mut().for_each(|(_, codes, totals)| {
            let all = codes.iter().fold(IndexBox::EMPTY, |all, &code| all.hull(&bounds[code]));
            self.sum_object(codes, all, totals);
        });
        self.totals.extend(totals.into_iter().map(|(key, _, totals)| (key, totals)));
    }

    fn sum_object(&self, codes: &[usize], bounds: IndexBox, totals: &mut Totals) {
        let start = Instant::now();
        let mask = self.window.mask(codes, bounds);
        let pass = Pass { slices: Some(self.layer.clone()), ..self.setup.pass(true) };
        // What is in reach of the layer decides; so a small object costs nothing, however far a blur spreads it.
        let sums = if Scheme::has_no_band(&self.setup, &mask) {
            ObjectSums::default()
        } else {
            Scheme::of_part(&self.setup, &mask).sums(&pass)
        };
        totals.integrated += sums.times.share_of_integrals(start.elapsed());
        totals.sums = std::mem::take(&mut totals.sums).merged(&sums);
        totals.add_voxels(&mask, self.layer.clone());
    }

    /// The selected objects, in order of selection or of label.
    fn results(&self) -> Result<Vec<(LabelGroup, Measured)>, MeasureError> {
        let labels = self.encoder.labels();
        let groups = self.selection.resolve_among(labels[1..].iter().copied())?;
        let key = |number: usize, group: &LabelGroup| match self.selection {
            LabelSelection::All => self.encoder.code_of(group.labels()[0]).expect("it occurs"),
            LabelSelection::Groups(_) => number,
        };
        let measured = |(number, group): (usize, LabelGroup)| {
            let measured = self.setup.measured(&self.totals[&key(number, &group)]);
            (group, measured)
        };
        Ok(groups.into_iter().enumerate().map(measured).collect())
    }
}
