//! The exact Euler number of a binary image.

use super::{ReferenceMethod, ReferenceValues};
use crate::topology::VoxelTopology;
use crate::volume::Mask;

/// V - E + F - C of the voxels (Odgaard and Gundersen 1993), as the surface's characteristic: twice the
/// solid's. Exact for the voxels, whatever they stand for.
#[derive(Debug, Clone, Copy)]
pub enum OdgaardGundersen {
    /// Voxels that touch in a corner are joined.
    Foreground26,
    /// Only those that share a face.
    Foreground6,
}

impl ReferenceMethod for OdgaardGundersen {
    fn name(&self) -> &'static str {
        match self {
            Self::Foreground26 => "odgaard-gundersen-26",
            Self::Foreground6 => "odgaard-gundersen-6",
        }
    }

    fn measure(&self, mask: &Mask) -> ReferenceValues {
        let topology = VoxelTopology::of(mask);
        let chi = match self {
            Self::Foreground26 => topology.euler_characteristic_26,
            Self::Foreground6 => topology.euler_characteristic_6,
        };
        ReferenceValues { euler_characteristic: Some(chi as f64), ..ReferenceValues::default() }
    }
}
