//! The classical estimators that the paper and its field compare with, behind one trait, so that a comparison
//! is a loop.
//!
//! They measure the mask as it is, each with its known bias, which its documentation states. None of them
//! gives local curvature.
//!
//! ```
//! use surfometry::{phantoms::Phantom, reference_methods::{Crofton, ReferenceMethod}};
//! let ball = Phantom::from_spec("ball?radius=12&shift=0.3,0.2,0.1")?;
//! let area = Crofton::Directions13.measure(&ball.labels()?.mask(1)).surface_area_mm2.expect("an area");
//! assert!((area / ball.truth().expect("exact").surface_area - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod crofton;
mod dilation;
mod directions;
mod lindblad;
mod odgaard_gundersen;
mod sample;
mod triangulation;
mod voxel_counting;

pub use crofton::Crofton;
pub use dilation::{area_derivative, structure_model_index};
pub use lindblad::Lindblad;
pub use odgaard_gundersen::OdgaardGundersen;
pub use sample::SampleValues;
#[cfg(feature = "io")]
pub(crate) use sample::cut_areas;
pub use triangulation::Triangulation;
pub use voxel_counting::VoxelCounting;

use crate::volume::{Mask, Spacing};
use serde::{Deserialize, Serialize};

/// A way to measure a mask.
pub trait ReferenceMethod: Sync {
    /// Its name on the command line and in records.
    fn name(&self) -> &'static str;

    /// Measures an object; what the method does not give stays `None`.
    fn measure(&self, mask: &Mask) -> ReferenceValues;

    /// The same for masks of one spacing, with what depends on nothing else worked out once.
    fn prepared(&self, _: Spacing) -> Prepared<'_> {
        Box::new(|mask| self.measure(mask))
    }

    /// Of methods that count the voxels' topology,
    /// [`SampleValues::euler_characteristic_edge_corrected`].
    fn edge_corrected_euler(&self, _: &Mask) -> Option<f64> {
        None
    }
}

/// A method made ready for masks of one spacing.
pub type Prepared<'a> = Box<dyn Fn(&Mask) -> ReferenceValues + Send + Sync + 'a>;

/// What a method gives; names and units as those of `measure`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ReferenceValues {
    /// V.
    pub volume_mm3: Option<f64>,
    /// A.
    pub surface_area_mm2: Option<f64>,
    /// M, the integral of H; 2 pi times the mean breadth.
    pub total_mean_curvature_mm: Option<f64>,
    /// M / A.
    pub average_mean_curvature_per_mm: Option<f64>,
    /// Of the surface: twice the solid's.
    pub euler_characteristic: Option<f64>,
    /// 6 V (dA / dr) / A^2: 0 of plates, 3 of rods, 4 of balls.
    pub structure_model_index: Option<f64>,
}

impl ReferenceValues {
    /// The same with M / A filled in.
    fn with_average(self) -> Self {
        let average = self.total_mean_curvature_mm.zip(self.surface_area_mm2).map(|(mean, area)| mean / area);
        Self { average_mean_curvature_per_mm: average, ..self }
    }
}

/// What bone scientists make of a method's values and a volume of interest (Bouxsein et al. 2010).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BoneValues {
    /// BV/TV.
    pub bone_volume_fraction: Option<f64>,
    /// BS/BV, 1/mm.
    pub specific_surface_per_mm: Option<f64>,
    /// Conn.D, 1/mm^3: 1 less the solid's Euler characteristic, over TV.
    pub connectivity_density_per_mm3: Option<f64>,
    /// BS/BV, 1/mm, without the faces in which the image cuts the object.
    pub specific_surface_without_cuts_per_mm: Option<f64>,
    /// Conn.D, 1/mm^3, with Odgaard and Gundersen's edge correction.
    pub connectivity_density_edge_corrected_per_mm3: Option<f64>,
}

impl BoneValues {
    /// In a total volume TV, mm^3.
    pub fn new(values: &ReferenceValues, total_volume: f64) -> Self {
        Self::of_sample(values, &SampleValues::default(), total_volume)
    }

    /// The same of a sample.
    pub fn of_sample(values: &ReferenceValues, sample: &SampleValues, total_volume: f64) -> Self {
        let specific = |area: Option<f64>| area.zip(values.volume_mm3).map(|(area, volume)| area / volume);
        let connectivity = |chi: Option<f64>| chi.map(|chi| (1.0 - 0.5 * chi) / total_volume);
        Self {
            bone_volume_fraction: values.volume_mm3.map(|volume| volume / total_volume),
            specific_surface_per_mm: specific(values.surface_area_mm2),
            connectivity_density_per_mm3: connectivity(values.euler_characteristic),
            specific_surface_without_cuts_per_mm: specific(sample.surface_area_without_cuts_mm2),
            connectivity_density_edge_corrected_per_mm3: connectivity(
                sample.euler_characteristic_edge_corrected,
            ),
        }
    }
}

/// All methods.
pub const METHODS: [&dyn ReferenceMethod; 9] = [
    &VoxelCounting,
    &OdgaardGundersen::Foreground26,
    &OdgaardGundersen::Foreground6,
    &Triangulation::Mask,
    &Triangulation::Smoothed,
    &Triangulation::SmoothedOneSided,
    &Crofton::Directions3,
    &Crofton::Directions13,
    &Lindblad,
];
