//! The components of an object and of the background within one box of its image, as the box's faces show
//! them.

use super::ComponentLabels;
use super::components::{Connectivity, Run};
use super::euler::EulerNumbers;
use super::face::{BACKGROUND, FOREGROUND, Face, Span};
use super::frame::{Frame, Rectangle, axes_across};
use super::numbering::{Joining, Numbering, OUTSIDE, shifted};
use crate::tiling::IndexBox;
use crate::volume::Mask;
use rayon::prelude::*;
use std::ops::Range;

/// Slices that are labelled at a time: few enough to share a layer of tiles among threads, and many against
/// the one that is labelled twice.
const SLICES: usize = 16;

/// The faces of a box, by axis and side; empty where the image ends.
pub(super) type Faces = [[Face; 2]; 3];

/// What is counted in a box.
#[derive(Default)]
pub(super) struct LabelledBox {
    pub(super) euler: EulerNumbers,
    /// Components of background and foreground that the faces do not show.
    pub(super) closed: [u64; 2],
    /// Components of background, besides the outside, and of foreground that they show.
    pub(super) shown: [u32; 2],
    pub(super) faces: Faces,
}

impl LabelledBox {
    /// Of the part of an object that a box sees.
    pub(super) fn of(mask: &Mask, frame: &Frame) -> Self {
        let seen = frame.seen();
        let region = mask.bounds().intersection(&seen).grown([1; 3]).intersection(&seen);
        let (lower, upper) = (region.lower[2], region.upper[2]);
        let starts: Vec<i64> = (lower..upper).step_by(SLICES).collect();
        let part = |&start: &i64| {
            Part { mask, frame, region, slices: start..(start + SLICES as i64).min(upper) }.labelled()
        };
        let parts: Vec<Self> = starts.par_iter().map(part).collect();
        Self::stacked(parts)
    }

    /// Of the parts of a box that follow each other along z.
    fn stacked(mut parts: Vec<Self>) -> Self {
        if parts.len() <= 1 {
            return parts.pop().unwrap_or_default();
        }
        let mut joining = Joining::new();
        for part in &mut parts {
            let offsets = joining.add(part.shown);
            for_each_component(&mut part.faces, |kind, component| {
                *component = shifted(kind, *component, offsets);
            });
        }
        for pair in parts.windows(2) {
            let slices = [&pair[0].faces[2][1], &pair[1].faces[2][0]];
            Face::for_each_shared(slices, [Rectangle([[0; 2]; 2]); 2], |kind, a, b| joining.join(kind, a, b));
        }
        let mut whole = Self::default();
        let last = parts.len() - 1;
        for (number, part) in parts.into_iter().enumerate() {
            whole.euler.merge(&part.euler);
            for kind in [BACKGROUND, FOREGROUND] {
                whole.closed[kind] += part.closed[kind];
            }
            let [x, y, [lower, upper]] = part.faces;
            let sides = whole.faces[..2].as_flattened_mut().iter_mut();
            sides.zip([x, y].as_flattened()).for_each(|(all, more)| all.append(more));
            if number == 0 {
                whole.faces[2][0] = lower;
            }
            if number == last {
                whole.faces[2][1] = upper;
            }
        }
        whole.number(joining.numbered());
        whole
    }

    /// Gives the components that the faces show their final numbers.
    fn number(&mut self, mut numbering: Numbering) {
        for_each_component(&mut self.faces, |kind, component| {
            *component = numbering.number(kind, *component);
        });
        let (shown, hidden) = numbering.counts();
        self.shown = shown;
        for kind in [BACKGROUND, FOREGROUND] {
            self.closed[kind] += hidden[kind];
        }
    }
}

/// Visits the component of every span of some faces.
pub(super) fn for_each_component(faces: &mut Faces, mut f: impl FnMut(usize, &mut u32)) {
    faces.as_flattened_mut().iter_mut().for_each(|face| face.for_each_component(&mut f));
}

/// Some slices of a box.
struct Part<'a> {
    mask: &'a Mask,
    frame: &'a Frame,
    /// The part of what the box sees that holds the object, and a voxel of background around it: beyond that
    /// all is as it is there.
    region: IndexBox,
    slices: Range<i64>,
}

impl Part<'_> {
    fn labelled(&self) -> LabelledBox {
        let mut region = self.region;
        region.lower[2] = self.slices.start;
        // With the next part's first slice, in which both are joined.
        region.upper[2] = (self.slices.end + 1).min(self.region.upper[2]);
        let of = |connectivity| ComponentLabels::in_box(self.mask, connectivity, region);
        let labels =
            Labels { background: of(Connectivity::Background6), foreground: of(Connectivity::Foreground26) };
        let faces = std::array::from_fn(|axis| [0, 1].map(|side| self.face(&labels, axis, side)));
        let mut whole = LabelledBox { euler: self.euler(), faces, ..LabelledBox::default() };
        whole.number(self.joined_outside(labels, &region).numbered());
        whole
    }

    fn euler(&self) -> EulerNumbers {
        let IndexBox { mut lower, mut upper } = self.frame.owned();
        lower[2] = lower[2].max(self.slices.start);
        upper[2] = upper[2].min(self.slices.end);
        let mut euler = EulerNumbers::default();
        euler.add(self.mask, &IndexBox::new(lower, upper));
        euler
    }

    /// The slice that a face lies in; `None` where the image ends.
    fn slice(&self, axis: usize, side: usize) -> Option<i64> {
        let IndexBox { lower, upper } = self.region;
        match (axis, side) {
            (2, 0) if self.slices.start > lower[2] => Some(self.slices.start),
            (2, 1) if self.slices.end < upper[2] => Some(self.slices.end),
            _ => Some(self.frame.face(axis, side)?.clamp(lower[axis], upper[axis] - 1)),
        }
    }

    fn face(&self, labels: &Labels, axis: usize, side: usize) -> Face {
        let mut face = Face::default();
        let Some(slice) = self.slice(axis, side) else { return face };
        let [along, across] = axes_across(axis);
        let rows = if across == 2 { self.slices.clone() } else { self.region.lower[1]..self.region.upper[1] };
        for row in rows {
            let mut spans = if axis == 0 {
                labels.column(slice, self.region.lower[1]..self.region.upper[1], row)
            } else {
                let [y, z] = if axis == 1 { [slice, row] } else { [row, slice] };
                labels.row(y, z)
            };
            let last = spans.len() - 1;
            spans[0].length += self.beyond(along, 0);
            spans[last].length += self.beyond(along, 1);
            let ends = [self.region.lower[across], self.region.upper[across] - 1];
            let more = [0, 1].map(|side| if row == ends[side] { self.beyond(across, side) } else { 0 });
            face.push(1 + more[0] + more[1], &spans);
        }
        face
    }

    /// Over how many voxels beyond the region's end the box sees what it sees there.
    fn beyond(&self, axis: usize, side: usize) -> u32 {
        let seen = self.frame.seen();
        let voxels = match side {
            0 => self.region.lower[axis] - seen.lower[axis],
            _ => seen.upper[axis] - self.region.upper[axis],
        };
        voxels as u32
    }

    /// The components, the outside joined with the rim: it is all background, so that one voxel of each of
    /// its sides will do.
    fn joined_outside(&self, labels: Labels, region: &IndexBox) -> Joining {
        let mut rim = Vec::new();
        for axis in 0..3 {
            for side in (0..2).filter(|&side| self.frame.is_outer(axis, side)) {
                let mut corner = region.lower;
                if side == 1 {
                    corner[axis] = region.upper[axis] - 1;
                }
                let end = [self.region.lower[axis], self.region.upper[axis] - 1][side];
                if corner[axis] == end {
                    let (first, runs) = labels.background.row_runs(corner[1], corner[2]);
                    rim.push(if axis == 0 && side == 1 { first + runs.len() - 1 } else { first });
                }
            }
        }
        let mut joining = Joining::of(labels.background.into_sets(), labels.foreground.into_sets());
        for member in rim {
            joining.join_outside(member);
        }
        joining
    }
}

/// Components by runs in a part's rows.
struct Labels {
    background: ComponentLabels,
    foreground: ComponentLabels,
}

impl Labels {
    /// A row along x as a face has it.
    fn row(&self, y: i64, z: i64) -> Vec<Span> {
        let [mut background, mut foreground] = [&self.background, &self.foreground].map(|labels| {
            let (first, runs) = labels.row_runs(y, z);
            (first..).zip(runs)
        });
        let begins_inside = match (background.clone().next(), foreground.clone().next()) {
            (Some((_, gap)), Some((_, run))) => run.0 < gap.0,
            (gap, _) => gap.is_none(),
        };
        let mut row = if begins_inside { vec![NOTHING] } else { Vec::new() };
        while let Some((component, (start, end))) =
            if row.len() % 2 == BACKGROUND { background.next() } else { foreground.next() }
        {
            row.push(Span { length: (end - start) as u32, component: component as u32 });
        }
        row
    }

    /// A row along y, at the first or the last x, as a face has it.
    fn column(&self, x: i64, ys: Range<i64>, z: i64) -> Vec<Span> {
        let at_end = |labels: &ComponentLabels, y| {
            let (first, runs) = labels.row_runs(y, z);
            let holds = |run: &Run| (run.0..run.1).contains(&x);
            let place = runs.first().filter(|run| holds(run)).map(|_| 0);
            place.or_else(|| runs.last().filter(|run| holds(run)).map(|_| runs.len() - 1)).map(|n| first + n)
        };
        let mut column: Vec<Span> = Vec::new();
        for y in ys {
            let (kind, component) = match at_end(&self.background, y) {
                Some(component) => (BACKGROUND, component),
                None => (FOREGROUND, at_end(&self.foreground, y).expect("a voxel is one or the other")),
            };
            if column.is_empty() && kind == FOREGROUND {
                column.push(NOTHING);
            }
            if column.len() % 2 == kind || column.is_empty() {
                column.push(Span { length: 1, component: component as u32 });
            } else if let Some(last) = column.last_mut() {
                last.length += 1;
            }
        }
        column
    }
}

/// The background before a row that begins with foreground.
const NOTHING: Span = Span { length: 0, component: OUTSIDE };
