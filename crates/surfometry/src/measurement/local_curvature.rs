//! Local curvature of the original object: which embedding, at which scale.

use super::{EmbeddingKind, MeasureError, Measurement, Parameters};
use crate::accuracy::{PILOT_SPACINGS, auto_curvature_sigma, rms_spacing};
use crate::integrals::{Integrals, QuadratureRule};
use crate::volume::Mask;

/// The blur at which local curvature is measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum CurvatureScale {
    /// That of the integrals: curvature of the blurred object.
    #[default]
    AsMeasured,
    /// The corrected embedding at a sigma that follows the object's radius of curvature and the spacing: curvature of the original object.
    Auto,
    /// The corrected embedding at this sigma, mm.
    Mm(f64),
}

impl Measurement {
    /// The measurement whose surface has the local curvature of the original object ([`EmbeddingKind::Corrected`]), at a given sigma or at the one
    /// that suits the object: sigma = 0.66 h^(2/7) R^(5/7), with h the rms spacing and 1/R the rms over the surface of the larger principal
    /// curvature, from a pilot measurement at sigma = 3 h.
    ///
    /// # Errors
    /// [`MeasureError`] for an empty mask, an embedding without a blur, or a sigma that makes no sense.
    pub fn for_local_curvature(&self, mask: &Mask, scale: CurvatureScale) -> Result<Self, MeasureError> {
        let sigma = match scale {
            CurvatureScale::AsMeasured => return Ok(*self),
            CurvatureScale::Mm(sigma) => sigma,
            CurvatureScale::Auto => self.scale_of(mask)?,
        };
        if !self.embedding.is_blur() {
            return Err(MeasureError::Conflict(
                "a scale for curvature belongs to the Gaussian and corrected embeddings: leave --curvature-sigma out",
            ));
        }
        let local = Self {
            embedding: EmbeddingKind::Corrected,
            sigma: Some(sigma),
            thickness: None,
            epsilon: None,
            level: 0.5,
            quadrature: QuadratureRule::Sum,
            derivatives: None,
            ..*self
        };
        Parameters::resolve(&local, mask.grid().spacing()).map(|_| local)
    }

    fn scale_of(&self, mask: &Mask) -> Result<f64, MeasureError> {
        let spacing = mask.grid().spacing();
        let pilot = Self { delta: self.delta, ..Self::default() };
        // Where the pilot's blur leaves nothing, an object is so small that half of it may.
        for share in [1.0, 0.5] {
            let sigma = share * PILOT_SPACINGS * rms_spacing(spacing);
            let surviving = pilot.sigma_mm(sigma).prepare(mask)?.plain_integrals();
            if let Some(integrals) = surviving.filter(Integrals::has_surface) {
                let surface = &integrals.surface;
                let radius = (surface.area / surface.larger_squared).sqrt();
                return Ok(auto_curvature_sigma(spacing, radius, 2.0 * integrals.volume / surface.area));
            }
        }
        Ok(auto_curvature_sigma(spacing, 0.0, 0.0))
    }
}
