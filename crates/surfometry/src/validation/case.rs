//! One shape in one pose on one grid.

use super::ZooShape;
use super::poses::UnitPose;
use crate::Choice;
use crate::choice::choices;
use crate::integrals::Globals;
use crate::measurement::{CurvatureScale, EmbeddingKind, MeasureError, Measured, Measurement, SurfaceValues};
use crate::phantoms::{Phantom, Pose, SurfacePoint, Truth};
use crate::volume::Mask;
use serde::Serialize;

/// What is measured once.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// The shape.
    pub shape: &'static ZooShape,
    /// R in units of the largest spacing.
    pub resolution: f64,
    /// Largest over smallest spacing.
    pub ratio: f64,
    /// Number of the pose.
    pub number: usize,
    /// Rotation, shift and size.
    pub pose: UnitPose,
    /// What is done to the mask.
    pub noise: Noise,
}

/// What is done to the masks of phantoms, as happens to those of scans.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Noise {
    /// Nothing.
    #[default]
    None,
    /// 1 % of the voxels beside the boundary are changed into the other kind.
    OnePercent,
    /// 5 % of them.
    FivePercent,
    /// Slices along z lie off by half a voxel in plane, as a standard deviation, as hand-drawn contours do.
    Slices,
}

choices!(Noise, "noise": {
    None = "none": "masks as they are",
    OnePercent = "flips-1": "1 % of the voxels beside the boundary changed",
    FivePercent = "flips-5": "5 % of them",
    Slices = "slices": "slices off by half a voxel in plane (standard deviation), as drawn by hand",
});

impl Noise {
    fn of(self, phantom: Phantom) -> Phantom {
        let [h, ..] = phantom.grid().spacing().mm();
        match self {
            Self::None => phantom,
            Self::OnePercent => phantom.with_flips(0.01),
            Self::FivePercent => phantom.with_flips(0.05),
            Self::Slices => phantom.with_jitter(0.5 * h),
        }
    }
}

/// Local curvature at the vertices of the corrected surface, against that of the exact surface beside them;
/// weighted by area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LocalErrors {
    /// Blur that was chosen, or the one that the mesh was made at where each vertex has its own, in rms spacings.
    pub sigma_voxels: f64,
    /// Rms of the error of H in % of the rms curvature 1/R.
    pub mean_curvature: f64,
    /// Rms of the error of K in % of 1/R^2.
    pub gaussian_curvature: f64,
    /// Rms distance from the exact surface, in rms spacings.
    pub position_voxels: f64,
    /// Share of the surface, in %, where the exact H lies within 1.96 standard errors.
    pub mean_coverage: f64,
    /// The same of K.
    pub gaussian_coverage: f64,
}

/// What came out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CaseResult {
    /// Shape.
    pub shape: &'static str,
    /// Whether constants were fitted on such shapes.
    pub tuned: bool,
    /// R in units of the largest spacing.
    pub resolution: f64,
    /// Largest over smallest spacing.
    pub ratio: f64,
    /// 1/R times sigma of the integrals.
    pub sigma_over_radius: f64,
    /// Rotation, shift and size.
    pub pose: UnitPose,
    /// What was done to the mask.
    pub noise: Noise,
    /// The embedding that its numbers are of.
    pub embedding: EmbeddingKind,
    /// Errors of the blurred object in %; of M, where M itself is small, as of minimal surfaces, in % of A / R.
    pub blurred: Globals,
    /// The same of the original object.
    pub original: Globals,
    /// Errors of the original object's values in units of their standard errors.
    pub standardised: Option<Globals>,
    /// Gauss-Bonnet less exact.
    pub euler_characteristic: f64,
    /// V - E + F less exact.
    pub mesh_euler_characteristic: i64,
    /// Local curvature, where it was asked for.
    pub local: Option<LocalErrors>,
}

/// A case ready to be sampled.
pub struct MadeCase {
    /// The case.
    pub case: Case,
    /// The shape on its grid.
    pub phantom: Phantom,
    /// Its exact integrals.
    pub truth: Truth,
    /// 1/R, 1/mm.
    curvature: f64,
}

impl MadeCase {
    /// Errors of values that somebody had of it, in % as those of [`CaseResult::original`].
    pub fn errors(&self, values: &SurfaceValues) -> Globals {
        relative_errors(values, &self.truth, self.curvature)
    }

    pub(super) fn run(&self, local: Option<CurvatureScale>) -> Result<CaseResult, MeasureError> {
        let Self { case, phantom, truth, curvature } = self;
        let mask = phantom.labels()?.mask(1);
        let measured = Measurement::default().run_settled(&mask)?;
        let chi = truth.euler_characteristic;
        Ok(CaseResult {
            shape: case.shape.name,
            tuned: case.shape.tuned,
            resolution: case.resolution,
            ratio: case.ratio,
            sigma_over_radius: measured.parameters.sigma_mm.unwrap_or(f64::NAN) * curvature,
            pose: case.pose,
            noise: case.noise,
            embedding: measured.parameters.embedding,
            blurred: self.errors(&measured.blurred),
            original: self.errors(&measured.values),
            standardised: standardised(&measured, truth),
            euler_characteristic: measured.blurred.euler_characteristic.unwrap_or(f64::NAN) - chi as f64,
            mesh_euler_characteristic: measured.topology.euler_characteristic_mesh.unwrap_or(0) - chi,
            local: local.map(|scale| local_errors(phantom, &mask, *curvature, scale)).transpose()?,
        })
    }
}

/// What is known of a shape in its unit size.
pub(super) struct Unit {
    truth: Truth,
    /// 1/R.
    curvature: f64,
}

impl Unit {
    pub(super) fn of(shape: &ZooShape) -> Self {
        let phantom =
            Phantom::new((shape.make)(1.0), Pose::new([0.0; 3], [0.0; 3]), [1.0; 3]).expect("a valid grid");
        Self {
            truth: phantom.truth().expect("the zoo's integrals converge"),
            curvature: phantom.rms_curvature(),
        }
    }
}

/// Most vertices at which local curvature is compared: the rest says the same.
const MOST_VERTICES: usize = 20_000;

/// V, A and M, measured less exact, in %; NaN where there is no value. Where the integral of H nearly cancels, its error is
/// told in terms of what would not, A / R.
pub(super) fn relative_errors(values: &SurfaceValues, truth: &Truth, curvature: f64) -> Globals {
    let exact_mean = truth.total_mean_curvature.abs().max(0.25 * truth.surface_area * curvature);
    let percent =
        |value: Option<f64>, exact: f64, unit: f64| value.map_or(f64::NAN, |v| 100.0 * (v - exact) / unit);
    let mean = percent(values.total_mean_curvature_mm, truth.total_mean_curvature, exact_mean);
    Globals {
        volume: percent(values.volume_mm3, truth.volume, truth.volume),
        area: percent(values.surface_area_mm2, truth.surface_area, truth.surface_area),
        total_mean_curvature: mean * truth.total_mean_curvature.signum(),
    }
}

impl Case {
    /// What its file is called, without an ending: shape, R and ratio, pose, noise.
    pub fn name(&self) -> String {
        let letters = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        let shape: String = self.shape.name.chars().map(letters).collect();
        let noise = if self.noise == Noise::None { String::new() } else { format!("_{}", self.noise.word()) };
        format!("{shape}_R{}_ratio{}_pose{}{noise}", self.resolution, self.ratio, self.number)
    }

    /// The phantom with its exact integrals.
    pub(super) fn made(&self, unit: &Unit) -> Result<MadeCase, MeasureError> {
        let (phantom, scale) = self.phantom(unit)?;
        Ok(MadeCase {
            case: *self,
            phantom,
            truth: unit.truth.scaled(scale),
            curvature: unit.curvature / scale,
        })
    }

    /// The phantom, in mm with a largest spacing of 1, and how many times its unit's size it has.
    fn phantom(&self, unit: &Unit) -> Result<(Phantom, f64), MeasureError> {
        let spacing = [1.0, 1.0 / self.ratio.sqrt(), 1.0 / self.ratio];
        let UnitPose { degrees, shift, size } = self.pose;
        let pose = Pose::new(degrees, std::array::from_fn(|a| shift[a] * spacing[a]));
        let radius = self.shape.half_thickness.unwrap_or(1.0 / unit.curvature);
        let scale = size * self.resolution / radius;
        Ok((self.noise.of(Phantom::new((self.shape.make)(scale), pose, spacing)?), scale))
    }
}

fn standardised(measured: &Measured, truth: &Truth) -> Option<Globals> {
    let (values, errors) = (measured.values, measured.standard_error);
    Some(Globals {
        volume: (values.volume_mm3? - truth.volume) / errors.volume_mm3?,
        area: (values.surface_area_mm2? - truth.surface_area) / errors.surface_area_mm2?,
        total_mean_curvature: (values.total_mean_curvature_mm? - truth.total_mean_curvature)
            / errors.total_mean_curvature_mm?,
    })
}

fn local_errors(
    phantom: &Phantom,
    mask: &Mask,
    curvature: f64,
    scale: CurvatureScale,
) -> Result<LocalErrors, MeasureError> {
    let measurement = Measurement::default().for_local_curvature(mask, scale)?;
    let object = measurement.prepare(mask)?;
    let surface = object.surface();
    if surface.is_empty() {
        return Err(MeasureError::Conflict(
            "nothing is left of a shape at so coarse a resolution: take a larger one, or leave local curvature out",
        ));
    }
    let spacing = crate::accuracy::rms_spacing(mask.grid().spacing());
    let areas = surface.mesh.vertex_areas();
    // Squares of the errors of H, K and the place; where H and K lie within their bars; all times areas.
    let mut sums = [0.0; 5];
    let mut total = 0.0;
    let stride = surface.vertices.len().div_ceil(MOST_VERTICES);
    for ((position, vertex), area) in
        surface.mesh.vertices.iter().zip(&surface.vertices).zip(areas).step_by(stride)
    {
        let Some(SurfacePoint { distance, curvature: exact }) = phantom.surface_point(*position) else {
            continue;
        };
        let (mean, gaussian) = (
            vertex.curvature.mean_curvature - exact.mean_curvature,
            vertex.curvature.gaussian_curvature - exact.gaussian_curvature,
        );
        let within = |error: f64, bar: f32| f64::from(u8::from(error.abs() <= 1.96 * f64::from(bar)));
        let covered = vertex
            .errors
            .map_or([0.0; 2], |e| [within(mean, e.mean_curvature), within(gaussian, e.gaussian_curvature)]);
        let terms = [mean * mean, gaussian * gaussian, distance * distance, covered[0], covered[1]];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += area * term);
        total += area;
    }
    let [mean, gaussian, distance, mean_covered, gaussian_covered] = sums.map(|sum| sum / total);
    Ok(LocalErrors {
        sigma_voxels: object.parameters().sigma_mm.unwrap_or(f64::NAN) / spacing,
        mean_curvature: 100.0 * mean.sqrt() / curvature,
        gaussian_curvature: 100.0 * gaussian.sqrt() / (curvature * curvature),
        position_voxels: distance.sqrt() / spacing,
        mean_coverage: 100.0 * mean_covered,
        gaussian_coverage: 100.0 * gaussian_covered,
    })
}
