//! What a measurement gives; names and units as in the JSON contract (DESIGN.md 4).

use super::{ClipSummary, LocatedChange, Parameters};
use crate::accuracy::{CompensatedIntegrals, CompensationTerms, Flag, IntegralErrors};
use crate::integrals::Integrals;
use crate::phantoms::Truth;
use crate::surface::SurfaceSummary;
use crate::tiling::IndexBox;
use crate::topology::VoxelTopology;
use crate::volume::Grid;
use serde::Serialize;
use std::f64::consts::TAU;

/// Where there is no model of errors.
pub(super) const NO_ERRORS: &str = "standard errors are modelled for the Gaussian and the corrected embedding at level 0.5, Gaussian or matched derivatives, the sum, \
     and a sigma of at least 1.2 voxels (geometric mean); compensated.standard_error and grid_noise are null";

/// All results for one object. `None` is a number that could not be had; a flag says why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// Of the blurred object.
    #[serde(flatten)]
    pub plain: PlainValues,
    /// Of the original object.
    pub compensated: UncertainValues,
    /// Spread of the plain values over sub-voxel shifts.
    pub grid_noise: PlainValues,
    /// The surface phi = 0 as a mesh.
    pub mesh: MeshSummary,
    /// Counted voxels.
    pub voxels: VoxelSummary,
    /// Exact topology.
    pub topology: TopologySummary,
    /// Where the object was measured, where its image cuts it and that was left out.
    pub clip: Option<ClipSummary>,
    /// Exact integrals, for phantoms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth>,
    /// The choices behind the numbers.
    pub parameters: Parameters,
    /// The image.
    pub grid: GridSummary,
    /// Warnings.
    pub flags: Vec<Flag>,
    /// Time to read and decode the input, s.
    pub read_seconds: Option<f64>,
    /// Time from the decoded labels to all integrals, s.
    pub seconds: f64,
    /// What compensation added to the plain values, by cause; not part of the records.
    #[serde(skip)]
    pub compensation: Option<CompensationTerms>,
    /// Time by stage; not part of the records.
    #[serde(skip)]
    pub timings: StageSeconds,
}

impl std::ops::Deref for Measured {
    type Target = PlainValues;

    fn deref(&self) -> &PlainValues {
        &self.plain
    }
}

/// Integrals over an object and its surface.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PlainValues {
    /// V.
    pub volume_mm3: Option<f64>,
    /// A.
    pub surface_area_mm2: Option<f64>,
    /// M, the integral of H.
    pub total_mean_curvature_mm: Option<f64>,
    /// M / A, the paper's `<H>`.
    pub average_mean_curvature_per_mm: Option<f64>,
    /// The integral of K.
    pub total_gaussian_curvature: Option<f64>,
    /// The integral of K over 2 pi: a real number, not rounded.
    pub euler_characteristic: Option<f64>,
    /// The integral of H^2.
    pub total_squared_mean_curvature: Option<f64>,
}

impl PlainValues {
    pub(super) fn of(integrals: &Integrals) -> Self {
        let surface = &integrals.surface;
        if !integrals.has_surface() {
            return Self { volume_mm3: Some(integrals.volume), ..Self::default() };
        }
        Self {
            volume_mm3: Some(integrals.volume),
            surface_area_mm2: Some(surface.area),
            total_mean_curvature_mm: Some(surface.mean),
            average_mean_curvature_per_mm: Some(surface.mean / surface.area),
            total_gaussian_curvature: Some(surface.gaussian),
            euler_characteristic: Some(surface.gaussian / TAU),
            total_squared_mean_curvature: Some(surface.mean_squared),
        }
    }
}

impl PlainValues {
    /// What the grid makes of each.
    pub(super) fn of_noise(e: &IntegralErrors) -> Self {
        Self {
            volume_mm3: Some(e.volume),
            surface_area_mm2: Some(e.area),
            total_mean_curvature_mm: Some(e.mean),
            average_mean_curvature_per_mm: Some(e.average),
            total_gaussian_curvature: Some(e.gaussian),
            euler_characteristic: Some(e.gaussian / TAU),
            total_squared_mean_curvature: Some(e.mean_squared),
        }
    }
}

/// Time in each stage, s, summed over threads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageSeconds {
    /// Making the field.
    pub embed: f64,
    /// Differentiating it in the band.
    pub derive: f64,
    /// Curvature and sums.
    pub integrate: f64,
    /// The mesh.
    pub surface: f64,
    /// Euler numbers, components, cavities.
    pub topology: f64,
    /// Where topology changes, where that was looked into.
    pub explain: f64,
}

/// The integrals that can be compensated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct CompensatedValues {
    /// V.
    pub volume_mm3: Option<f64>,
    /// A.
    pub surface_area_mm2: Option<f64>,
    /// M, the integral of H.
    pub total_mean_curvature_mm: Option<f64>,
    /// M / A.
    pub average_mean_curvature_per_mm: Option<f64>,
}

/// Compensated integrals and their standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct UncertainValues {
    /// The values.
    #[serde(flatten)]
    pub values: CompensatedValues,
    /// Their standard errors.
    pub standard_error: CompensatedValues,
}

impl UncertainValues {
    pub(super) fn of(c: &CompensatedIntegrals, errors: Option<&IntegralErrors>) -> Self {
        let values = CompensatedValues {
            volume_mm3: Some(c.volume),
            surface_area_mm2: Some(c.area),
            total_mean_curvature_mm: Some(c.mean),
            average_mean_curvature_per_mm: Some(c.mean / c.area),
        };
        let error = |e: &IntegralErrors| CompensatedValues {
            volume_mm3: Some(e.volume),
            surface_area_mm2: Some(e.area),
            total_mean_curvature_mm: Some(e.mean),
            average_mean_curvature_per_mm: Some(e.average),
        };
        Self { values, standard_error: errors.map(error).unwrap_or_default() }
    }
}

impl std::ops::Deref for UncertainValues {
    type Target = CompensatedValues;

    fn deref(&self) -> &CompensatedValues {
        &self.values
    }
}

/// The surface phi = 0 as a mesh: a cross-check of the plain integrals that knows no band.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct MeshSummary {
    /// Enclosed volume; `None` where the surface is open.
    pub volume_mm3: Option<f64>,
    /// Sum of the triangles' areas.
    pub surface_area_mm2: Option<f64>,
    /// Number of vertices.
    pub vertices: Option<u64>,
    /// Number of triangles.
    pub triangles: Option<u64>,
}

impl MeshSummary {
    pub(super) fn of(mesh: &SurfaceSummary) -> Self {
        Self {
            volume_mm3: mesh.volume,
            surface_area_mm2: Some(mesh.area),
            vertices: Some(mesh.vertices),
            triangles: Some(mesh.triangles),
        }
    }
}

/// What counting voxels gives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VoxelSummary {
    /// Number of voxels.
    pub count: u64,
    /// Their volume.
    pub volume_mm3: f64,
    /// Their mean position in the world (RAS), mm.
    pub centroid_mm: [f64; 3],
    /// Area of the voxels' faces on the edge of the image: where it may have cut the object.
    pub cut_area_mm2: f64,
    /// First and last voxel index (x, y, z) along each axis, both inclusive.
    pub bounding_box: [[i64; 3]; 2],
}

impl VoxelSummary {
    /// Voxels of the bounding box.
    pub fn box_voxels(&self) -> usize {
        let [first, last] = self.bounding_box;
        IndexBox::new(first, last.map(|v| v + 1)).voxels()
    }
}

/// Topology of surface and voxels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TopologySummary {
    /// V - E + F of the surface phi = 0.
    pub euler_characteristic_mesh: Option<i64>,
    /// Of the voxels' surface, 26-connected foreground.
    pub euler_characteristic_voxels_26: i64,
    /// Of the voxels' surface, 6-connected foreground.
    pub euler_characteristic_voxels_6: i64,
    /// 26-connected pieces.
    pub components: u64,
    /// Enclosed 6-connected pieces of background.
    pub cavities: u64,
    /// components + cavities - chi_26 / 2.
    pub handles: i64,
    /// The Gauss-Bonnet characteristic that the band must see: the mean over its levels. `None` where it was not looked for.
    pub euler_characteristic_expected: Option<f64>,
    /// Where and what the blur and the band change; `None` where it was not looked for.
    pub changes: Option<Vec<LocatedChange>>,
}

impl TopologySummary {
    pub(super) fn of(topology: &VoxelTopology, mesh: Option<&SurfaceSummary>) -> Self {
        Self {
            euler_characteristic_mesh: mesh.map(SurfaceSummary::euler_characteristic),
            euler_characteristic_voxels_26: topology.euler_characteristic_26,
            euler_characteristic_voxels_6: topology.euler_characteristic_6,
            components: topology.components,
            cavities: topology.cavities,
            handles: topology.handles,
            euler_characteristic_expected: None,
            changes: None,
        }
    }
}

/// The image that an object lies in.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GridSummary {
    /// Voxels along x, y, z.
    pub dimensions: [usize; 3],
    /// Spacing along x, y, z.
    pub spacing_mm: [f64; 3],
}

impl GridSummary {
    pub(super) fn of(grid: &Grid) -> Self {
        Self { dimensions: grid.dimensions(), spacing_mm: grid.spacing().mm() }
    }
}
