//! Objects to records.

use super::ExplainTopology;
use super::called::{Asked, with_name};
use super::object::prepared_flags;
use super::reading::{Watched, grey_values};
use super::stamps::FileStamps;
use super::{Item, Opened, Plan, Reading, Record, RunError, Task};
use crate::inputs::open;
use crate::measurement::{MeasureError, Measured, StageSeconds, StreamError};
use crate::volume::{LabelGroup, look_grey};
use crate::{Control, Event};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Measures every selected object of an input; a record an object.
#[derive(Debug, Default)]
pub struct MeasureTask {
    /// What is asked.
    pub plan: Plan,
    /// Pictures that are drawn of the same reading.
    #[cfg(feature = "pictures")]
    pub pictures: Option<super::Pictures>,
    /// Whether whoever listens is told where the time went.
    pub timings: bool,
}

impl Task for MeasureTask {
    type Row = Record;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<Record>)) -> Result<(), RunError> {
        input.begin_hashing();
        // Segments that may overlap are known once all voxels are.
        if self.needs_all() || input.source.segments().is_some() {
            self.of_whole(input, out)
        } else {
            self.of_stream(input, out)
        }
    }
}

impl MeasureTask {
    /// Whether more is asked of an input than can be had while its slices go by.
    fn needs_all(&self) -> bool {
        self.plan.needs_all() || self.plan.explain_topology == ExplainTopology::Always || self.draws()
    }

    #[cfg(feature = "pictures")]
    fn draws(&self) -> bool {
        self.pictures.is_some()
    }

    #[cfg(not(feature = "pictures"))]
    fn draws(&self) -> bool {
        false
    }

    fn of_whole(&self, input: &Opened, out: &mut dyn FnMut(Item<Record>)) -> Result<(), RunError> {
        let reading = Reading::of(input, &self.plan)?;
        let mut stages = StageSeconds::default();
        let mut read = 0.0;
        for object in reading.objects() {
            let object = object?;
            let record = object.record();
            input.control.check()?;
            stages = stages.plus(&record.measured.timings);
            read = record.read_seconds.unwrap_or_default();
            out(Item::Row(record));
            #[cfg(feature = "pictures")]
            if let Some(pictures) = &self.pictures {
                pictures.draw(input, &object, out);
            }
        }
        self.tell_timings(input, [read, 0.0], &stages);
        Ok(())
    }

    /// Measures while slices go by, in bounded memory.
    fn of_stream(&self, input: &Opened, out: &mut dyn FnMut(Item<Record>)) -> Result<(), RunError> {
        let Opened { name, source, control, .. } = input;
        let files = FileStamps::of(&**source);
        let table = source.label_table();
        let asked = Asked::of(&self.plan, &table)?;
        input.lacks(asked.missing)?;
        let mut slabs = Watched { slabs: source.slabs()?, input: name, control };
        let streamed = self.plan.measurement.run_slabs_under(control, &mut slabs, &asked.labels, |at| {
            control.tell(&Event::Slices {
                input: name,
                done: at.slices,
                of: at.of_slices,
                labels: at.labels,
            });
        });
        let streamed = streamed.map_err(|error| match error {
            StreamError::Measure(MeasureError::Volume(error)) => with_name(error, &table),
            error => error.into(),
        })?;
        control.check()?;
        input.lacks(streamed.missing.into_iter().map(|error| with_name(error, &table)))?;
        let file = crate::volume::SlabReader::file_time(&slabs).as_secs_f64();
        let read = streamed.source_seconds + streamed.encode_seconds;
        let mut results = streamed.results;
        self.explain(input, &mut results)?;
        if files != FileStamps::of(&**source) {
            return Err(RunError::Changed);
        }
        let stages = results.iter().fold(StageSeconds::default(), |sum, (_, m)| sum.plus(&m.timings));
        self.tell_timings(input, [file, read - file], &stages);
        let (mut flags, truth) = (source.flags(), source.truth());
        let boxes = results.iter().map(|(_, m)| (m.voxels.count, m.voxels.box_voxels() as u64));
        flags.extend(grey_values(results.len(), look_grey(boxes)));
        let preparations = source.preparations();
        let record = |(label, mut measured): (LabelGroup, Measured)| {
            let preparation = preparations.as_ref().map(|all| all.of(Some(&label)));
            measured.flags.splice(0..0, flags.iter().cloned().chain(prepared_flags(preparation)));
            Record {
                truth,
                preparation,
                input_sha256: input.fingerprint.text(),
                read_seconds: Some(read),
                ..Record::of_label(name, &table, label, measured)
            }
        };
        // One after the other, for there may be a hundred thousand.
        for result in results {
            out(Item::Row(record(result)));
        }
        Ok(())
    }

    /// Where the blur loses detail, or voxels and mesh disagree, the input is read again: to measure the object in the
    /// embedding that gives it back, and to see why.
    fn explain(&self, input: &Opened, results: &mut [(LabelGroup, Measured)]) -> Result<(), RunError> {
        let wanted: Vec<bool> =
            results.iter_mut().map(|(_, measured)| self.plan.wants_whole(measured)).collect();
        if !wanted.contains(&true) {
            return Ok(());
        }
        let start = Instant::now();
        let reading = Reading::of(input, &self.plan)?;
        let read_again = start.elapsed().as_secs_f64();
        let (of, done) = (wanted.iter().filter(|wanted| **wanted).count(), AtomicUsize::new(0));
        let numbered = results.par_iter_mut().enumerate().filter(|(number, _)| wanted[*number]);
        numbered.try_for_each(|(number, (_, measured))| {
            *measured = reading.looked_again(number, measured.clone())?;
            let number = done.fetch_add(1, Ordering::Relaxed) + 1;
            input.control.tell(&Event::Object { input: input.name, number, of });
            Ok::<(), RunError>(())
        })?;
        if let Some(first) = wanted.iter().position(|&wanted| wanted) {
            results[first].1.timings.read_again = read_again;
        }
        Ok(())
    }

    fn tell_timings(&self, input: &Opened, [read, decode]: [f64; 2], stages: &StageSeconds) {
        if !self.timings {
            return;
        }
        let stages = [("read", read), ("decode", decode)].into_iter().chain(stages.named());
        let stages: Vec<String> = stages.map(|(name, seconds)| format!("{name} {seconds:.3}")).collect();
        let text = format!("seconds: {}", stages.join(", "));
        input.control.tell(&Event::Note { input: input.name, text: &text });
    }
}

/// The records of one input.
///
/// ```
/// use surfometry::runs::{Plan, records_of};
/// let records = records_of("phantom:ball?radius=8", &Plan::default())?;
/// assert_eq!(records[0].measured.euler_characteristic, Some(2.0));
/// # Ok::<(), surfometry::runs::RunError>(())
/// ```
///
/// # Errors
/// [`RunError`].
pub fn records_of(input: &str, plan: &Plan) -> Result<Vec<Record>, RunError> {
    plan.check()?;
    let (source, control) = (open(input, &plan.open)?, Control::default());
    let input = Opened::new(input, None, source, &control);
    let task = MeasureTask { plan: plan.clone(), ..MeasureTask::default() };
    let mut records = Vec::new();
    task.run(&input, &mut |item| {
        if let Item::Row(record) = item {
            records.push(record);
        }
    })?;
    Ok(records)
}
