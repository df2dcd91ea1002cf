//! What is blurred.

use crate::tiling::IndexBox;
use crate::volume::{Grid, Mask};
use std::fmt::Debug;

/// An object as a number at every voxel of a grid: 1 inside, 0 outside, and near the surface, where more is
/// known than that, whatever is known.
///
/// It is all that a blur needs to know: [`GaussianEmbedding`](super::GaussianEmbedding), its derivatives, its
/// mesh and its band work on any indicator. A row is told as runs of ones, which a blur takes by their ends,
/// and other amounts, which it takes one by one.
///
/// ```
/// use surfometry::embedding::{Embedding, GaussianEmbedding, Indicator, Row, TRUNCATION};
/// use surfometry::tiling::IndexBox;
/// use surfometry::volume::Grid;
///
/// /// A slab between two planes of voxels, the upper of which it half fills.
/// #[derive(Debug)]
/// struct Slab(Grid);
///
/// impl Indicator for Slab {
///     fn grid(&self) -> &Grid {
///         &self.0
///     }
///
///     fn bounds(&self) -> IndexBox {
///         self.0.index_box()
///     }
///
///     fn uniform_in(&self, region: &IndexBox) -> Option<bool> {
///         let outside = region.intersection(&self.bounds()).is_empty();
///         outside.then_some(false)
///     }
///
///     fn read_row(&self, y: i64, z: i64, row: &mut Row) {
///         let [nx, ny, nz] = self.0.dimensions().map(|n| n as i64);
///         if !(0..ny).contains(&y) || !(0..nz).contains(&z) {
///             return;
///         }
///         if z < nz - 1 {
///             row.add_run(0, nx);
///         } else {
///             (0..nx).for_each(|x| row.add_amount(x, 0.5));
///         }
///     }
/// }
///
/// let slab = Slab(Grid::axis_aligned([40, 40, 21], [1.0; 3])?);
/// let embedding = GaussianEmbedding::new(&slab, 2.0, 0.5, TRUNCATION);
/// // The surface is in the middle of the half-filled voxels.
/// let phi = embedding.evaluate(&IndexBox::voxel([20, 20, 20]), 0.5);
/// assert!(phi.get([20, 20, 20]).abs() < 1e-3);
/// # Ok::<(), surfometry::volume::VolumeError>(())
/// ```
pub trait Indicator: Debug + Sync {
    /// The lattice of the image.
    fn grid(&self) -> &Grid;

    /// A box outside which it is 0.
    fn bounds(&self) -> IndexBox;

    /// `Some` where it is known to be 0, or 1, at every voxel of a box, so that nothing there needs to be
    /// computed.
    fn uniform_in(&self, region: &IndexBox) -> Option<bool>;

    /// Adds what the row at y, z holds within its [span](Row::span). Any row may be asked for.
    fn read_row(&self, y: i64, z: i64, row: &mut Row);
}

/// A part of a row of voxels: the sum of runs of ones and of amounts at voxels.
#[derive(Debug, Default)]
pub struct Row {
    span: (i64, i64),
    /// Where the runs start and end, in turn.
    edges: Vec<i64>,
    /// One a voxel of the span; empty where there are none.
    amounts: Vec<f32>,
}

impl Row {
    /// The voxels that are asked for, from the first up to, not including, the second.
    pub fn span(&self) -> (i64, i64) {
        self.span
    }

    /// Adds ones from `start` up to, not including, `end`, as far as they lie in the span. Runs come in
    /// ascending order.
    pub fn add_run(&mut self, start: i64, end: i64) {
        let (start, end) = (start.max(self.span.0), end.min(self.span.1));
        if start < end {
            self.edges.extend([start, end]);
        }
    }

    /// Adds an amount at a voxel, where that lies in the span.
    pub fn add_amount(&mut self, x: i64, amount: f32) {
        let (start, end) = self.span;
        if (start..end).contains(&x) && amount != 0.0 {
            self.amounts.resize((end - start) as usize, 0.0);
            self.amounts[(x - start) as usize] += amount;
        }
    }

    /// Starts another row.
    pub(super) fn clear(&mut self, span: (i64, i64)) {
        self.span = span;
        self.edges.clear();
        self.amounts.clear();
    }

    pub(super) fn edges(&self) -> &[i64] {
        &self.edges
    }

    pub(super) fn runs(&self) -> impl Iterator<Item = (i64, i64)> + '_ {
        self.edges.chunks_exact(2).map(|run| (run[0], run[1]))
    }

    pub(super) fn amounts(&self) -> &[f32] {
        &self.amounts
    }

    /// `Some` where all of the span is 0 or 1.
    pub(super) fn uniform(&self) -> Option<bool> {
        match (self.edges.as_slice(), self.amounts.is_empty()) {
            ([], true) => Some(false),
            (&[start, end], true) if (start, end) == self.span => Some(true),
            _ => None,
        }
    }
}

impl Indicator for Mask {
    fn grid(&self) -> &Grid {
        self.grid()
    }

    fn bounds(&self) -> IndexBox {
        self.bounds()
    }

    fn uniform_in(&self, region: &IndexBox) -> Option<bool> {
        self.uniform_in(region)
    }

    fn read_row(&self, y: i64, z: i64, row: &mut Row) {
        for (start, end) in self.runs_within(y, z, row.span()) {
            row.add_run(start, end);
        }
    }
}
