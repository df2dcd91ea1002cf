//! An object at several scales, of which each vertex of its surface has its own.

use super::object::Content;
use super::recovery::RecoverySummary;
use super::scheme::Scheme;
use super::setup::Setup;
use super::{EmbeddingKind, Measurement, Object};
use crate::accuracy::local_scales;
use crate::embedding::{CorrectedMask, EdgeProfile, Price, Recovery};
use crate::local_geometry::Jet;
use crate::surface::{ScaledField, Surface};
use crate::volume::{Mask, Spacing};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Sigma at which it is told whether a mask is noisy, in geometric mean spacings: thin parts are not taken for
/// noise there, nor noise for detail (`experiments/recovering_embedding`).
const SIGMA_OF_EVIDENCE: f64 = 2.0;

/// An object recovered at one scale.
#[derive(Debug, Clone)]
pub(super) struct AtScale {
    setup: Setup,
    voxels: Arc<CorrectedMask>,
}

/// Whether a mask has, or may have, noise that no recovery should follow.
pub(super) fn may_be_noisy(mask: &Mask, truncation: f64) -> bool {
    let sigma = SIGMA_OF_EVIDENCE * mask.grid().spacing().geometric_mean();
    recovery(sigma, truncation).may_be_noisy(mask)
}

fn recovery(sigma: f64, truncation: f64) -> Recovery {
    Recovery { sigma, truncation, price: Price::FromEvidence, margin: 0.0 }
}

impl Measurement {
    /// The measurement of an object of some radius of curvature, mm, that gives each vertex a scale; sigma is
    /// the one that the mesh is made at.
    pub(super) fn with_local_scales(&self, spacing: Spacing, radius: f64) -> Self {
        let scales = local_scales(spacing, radius);
        Self { radius_of_scales: Some(radius), ..self.recovering_at(scales[scales.len() / 2]) }
    }

    /// An object whose surface is made at the sigma of a setup and has a scale of its own at each vertex.
    pub(super) fn at_local_scales(&self, setup: Setup, mask: &Arc<Mask>, radius: f64) -> Object {
        let start = Instant::now();
        let scales = local_scales(setup.grid.spacing(), radius);
        let at = |&sigma: &f64| {
            let measurement = self.recovering_at(sigma);
            let setup =
                Setup { control: setup.control.clone(), ..Setup::of_masks(&measurement, setup.grid).ok()? };
            let found = recovery(sigma, setup.truncation()).corrections_of_wide_blur(mask);
            Some(AtScale { setup, voxels: Arc::new(CorrectedMask::new(mask, found.amounts)) })
        };
        let scales: Vec<AtScale> = scales.par_iter().filter_map(at).collect();
        let middle = &scales[scales.len() / 2];
        let content = Content::Corrected(Arc::clone(&middle.voxels), RecoverySummary::default());
        Object { mask: Arc::clone(mask), setup, content, scales, part: None, preparation: start.elapsed() }
    }

    /// The recovering embedding at some blur, the rest as it suits that.
    fn recovering_at(&self, sigma: f64) -> Self {
        Self { embedding: EmbeddingKind::Recovering, ..self.corrected(sigma) }
    }
}

impl Object {
    /// The least and the largest sigma, mm, of which each vertex of the surface has one of its own; `None` where all
    /// have that of [`Object::parameters`].
    pub fn local_sigmas(&self) -> Option<[f64; 2]> {
        let sigma = |scale: &AtScale| scale.setup.parameters.sigma_mm;
        Some([sigma(self.scales.first()?)?, sigma(self.scales.last()?)?])
    }

    /// The surface at the middle one of its scales, its vertices moved to where their own have it.
    pub(super) fn surface_at_local_scales(&self) -> Surface {
        let mut surface = self.bare_surface();
        let schemes: Vec<SchemesAt<'_>> = self.scales.iter().filter_map(AtScale::schemes).collect();
        surface.at_local_scales(&schemes, self.grid(), &self.setup.control);
        surface
    }
}

/// Fields of an object at one scale.
struct SchemesAt<'a> {
    sigma: f64,
    corrected: Scheme<'a>,
    plain: Scheme<'a>,
}

impl ScaledField for SchemesAt<'_> {
    fn sigma(&self) -> f64 {
        self.sigma
    }

    fn slope(&self) -> f64 {
        EdgeProfile::corrected(self.sigma).slope(0.0).abs()
    }

    fn jets(&self, points: &[[f64; 3]]) -> Vec<Jet> {
        self.corrected.jets(points)
    }

    fn plain_jets(&self, points: &[[f64; 3]]) -> Vec<Jet> {
        self.plain.jets(points)
    }
}

impl AtScale {
    fn schemes(&self) -> Option<SchemesAt<'_>> {
        let uncorrected = Setup { parameters: self.setup.parameters.uncorrected(), ..self.setup.clone() };
        Some(SchemesAt {
            sigma: self.setup.parameters.sigma_mm?,
            corrected: Scheme::of_blur(&self.setup, &*self.voxels)?,
            plain: Scheme::of_blur(&uncorrected, &*self.voxels)?,
        })
    }
}
