//! Parameters -> all stages -> result.

mod parameters;
mod result;
mod voxels;

pub use parameters::{Derivatives, EmbeddingKind, MeasureError, Parameters};
pub use result::{
    CompensatedValues, GridSummary, Measured, PlainValues, TopologySummary, UncertainValues, VoxelSummary,
};

use crate::accuracy::{Evidence, Flag, FlagCode, band_variance, compensate, raise_flags};
use crate::embedding::{DistanceEmbedding, GaussianEmbedding, GaussianKernel, TRUNCATION};
use crate::integrals::{Band, Integrals, Quadrature, QuadratureRule, SmearedDelta, Smearing, integrate};
use crate::local_geometry::{FiniteDifferences, GaussianDerivatives, MINIMUM_POINTS};
use crate::topology::VoxelTopology;
use crate::volume::{FieldImage, LabelGroup, LabelImage, LabelSelection, Mask, VolumeError};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Largest sigma in voxels: the kernels' reach, five times that, is what a tile needs around it.
const MOST_SIGMA_VOXELS: f64 = 400.0;
/// Largest band of a distance in voxels: a tile is transformed with half of that around it.
const MOST_BAND_VOXELS: f64 = 60.0;

/// How to measure; the defaults are those of DESIGN.md 3.
///
/// ```
/// use surfometry::Measurement;
/// let paper = Measurement::paper();
/// let finer = Measurement::default().sigma_mm(1.0).thickness_mm(2.5);
/// # let _ = (paper, finer);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    pub(crate) embedding: EmbeddingKind,
    pub(crate) derivatives: Option<Derivatives>,
    pub(crate) quadrature: QuadratureRule,
    pub(crate) delta: Smearing,
    pub(crate) sigma: Option<f64>,
    pub(crate) thickness: Option<f64>,
    pub(crate) epsilon: Option<f64>,
    pub(crate) level: f64,
    truncation: f64,
}

impl Default for Measurement {
    fn default() -> Self {
        Self {
            embedding: EmbeddingKind::Gaussian,
            derivatives: None,
            quadrature: QuadratureRule::Sum,
            delta: Smearing::Sine,
            sigma: None,
            thickness: None,
            epsilon: None,
            level: 0.5,
            truncation: TRUNCATION,
        }
    }
}

/// Setters, each of which gives back the measurement, so that they can be chained.
impl Measurement {
    /// The paper's choices: fourth-order differences, Simpson's rule, sigma 2.0 mm, t 2.5 mm, level 0.5, sine.
    #[must_use]
    pub fn paper() -> Self {
        Self { quadrature: QuadratureRule::Simpson, ..Self::default() }
            .derivatives(Derivatives::FiniteDifference)
            .sigma_mm(2.0)
            .thickness_mm(2.5)
    }

    /// Standard deviation of the blur in mm; `None`, the default, follows the spacing.
    #[must_use]
    pub fn sigma_mm(self, sigma: impl Into<Option<f64>>) -> Self {
        Self { sigma: sigma.into(), ..self }
    }

    /// Thickness t of the band in mm; `None`, the default, follows the spacing.
    #[must_use]
    pub fn thickness_mm(self, thickness: impl Into<Option<f64>>) -> Self {
        Self { thickness: thickness.into(), ..self }
    }

    /// Half-width of the delta in units of phi, instead of a thickness.
    #[must_use]
    pub fn epsilon(self, epsilon: impl Into<Option<f64>>) -> Self {
        Self { epsilon: epsilon.into(), ..self }
    }

    /// Level T of the blurred indicator that is the surface, between 0 and 1.
    #[must_use]
    pub fn level(self, level: f64) -> Self {
        Self { level, ..self }
    }

    /// How an object becomes a field.
    #[must_use]
    pub fn embedding(self, embedding: EmbeddingKind) -> Self {
        Self { embedding, ..self }
    }

    /// How the field is differentiated; by default with Gaussian derivatives for the Gaussian embedding and with
    /// finite differences for the others.
    #[must_use]
    pub fn derivatives(self, derivatives: Derivatives) -> Self {
        Self { derivatives: Some(derivatives), ..self }
    }

    /// How band voxels are summed.
    #[must_use]
    pub fn quadrature(self, quadrature: QuadratureRule) -> Self {
        Self { quadrature, ..self }
    }

    /// Profile of the delta.
    #[must_use]
    pub fn delta(self, delta: Smearing) -> Self {
        Self { delta, ..self }
    }

    /// Cuts Gaussian kernels at another number of sigma than [`TRUNCATION`].
    #[must_use]
    pub fn truncation(self, truncation: f64) -> Self {
        Self { truncation, ..self }
    }

    /// Measures the selected labels of an image, each as an object of its own, in parallel. `progress` is told how many
    /// are done, of how many: first 0, then after each object, from whichever thread.
    ///
    /// # Errors
    /// [`MeasureError`] for a label that does not occur, an image without foreground, or parameters that make no sense.
    pub fn run_labels(
        &self,
        image: &LabelImage,
        selection: &LabelSelection,
        progress: impl Fn(usize, usize) + Sync,
    ) -> Result<Vec<(LabelGroup, Measured)>, MeasureError> {
        let groups = selection.resolve(image)?;
        let (done, total) = (AtomicUsize::new(0), groups.len());
        progress(0, total);
        let measure = |group: LabelGroup| {
            let start = Instant::now();
            let mask = image.group_mask(&group);
            let extraction = start.elapsed().as_secs_f64();
            let mut measured = self.run(&mask)?;
            measured.seconds += extraction;
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
            Ok((group, measured))
        };
        groups.into_par_iter().map(measure).collect()
    }

    /// Measures one object: the special case of one label.
    ///
    /// # Errors
    /// [`MeasureError`] for an empty mask or parameters that make no sense. An object that the blur removes is no
    /// error: its numbers are `None`, under the flag `surface-vanished`.
    pub fn run(&self, mask: &Mask) -> Result<Measured, MeasureError> {
        let start = Instant::now();
        let parameters = Parameters::resolve(self, mask.grid().spacing())?;
        if mask.is_empty() {
            return Err(VolumeError::NoForeground.into());
        }
        let delta = SmearedDelta::new(self.delta, parameters.epsilon, parameters.saturation());
        let integrals =
            self.embed_and_integrate(mask, &parameters, &Band::new(delta, parameters.thickness_mm))?;
        Ok(self.conclude(mask, parameters, &delta, integrals, start))
    }

    /// `None` where the blur is known to leave nothing.
    fn embed_and_integrate(
        &self,
        mask: &Mask,
        parameters: &Parameters,
        band: &Band,
    ) -> Result<Option<Integrals>, MeasureError> {
        let spacing = mask.grid().spacing();
        let quadrature = Quadrature::unbounded(self.quadrature);
        let Some(sigma) = parameters.sigma_mm else {
            if self.embedding == EmbeddingKind::Given {
                return Err(MeasureError::Conflict(
                    "a given embedding is a field, not a mask: use `run_field`",
                ));
            }
            Parameters::check_reach("thickness", parameters.thickness_mm, MOST_BAND_VOXELS, spacing)?;
            let scheme = FiniteDifferences::new(DistanceEmbedding::new(mask), spacing.mm());
            return Ok(Some(integrate(&scheme, band, &quadrature, spacing)));
        };
        if self.vanishes_for_certain(mask, sigma) {
            return Ok(None);
        }
        Parameters::check_reach("sigma", sigma, MOST_SIGMA_VOXELS, spacing)?;
        let embedding = GaussianEmbedding::new(mask, sigma, self.level, self.truncation);
        Ok(Some(match parameters.derivatives {
            Derivatives::Gaussian => {
                integrate(&GaussianDerivatives::new(embedding), band, &quadrature, spacing)
            }
            Derivatives::FiniteDifference => {
                integrate(&FiniteDifferences::new(embedding, spacing.mm()), band, &quadrature, spacing)
            }
        }))
    }

    /// Measures the level set phi = 0 of a field that is an embedding already.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, a field without negative voxels, or one of fewer than six
    /// voxels along an axis.
    pub fn run_field(&self, field: &FieldImage) -> Result<Measured, MeasureError> {
        let start = Instant::now();
        let measurement = Self { embedding: EmbeddingKind::Given, ..*self };
        let grid = field.grid();
        let spacing = grid.spacing();
        if let Some(axis) = grid.dimensions().iter().position(|&n| n < MINIMUM_POINTS) {
            return Err(MeasureError::FieldTooSmall { axis, voxels: grid.dimensions()[axis] });
        }
        let mut parameters = Parameters::resolve(&measurement, spacing)?;
        let mask = field.inside();
        if mask.is_empty() {
            return Err(VolumeError::NothingInside.into());
        }
        let scheme = FiniteDifferences::new(field, spacing.mm());
        // A band of thickness t spans t |grad phi| in units of phi.
        let slope = scheme.gradient_at_surface(&mask).filter(|g| g.is_finite() && *g > 0.0);
        match (self.epsilon, slope) {
            (Some(_), Some(slope)) => parameters.thickness_mm /= slope,
            (Some(_), None) => {}
            (None, slope) => parameters.epsilon *= slope.ok_or(MeasureError::FlatField)?,
        }
        let delta = SmearedDelta::new(measurement.delta, parameters.epsilon, f64::INFINITY);
        let band = Band::new(delta, parameters.thickness_mm);
        let quadrature = Quadrature::bounded(measurement.quadrature, grid.dimensions());
        let integrals = integrate(&scheme, &band, &quadrature, spacing);
        Ok(measurement.conclude(&mask, parameters, &delta, Some(integrals), start))
    }

    fn conclude(
        &self,
        mask: &Mask,
        parameters: Parameters,
        delta: &SmearedDelta,
        integrals: Option<Integrals>,
        start: Instant,
    ) -> Measured {
        let surviving = integrals.filter(|i| i.inside_voxels > 0);
        let compensated = parameters
            .compensable_sigma()
            .zip(surviving.filter(Integrals::has_surface))
            .map(|(sigma, integrals)| compensate(&integrals, sigma, band_variance(sigma, delta)));
        let seconds = start.elapsed().as_secs_f64();
        let topology = VoxelTopology::of(mask);
        let voxels = VoxelSummary::of(mask);
        let plain = surviving.map_or_else(PlainValues::default, |i| PlainValues::of(&i));
        let evidence = Evidence {
            spacing: mask.grid().spacing(),
            distance: self.embedding == EmbeddingKind::Distance,
            sigma: parameters.sigma_mm,
            thickness: parameters.thickness_mm,
            epsilon: parameters.epsilon,
            saturation: parameters.saturation(),
            voxel_volume: voxels.volume_mm3,
            voxel_euler: topology.euler_characteristic_26,
            compensated_volume: compensated.map(|c| c.volume),
            plain: surviving,
        };
        let compensated = compensated.filter(|_| !evidence.compensation_failed());
        let mut flags = self.parameter_flags(mask, &parameters);
        flags.extend(raise_flags(&evidence));
        flags.push(Flag::new(FlagCode::NotComputed, result::NOT_COMPUTED));
        Measured {
            plain,
            compensated: compensated.map_or_else(UncertainValues::default, |c| UncertainValues::of(&c)),
            grid_noise: PlainValues::default(),
            voxels,
            topology: TopologySummary::of(&topology),
            truth: None,
            parameters,
            grid: GridSummary::of(mask.grid()),
            flags,
            read_seconds: None,
            seconds,
        }
    }

    fn parameter_flags(&self, mask: &Mask, parameters: &Parameters) -> Vec<Flag> {
        let mut flags = Vec::new();
        let given = self.embedding == EmbeddingKind::Given;
        if mask.touches_border() && given {
            flags.push(Flag::new(FlagCode::SurfaceLeavesField, "the inside reaches the edge of the field, where its surface is left open: area and curvature miss that part and chi has no boundary term"));
        } else if mask.touches_border() {
            flags.push(Flag::new(FlagCode::TouchesBorder, "the object reaches the edge of the image and is closed there with a flat cap, which counts in volume, area and curvature"));
        }
        if parameters.compensable_sigma().is_none() {
            flags.push(Flag::new(FlagCode::CompensationUndefined, "compensation is defined for the Gaussian embedding at level 0.5 only, so `compensated` is null"));
        }
        flags
    }

    /// Whether the blurred indicator stays below the level everywhere: it is at most that of the bounding box, whose
    /// maximum is a product over the axes of the largest sum of as many neighbouring taps as the box is wide.
    fn vanishes_for_certain(&self, mask: &Mask, sigma: f64) -> bool {
        // From there on samples and the integral differ by less than the hundredth that is added.
        const FINE: f64 = 20.0;
        let (spacing, extent) = (mask.grid().spacing().mm(), mask.bounds().extent());
        let share = |a: usize| {
            let width = extent[a] as f64 * spacing[a];
            if sigma > FINE * spacing[a] {
                (1.01 * libm::erf(width / (2.0 * std::f64::consts::SQRT_2 * sigma))).min(1.0)
            } else {
                GaussianKernel::new(sigma, spacing[a], 0, self.truncation).largest_sum(extent[a])
            }
        };
        (0..3).map(share).product::<f64>() < self.level * (1.0 - 1e-6)
    }
}
