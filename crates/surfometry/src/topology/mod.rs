//! Exact topology of the voxels: Euler numbers, components, cavities, handles; and where two objects differ in it.

mod bricks;
mod changes;
mod component_labels;
mod components;
mod disjoint_sets;
mod euler;
mod euler_growth;
mod local_width;
mod simple_voxel;
mod thinning;

pub(crate) use changes::timed_changes;
pub use changes::{ChangeKind, TopologyChange, topology_changes};
pub use component_labels::ComponentLabels;
use components::ComponentCounter;
pub use components::Connectivity;
pub(crate) use disjoint_sets::DisjointSets;
use euler::EulerNumbers;

use crate::volume::Mask;
use std::ops::Range;

/// Exact topology of a voxel object. Euler characteristics are those of the surface: twice the solid's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoxelTopology {
    /// With 26-connected foreground (voxels are closed cubes).
    pub euler_characteristic_26: i64,
    /// With 6-connected foreground (voxels are open cubes).
    pub euler_characteristic_6: i64,
    /// 26-connected pieces of the object.
    pub components: u64,
    /// 6-connected pieces of the background that do not reach the outside.
    pub cavities: u64,
    /// Independent tunnels: components + cavities - chi / 2.
    pub handles: i64,
}

impl VoxelTopology {
    /// Topology of an object; beyond the image there is background.
    pub fn of(mask: &Mask) -> Self {
        let mut counter = TopologyCounter::default();
        let region = mask.bounds().grown([1; 3]);
        counter.add(mask, region.lower[2]..region.upper[2]);
        counter.topology()
    }
}

/// Counts the topology of an object slices by slices.
#[derive(Debug, Clone)]
pub(crate) struct TopologyCounter {
    euler: EulerNumbers,
    foreground: ComponentCounter,
    background: ComponentCounter,
}

impl Default for TopologyCounter {
    fn default() -> Self {
        Self {
            euler: EulerNumbers::default(),
            foreground: ComponentCounter::new(Connectivity::Foreground26),
            background: ComponentCounter::new(Connectivity::Background6),
        }
    }
}

impl TopologyCounter {
    /// Adds the next slices, without gaps and from before the object's first to behind its last. The mask holds the object's part in them,
    /// in the slice before and in the one behind.
    pub(crate) fn add(&mut self, mask: &Mask, slices: Range<i64>) {
        let Self { euler, foreground, background } = self;
        rayon::join(
            || euler.add(mask, slices.clone()),
            || rayon::join(|| foreground.add(mask, slices.clone()), || background.add(mask, slices.clone())),
        );
    }

    pub(crate) fn topology(&self) -> VoxelTopology {
        let euler_characteristic_26 = 2 * self.euler.foreground_26;
        let (components, cavities) = (self.foreground.count(), self.background.count() - 1);
        VoxelTopology {
            euler_characteristic_26,
            euler_characteristic_6: 2 * self.euler.foreground_6,
            components,
            cavities,
            handles: (components + cavities) as i64 - euler_characteristic_26 / 2,
        }
    }
}
