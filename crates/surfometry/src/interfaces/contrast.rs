//! Two labels against each other, as something that can be blurred.

use crate::embedding::{Indicator, Row};
use crate::tiling::IndexBox;
use crate::volume::{Grid, LabelImage};
use std::collections::BTreeMap;

/// An amount by label; 0 for background.
#[derive(Debug)]
pub(crate) struct Contrast<'a> {
    image: &'a LabelImage,
    amounts: BTreeMap<i64, f32>,
    of_others: f32,
}

impl<'a> Contrast<'a> {
    /// Some labels' own amounts, and that of all others but background.
    pub(crate) fn new(
        image: &'a LabelImage,
        own: impl IntoIterator<Item = (i64, f32)>,
        of_others: f32,
    ) -> Self {
        Self { image, amounts: own.into_iter().collect(), of_others }
    }
}

impl Indicator for Contrast<'_> {
    fn grid(&self) -> &Grid {
        self.image.grid()
    }

    fn bounds(&self) -> IndexBox {
        self.image.grid().index_box()
    }

    fn uniform_in(&self, region: &IndexBox) -> Option<bool> {
        region.intersection(&self.bounds()).is_empty().then_some(false)
    }

    fn read_row(&self, y: i64, z: i64, row: &mut Row) {
        let [_, ny, nz] = self.grid().dimensions().map(|n| n as i64);
        if !(0..ny).contains(&y) || !(0..nz).contains(&z) {
            return;
        }
        let (start, end) = row.span();
        for (run, label) in self.image.labelled_runs(y as usize, z as usize) {
            let amount = self.amounts.get(&label).copied().unwrap_or(self.of_others);
            for x in start.max(run.start as i64)..end.min(run.end as i64) {
                row.add_amount(x, amount);
            }
        }
    }
}
