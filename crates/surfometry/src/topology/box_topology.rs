//! Topology of an object that is known in some boxes of its image, in whatever order they come.

use super::VoxelTopology;
use super::euler::EulerNumbers;
use super::face::{BACKGROUND, FOREGROUND, Face, Kind};
use super::frame::Frame;
use super::labelled_box::{Faces, LabelledBox, for_each_component};
use super::numbering::{Joining, OUTSIDE, shifted};
use crate::tiling::{Cover, IndexBox, Joint};
use crate::volume::Mask;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What the boxes of a [`Cover`] tell of an object's topology. The same boxes lead to the same topology in
/// whatever order they are merged. How much of what is finished a value still holds hangs on the order: where
/// a part of the object was finished before another was begun, it is forgotten, and beside the other it isn't.
///
/// Euler numbers add up. Of the components, those that end within the boxes are counted, and the others are
/// known by the voxels on the boxes' faces. A box whose faces are all background is only kept beside one
/// whose faces are not; everywhere else it goes without saying. Memory follows the object's sections in the
/// faces behind which something is missing.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct BoxTopology {
    euler: EulerNumbers,
    /// Components of background and foreground that nothing can be added to.
    closed: [u64; 2],
    /// Components of background, besides the outside, and of foreground on the faces.
    open: [u32; 2],
    #[serde(with = "crate::tiling::pairs")]
    shells: BTreeMap<IndexBox, Shell>,
    /// Boxes that had a shell with foreground until all around them was known.
    finished: Vec<IndexBox>,
}

/// Components on the faces of a box.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
enum Shell {
    /// All faces are background, and so connected.
    Background(u32),
    Mixed(Box<Faces>),
}

impl BoxTopology {
    /// Of the part of an object that lies in a box of an image. The mask holds what there is of it in the box
    /// and in the voxels around it.
    pub(crate) fn of(mask: &Mask, image: &IndexBox, region: &IndexBox) -> Self {
        let LabelledBox { euler, closed, shown, faces } = LabelledBox::of(mask, &Frame::new(image, region));
        let mut topology = Self { euler, closed, ..Self::default() };
        if faces.as_flattened().iter().any(Face::has_foreground) {
            topology.shells.insert(*region, Shell::Mixed(Box::new(faces)));
            topology.open = shown;
        }
        topology
    }

    /// Whether boxes in which the object does not occur can change anything.
    pub(crate) fn meets(&self, joint: &Joint) -> bool {
        self.shells.keys().any(|region| !joint.contacts(region).is_empty())
    }

    /// Two parts as one; `joint` says where the boxes that they are known in meet, which have nothing in
    /// common.
    pub(crate) fn merge(&mut self, mut other: Self, image: &IndexBox, joint: &Joint) {
        self.euler.merge(&other.euler);
        for kind in [BACKGROUND, FOREGROUND] {
            self.closed[kind] += other.closed[kind];
        }
        self.finished.append(&mut other.finished);
        let mut joining = Joining::new();
        joining.add(self.open);
        let offsets = joining.add(other.open);
        for shell in other.shells.values_mut() {
            shell.for_each_component(|kind, component| *component = shifted(kind, *component, offsets));
        }
        let unsaid = [
            unsaid_beside(&self.shells, &other.shells, joint),
            unsaid_beside(&other.shells, &self.shells, joint),
        ]
        .concat();
        let unsaid = background_shells(unsaid, image, &mut joining);
        join_between([&self.shells, &other.shells], image, &mut joining);
        join_between([&self.shells, &unsaid], image, &mut joining);
        join_between([&other.shells, &unsaid], image, &mut joining);
        join_within(&unsaid, image, &mut joining);
        self.shells.extend(other.shells);
        self.shells.extend(unsaid);
        self.settle(joining, image, joint);
    }

    /// Counts what is finished, and numbers the rest.
    fn settle(&mut self, joining: Joining, image: &IndexBox, joint: &Joint) {
        let is_finished =
            |region: &IndexBox, shell: &Shell| matches!(shell, Shell::Mixed(_)) && joint.surrounds(region);
        let finished = self.shells.extract_if(.., |region, shell| is_finished(region, shell));
        self.finished.extend(finished.map(|(region, _)| region));
        self.finished.sort_unstable();
        let mut numbering = joining.numbered();
        for shell in self.shells.values_mut() {
            shell.for_each_component(|kind, component| *component = numbering.number(kind, *component));
        }
        let (open, closed) = numbering.counts();
        self.open = open;
        for kind in [BACKGROUND, FOREGROUND] {
            self.closed[kind] += closed[kind];
        }
        if self.says_nothing(image) {
            *self = Self { euler: self.euler, closed: self.closed, ..Self::default() };
        }
    }

    /// Whether the shells say what goes without saying: that all around the object is connected, and with the
    /// outside.
    fn says_nothing(&self, image: &IndexBox) -> bool {
        let mut shells = self.shells.values();
        let Some(first) = shells.next() else { return true };
        let is_connected = matches!(first, Shell::Background(_)) && shells.all(|shell| shell == first);
        // What the object's boxes and the end of the image enclose together may be a cavity.
        let is_enclosed = || self.finished.iter().any(|region| Frame::new(image, region).touches_outside());
        is_connected && (*first == Shell::Background(OUTSIDE) || !is_enclosed())
    }

    /// The topology of the object, of which all boxes are known.
    pub(crate) fn topology(&self, cover: &Cover) -> VoxelTopology {
        let mut joining = Joining::new();
        joining.add(self.open);
        if !self.shells.is_empty() {
            let said = |region: &IndexBox| self.shells.contains_key(region) || self.finished.contains(region);
            let unsaid = cover.boxes().iter().copied().filter(|region| !said(region)).collect();
            let unsaid = background_shells(unsaid, cover.image(), &mut joining);
            join_within(&self.shells, cover.image(), &mut joining);
            join_between([&self.shells, &unsaid], cover.image(), &mut joining);
            join_within(&unsaid, cover.image(), &mut joining);
        }
        let open = joining.counts();
        let [cavities, components] = [BACKGROUND, FOREGROUND].map(|kind| self.closed[kind] + open[kind]);
        let euler_characteristic_26 = 2 * self.euler.foreground_26;
        VoxelTopology {
            euler_characteristic_26,
            euler_characteristic_6: 2 * self.euler.foreground_6,
            components,
            cavities,
            handles: (components + cavities) as i64 - euler_characteristic_26 / 2,
        }
    }

    /// Whether a value that was read can be one of a cover.
    pub(crate) fn is_valid(&self, cover: &Cover) -> bool {
        let known = |region: &IndexBox| cover.boxes().binary_search(region).is_ok();
        self.shells.iter().all(|(region, shell)| {
            known(region) && shell.is_valid(&Frame::new(cover.image(), region), self.open)
        }) && self.finished.iter().all(known)
    }
}

type Shells = BTreeMap<IndexBox, Shell>;

/// The boxes of another cover that touch shells with foreground and have no shell there.
fn unsaid_beside(shells: &Shells, others: &Shells, joint: &Joint) -> Vec<IndexBox> {
    let mixed = shells.iter().filter(|(_, shell)| matches!(shell, Shell::Mixed(_)));
    let near = mixed.flat_map(|(region, _)| joint.contacts(region)).copied();
    near.filter(|region| !others.contains_key(region)).collect()
}

/// Shells of boxes without foreground on their faces, as new components.
fn background_shells(regions: Vec<IndexBox>, image: &IndexBox, joining: &mut Joining) -> Shells {
    let mut shells = Shells::new();
    for region in regions {
        shells.entry(region).or_insert_with(|| {
            let is_outside = Frame::new(image, &region).touches_outside();
            Shell::Background(if is_outside { OUTSIDE } else { joining.add([1, 0])[BACKGROUND] + 1 })
        });
    }
    shells
}

fn join_between([some, others]: [&Shells; 2], image: &IndexBox, joining: &mut Joining) {
    for a in some {
        for b in others {
            join(a, b, image, joining);
        }
    }
}

fn join_within(shells: &Shells, image: &IndexBox, joining: &mut Joining) {
    for (number, a) in shells.iter().enumerate() {
        shells.iter().skip(number + 1).for_each(|b| join(a, b, image, joining));
    }
}

/// Joins what two boxes have in common: wherever the slices that they share lie, what they see there are the
/// same voxels.
fn join(a: (&IndexBox, &Shell), b: (&IndexBox, &Shell), image: &IndexBox, joining: &mut Joining) {
    if !a.0.is_near(b.0) {
        return;
    }
    let frames = [a.0, b.0].map(|region| Frame::new(image, region));
    for (axis, [side_a, side_b]) in (0..3).flat_map(|axis| SIDES.map(|sides| (axis, sides))) {
        let slice = frames[0].face(axis, side_a);
        if slice.is_some() && slice == frames[1].face(axis, side_b) {
            let rectangles = frames.map(|frame| frame.rectangle(axis));
            let faces = [a.1.face(axis, side_a, &rectangles[0]), b.1.face(axis, side_b, &rectangles[1])];
            let join = |kind, a, b| joining.join(kind, a, b);
            Face::for_each_shared(faces.each_ref().map(|face| &**face), rectangles, join);
        }
    }
}

/// The sides of two boxes.
const SIDES: [[usize; 2]; 4] = [[0, 0], [0, 1], [1, 0], [1, 1]];

impl Shell {
    fn face(&self, axis: usize, side: usize, rectangle: &super::frame::Rectangle) -> Cow<'_, Face> {
        match self {
            Self::Background(component) => Cow::Owned(Face::background(rectangle, *component)),
            Self::Mixed(faces) => Cow::Borrowed(&faces[axis][side]),
        }
    }

    fn for_each_component(&mut self, mut f: impl FnMut(Kind, &mut u32)) {
        match self {
            Self::Background(component) => f(BACKGROUND, component),
            Self::Mixed(faces) => for_each_component(faces, f),
        }
    }

    fn is_valid(&self, frame: &Frame, open: [u32; 2]) -> bool {
        match self {
            Self::Background(component) => *component <= open[BACKGROUND],
            Self::Mixed(faces) => (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]).all(|(axis, side)| {
                let face = &faces[axis][side];
                match frame.face(axis, side) {
                    Some(_) => face.is_valid(&frame.rectangle(axis), open),
                    None => *face == Face::default(),
                }
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::Connectivity;
    use crate::topology::components::tests::flood;
    use crate::volume::Grid;
    use proptest::prelude::*;

    const N: [usize; 3] = [9, 8, 7];

    /// Boxes painted over each other, which leaves shells and hollows, with noise on top.
    fn voxels() -> impl Strategy<Value = Vec<bool>> {
        let painted = (prop::array::uniform3(0..6usize), prop::array::uniform3(1..10usize), any::<bool>());
        let noise = prop_oneof![3 => Just(0.02), 1 => Just(0.3), 1 => Just(0.6)];
        let noise =
            noise.prop_flat_map(|share| prop::collection::vec(prop::bool::weighted(share), 9 * 8 * 7));
        (prop::collection::vec(painted, 0..7), noise).prop_map(|(boxes, mut on)| {
            for (n, flip) in on.iter_mut().enumerate() {
                let index = [n % N[0], n / N[0] % N[1], n / N[0] / N[1]];
                let holds = |lower: &[usize; 3], extent: &[usize; 3]| {
                    (0..3).all(|a| (lower[a]..lower[a] + extent[a]).contains(&index[a]))
                };
                let painted = boxes.iter().rev().find(|(lower, extent, _)| holds(lower, extent));
                *flip ^= painted.is_some_and(|(.., on)| *on);
            }
            on
        })
    }

    /// The image cut in two again and again, each time another box.
    fn cut(cuts: &[(prop::sample::Index, usize, prop::sample::Index)]) -> Vec<IndexBox> {
        let mut boxes = vec![IndexBox::from_dimensions(N)];
        for (which, axis, place) in cuts {
            let whole = boxes.swap_remove(which.index(boxes.len()));
            let (mut before, mut behind) = (whole, whole);
            let at = whole.lower[*axis] + place.index(whole.extent()[*axis] + 1) as i64;
            (before.upper[*axis], behind.lower[*axis]) = (at, at);
            let parts = [before, behind].map(|part| IndexBox::new(part.lower, part.upper));
            boxes.extend(parts.into_iter().filter(|part| !part.is_empty()));
        }
        boxes
    }

    /// A value and the boxes it is of, as it is after it was written and read.
    type Known = (Cover, BoxTopology);

    fn merged((cover, mut topology): Known, (other, more): Known) -> Known {
        let (cover, joint) = cover.merged(&other).unwrap();
        topology.merge(more, cover.image(), &joint);
        assert!(topology.is_valid(&cover));
        let bytes = postcard::to_stdvec(&topology).unwrap();
        (cover, postcard::from_bytes(&bytes).unwrap())
    }

    /// One value of all, two at a time.
    fn in_order(mut known: Vec<Known>, order: &[[prop::sample::Index; 2]]) -> Known {
        let mut order = order.iter();
        while known.len() > 1 {
            let [a, b] = order.next().unwrap();
            let a = known.swap_remove(a.index(known.len()));
            let b = known.swap_remove(b.index(known.len()));
            known.push(merged(a, b));
        }
        known.remove(0)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]
        #[test]
        fn boxes_in_any_order_are_the_whole(
            on in voxels(),
            cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..3usize, any::<prop::sample::Index>()), 0..30),
            order in prop::collection::vec(any::<[prop::sample::Index; 2]>(), 30),
            other_order in prop::collection::vec(any::<[prop::sample::Index; 2]>(), 30),
        ) {
            let grid = Grid::axis_aligned(N, [1.0; 3]).unwrap();
            let inside = |[x, y, z]: [usize; 3]| on[(z * N[1] + y) * N[0] + x];
            let image = grid.index_box();
            let known: Vec<Known> = cut(&cuts).into_iter().map(|region| {
                // No more of the image than the box and the voxels around it.
                let around = region.grown([1; 3]);
                let mask = Mask::from_predicate(grid, |v| inside(v) && around.contains(v.map(|v| v as i64)));
                (Cover::of(image, region), BoxTopology::of(&mask, &image, &region))
            }).collect();
            // All in an order, and a half in another with the rest at once.
            let (part, rest) = known.split_at(known.len().div_ceil(2));
            let halves = [Some(part), Some(rest).filter(|rest| !rest.is_empty())];
            let halves = halves.into_iter().flatten().map(|half| in_order(half.to_vec(), &other_order));
            let of_halves = halves.reduce(merged).unwrap();
            let (cover, whole) = in_order(known.clone(), &order);
            let topology = whole.topology(&cover);
            prop_assert_eq!(of_halves.1.topology(&of_halves.0), topology);
            let mask = Mask::from_predicate(grid, inside);
            prop_assert_eq!(topology, VoxelTopology::of(&mask));
            prop_assert_eq!(topology.components, flood(N, &on, Connectivity::Foreground26));
            prop_assert_eq!(topology.cavities + 1, flood(N, &on, Connectivity::Background6));
        }
    }

    #[test]
    fn an_empty_box_may_be_a_part_of_a_cavity() {
        // A hollow cube in 5 x 5 x 5 boxes, the inner ones of which know nothing of it.
        let grid = Grid::axis_aligned([20; 3], [1.0; 3]).unwrap();
        let at = |v: [usize; 3], ends: [usize; 2]| v.iter().all(|i| (ends[0]..ends[1]).contains(i));
        let mask = Mask::from_predicate(grid, |v| at(v, [1, 19]) && !at(v, [3, 17]));
        let mut known: Vec<Known> = grid
            .index_box()
            .tiles([4; 3])
            .into_iter()
            .map(|region| {
                (Cover::of(grid.index_box(), region), BoxTopology::of(&mask, &grid.index_box(), &region))
            })
            .collect();
        // Far ones first.
        known.sort_by_key(|(cover, _)| cover.boxes()[0].lower.iter().map(|v| v * 7 % 5).sum::<i64>());
        let (cover, whole) = known.into_iter().reduce(merged).unwrap();
        let topology = whole.topology(&cover);
        assert_eq!((topology.components, topology.cavities, topology.handles), (1, 1, 0));
    }
}
