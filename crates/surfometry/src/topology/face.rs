//! Components on a rectangle of voxels, by runs.

use super::frame::Rectangle;
use serde::{Deserialize, Serialize};

/// What is numbered: the background's components apart from the foreground's.
pub(super) type Kind = usize;
pub(super) const BACKGROUND: Kind = 0;
pub(super) const FOREGROUND: Kind = 1;

/// Neighbours of one component along a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Span {
    pub(super) length: u32,
    pub(super) component: u32,
}

/// Rows of a rectangle that are alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Band {
    rows: u32,
    spans: u32,
}

/// The components on a rectangle. In a row background and foreground alternate; it begins with background, of
/// length 0 where there is none.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Face {
    bands: Vec<Band>,
    spans: Vec<Span>,
}

impl Face {
    /// A rectangle of background.
    pub(super) fn background(rectangle: &Rectangle, component: u32) -> Self {
        let [length, rows] = rectangle.extent();
        Self { bands: vec![Band { rows, spans: 1 }], spans: vec![Span { length, component }] }
    }

    /// Adds rows behind those that are there.
    pub(super) fn push(&mut self, rows: u32, spans: &[Span]) {
        let last = self.bands.last_mut().filter(|band| band.spans as usize == spans.len());
        if let Some(band) = last.filter(|_| self.spans.ends_with(spans)) {
            band.rows += rows;
        } else {
            self.bands.push(Band { rows, spans: spans.len() as u32 });
            self.spans.extend_from_slice(spans);
        }
    }

    /// Adds another's rows behind its own.
    pub(super) fn append(&mut self, other: &Self) {
        other.bands().for_each(|(rows, spans)| self.push(rows, spans));
    }

    /// Rows that are alike, how many and what they hold.
    fn bands(&self) -> impl Iterator<Item = (u32, &[Span])> {
        let mut rest = &self.spans[..];
        self.bands.iter().map(move |band| {
            let (spans, others) = rest.split_at(band.spans as usize);
            rest = others;
            (band.rows, spans)
        })
    }

    /// Whether there is more than background on it.
    pub(super) fn has_foreground(&self) -> bool {
        self.bands.iter().any(|band| band.spans > 1)
    }

    /// The component of every span that has voxels, to be renumbered.
    pub(super) fn for_each_component(&mut self, mut f: impl FnMut(Kind, &mut u32)) {
        let mut rest = &mut self.spans[..];
        for band in &self.bands {
            let (spans, others) = rest.split_at_mut(band.spans as usize);
            for (place, span) in spans.iter_mut().enumerate().filter(|(_, span)| span.length > 0) {
                f(place % 2, &mut span.component);
            }
            rest = others;
        }
    }

    /// Tells what two faces in one plane call the components that they share.
    pub(super) fn for_each_shared(
        [a, b]: [&Self; 2],
        [Rectangle([along_a, across_a]), Rectangle([along_b, across_b])]: [Rectangle; 2],
        mut f: impl FnMut(Kind, u32, u32),
    ) {
        for_each_overlap((across_a[0], a.bands()), (across_b[0], b.bands()), |spans_a, spans_b| {
            for_each_overlap((along_a[0], kinds(spans_a)), (along_b[0], kinds(spans_b)), |a, b| {
                if a.0 == b.0 {
                    f(a.0, a.1, b.1);
                }
            });
        });
    }

    /// Whether it fills a rectangle with components of which there are so many, besides the outside.
    pub(super) fn is_valid(&self, rectangle: &Rectangle, components: [u32; 2]) -> bool {
        let [width, height] = rectangle.extent().map(u64::from);
        let total = |lengths: &mut dyn Iterator<Item = u32>| lengths.map(u64::from).sum::<u64>();
        let counted = self.bands.iter().try_fold(0usize, |n, band| n.checked_add(band.spans as usize));
        counted == Some(self.spans.len())
            && total(&mut self.bands.iter().map(|band| band.rows)) == height
            && self.bands().all(|(_, spans)| {
                total(&mut spans.iter().map(|span| span.length)) == width
                    && kinds(spans).all(|(_, (kind, component))| match kind {
                        BACKGROUND => component <= components[BACKGROUND],
                        _ => component < components[FOREGROUND],
                    })
            })
    }
}

/// Length, kind and component of a row's spans.
fn kinds(spans: &[Span]) -> impl Iterator<Item = (u32, (Kind, u32))> {
    spans.iter().enumerate().map(|(place, span)| (span.length, (place % 2, span.component)))
}

/// Visits what overlaps of two sequences of pieces, of each of which the start and the pieces' lengths are
/// given.
fn for_each_overlap<A: Copy, B: Copy>(
    (start_a, a): (i64, impl Iterator<Item = (u32, A)>),
    (start_b, b): (i64, impl Iterator<Item = (u32, B)>),
    mut f: impl FnMut(A, B),
) {
    let (mut a, mut b) = (placed(start_a, a), placed(start_b, b));
    let (mut next_a, mut next_b) = (a.next(), b.next());
    while let (Some(([from_a, to_a], piece_a)), Some(([from_b, to_b], piece_b))) = (next_a, next_b) {
        if from_a.max(from_b) < to_a.min(to_b) {
            f(piece_a, piece_b);
        }
        if to_a < to_b { next_a = a.next() } else { next_b = b.next() }
    }
}

/// The ends of pieces that follow each other.
fn placed<T>(start: i64, pieces: impl Iterator<Item = (u32, T)>) -> impl Iterator<Item = ([i64; 2], T)> {
    pieces.scan(start, |end, (length, piece)| {
        let from = std::mem::replace(end, *end + i64::from(length));
        Some(([from, *end], piece))
    })
}
