//! Analytic shapes with exact truth, as public API: to test this crate, or any other estimator, against.
//!
//! A [`Shape`] is an implicit function with analytic derivatives and known integrals; a [`Phantom`] is a
//! shape in a pose, sampled on a grid ([`Phantom::labels`]). `phantom:NAME?key=value&...`
//! ([`Phantom::from_spec`]) is its text form.
//!
//! ```
//! use surfometry::phantoms::{Ellipsoid, Phantom, Pose};
//! let pose = Pose::new([10.0, 20.0, 30.0], [0.3, 0.2, 0.1]);
//! let phantom = Phantom::new(Ellipsoid { radii: [9.0, 7.0, 6.0] }, pose, [1.0, 1.0, 1.5])?;
//! let truth = phantom.truth().expect("an ellipsoid's integrals converge");
//! let counted = phantom.labels()?.mask(1).voxels() as f64 * 1.5;
//! assert!((counted / truth.volume - 1.0).abs() < 0.01);
//! # Ok::<(), surfometry::volume::VolumeError>(())
//! ```

mod bone;
mod bone_part;
mod chance;
mod cohort;
mod curved_triangles;
mod ellipsoid;
mod genus;
mod helix;
mod jet_arithmetic;
mod periodic;
mod phantom;
mod pose;
mod primitives;
mod rounded_box;
mod spec;
mod struts;
mod surface_point;
mod torus;

pub use bone::Bone;
pub use cohort::{CohortMember, cohort};
pub use ellipsoid::Ellipsoid;
pub use genus::Genus;
pub use helix::Helix;
pub use periodic::{MinimalSurface, Periodic};
pub use phantom::{Phantom, PhantomSlabs};
pub use pose::Pose;
pub use primitives::{Ball, Capsule, Shell, TwoBalls};
pub use rounded_box::RoundedBox;
pub use spec::{NAMES as PHANTOM_NAMES, ParsePhantomError};
pub use struts::Struts;
pub use surface_point::SurfacePoint;
pub use torus::Torus;

use crate::local_geometry::Jet;
use serde::{Deserialize, Serialize};

/// A closed surface given by an implicit function, negative inside, in a frame of its own (mm).
pub trait Shape: Send + Sync {
    /// Value of the implicit function at a point.
    fn value(&self, point: [f64; 3]) -> f64;

    /// Value, gradient and Hessian of the implicit function at a point, analytic.
    fn jet(&self, point: [f64; 3]) -> Jet;

    /// Exact integrals of the surface; `None` where a quadrature did not converge (a shape finer than its own
    /// sampling).
    fn truth(&self) -> Option<Truth>;

    /// Half the edges of an axis-aligned box around the origin that holds the shape, mm.
    fn half_extent(&self) -> [f64; 3];
}

impl Shape for Box<dyn Shape> {
    fn value(&self, point: [f64; 3]) -> f64 {
        (**self).value(point)
    }

    fn jet(&self, point: [f64; 3]) -> Jet {
        (**self).jet(point)
    }

    fn truth(&self) -> Option<Truth> {
        (**self).truth()
    }

    fn half_extent(&self) -> [f64; 3] {
        (**self).half_extent()
    }
}

/// Exact integrals of a closed surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// mm^3.
    #[serde(rename = "volume_mm3")]
    pub volume: f64,
    /// mm^2.
    #[serde(rename = "surface_area_mm2")]
    pub surface_area: f64,
    /// Integral of H, mm.
    #[serde(rename = "total_mean_curvature_mm")]
    pub total_mean_curvature: f64,
    /// The same over the area, 1/mm.
    #[serde(rename = "average_mean_curvature_per_mm")]
    pub average_mean_curvature: f64,
    /// 2 pi chi.
    pub total_gaussian_curvature: f64,
    /// Of the surface: ball 2, solid torus 0, shell 4.
    pub euler_characteristic: i64,
}

impl Truth {
    /// From volume, area, total mean curvature and Euler characteristic.
    pub fn new(volume: f64, surface_area: f64, total_mean_curvature: f64, euler_characteristic: i64) -> Self {
        Self {
            volume,
            surface_area,
            total_mean_curvature,
            average_mean_curvature: total_mean_curvature / surface_area,
            total_gaussian_curvature: std::f64::consts::TAU * euler_characteristic as f64,
            euler_characteristic,
        }
    }
}

impl Truth {
    /// Of the shape made larger by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self::new(
            self.volume * factor.powi(3),
            self.surface_area * factor * factor,
            self.total_mean_curvature * factor,
            self.euler_characteristic,
        )
    }
}

/// Implements [`Shape::value`] and [`Shape::jet`] from one generic `implicit` function.
macro_rules! value_and_jet {
    () => {
        fn value(&self, point: [f64; 3]) -> f64 {
            self.implicit(point)
        }

        fn jet(&self, point: [f64; 3]) -> $crate::local_geometry::Jet {
            self.implicit($crate::phantoms::jet_arithmetic::coordinates(point))
        }
    };
}
use value_and_jet;
