//! An image that no process sees as a whole: it is measured block by block, anywhere, and what the blocks say is merged.

use super::called::Asked;
use super::reading::Reading;
use super::{Plan, Record, RunError};
use crate::Control;
use crate::measurement::{BoxShare, PartialMeasurement};
use crate::tiling::IndexBox;
use crate::volume::{Grid, LabelBlock, LabelGroup, LabelTable};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// An image that is measured block by block. The records are those of [`MeasureTask`](super::MeasureTask), bit by bit,
/// times apart.
///
/// First every block gives a [`PartialMeasurement`] of itself and what lies around it; all of these are merged, in any
/// order, and give the records. Of some objects more is wanted than blocks know: those are named, and looked at again
/// by whoever has the voxels in the box around them.
///
/// ```
/// use surfometry::runs::{Blockwise, Plan};
/// use surfometry::tiling::IndexBox;
/// use surfometry::volume::{Grid, LabelBlock};
/// use surfometry::Control;
/// let grid = Grid::axis_aligned([24, 24, 24], [1.0; 3])?;
/// let ball = |v: [usize; 3]| (0..3).map(|a| v[a].abs_diff(12).pow(2)).sum::<usize>() < 81;
/// let voxels: Vec<u8> = (0..grid.voxel_count()).map(|n| u8::from(ball(grid.index_of(n)))).collect();
/// let run = Blockwise::new(Plan::default(), grid, "ball", Default::default())?;
/// let region = IndexBox::new([0, 0, 0], [24, 24, 24]);
/// let block = LabelBlock::from_voxels(grid, run.share(region)?.needed, &voxels)?;
/// let found = run.records(&run.partial(&block, region, &Control::default())?)?;
/// assert_eq!(found[0].record.measured.euler_characteristic, Some(2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Blockwise {
    plan: Plan,
    grid: Grid,
    name: String,
    names: LabelTable,
}

/// What blocks know of an object.
#[derive(Debug, Clone)]
pub struct BlockRecord {
    /// Its record, without where topology changes.
    pub record: Record,
    /// Whether it is to be looked at as a whole: see [`Blockwise::looked_again`].
    pub wants_whole: bool,
}

impl Blockwise {
    /// Of an image with a lattice and a name.
    ///
    /// # Errors
    /// [`RunError`] for choices that ask for more than blocks can tell.
    pub fn new(
        plan: Plan,
        grid: Grid,
        name: &str,
        label_names: BTreeMap<i64, String>,
    ) -> Result<Self, RunError> {
        if plan.needs_all() {
            return Err(RunError::Unfit(
                "block by block only labels are measured, each as one object and all with one sigma and thickness: leave \
                 pieces, fields, soft segmentations, lengths of labels of their own, regions and interfaces out, or measure the image as a whole",
            ));
        }
        let names = label_names.into_iter().collect::<LabelTable>().overlaid(&plan.open.names);
        let Asked { labels, missing, .. } = Asked::of(&plan, &names)?;
        missing.into_iter().next().map_or(Ok(()), Err)?;
        let plan = Plan { labels, ..plan };
        let run = Self { plan, grid, name: name.to_owned(), names };
        run.share(IndexBox::EMPTY)?;
        Ok(run)
    }

    /// What a block covers, and the voxels that must be known for it.
    ///
    /// # Errors
    /// As of [`Measurement::share`](crate::Measurement::share).
    pub fn share(&self, region: IndexBox) -> Result<BoxShare, RunError> {
        Ok(self.plan.measurement.share(&self.grid, region)?)
    }

    /// What a block adds.
    ///
    /// # Errors
    /// As of [`Measurement::measure_box`](crate::Measurement::measure_box); a stop.
    pub fn partial(
        &self,
        block: &LabelBlock,
        region: IndexBox,
        control: &Control,
    ) -> Result<PartialMeasurement, RunError> {
        control.check()?;
        Ok(self.plan.measurement.measure_box(block, region, &self.plan.labels)?)
    }

    /// The value of no block.
    ///
    /// # Errors
    /// As of [`PartialMeasurement::new`].
    pub fn nothing(&self) -> Result<PartialMeasurement, RunError> {
        Ok(PartialMeasurement::new(&self.plan.measurement, self.grid, &self.plan.labels)?)
    }

    /// The objects, in order of selection or of label.
    ///
    /// # Errors
    /// As of [`PartialMeasurement::results`].
    pub fn records(&self, all: &PartialMeasurement) -> Result<Vec<BlockRecord>, RunError> {
        let found = all.results()?.into_iter().map(|(label, mut measured)| BlockRecord {
            wants_whole: self.plan.wants_whole(&mut measured),
            record: Record::of_label(&self.name, &self.names, label, measured),
        });
        Ok(found.collect())
    }

    /// Records of objects all of whose voxels are in a block, now that they are known as wholes.
    ///
    /// # Errors
    /// [`RunError`] of the measurement; a stop.
    pub fn looked_again(
        &self,
        records: Vec<Record>,
        block: &LabelBlock,
        control: &Control,
    ) -> Result<Vec<Record>, RunError> {
        let groups: Vec<LabelGroup> = records.iter().filter_map(|record| record.label.clone()).collect();
        let reading = Reading::of_part(&self.name, &self.plan, control, block.image().clone(), groups);
        let again = |(number, record): (usize, Record)| {
            let measured = reading.looked_again(number, record.measured)?;
            Ok(Record { seconds: measured.timings.integrals, measured, ..record })
        };
        records.into_par_iter().enumerate().map(again).collect()
    }
}
