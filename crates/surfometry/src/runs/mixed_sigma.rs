//! Whether automatic blurs of one run differ.

use super::{Failure, Record, Sink};
use crate::measurement::DescribedSurface;
use std::io;

/// Hands records on, and minds the range of their blurs where numbers are those of the blurred surface: an automatic sigma
/// follows the spacing, and such numbers of images that differ in it are not comparable.
pub struct SigmaRange<'a> {
    inner: &'a mut dyn Sink<Record>,
    low: f64,
    high: f64,
}

impl<'a> SigmaRange<'a> {
    /// In front of a sink.
    pub fn new(inner: &'a mut dyn Sink<Record>) -> Self {
        Self { inner, low: f64::INFINITY, high: 0.0 }
    }

    /// The least and the largest sigma, mm, where they differ.
    pub fn differing(&self) -> Option<[f64; 2]> {
        // Spacings written in f32 differ in the seventh digit.
        (self.low < self.high * (1.0 - 1e-5)).then_some([self.low, self.high])
    }
}

impl Sink<Record> for SigmaRange<'_> {
    fn row(&mut self, row: Record) -> io::Result<()> {
        let blurred = row.measured.surface == DescribedSurface::Blurred;
        if let Some(sigma) = row.measured.parameters.sigma_mm.filter(|_| blurred) {
            (self.low, self.high) = (self.low.min(sigma), self.high.max(sigma));
        }
        self.inner.row(row)
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.inner.failure(failure)
    }

    fn input_ends(&mut self) -> io::Result<()> {
        self.inner.input_ends()
    }
}
