//! What a measurement gives; names and units as in the JSON contract (docs/contract.md).

use super::RecoverySummary;
use super::{ClipSummary, LocatedChange, Parameters};
use crate::accuracy::{CompensationTerms, Flag, IntegralErrors, of_average};
use crate::choice::choices;
use crate::integrals::{Globals, Integrals};
use crate::surface::SurfaceSummary;
use crate::tiling::IndexBox;
use crate::topology::VoxelTopology;
use crate::volume::Grid;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Where there is no model of errors.
pub(super) const NO_ERRORS: &str = "standard errors are modelled for the Gaussian and the corrected embedding at level 0.5, Gaussian or matched \
     derivatives, the sum, and a sigma of at least 1.2 voxels (geometric mean); standard_error and blurred.grid_noise \
     are null";

/// Which surface the unqualified numbers of a result describe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DescribedSurface {
    /// The object's as it was segmented.
    Original,
    /// That of the embedding, phi = 0.
    Blurred,
    /// The zero level of a field that was given.
    Given,
}

choices!(DescribedSurface, "surface": {
    Original = "original": "The object's as it was segmented",
    Blurred = "blurred": "The embedding's own, phi = 0",
    Given = "given": "The zero level of a field that was given",
});

/// All results for one object, which [`Deref`](std::ops::Deref) to the numbers that one takes first: those of
/// `surface`. `None` is a number that could not be had; a flag says why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Which surface `values` and `standard_error` describe.
    pub surface: DescribedSurface,
    /// The numbers. The original's Euler characteristic is exact: that of its voxels, 26-connected, or, of
    /// the part between cuts, that of the mesh; its bending energy cannot be had.
    #[serde(flatten)]
    pub values: SurfaceValues,
    /// Standard errors of `values`.
    pub standard_error: SurfaceValues,
    /// Integrals over phi = 0.
    pub blurred: BlurredValues,
    /// The surface phi = 0 as a mesh.
    pub mesh: MeshSummary,
    /// Counted voxels.
    pub voxels: VoxelSummary,
    /// Exact topology.
    pub topology: TopologySummary,
    /// Where the object was measured, where its image cuts it and that was left out.
    pub clip: Option<ClipSummary>,
    /// The choices behind the numbers.
    pub parameters: Parameters,
    /// The image.
    pub grid: GridSummary,
    /// Of the recovering embedding, what corrections did; `None` of others.
    #[serde(default)]
    pub recovery: Option<RecoverySummary>,
    /// Warnings.
    pub flags: Vec<Flag>,
    /// What compensation added to the blurred values, by cause; not part of the records.
    #[serde(skip)]
    pub compensation: Option<CompensationTerms>,
    /// Time by stage; not part of the records.
    #[serde(skip)]
    pub timings: StageSeconds,
}

impl std::ops::Deref for Measured {
    type Target = SurfaceValues;

    fn deref(&self) -> &SurfaceValues {
        &self.values
    }
}

/// Integrals over phi = 0, as the paper has them; its Euler characteristic is that of Gauss and Bonnet, a
/// real number.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BlurredValues {
    /// The integrals.
    #[serde(flatten)]
    pub values: SurfaceValues,
    /// Their spread over sub-voxel shifts.
    pub grid_noise: SurfaceValues,
}

impl std::ops::Deref for BlurredValues {
    type Target = SurfaceValues;

    fn deref(&self) -> &SurfaceValues {
        &self.values
    }
}

/// Volume of an object and integrals over its surface, or the errors of such.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SurfaceValues {
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
    /// Of the surface: 2 for a ball, 0 for a torus.
    pub euler_characteristic: Option<f64>,
    /// The integral of H^2.
    pub total_squared_mean_curvature: Option<f64>,
}

impl SurfaceValues {
    /// Standard errors with more of a cause that is independent of the others, of A and M, mm^2 and mm; `values` are those
    /// that they are of.
    #[must_use]
    pub(super) fn with(self, area: f64, total_mean_curvature: f64, values: &Self) -> Self {
        let more = |error: Option<f64>, of: f64| error.map(|error| libm::hypot(error, of));
        let average = |values: &Self| {
            let known = [values.surface_area_mm2?, values.total_mean_curvature_mm?];
            Some(of_average(known, [area, total_mean_curvature], 0.0))
        };
        Self {
            surface_area_mm2: more(self.surface_area_mm2, area),
            total_mean_curvature_mm: more(self.total_mean_curvature_mm, total_mean_curvature),
            average_mean_curvature_per_mm: self
                .average_mean_curvature_per_mm
                .zip(average(values))
                .map(|(error, of)| libm::hypot(error, of)),
            ..self
        }
    }

    /// Over phi = 0.
    pub(super) fn of(integrals: &Integrals) -> Self {
        let surface = &integrals.surface;
        if !integrals.has_surface() {
            return Self { volume_mm3: Some(integrals.volume), ..Self::default() };
        }
        Self {
            volume_mm3: Some(integrals.volume),
            surface_area_mm2: Some(surface.area),
            total_mean_curvature_mm: Some(surface.total_mean_curvature),
            average_mean_curvature_per_mm: Some(surface.total_mean_curvature / surface.area),
            total_gaussian_curvature: Some(surface.total_gaussian_curvature),
            euler_characteristic: Some(surface.total_gaussian_curvature / TAU),
            total_squared_mean_curvature: Some(surface.total_squared_mean_curvature),
        }
    }

    /// What the grid makes of each.
    pub(super) fn of_noise(e: &IntegralErrors) -> Self {
        Self {
            volume_mm3: Some(e.volume),
            surface_area_mm2: Some(e.area),
            total_mean_curvature_mm: Some(e.total_mean_curvature),
            average_mean_curvature_per_mm: Some(e.average_mean_curvature),
            total_gaussian_curvature: Some(e.total_gaussian_curvature),
            euler_characteristic: Some(e.total_gaussian_curvature / TAU),
            total_squared_mean_curvature: Some(e.total_squared_mean_curvature),
        }
    }

    /// Of the original object.
    pub(super) fn compensated(c: &Globals) -> Self {
        Self {
            volume_mm3: Some(c.volume),
            surface_area_mm2: Some(c.area),
            total_mean_curvature_mm: Some(c.total_mean_curvature),
            average_mean_curvature_per_mm: Some(c.total_mean_curvature / c.area),
            ..Self::default()
        }
    }

    /// Standard errors of the original object's.
    pub(super) fn of_errors(e: &IntegralErrors) -> Self {
        Self {
            volume_mm3: Some(e.volume),
            surface_area_mm2: Some(e.area),
            total_mean_curvature_mm: Some(e.total_mean_curvature),
            average_mean_curvature_per_mm: Some(e.average_mean_curvature),
            ..Self::default()
        }
    }
}

/// Time in each stage, s, summed over threads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageSeconds {
    /// Finding the corrections that give an object back, and reading their surface, on the clock.
    pub recover: f64,
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
    /// Having the object as a whole, where that was not needed before, to look into its topology.
    pub read_again: f64,
    /// Finding out where topology changes.
    pub explain: f64,
    /// From the decoded labels to all integrals, on the clock: a record's `seconds`.
    pub integrals: f64,
}

impl StageSeconds {
    /// The stages by their names, in their order.
    pub fn named(&self) -> [(&'static str, f64); 8] {
        [
            ("recover", self.recover),
            ("embed", self.embed),
            ("derive", self.derive),
            ("integrate", self.integrate),
            ("topology", self.topology),
            ("surface", self.surface),
            ("read again", self.read_again),
            ("explain", self.explain),
        ]
    }

    /// Of two objects.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            recover: self.recover + other.recover,
            embed: self.embed + other.embed,
            derive: self.derive + other.derive,
            integrate: self.integrate + other.integrate,
            surface: self.surface + other.surface,
            topology: self.topology + other.topology,
            read_again: self.read_again + other.read_again,
            explain: self.explain + other.explain,
            integrals: self.integrals + other.integrals,
        }
    }
}

/// The surface phi = 0 as a mesh: a cross-check of the plain integrals that knows no band.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// The Gauss-Bonnet characteristic that the band must see: the mean over its levels. `None` where it was
    /// not looked for.
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
