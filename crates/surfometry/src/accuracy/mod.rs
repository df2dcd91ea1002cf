//! Scale, compensation of the blur's shift, and warnings.

mod compensation;
mod flags;
mod scale;

pub use compensation::{CompensatedIntegrals, compensate};
pub use flags::{Evidence, Flag, FlagCode, raise_flags};
pub use scale::{
    AUTO_SIGMA_SPACINGS, AUTO_THICKNESS_SPACINGS, auto_sigma, auto_thickness, auto_thickness_of_blur,
    band_variance, epsilon_of_blur, thickness_of_blur,
};
