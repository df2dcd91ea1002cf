//! Exact topology of the voxels: Euler numbers, components, cavities, handles; and where two objects differ
//! in it.
//!
//! ```
//! use surfometry::{phantoms::Phantom, topology::VoxelTopology};
//! let mask = Phantom::from_spec("torus?major=12&minor=5")?.labels()?.mask(1);
//! let topology = VoxelTopology::of(&mask);
//! assert_eq!((topology.components, topology.cavities, topology.handles), (1, 0, 1));
//! assert_eq!(topology.euler_characteristic_26, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod box_topology;
mod bricks;
mod changes;
mod component_labels;
mod components;
mod euler;
mod euler_growth;
mod face;
mod frame;
mod labelled_box;
mod local_width;
mod numbering;
mod simple_voxel;
mod thinning;

pub(crate) use box_topology::BoxTopology;
pub(crate) use changes::timed_changes;
pub use changes::{ChangeKind, TopologyChange, topology_changes};
pub use component_labels::ComponentLabels;
pub use components::Connectivity;
pub(crate) use euler::EulerNumbers;

use crate::tiling::Cover;
use crate::volume::Mask;

/// Exact topology of a voxel object. Euler characteristics are those of the surface: twice the solid's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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
        let image = mask.bounds();
        BoxTopology::of(mask, &image, &image).topology(&Cover::of(image, image))
    }
}
