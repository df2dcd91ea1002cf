//! Voxels of a band with their derivatives, a column a number.

use super::Jet;

/// A voxel of the band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandVoxel {
    /// Image index.
    pub index: [i64; 3],
    /// The field and its derivatives there.
    pub jet: Jet,
}

/// Some voxels of a band. Kept by columns, so that curvature is computed for many at once.
#[derive(Debug, Clone)]
pub struct BandVoxels {
    pub(crate) indices: Vec<[i64; 3]>,
    /// A jet's ten numbers; the unused end of each is of no meaning.
    pub(crate) columns: [Vec<f64>; 10],
}

impl BandVoxels {
    /// Voxels that are handed on together: their columns stay in the processor's nearest caches.
    pub(crate) const CAPACITY: usize = 256;

    /// None, and room for the capacity.
    pub(crate) fn new() -> Self {
        Self {
            indices: Vec::with_capacity(Self::CAPACITY),
            columns: std::array::from_fn(|_| vec![0.0; Self::CAPACITY]),
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// One by one.
    pub fn iter(&self) -> impl Iterator<Item = BandVoxel> + '_ {
        self.indices.iter().enumerate().map(|(n, &index)| {
            let number = |column: usize| self.columns[column][n];
            let jet = Jet {
                value: number(0),
                gradient: std::array::from_fn(|a| number(1 + a)),
                hessian: std::array::from_fn(|a| number(4 + a)),
            };
            BandVoxel { index, jet }
        })
    }

    /// Adds one; hands all on and starts again where that fills it.
    pub(crate) fn push(
        &mut self,
        index: [i64; 3],
        numbers: impl Fn(usize) -> f64,
        visit: &mut dyn FnMut(&Self),
    ) {
        let n = self.indices.len();
        for (number, column) in self.columns.iter_mut().enumerate() {
            column[n] = numbers(number);
        }
        self.indices.push(index);
        if self.indices.len() == Self::CAPACITY {
            self.flush(visit);
        }
    }

    /// Adds one by its jet.
    pub(crate) fn push_jet(&mut self, index: [i64; 3], jet: &Jet, visit: &mut dyn FnMut(&Self)) {
        let number = |n: usize| match n {
            0 => jet.value,
            1..4 => jet.gradient[n - 1],
            _ => jet.hessian[n - 4],
        };
        self.push(index, number, visit);
    }

    /// Hands on what is left.
    pub(crate) fn flush(&mut self, visit: &mut dyn FnMut(&Self)) {
        if !self.is_empty() {
            visit(self);
            self.indices.clear();
        }
    }
}
