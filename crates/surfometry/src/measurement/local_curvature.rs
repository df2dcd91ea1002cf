//! Local curvature of the original object: which embedding, at which scale.

use super::local_scales::may_be_noisy;
use super::object::Content;
use super::scheme::Scheme;
use super::{Clip, EmbeddingKind, MeasureError, Measurement, Object, Parameters};
use crate::accuracy::{PILOT_SPACINGS, auto_curvature_sigma, balanced_sigma, rms_spacing};
use crate::embedding::TRUNCATION;
use crate::integrals::{Integrals, QuadratureRule};
use crate::local_geometry::Curvature;
use crate::tiling::{IndexBox, TILE};
use crate::volume::{Mask, ProbabilityImage, Shared, Spacing};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;

/// Fewest voxels that tell how curvature changes with scale.
const FEWEST_CHANGES: usize = 100;

/// The blur at which local curvature is measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum CurvatureScale {
    /// That of the integrals: curvature of the blurred object.
    #[default]
    AsMeasured,
    /// What is known to be best: [`CurvatureScale::Local`] since `experiments/local_scale`.
    Auto,
    /// The corrected embedding at one sigma, which follows the object's radius of curvature and the spacing:
    /// curvature of the original object, without detail that this sigma blurs. A tenth to all of the time.
    Object,
    /// The embedding that gives the object back, at a sigma of its own at each vertex: curvature of the original
    /// object. Soft segmentations, objects cut open and noisy masks, which nothing should give back, have one
    /// sigma, as [`CurvatureScale::Object`].
    Local,
    /// The corrected embedding at this sigma, mm.
    Mm(f64),
}

/// Sets up the object of which curvature is measured by another measurement.
type Prepare<'a> = &'a dyn Fn(&Measurement) -> Result<Object, MeasureError>;

impl Measurement {
    /// The measurement whose surface has the local curvature of the original object
    /// ([`EmbeddingKind::Corrected`]), at a given sigma, at those that suit its vertices, or at the one that suits the
    /// object: 0.66 h^(2/7) R^(5/7), with h the rms spacing and 1/R the rms over the surface of the larger principal curvature,
    /// from a pilot measurement at sigma = 3 h; then 0.6 to 1.45 times that, as the change of curvature with
    /// sigma tells noise from bias ([`balanced_sigma`]).
    ///
    /// # Errors
    /// [`MeasureError`] for an empty mask, an embedding without a blur, or a sigma that makes no sense.
    pub fn for_local_curvature(
        &self,
        mask: impl Shared<Mask>,
        scale: CurvatureScale,
    ) -> Result<Self, MeasureError> {
        let mask = mask.shared();
        self.at_local_scale(mask.grid().spacing(), scale, Some(&mask), &|m| m.prepare(&mask))
    }

    /// The same of a soft segmentation, for [`Measurement::prepare_probability`].
    ///
    /// # Errors
    /// Those of [`Measurement::for_local_curvature`] and of [`Measurement::prepare_probability`].
    pub fn for_local_curvature_of_probability(
        &self,
        image: impl Shared<ProbabilityImage>,
        scale: CurvatureScale,
    ) -> Result<Self, MeasureError> {
        let image = image.shared();
        let prepare = |measurement: &Self| measurement.prepare_probability(&image);
        self.at_local_scale(image.grid().spacing(), scale, None, &prepare)
    }

    fn at_local_scale(
        &self,
        spacing: Spacing,
        scale: CurvatureScale,
        mask: Option<&Mask>,
        prepare: Prepare,
    ) -> Result<Self, MeasureError> {
        if scale != CurvatureScale::AsMeasured && !self.embedding.is_blur() {
            return Err(MeasureError::Conflict(
                "a scale for curvature belongs to the embeddings that blur (gaussian, corrected, recovering, probability): leave it out",
            ));
        }
        let local = match scale {
            CurvatureScale::AsMeasured => return Ok(*self),
            CurvatureScale::Mm(sigma) => self.corrected(sigma),
            CurvatureScale::Object => self.corrected(self.scale_of(spacing, prepare)?),
            CurvatureScale::Auto | CurvatureScale::Local => self.of_vertices(spacing, mask, prepare)?,
        };
        Parameters::resolve(&local, spacing).map(|_| local)
    }

    /// A scale at each vertex, or one where that cannot be.
    fn of_vertices(
        &self,
        spacing: Spacing,
        mask: Option<&Mask>,
        prepare: Prepare,
    ) -> Result<Self, MeasureError> {
        let truncation = self.truncation.unwrap_or(TRUNCATION);
        let whole = mask.filter(|mask| self.clip != Clip::Exclude && !mask.is_empty());
        match (self.size_of(spacing, prepare)?, whole.filter(|mask| !may_be_noisy(mask, truncation))) {
            (Some((radius, _)), Some(_)) => Ok(self.with_local_scales(spacing, radius)),
            (size, _) => Ok(self.corrected(self.scale_of_size(spacing, size, prepare)?)),
        }
    }

    /// The corrected embedding at some blur, the rest as it suits that.
    pub(super) fn corrected(&self, sigma: f64) -> Self {
        Self {
            embedding: EmbeddingKind::Corrected,
            sigma: Some(sigma),
            thickness: None,
            epsilon: None,
            level: None,
            quadrature: QuadratureRule::Sum,
            derivatives: None,
            radius_of_scales: None,
            ..*self
        }
    }

    fn scale_of(&self, spacing: Spacing, prepare: Prepare) -> Result<f64, MeasureError> {
        let size = self.size_of(spacing, prepare)?;
        self.scale_of_size(spacing, size, prepare)
    }

    /// One scale for all of an object, from its radius of curvature and mean thickness.
    fn scale_of_size(
        &self,
        spacing: Spacing,
        size: Option<(f64, f64)>,
        prepare: Prepare,
    ) -> Result<f64, MeasureError> {
        let Some((radius, thickness)) = size else { return Ok(auto_curvature_sigma(spacing, 0.0, 0.0)) };
        let sigma = auto_curvature_sigma(spacing, radius, thickness);
        let changes = self.changes_with_scale(prepare, sigma, radius)?;
        Ok(changes.map_or(sigma, |changes| balanced_sigma(spacing, sigma, changes, (radius, thickness))))
    }

    /// Radius of curvature, 1 / rms of the larger principal curvature, and mean thickness of the blurred object,
    /// mm; `None` where nothing is left of it.
    fn size_of(&self, spacing: Spacing, prepare: Prepare) -> Result<Option<(f64, f64)>, MeasureError> {
        let pilot = Self { delta: self.delta, ..Self::default() };
        // Where the pilot's blur leaves nothing, an object is so small that half of it may.
        for share in [1.0, 0.5] {
            let sigma = share * PILOT_SPACINGS * rms_spacing(spacing);
            let surviving = prepare(&pilot.sigma_mm(sigma))?.plain_integrals();
            if let Some(integrals) = surviving.filter(Integrals::has_surface) {
                let surface = &integrals.surface;
                let radius = (surface.area / surface.larger_squared).sqrt();
                return Ok(Some((radius, 2.0 * integrals.volume / surface.area)));
            }
        }
        Ok(None)
    }

    /// Mean squares of the changes of H R and K R^2, summed, from sigma / sqrt 2 to sigma and from there to
    /// sqrt 2 sigma, at the voxels beside the surface; `None` where there are too few to tell.
    fn changes_with_scale(
        &self,
        prepare: Prepare,
        sigma: f64,
        radius: f64,
    ) -> Result<Option<[f64; 2]>, MeasureError> {
        let at = |sigma: f64| prepare(&self.corrected(sigma));
        let objects = [at(sigma / SQRT_2)?, at(sigma)?, at(SQRT_2 * sigma)?];
        let [Some(fine), Some(middle), Some(coarse)] = objects.each_ref().map(Object::beside_surface) else {
            return Ok(None);
        };
        let of_tile = |tile: &IndexBox| {
            let others = [&fine, &coarse].map(|(scheme, width)| curvatures(scheme, tile, 2.0 * width));
            let change = |(index, here): (&[i64; 3], &Curvature)| {
                let difference = |there: &Curvature| {
                    let mean = (there.mean_curvature - here.mean_curvature) * radius;
                    let gaussian = (there.gaussian_curvature - here.gaussian_curvature) * radius * radius;
                    mean * mean + gaussian * gaussian
                };
                // Where the surface has gone elsewhere, curvature has changed altogether.
                others.each_ref().map(|other| other.get(index).map_or(1.0, difference))
            };
            curvatures(&middle.0, tile, middle.1).iter().map(change).collect::<Vec<_>>()
        };
        let tiles = middle.0.limits(middle.1).tiles(TILE);
        let changes: Vec<[f64; 2]> = tiles.par_iter().map(of_tile).flatten().collect();
        Ok((changes.len() >= FEWEST_CHANGES).then(|| [0, 1].map(|n| trimmed_mean(&changes, n))))
    }
}

impl Object {
    /// The same object on the other side of the blur: of one that is blurred, the original surface at the scale that suits
    /// the object ([`CurvatureScale::Object`]), with standard errors; of one that is given back, the blurred surface at
    /// its sigma. `None` where nothing was blurred.
    ///
    /// # Errors
    /// Those of [`Measurement::for_local_curvature`].
    pub fn counterpart(&self) -> Result<Option<Self>, MeasureError> {
        let measurement = &self.setup.measurement;
        let object = match &self.content {
            Content::Mask(_) if measurement.embedding == EmbeddingKind::Gaussian => {
                measurement.for_local_curvature(&self.mask, CurvatureScale::Object)?.prepare(&self.mask)?
            }
            Content::Mask(_) | Content::Corrected(..) if measurement.embedding.is_corrected() => {
                measurement.embedding(EmbeddingKind::Gaussian).prepare(&self.mask)?
            }
            _ => return Ok(None),
        };
        Ok(Some(object.under(&self.setup.control)))
    }
}

/// Curvature at the voxels of a tile where |phi| <= `half_width`, in order of their indices.
fn curvatures(scheme: &Scheme, tile: &IndexBox, half_width: f64) -> BTreeMap<[i64; 3], Curvature> {
    let band = scheme.band(tile, half_width).into_iter();
    band.filter_map(|voxel| Some((voxel.index, Curvature::of(&voxel.jet)?))).collect()
}

/// Mean without the largest fiftieth: edges and specks are no reason to leave the rest noisy.
fn trimmed_mean(changes: &[[f64; 2]], number: usize) -> f64 {
    let mut values: Vec<f64> = changes.iter().map(|change| change[number]).collect();
    values.sort_by(f64::total_cmp);
    let kept = values.len() - values.len() / 50;
    values[..kept].iter().sum::<f64>() / kept as f64
}
