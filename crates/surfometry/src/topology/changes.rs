//! Where one object differs from another in topology.

use super::euler_growth::euler_growth;
use super::local_width::width_around;
use super::thinning::{Thinned, thinned};
use super::{ComponentLabels, Connectivity};
use crate::tiling::WorkTime;
use crate::volume::{Mask, Place};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What happened to an object's topology at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeKind {
    /// A piece of its own is gone.
    PieceLost,
    /// A piece of its own has appeared.
    PieceAppeared,
    /// A gap between two pieces was filled.
    PiecesJoined,
    /// A piece was cut in two.
    PieceSplit,
    /// A cavity was filled.
    CavityFilled,
    /// A cavity has appeared.
    CavityAppeared,
    /// The mouth of a pit was closed.
    CavityClosedOff,
    /// The wall of a cavity was broken through.
    CavityOpened,
    /// A tunnel was filled.
    HoleClosed,
    /// A wall was broken through.
    HoleOpened,
    /// A gap between two parts of a piece was filled.
    BridgeMade,
    /// A strut was cut.
    BridgeCut,
}

impl ChangeKind {
    /// What was concerned, in the singular, and what became of it.
    pub fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::PieceLost => ("piece", "lost"),
            Self::PieceAppeared => ("piece", "made"),
            Self::PiecesJoined => ("gap", "between pieces filled"),
            Self::PieceSplit => ("piece", "split"),
            Self::CavityFilled => ("void", "filled"),
            Self::CavityAppeared => ("void", "made"),
            Self::CavityClosedOff => ("pit", "closed off"),
            Self::CavityOpened => ("void", "opened"),
            Self::HoleClosed => ("hole", "closed"),
            Self::HoleOpened => ("hole", "opened"),
            Self::BridgeMade => ("gap", "bridged"),
            Self::BridgeCut => ("bridge", "cut"),
        }
    }
}

impl fmt::Display for ChangeKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// A change of topology at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TopologyChange {
    /// What; the first of components, cavities, handles that changes decides.
    pub kind: ChangeKind,
    /// By how much the number of 26-connected components grows.
    pub components: i64,
    /// By how much the number of 6-connected cavities grows.
    pub cavities: i64,
    /// By how much the number of handles grows.
    pub handles: i64,
    /// Where it happens: the voxel of lowest rank of those none of which can change without it, the middle of
    /// a piece or cavity, the line along a strut or a hole, the sheet within a wall or a gap.
    pub voxel: [i64; 3],
    /// Width there before the change, mm: of the strut, hole, piece or cavity, the wall that was broken or
    /// the gap that was filled.
    pub width_mm: f64,
}

impl TopologyChange {
    /// What it adds to the Euler characteristic of the surface.
    pub fn euler_characteristic(&self) -> i64 {
        2 * (self.components + self.cavities - self.handles)
    }
}

/// The changes of topology (26-connected object, 6-connected background) from one object to another on the
/// same grid, losses first. Their sums are exactly the differences in components, cavities and handles.
///
/// Voxels in which the objects differ are first changed where that is of no consequence (simple points),
/// those of low `rank` first; what is left over are the middles of the places that matter. Their effects are
/// counted with the components of the states between.
pub fn topology_changes(
    before: &Mask,
    after: &Mask,
    rank: impl Fn([i64; 3]) -> f32 + Sync,
) -> Vec<TopologyChange> {
    timed_changes(before, after, rank, &WorkTime::default())
}

/// The same, with the time that it takes.
pub(crate) fn timed_changes(
    before: &Mask,
    after: &Mask,
    rank: impl Fn([i64; 3]) -> f32 + Sync,
    time: &WorkTime,
) -> Vec<TopologyChange> {
    let Thinned { state: start, rest } = thinned(before, after, &rank, time);
    let cores = time.of(|| clusters(rest, &start));
    let (losses, gains): (Vec<_>, Vec<_>) =
        cores.into_iter().partition(|core| start.get(start.voxel_at(core[0])));
    // Losses let the background grow and gains the object, so that their components only ever join.
    let lost = Cores { cores: &losses, gain: false };
    let gained = Cores { cores: &gains, gain: true };
    let mut between = start.clone();
    let lost_euler = time.of(|| lost.apply(&mut between));
    let mut end = between.clone();
    let gained_euler = time.of(|| gained.apply(&mut end));
    let (object, background) = (Connectivity::Foreground26, Connectivity::Background6);
    let ((lost_components, gained_components), (lost_cavities, gained_cavities)) = rayon::join(
        || time.of(|| (lost.backwards(&between, object), gained.forwards(&between, object))),
        || {
            rayon::join(
                || time.of(|| lost.forwards(&start, background)),
                || time.of(|| gained.backwards(&end, background)),
            )
        },
    );
    let lost_effects = Effect::each(lost_components, lost_cavities, lost_euler);
    let gained_effects = Effect::each(gained_components, gained_cavities, gained_euler);
    let changes = |cores: Cores, effects: Vec<Effect>| -> Vec<TopologyChange> {
        let change = |(core, effect): (&Vec<Place>, Effect)| {
            let Effect { components, cavities, euler } = effect;
            let handles = components + cavities - euler;
            let kind = kind(cores.gain, [components, cavities, handles])?;
            let voxels = core.iter().map(|&place| start.voxel_at(place));
            let voxel = voxels.min_by(|&a, &b| rank(a).total_cmp(&rank(b)))?;
            let width_mm = width_around(before, voxel);
            Some(TopologyChange { kind, components, cavities, handles, voxel, width_mm })
        };
        let places = cores.cores.par_iter().zip(effects);
        places.filter_map(|place| time.of(|| change(place))).collect()
    };
    [changes(lost, lost_effects), changes(gained, gained_effects)].concat()
}

/// By how much numbers grow.
#[derive(Debug, Clone, Copy)]
struct Effect {
    components: i64,
    cavities: i64,
    /// Of the solid.
    euler: i64,
}

impl Effect {
    fn each(components: Vec<i64>, cavities: Vec<i64>, euler: Vec<i64>) -> Vec<Self> {
        let numbers = components.into_iter().zip(cavities).zip(euler);
        numbers.map(|((components, cavities), euler)| Self { components, cavities, euler }).collect()
    }
}

/// Cores that are put on the other side one after the other.
#[derive(Clone, Copy)]
struct Cores<'a> {
    cores: &'a [Vec<Place>],
    gain: bool,
}

impl Cores<'_> {
    /// Puts all on the other side; by how much the solid's Euler number grows with each.
    fn apply(&self, state: &mut Mask) -> Vec<i64> {
        let mut change = |&place: &Place| {
            let growth = euler_growth(state.around(place));
            state.toggle(place);
            if self.gain { growth } else { -growth }
        };
        self.cores.iter().map(|core| core.iter().map(&mut change).sum()).collect()
    }

    /// By how much components grow in number that each core is added to, in order, from what they are before.
    fn forwards(&self, before: &Mask, connectivity: Connectivity) -> Vec<i64> {
        self.growth(before, connectivity, self.cores.iter())
    }

    /// By how much components grow in number that each core is taken from, in order, from what they are at
    /// the end.
    fn backwards(&self, end: &Mask, connectivity: Connectivity) -> Vec<i64> {
        let mut growth = self.growth(end, connectivity, self.cores.iter().rev());
        for growth in &mut growth {
            *growth = -*growth;
        }
        growth.reverse();
        growth
    }

    fn growth<'c>(
        &self,
        state: &Mask,
        connectivity: Connectivity,
        cores: impl Iterator<Item = &'c Vec<Place>>,
    ) -> Vec<i64> {
        if self.cores.is_empty() {
            return Vec::new();
        }
        let mut labels = ComponentLabels::of(state, connectivity);
        let voxels = |core: &Vec<Place>| core.iter().map(|&place| state.voxel_at(place)).collect::<Vec<_>>();
        cores.map(|core| labels.grow(&mut voxels(core))).collect()
    }
}

/// Voxels that touch, of those on one side of an object, in the order of their first ones.
fn clusters(mut left: Mask, object: &Mask) -> Vec<Vec<Place>> {
    let mut clusters = Vec::new();
    for first in left.places().collect::<Vec<_>>() {
        if !left.has(first) {
            continue;
        }
        left.toggle(first);
        let mut cluster = vec![first];
        let mut next = 0;
        while next < cluster.len() {
            for neighbour in left.places_around(cluster[next]) {
                if object.has(neighbour) == object.has(first) {
                    left.toggle(neighbour);
                    cluster.push(neighbour);
                }
            }
            next += 1;
        }
        clusters.push(cluster);
    }
    clusters
}

/// What a growth in components, cavities and handles is called; none where the parts of a change cancel.
fn kind(gain: bool, growth: [i64; 3]) -> Option<ChangeKind> {
    use ChangeKind as Kind;
    let (what, growth) = growth.into_iter().enumerate().find(|(_, growth)| *growth != 0)?;
    Some(match (what, gain, growth > 0) {
        (0, true, true) => Kind::PieceAppeared,
        (0, true, false) => Kind::PiecesJoined,
        (0, false, true) => Kind::PieceSplit,
        (0, false, false) => Kind::PieceLost,
        (1, true, true) => Kind::CavityClosedOff,
        (1, true, false) => Kind::CavityFilled,
        (1, false, true) => Kind::CavityAppeared,
        (1, false, false) => Kind::CavityOpened,
        (_, true, true) => Kind::BridgeMade,
        (_, true, false) => Kind::HoleClosed,
        (_, false, true) => Kind::HoleOpened,
        (_, false, false) => Kind::BridgeCut,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::VoxelTopology;
    use crate::volume::Grid;
    use proptest::prelude::*;

    const N: [usize; 3] = [9, 7, 6];

    fn mask(on: &[bool]) -> Mask {
        let grid = Grid::axis_aligned(N, [1.0, 1.3, 0.7]).unwrap();
        Mask::from_predicate(grid, |[x, y, z]| on[(z * N[1] + y) * N[0] + x])
    }

    proptest! {
        /// The sums of the changes are the differences that counting gives, and what is of no consequence has
        /// none.
        #[test]
        fn changes_add_up(
            a in prop::collection::vec(prop::bool::weighted(0.5), 9 * 7 * 6),
            share in 0.0..1.0f64,
            b in prop::collection::vec(prop::bool::weighted(0.5), 9 * 7 * 6),
        ) {
            // A part of the image is changed, so that there are places to tell apart.
            let voxels = a.len();
            let mixed = |i: usize| if i < (share * voxels as f64) as usize { b[i] } else { a[i] };
            let (before, after) = (mask(&a), mask(&(0..a.len()).map(mixed).collect::<Vec<_>>()));
            prop_assume!(!before.is_empty() && !after.is_empty());
            let (from, to) = (VoxelTopology::of(&before), VoxelTopology::of(&after));
            let rank = |[x, y, z]: [i64; 3]| (x * 5 + y * 3 + z * 7 % 11) as f32;
            let state = thinned(&before, &after, &rank, &WorkTime::default()).state;
            prop_assert_eq!(VoxelTopology::of(&state), VoxelTopology { euler_characteristic_6: VoxelTopology::of(&state).euler_characteristic_6, ..from });
            let changes = topology_changes(&before, &after, rank);
            let sum = |growth: fn(&TopologyChange) -> i64| changes.iter().map(growth).sum::<i64>();
            prop_assert_eq!(sum(|c| c.components), to.components as i64 - from.components as i64);
            prop_assert_eq!(sum(|c| c.cavities), to.cavities as i64 - from.cavities as i64);
            prop_assert_eq!(sum(|c| c.handles), to.handles - from.handles);
            prop_assert_eq!(
                sum(TopologyChange::euler_characteristic),
                to.euler_characteristic_26 - from.euler_characteristic_26
            );
        }
    }
}
