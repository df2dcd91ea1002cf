//! A soft segmentation as an indicator.

use super::{Indicator, Row};
use crate::tiling::IndexBox;
use crate::volume::{Grid, ProbabilityImage};

impl Indicator for ProbabilityImage {
    fn grid(&self) -> &Grid {
        self.grid()
    }

    fn bounds(&self) -> IndexBox {
        self.bounds()
    }

    fn uniform_in(&self, region: &IndexBox) -> Option<bool> {
        let inner = region.intersection(&self.bounds());
        if inner.is_empty() {
            return Some(false);
        }
        let (first, last) = ((inner.lower[0] - self.bounds().lower[0]) as usize, inner.extent()[0]);
        let value = self.row(inner.lower[1], inner.lower[2])[first];
        let known = value == 0.0 || (value == 1.0 && inner == *region);
        let alike = |(y, z)| self.row(y, z)[first..][..last].iter().all(|&v| v == value);
        (known && inner.rows().all(alike)).then_some(value == 1.0)
    }

    /// Ones as runs, so that an image of zeros and ones is blurred to the bits that its mask is.
    fn read_row(&self, y: i64, z: i64, row: &mut Row) {
        let (start, end) = row.span();
        let first = self.bounds().lower[0];
        let values = self.row(y, z);
        let place = |x: i64| (x - first).clamp(0, values.len() as i64) as usize;
        let (mut at, end) = (place(start), place(end));
        while at < end {
            let x = first + at as i64;
            let ones = values[at..end].iter().take_while(|&&v| v == 1.0).count();
            if ones > 0 {
                row.add_run(x, x + ones as i64);
                at += ones;
            } else {
                row.add_amount(x, values[at]);
                at += 1;
            }
        }
    }
}
