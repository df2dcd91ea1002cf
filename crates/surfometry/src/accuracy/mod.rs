//! Scale, compensation of the blur's shift, standard errors, and what a warning is.
//!
//! ```
//! use surfometry::{accuracy::auto_sigma, volume::Spacing};
//! // Two voxels, of the geometric mean of the spacings.
//! assert_eq!(auto_sigma(Spacing::new([0.5, 0.5, 4.0])?), 2.0);
//! # Ok::<(), surfometry::volume::VolumeError>(())
//! ```

mod compensation;
mod curvature_scale;
mod flags;
mod local_errors;
mod occupancy_noise;
mod position_noise;
mod ripples;
mod scale;
mod scale_choice;
mod shear;
mod soft_edges;
mod terraces;
mod uncertainty;

pub use compensation::{CompensationTerms, compensation_terms};
pub use curvature_scale::{PILOT_SPACINGS, auto_curvature_sigma, balanced_sigma, rms_spacing};
pub use flags::{Flag, FlagCode};
pub(crate) use flags::{decimals_for, mm_text, place_text, thick_slices};
pub(crate) use local_errors::scaled_errors;
pub use local_errors::{CurvatureDifferences, CurvatureErrors, LocalErrorModel};
pub use position_noise::PositionNoise;
pub use scale::{
    AUTO_SIGMA_SPACINGS, AUTO_THICKNESS_SPACINGS, auto_sigma, auto_thickness, auto_thickness_of_blur,
    band_variance, epsilon_of_blur, thickness_of_blur,
};
pub use scale_choice::local_scales;
pub(crate) use scale_choice::{largest_agreeing, noise_factor, vertex_noise};
#[cfg(feature = "io")]
pub(crate) use shear::taken_as_perpendicular;
pub(crate) use shear::{shear_errors, sheared};
pub use soft_edges::SoftEdges;
pub use terraces::Terraces;
pub use uncertainty::{ErrorModel, IntegralErrors};
pub(crate) use uncertainty::{SHARED, left_of_terraces, of_average};
