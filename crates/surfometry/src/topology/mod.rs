//! Exact topology of the voxels: Euler numbers, components, cavities, handles.

mod components;
mod configurations;
mod disjoint_sets;

pub use components::{Connectivity, count_components};
pub use configurations::ConfigurationHistogram;
pub(crate) use disjoint_sets::DisjointSets;

use crate::volume::Mask;

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
        let histogram = ConfigurationHistogram::of(mask, &mask.bounds().grown([1; 3]));
        let euler_characteristic_26 = 2 * histogram.euler_26();
        let components = count_components(mask, Connectivity::Foreground26);
        let cavities = count_components(mask, Connectivity::Background6) - 1;
        Self {
            euler_characteristic_26,
            euler_characteristic_6: 2 * histogram.euler_6(),
            components,
            cavities,
            handles: (components + cavities) as i64 - euler_characteristic_26 / 2,
        }
    }
}
