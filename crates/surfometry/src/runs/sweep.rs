//! The same objects over a range of a parameter, from one reading.

use super::{Failure, FileLedger, Item, MapStyle, Opened, Plan, Reading, Record, RunError, SweepChart, Task};
use super::{Row, write_map_files, write_sweep_chart};
use crate::Choice;
use crate::choice::choices;
use crate::inputs::with_parts;
use crate::measurement::{Measurement, Parameters};
use crate::pictures::{PictureStyle, color_scale, significant};
use std::path::{Path, PathBuf};

/// What is swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SweptParameter {
    /// The blur, mm.
    #[default]
    Sigma,
    /// The band's thickness, mm.
    Thickness,
    /// The level.
    Level,
}

choices!(SweptParameter, "swept parameter": {
    Sigma = "sigma": "the blur, mm",
    Thickness = "thickness": "the band's thickness, mm",
    Level = "level": "the level of the blurred mask that is the surface",
});

impl SweptParameter {
    /// A measurement with another value of it.
    #[must_use]
    pub fn set(self, measurement: Measurement, value: f64) -> Measurement {
        match self {
            Self::Sigma => measurement.sigma_mm(value),
            Self::Thickness => measurement.thickness_mm(value),
            Self::Level => measurement.level(value),
        }
    }

    /// Its value in a record's parameters.
    pub fn of(self, parameters: &Parameters) -> Option<f64> {
        match self {
            Self::Sigma => parameters.sigma_mm,
            Self::Thickness => Some(parameters.thickness_mm),
            Self::Level => parameters.level,
        }
    }

    /// Its short name with unit, over a column of a table.
    pub fn heading(self) -> &'static str {
        match self {
            Self::Sigma => "sigma mm",
            Self::Thickness => "t mm",
            Self::Level => "level",
        }
    }

    /// Its name with unit, along an axis.
    pub fn axis(self) -> &'static str {
        match self {
            Self::Sigma => "sigma (mm)",
            Self::Thickness => "thickness t (mm)",
            Self::Level => "level",
        }
    }
}

/// Measures every selected object of an input at each of some values of a parameter; records object by
/// object, each over the values.
///
/// ```
/// use surfometry::{Control, runs::{Batch, Collected, FileLedger, Plan, SweepTask, SweptParameter}};
/// let (inputs, control) = (["phantom:ball?radius=8".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let task = SweepTask {
///     plan: Plan { recover: false, ..Plan::default() },
///     over: SweptParameter::Sigma,
///     values: vec![1.5, 2.0],
///     chart: None,
///     surfaces: None,
///     ledger: FileLedger::new(&inputs),
/// };
/// task.check().expect("nothing contradicts itself");
/// let mut found = Collected::default();
/// batch.run(&task, &mut found)?;
/// // The larger blur leaves the smaller ball.
/// let blurred: Vec<_> = found.results.iter().map(|record| record.measured.blurred.volume_mm3).collect();
/// assert!(blurred[1] < blurred[0]);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct SweepTask {
    /// What is asked beside.
    pub plan: Plan,
    /// What is swept.
    pub over: SweptParameter,
    /// Its values.
    pub values: Vec<f64>,
    /// A chart of each object.
    pub chart: Option<SweepChart>,
    /// Pictures of the surfaces along the way.
    pub surfaces: Option<SweptSurfaces>,
    /// The files of the run.
    pub ledger: FileLedger,
}

/// Pictures of surfaces at some of the values, all in the colours of the first.
#[derive(Debug)]
pub struct SweptSurfaces {
    /// The file; the value, such as `_sigma-2`, goes before its ending.
    pub path: PathBuf,
    /// At how many values, evenly.
    pub count: usize,
    /// How they are made.
    pub style: MapStyle,
}

impl Task for SweepTask {
    type Row = Record;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<Record>)) -> Result<(), RunError> {
        input.begin_hashing();
        let reading = Reading::of(input, &self.plan)?;
        let mut records = Vec::new();
        for &value in &self.values {
            match self.at(&reading, value) {
                Ok(found) => records.extend(found),
                // A value that makes no sense leaves the others.
                Err(error @ RunError::Measure(_)) => {
                    let text = format!("{} {}: {error}", self.over.heading(), significant(value, 6));
                    input.fail(Failure::new(input.name, &text), out);
                }
                Err(error) => return Err(error),
            }
        }
        // Object by object, each over the range.
        let place = |record: &Record| record.label.as_ref().map(|label| label.labels().to_vec());
        records.sort_by_key(|record| (place(record), record.component));
        self.draw_charts(input, &reading, &records, out);
        if let Some(surfaces) = &self.surfaces {
            self.draw_surfaces(input, &reading, surfaces, out)?;
        }
        for record in records {
            out(Item::Row(record));
        }
        Ok(())
    }
}

impl SweepTask {
    /// Refuses values that contradict the plan, and measures that no record has, whatever the input.
    ///
    /// # Errors
    /// [`RunError::Measure`], [`RunError::NoMeasure`].
    pub fn check(&self) -> Result<(), RunError> {
        for &value in &self.values {
            self.plan_at(value).check()?;
        }
        let mut names: Vec<String> = self.values.iter().map(|&value| significant(value, 6)).collect();
        names.dedup();
        if self.surfaces.is_some() && names.len() < self.values.len() {
            return Err(RunError::Unfit(
                "values so close have the same six digits, by which their pictures are named: take fewer, or a wider range",
            ));
        }
        let columns = Record::columns();
        let asked = self.chart.iter().flat_map(|chart| &chart.measures);
        match asked.into_iter().find(|name| !columns.contains(name)) {
            Some(name) => Err(RunError::NoMeasure(name.clone())),
            None => Ok(()),
        }
    }

    fn plan_at(&self, value: f64) -> Plan {
        Plan { measurement: self.over.set(self.plan.measurement, value), ..self.plan.clone() }
    }

    fn at(&self, reading: &Reading, value: f64) -> Result<Vec<Record>, RunError> {
        let plan = self.plan_at(value);
        reading.objects_of(&plan).map(|object| Ok(object?.record())).collect()
    }

    fn draw_charts(
        &self,
        input: &Opened,
        reading: &Reading,
        records: &[Record],
        out: &mut dyn FnMut(Item<Record>),
    ) {
        let Some(chart) = &self.chart else { return };
        let path = with_parts(&chart.path, input.part.as_slice());
        let objects: Vec<&[Record]> = records.chunk_by(|a, b| a.label == b.label).collect();
        for object in &objects {
            let part = object[0].label.as_ref().and_then(|label| reading.file_part(label));
            let path = with_parts(&path, part.as_slice());
            if let Err(error) = write_sweep_chart(object, self.over, chart, &path, &self.ledger) {
                input.fail(Failure::new(input.name, &format!("no chart: {error}")), out);
            }
        }
    }

    fn draw_surfaces(
        &self,
        input: &Opened,
        reading: &Reading,
        surfaces: &SweptSurfaces,
        out: &mut dyn FnMut(Item<Record>),
    ) -> Result<(), RunError> {
        let path = with_parts(&surfaces.path, input.part.as_slice());
        let mut style = surfaces.style.clone();
        let count = surfaces.count.min(self.values.len());
        for n in 0..count {
            let value = self.values[(n * (self.values.len() - 1)).div_ceil((count - 1).max(1))];
            let part = format!("{}-{}", self.over.word(), significant(value, 6));
            let path = with_parts(&path, &[part]);
            if let Err(error) = self.draw_surfaces_at(reading, value, &path, &mut style) {
                if error.is_stop() {
                    return Err(error);
                }
                input.fail(Failure::new(input.name, &format!("no pictures of it: {error}")), out);
                return Ok(());
            }
        }
        Ok(())
    }

    fn draw_surfaces_at(
        &self,
        reading: &Reading,
        value: f64,
        path: &Path,
        style: &mut MapStyle,
    ) -> Result<(), RunError> {
        let plan = self.plan_at(value);
        for object in reading.objects_of(&plan) {
            let object = object?;
            let PictureStyle { quantity, limit, .. } = style.picture;
            let [_, most] = color_scale(object.surface(), quantity, limit).limits();
            style.picture.limit = Some(most);
            write_map_files(&object, path, style, &self.ledger)?;
        }
        Ok(())
    }
}
