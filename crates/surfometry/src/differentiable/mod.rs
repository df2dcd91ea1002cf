//! Integrals over a surface with their derivatives by every voxel, for optimisation and learning.
//!
//! [`Differentiable`] takes a field phi, or a soft segmentation p that it blurs (phi = T - G_sigma * p), and
//! gives V, A and the integrals of H, K and H^2 over phi = 0 as the smeared band has them: the numbers that
//! [`Measurement`] calls `blurred`, of the same choices. [`Differentiable::gradient`] is the exact derivative of
//! those numbers, by the chain rule backwards through integrand, differences and blur; nothing is recorded on the
//! way.
//!
//! Numbers are not those of the original object: compensation is a model of what the blur did, and is left to the
//! caller, who has what it needs (docs/differentiable.md).
//!
//! ```
//! use surfometry::Measurement;
//! use surfometry::differentiable::{Differentiable, IntegralValues};
//! use surfometry::measurement::EmbeddingKind;
//! use surfometry::volume::Grid;
//!
//! // The distance from a sphere of 8 mm on a grid of unequal spacings.
//! let grid = Grid::axis_aligned([30, 28, 24], [0.8, 0.9, 1.1])?;
//! let phi: Vec<f64> = (0..grid.voxel_count())
//!     .map(|offset| grid.affine().apply(grid.index_of(offset).map(|i| i as f64)))
//!     .map(|[x, y, z]| ((x - 12.0).powi(2) + (y - 12.1).powi(2) + (z - 12.7).powi(2)).sqrt() - 8.0)
//!     .collect();
//! let sphere = Differentiable::new(&Measurement::default().embedding(EmbeddingKind::Given), grid)?;
//! let values = sphere.values(&phi)?;
//! assert!((values.surface_area / (4.0 * std::f64::consts::PI * 64.0) - 1.0).abs() < 0.01);
//!
//! // The field raised by a constant: the sphere shrinks, and A by dA/dR = 8 pi R.
//! let weights = IntegralValues { surface_area: 1.0, ..IntegralValues::default() };
//! let slope: f64 = sphere.gradient(&phi, &weights)?.iter().sum();
//! assert!((slope / (-8.0 * std::f64::consts::PI * 8.0) - 1.0).abs() < 0.02);
//! # Ok::<(), surfometry::measurement::MeasureError>(())
//! ```

mod band_sums;
mod differences;
mod integrand;
mod transposable_blur;

pub use integrand::IntegralValues;

use crate::accuracy::{auto_sigma, auto_thickness};
use crate::integrals::{Band, Quadrature, SmearedDelta};
use crate::local_geometry::{MATCHED_SIDE, MINIMUM_POINTS, MatchedWeights};
use crate::measurement::MOST_SIGMA_VOXELS;
use crate::measurement::{Clip, Derivatives, EmbeddingKind, MeasureError, Measurement, Parameters};
use crate::tiling::IndexBox;
use crate::volume::{Grid, LARGEST_FIELD_VALUE, PROBABILITY_TOLERANCE, Spacing, VolumeError};
use band_sums::BandSums;
use differences::Differences;
use rayon::prelude::*;
use transposable_blur::TransposableBlur;

/// The smallest sigma, in voxels along every axis, for which differences of the blurred field are right.
const LEAST_SIGMA: f64 = 1.75;
/// Values that are checked together.
const PART: usize = 1 << 14;
/// Voxels that a fourth-order difference takes on each side of a voxel that is not at the end of its block.
const FOURTH_ORDER_SIDE: usize = 2;

/// Integrals of images of one grid, with their derivatives.
#[derive(Debug)]
pub struct Differentiable {
    grid: Grid,
    parameters: Parameters,
    band: Band,
    differences: Differences,
    /// Quadrature weights along x, y, z of `region`.
    weights: [Vec<f64>; 3],
    /// Where the field is known: the grid, and of a blur what lies around it.
    region: IndexBox,
    blur: Option<TransposableBlur>,
}

impl Differentiable {
    /// For images of a grid, which are fields ([`EmbeddingKind::Given`]) or soft segmentations
    /// ([`EmbeddingKind::Probability`]).
    ///
    /// Choices mean what they mean to [`Measurement`], but for these. Of a field, a thickness is that of a signed
    /// distance in mm: of a field of another slope say epsilon, which a measurement derives from the field's
    /// slope, and which must not depend on the field here. Of a soft segmentation the derivatives are differences,
    /// matched ones from sigma = 1.75 voxels on, and sigma is, where nothing is said, as large as that asks: larger
    /// than a measurement's on slices more than 1.2 times as thick as voxels are wide.
    ///
    /// # Errors
    /// [`MeasureError`] for choices that make no sense or have no derivative here (other embeddings, Gaussian
    /// derivatives, padding, cuts left out), a blur or band too wide, and a field of fewer than six voxels along an
    /// axis.
    pub fn new(measurement: &Measurement, grid: Grid) -> Result<Self, MeasureError> {
        measurement.check()?;
        let conflict = |text| Err(MeasureError::Conflict(text));
        if measurement.clip != Clip::Cap || measurement.padding.is_some() {
            return conflict("clip and padding have no derivative: pad the image before it is handed over");
        }
        match measurement.embedding {
            EmbeddingKind::Given => Self::of_field(measurement, grid),
            EmbeddingKind::Probability => Self::of_blur(measurement, grid),
            _ => conflict(
                "derivatives are those of a field (the given embedding) or of a soft segmentation (probability): say which of the two it is",
            ),
        }
    }

    fn of_field(measurement: &Measurement, grid: Grid) -> Result<Self, MeasureError> {
        let dimensions = grid.dimensions();
        if let Some(axis) = dimensions.iter().position(|&voxels| voxels < MINIMUM_POINTS) {
            return Err(MeasureError::FieldTooSmall { axis, voxels: dimensions[axis] });
        }
        let mut parameters = Parameters::resolve(measurement, grid.spacing())?;
        if measurement.epsilon.is_some() {
            // The field's slope is not known: its band is taken to be as wide as bands are.
            parameters.thickness_mm = auto_thickness(grid.spacing());
        }
        let delta = SmearedDelta::new(parameters.delta, parameters.epsilon, f64::INFINITY);
        let quadrature = Quadrature::bounded(parameters.quadrature, dimensions);
        let region = grid.index_box();
        Ok(Self {
            grid,
            parameters,
            band: Band::new(delta, parameters.thickness_mm),
            differences: Differences::of_fourth_order(dimensions, grid.spacing().mm()),
            weights: weights_on(&quadrature, &region),
            region,
            blur: None,
        })
    }

    fn of_blur(measurement: &Measurement, grid: Grid) -> Result<Self, MeasureError> {
        let spacing = grid.spacing();
        let sigma =
            measurement.sigma.unwrap_or_else(|| auto_sigma(spacing).max(LEAST_SIGMA * spacing.largest()));
        let derivatives = derivatives_of_blur(measurement, sigma, spacing)?;
        let resolvable = measurement.sigma_mm(sigma).derivatives(Derivatives::FiniteDifference);
        let parameters = Parameters { derivatives, ..Parameters::resolve(&resolvable, spacing)? };
        Parameters::check_reach("sigma", sigma, MOST_SIGMA_VOXELS, spacing)?;
        let level = parameters.level.unwrap_or(0.5);
        let delta = SmearedDelta::new(parameters.delta, parameters.epsilon, parameters.saturation());
        let blur = TransposableBlur::new(sigma, spacing.mm(), measurement.truncation_with(derivatives));
        // The band ends where less than this is left of whatever the image holds; differences reach farther.
        let beyond = blur.reach(level - delta.half_width());
        let side = if derivatives == Derivatives::Matched { MATCHED_SIDE } else { FOURTH_ORDER_SIDE };
        // One voxel more, for the rounding of sums that are equal to the share.
        let region = grid.index_box().grown(beyond.map(|voxels| (voxels + side + 1) as i64));
        let differences = match derivatives {
            Derivatives::Matched => {
                Differences::matched(region.extent(), MatchedWeights::new(sigma, spacing.mm()).central())
            }
            _ => Differences::of_fourth_order(region.extent(), spacing.mm()),
        };
        Ok(Self {
            grid,
            parameters,
            band: Band::new(delta, parameters.thickness_mm),
            differences,
            weights: weights_on(&Quadrature::unbounded(parameters.quadrature), &region),
            region,
            blur: Some(blur),
        })
    }

    /// The choices, filled in.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The integrals of an image, x fastest. Where there is no surface they are 0, and V that of all voxels or
    /// none.
    ///
    /// # Errors
    /// [`MeasureError::Volume`] where the number of values is not the grid's, a value is not finite or beyond 1e30,
    /// or one of a soft segmentation does not lie between 0 and 1.
    pub fn values<T: Copy + Into<f64> + Sync>(&self, image: &[T]) -> Result<IntegralValues, MeasureError> {
        self.check(image)?;
        Ok(match &self.blur {
            None => self.sums(image).values(),
            Some(blur) => self.sums(&self.blurred(blur, image)).values(),
        })
    }

    /// Derivatives by every voxel of the image of the integrals' weighted sum: the vector-Jacobian product of
    /// [`Differentiable::values`]. In units of the weighted sum over those of the image.
    ///
    /// They are 0 where neither the band nor what it is computed from reaches. A voxel whose gradient is less than
    /// 5 % of a surface's counts for V only, so that the numbers jump where one comes to count; between jumps the
    /// derivative is exact.
    ///
    /// # Errors
    /// Those of [`Differentiable::values`].
    pub fn gradient<T: Copy + Into<f64> + Sync>(
        &self,
        image: &[T],
        weights: &IntegralValues,
    ) -> Result<Vec<f64>, MeasureError> {
        self.check(image)?;
        Ok(match &self.blur {
            None => self.sums(image).gradient(weights),
            Some(blur) => {
                // phi falls where p grows.
                let falling = weights.to_array().map(|weight| -weight);
                let by_phi =
                    self.sums(&self.blurred(blur, image)).gradient(&IntegralValues::from_array(falling));
                blur.apply(&by_phi, &self.region, &self.grid.index_box())
            }
        })
    }

    /// phi = T - G_sigma * p on the region.
    fn blurred<T: Copy + Into<f64> + Sync>(&self, blur: &TransposableBlur, image: &[T]) -> Vec<f64> {
        let level = self.parameters.level.unwrap_or(0.5);
        let mut phi = blur.apply(image, &self.grid.index_box(), &self.region);
        phi.par_iter_mut().for_each(|value| *value = level - *value);
        phi
    }

    fn sums<'a, T>(&'a self, phi: &'a [T]) -> BandSums<'a, T> {
        BandSums {
            phi,
            extent: self.region.extent(),
            differences: &self.differences,
            band: &self.band,
            weights: self.weights.each_ref().map(Vec::as_slice),
            cell_volume: self.grid.spacing().cell_volume(),
        }
    }

    fn check<T: Copy + Into<f64> + Sync>(&self, image: &[T]) -> Result<(), VolumeError> {
        let (found, expected) = (image.len(), self.grid.voxel_count());
        if found != expected {
            return Err(VolumeError::Incomplete { found, expected });
        }
        let (least, most) = match self.blur {
            None => (-LARGEST_FIELD_VALUE, LARGEST_FIELD_VALUE),
            Some(_) => (-PROBABILITY_TOLERANCE, 1.0 + PROBABILITY_TOLERANCE),
        };
        let fits = |value: f64| (least..=most).contains(&value);
        // Without a branch in a part, for nearly always all fit.
        let all_fit = |part: &[T]| part.iter().fold(true, |all, &value| all & fits(value.into()));
        if image.par_chunks(PART).all(all_fit) {
            return Ok(());
        }
        let Some(at) = image.iter().position(|&value| !fits(value.into())) else { return Ok(()) };
        let (index, value) = (self.grid.index_of(at), image[at].into());
        Err(match self.blur {
            Some(_) => VolumeError::NotAProbability { index, value },
            None if value.is_finite() => VolumeError::HugeValue { index, value },
            None => VolumeError::NotFinite { index, value },
        })
    }
}

/// Differences that are right for a blur, or those that were asked for.
fn derivatives_of_blur(m: &Measurement, sigma: f64, spacing: Spacing) -> Result<Derivatives, MeasureError> {
    // In double precision wide blurs have no upper end. A hair is allowed for spacings that went through f32.
    let wide_enough = sigma >= (LEAST_SIGMA - 1e-3) * spacing.largest();
    match m.derivatives {
        Some(Derivatives::FiniteDifference) => Ok(Derivatives::FiniteDifference),
        Some(Derivatives::Gaussian) => Err(MeasureError::Conflict(
            "integrals are differentiated through differences of the blurred field, not through Gaussian derivatives: leave derivatives out",
        )),
        _ if wide_enough => Ok(Derivatives::Matched),
        _ => Err(MeasureError::Conflict(
            "matched differences need a sigma of 1.75 voxels or more along every axis: take a larger sigma, leave it out, or take finite differences, which lose some of the area",
        )),
    }
}

fn weights_on(quadrature: &Quadrature, region: &IndexBox) -> [Vec<f64>; 3] {
    std::array::from_fn(|axis| quadrature.weights(axis, region.lower[axis]..region.upper[axis]))
}
