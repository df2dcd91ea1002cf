//! Where one object differs from another in topology.

use super::euler::solid_euler_around;
use super::simple_voxel::is_simple;
use super::{ComponentLabels, Connectivity};
use crate::tiling::IndexBox;
use crate::volume::{Mask, Spacing};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet};
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
    /// Where it happens: the voxel of lowest rank of those none of which can change without it, the middle of a piece or cavity, the line along a
    /// strut or a hole, the sheet within a wall or a gap.
    pub voxel: [i64; 3],
    /// Width there before the change, mm: of the strut, hole, piece or cavity, the wall that was broken or the gap that was filled.
    pub width_mm: f64,
}

impl TopologyChange {
    /// What it adds to the Euler characteristic of the surface.
    pub fn euler_characteristic(&self) -> i64 {
        2 * (self.components + self.cavities - self.handles)
    }
}

/// The changes of topology (26-connected object, 6-connected background) from one object to another on the same grid, losses first. Their
/// sums are exactly the differences in components, cavities and handles.
///
/// Voxels in which the objects differ are first changed where that is of no consequence (simple points), those of low `rank` first; what is
/// left over are the middles of the places that matter. Their effects are counted with the components of the states between.
pub fn topology_changes(before: &Mask, after: &Mask, rank: impl Fn([i64; 3]) -> f64) -> Vec<TopologyChange> {
    let (mut state, rest) = homotopic_part(before, after, &rank);
    let (losses, gains): (Vec<_>, Vec<_>) =
        clusters(&rest, before).into_iter().partition(|core| before.get(core[0]));
    // Losses let the background grow and gains the object, so that their components only ever join.
    let start = ComponentLabels::of(&state, Connectivity::Background6);
    let lost = Cores { cores: &losses, gain: false };
    let lost_euler = lost.apply(&mut state);
    let between = ComponentLabels::of(&state, Connectivity::Foreground26);
    let gained = Cores { cores: &gains, gain: true };
    let gained_euler = gained.apply(&mut state);
    let end = ComponentLabels::of(&state, Connectivity::Background6);
    let lost_effects = Effect::each(lost.backwards(between.clone()), lost.forwards(start), lost_euler);
    let gained_effects = Effect::each(gained.forwards(between), gained.backwards(end), gained_euler);
    let changes = |cores: Cores, effects: Vec<Effect>| -> Vec<TopologyChange> {
        let change = |(core, effect): (&Vec<[i64; 3]>, Effect)| {
            let Effect { components, cavities, euler } = effect;
            let handles = components + cavities - euler;
            let kind = kind(cores.gain, [components, cavities, handles])?;
            let voxel = core.iter().copied().min_by(|&a, &b| rank(a).total_cmp(&rank(b)))?;
            let width_mm = width_around(before, voxel);
            Some(TopologyChange { kind, components, cavities, handles, voxel, width_mm })
        };
        cores.cores.iter().zip(effects).filter_map(change).collect()
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
struct Cores<'a> {
    cores: &'a [Vec<[i64; 3]>],
    gain: bool,
}

impl Cores<'_> {
    /// Puts all on the other side; by how much the solid's Euler number grows with each. No neighbourhood of 2 x 2 x 2 voxels meets two.
    fn apply(&self, state: &mut Mask) -> Vec<i64> {
        let apply = |core: &Vec<[i64; 3]>| {
            let before = solid_euler_around(state, core);
            for &voxel in core {
                state.set(voxel, self.gain);
            }
            solid_euler_around(state, core) - before
        };
        self.cores.iter().map(apply).collect()
    }

    /// By how much components grow in number that each core is added to, in order, from what they are before.
    fn forwards(&self, mut labels: ComponentLabels) -> Vec<i64> {
        self.cores.iter().map(|core| labels.grow(core)).collect()
    }

    /// By how much components grow in number that each core is taken from, in order, from what they are at the end.
    fn backwards(&self, mut labels: ComponentLabels) -> Vec<i64> {
        let mut growth: Vec<i64> = self.cores.iter().rev().map(|core| -labels.grow(core)).collect();
        growth.reverse();
        growth
    }
}

/// The object after all changes that are of no consequence, and the voxels that still differ, in order.
fn homotopic_part(before: &Mask, after: &Mask, rank: &impl Fn([i64; 3]) -> f64) -> (Mask, Vec<[i64; 3]>) {
    let region = before.bounds().hull(&after.bounds());
    let (mut state, target) = (before.on_bounds(region), after.on_bounds(region));
    let mut voxels = state.differences(&target);
    let differs = |state: &Mask, voxel| state.get(voxel) != target.get(voxel);
    let mut queued = Mask::cleared(*before.grid(), region);
    let mut waiting = BinaryHeap::new();
    let wait = |voxel: [i64; 3], queued: &mut Mask, waiting: &mut BinaryHeap<Waiting>| {
        queued.set(voxel, true);
        waiting.push(Waiting { rank: rank(voxel), voxel });
    };
    for &voxel in &voxels {
        wait(voxel, &mut queued, &mut waiting);
    }
    while let Some(Waiting { voxel, .. }) = waiting.pop() {
        queued.set(voxel, false);
        if !is_simple(&state, voxel) {
            continue;
        }
        state.set(voxel, !state.get(voxel));
        for neighbour in Connectivity::Foreground26.neighbours(voxel) {
            if differs(&state, neighbour) && !queued.get(neighbour) {
                wait(neighbour, &mut queued, &mut waiting);
            }
        }
    }
    voxels.retain(|&voxel| differs(&state, voxel));
    (state, voxels)
}

/// A voxel in a queue from which the lowest rank comes first, and of equal ranks the first along z, y, x.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    rank: f64,
    voxel: [i64; 3],
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |[x, y, z]: [i64; 3]| [z, y, x];
        other.rank.total_cmp(&self.rank).then_with(|| place(other.voxel).cmp(&place(self.voxel)))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Waiting {}

/// Voxels that touch, of those on one side of an object, in the order of their first ones.
fn clusters(voxels: &[[i64; 3]], object: &Mask) -> Vec<Vec<[i64; 3]>> {
    let mut left: HashSet<[i64; 3]> = voxels.iter().copied().collect();
    let mut clusters = Vec::new();
    for &voxel in voxels {
        if !left.remove(&voxel) {
            continue;
        }
        let side = object.get(voxel);
        let mut cluster = vec![voxel];
        let mut next = 0;
        while next < cluster.len() {
            for neighbour in Connectivity::Foreground26.neighbours(cluster[next]) {
                if object.get(neighbour) == side && left.remove(&neighbour) {
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

/// The largest width at a voxel and its neighbours on the same side: a core that is one voxel wide runs beside the middle as often as in it.
fn width_around(mask: &Mask, voxel: [i64; 3]) -> f64 {
    let alike = Connectivity::Foreground26.neighbours(voxel).filter(|&v| mask.get(v) == mask.get(voxel));
    alike.map(|neighbour| width_at(mask, neighbour)).fold(width_at(mask, voxel), f64::max)
}

/// Width of the part that a voxel is the middle of, mm: twice the distance to the nearest voxel on the other side, less a voxel.
fn width_at(mask: &Mask, voxel: [i64; 3]) -> f64 {
    let spacing = mask.grid().spacing();
    let side = mask.get(voxel);
    let mut nearest = f64::INFINITY;
    let reach = mask.bounds().hull(&IndexBox::voxel(voxel)).extent().into_iter().max().unwrap_or(0) as i64;
    for steps in 1..=reach {
        // Nothing beyond the cubes of the steps before is nearer.
        if nearest <= (2 * steps - 1) as f64 * spacing.smallest() {
            break;
        }
        let shell = IndexBox::voxel(voxel).grown([steps; 3]);
        for (y, z) in shell.rows() {
            let at_end = (y - voxel[1]).abs().max((z - voxel[2]).abs()) == steps;
            let stride = if at_end { 1 } else { 2 * steps as usize };
            for x in (shell.lower[0]..shell.upper[0]).step_by(stride) {
                if mask.get([x, y, z]) != side {
                    nearest = nearest.min(width_between(spacing, voxel, [x, y, z]));
                }
            }
        }
    }
    nearest
}

/// Twice the distance of two voxels' centres, less the spacing in that direction.
fn width_between(spacing: Spacing, from: [i64; 3], to: [i64; 3]) -> f64 {
    let norm = |along: [f64; 3]| libm::hypot(libm::hypot(along[0], along[1]), along[2]);
    let offset: [f64; 3] = std::array::from_fn(|a| (to[a] - from[a]) as f64 * spacing.mm()[a]);
    let distance = norm(offset);
    2.0 * distance - norm(std::array::from_fn(|a| offset[a] / distance * spacing.mm()[a]))
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
        /// The sums of the changes are the differences that counting gives, and what is of no consequence has none.
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
            let rank = |[x, y, z]: [i64; 3]| (x * 5 + y * 3 + z * 7 % 11) as f64;
            let (state, _) = homotopic_part(&before, &after, &rank);
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
