//! One shape in one pose on one grid.

use super::ZooShape;
use super::poses::UnitPose;
use crate::measurement::{CurvatureScale, MeasureError, Measured, Measurement, SurfaceValues};
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
    /// Rotation, shift and size.
    pub pose: UnitPose,
}

/// Measured against exact, in %.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RelativeErrors {
    /// V.
    pub volume: f64,
    /// A.
    pub surface_area: f64,
    /// M; of the size of A / R where M itself is small, as of minimal surfaces.
    pub total_mean_curvature: f64,
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
    /// The blurred object.
    pub blurred: RelativeErrors,
    /// The original object.
    pub original: RelativeErrors,
    /// Errors of the original object's values in units of their standard errors.
    pub standardised: Option<RelativeErrors>,
    /// Gauss-Bonnet less exact.
    pub euler_characteristic: f64,
    /// V - E + F less exact.
    pub mesh_euler_characteristic: i64,
    /// Local curvature, where it was asked for.
    pub local: Option<LocalErrors>,
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

impl Case {
    /// The phantom, in mm with a largest spacing of 1, and how many times its unit's size it has.
    fn phantom(&self, unit: &Unit) -> Result<(Phantom, f64), MeasureError> {
        let spacing = [1.0, 1.0 / self.ratio.sqrt(), 1.0 / self.ratio];
        let UnitPose { degrees, shift, size } = self.pose;
        let pose = Pose::new(degrees, std::array::from_fn(|a| shift[a] * spacing[a]));
        let scale = size * self.resolution * unit.curvature;
        Ok((Phantom::new((self.shape.make)(scale), pose, spacing)?, scale))
    }

    pub(super) fn run(&self, unit: &Unit, local: Option<CurvatureScale>) -> Result<CaseResult, MeasureError> {
        let (phantom, scale) = self.phantom(unit)?;
        let (truth, curvature) = (unit.truth.scaled(scale), unit.curvature / scale);
        let mask = phantom.labels()?.mask(1);
        let measured = Measurement::default().run(&mask)?;
        // Where the integral of H nearly cancels, its error is told in terms of what would not.
        let exact_mean = truth.total_mean_curvature.abs().max(0.25 * truth.surface_area * curvature)
            * truth.total_mean_curvature.signum();
        let percent = |value: Option<f64>, exact: f64, unit: f64| {
            value.map_or(f64::NAN, |v| 100.0 * (v - exact) / unit)
        };
        let errors = |values: &SurfaceValues| RelativeErrors {
            volume: percent(values.volume_mm3, truth.volume, truth.volume),
            surface_area: percent(values.surface_area_mm2, truth.surface_area, truth.surface_area),
            total_mean_curvature: percent(
                values.total_mean_curvature_mm,
                truth.total_mean_curvature,
                exact_mean,
            ),
        };
        let chi = truth.euler_characteristic;
        Ok(CaseResult {
            shape: self.shape.name,
            tuned: self.shape.tuned,
            resolution: self.resolution,
            ratio: self.ratio,
            sigma_over_radius: measured.parameters.sigma_mm.unwrap_or(f64::NAN) * curvature,
            pose: self.pose,
            blurred: errors(&measured.blurred),
            original: errors(&measured.values),
            standardised: standardised(&measured, &truth),
            euler_characteristic: measured.blurred.euler_characteristic.unwrap_or(f64::NAN) - chi as f64,
            mesh_euler_characteristic: measured.topology.euler_characteristic_mesh.unwrap_or(0) - chi,
            local: local.map(|scale| local_errors(&phantom, &mask, curvature, scale)).transpose()?,
        })
    }
}

fn standardised(measured: &Measured, truth: &Truth) -> Option<RelativeErrors> {
    let (values, errors) = (measured.values, measured.standard_error);
    Some(RelativeErrors {
        volume: (values.volume_mm3? - truth.volume) / errors.volume_mm3?,
        surface_area: (values.surface_area_mm2? - truth.surface_area) / errors.surface_area_mm2?,
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
