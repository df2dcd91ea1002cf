//! One object, ready for whatever is asked of it.

use super::result::{
    GridSummary, Measured, MeshSummary, NOT_COMPUTED, PlainValues, TopologySummary, UncertainValues,
    VoxelSummary,
};
use super::pass::Pass;
use super::scheme::Scheme;
use super::{EmbeddingKind, MeasureError, Measurement, Parameters};
use crate::accuracy::{
    CompensatedIntegrals, Evidence, Flag, FlagCode, band_variance, compensate, raise_flags,
};
use crate::integrals::{Band, Integrals, Quadrature, SmearedDelta};
use crate::local_geometry::{FiniteDifferences, MINIMUM_POINTS};
use crate::surface::{Surface, SurfaceSummary};
use crate::tiling::IndexBox;
use crate::topology::VoxelTopology;
use crate::volume::{FieldImage, Grid, Mask, VolumeError};
use std::borrow::Cow;
use std::time::{Duration, Instant};

/// An object with its parameters filled in and its field set up: the one that is measured, mapped and shown.
pub struct Object<'a> {
    pub(super) mask: Cow<'a, Mask>,
    pub(super) parameters: Parameters,
    pub(super) band: Band,
    quadrature: Quadrature,
    /// `None` where the blur is known to leave nothing.
    pub(super) scheme: Option<Scheme<'a>>,
    setup: Duration,
}

impl Measurement {
    /// Sets up one object.
    ///
    /// # Errors
    /// [`MeasureError`] for an empty mask or parameters that make no sense.
    pub fn prepare<'a>(&self, mask: &'a Mask) -> Result<Object<'a>, MeasureError> {
        let start = Instant::now();
        let parameters = Parameters::resolve(self, mask.grid().spacing())?;
        if mask.is_empty() {
            return Err(VolumeError::NoForeground.into());
        }
        let delta = SmearedDelta::new(self.delta, parameters.epsilon, parameters.saturation());
        Ok(Object {
            mask: Cow::Borrowed(mask),
            parameters,
            band: Band::new(delta, parameters.thickness_mm),
            quadrature: Quadrature::unbounded(self.quadrature),
            scheme: Scheme::of_mask(self, mask, &parameters)?,
            setup: start.elapsed(),
        })
    }

    /// Sets up the level set phi = 0 of a field that is an embedding already.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, a field without negative voxels, or one of fewer than six
    /// voxels along an axis.
    pub fn prepare_field<'a>(&self, field: &'a FieldImage) -> Result<Object<'a>, MeasureError> {
        let start = Instant::now();
        let measurement = Self { embedding: EmbeddingKind::Given, ..*self };
        let grid = field.grid();
        if let Some(axis) = grid.dimensions().iter().position(|&n| n < MINIMUM_POINTS) {
            return Err(MeasureError::FieldTooSmall { axis, voxels: grid.dimensions()[axis] });
        }
        let mut parameters = Parameters::resolve(&measurement, grid.spacing())?;
        let mask = field.inside();
        if mask.is_empty() {
            return Err(VolumeError::NothingInside.into());
        }
        let differences = FiniteDifferences::new(field, grid.spacing().mm());
        // A band of thickness t spans t |grad phi| in units of phi.
        let slope = differences.gradient_at_surface(&mask).filter(|g| g.is_finite() && *g > 0.0);
        match (self.epsilon, slope) {
            (Some(_), Some(slope)) => parameters.thickness_mm /= slope,
            (Some(_), None) => {}
            (None, slope) => parameters.epsilon *= slope.ok_or(MeasureError::FlatField)?,
        }
        let delta = SmearedDelta::new(measurement.delta, parameters.epsilon, f64::INFINITY);
        Ok(Object {
            mask: Cow::Owned(mask),
            parameters,
            band: Band::new(delta, parameters.thickness_mm),
            quadrature: Quadrature::bounded(measurement.quadrature, grid.dimensions()),
            scheme: Some(Scheme::Given(differences)),
            setup: start.elapsed(),
        })
    }
}

impl Object<'_> {
    /// The voxels: of a field, those where it is negative.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// The image's lattice.
    pub fn grid(&self) -> &Grid {
        self.mask.grid()
    }

    /// The choices, filled in.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The smeared delta.
    pub fn delta(&self) -> &SmearedDelta {
        self.band.delta()
    }

    /// Where there is a field: everywhere, unless it is given and ends with its image.
    pub fn available(&self, region: &IndexBox) -> IndexBox {
        match self.parameters.embedding {
            EmbeddingKind::Given => region.intersection(&self.grid().index_box()),
            _ => *region,
        }
    }

    /// The surface phi = 0 with the geometry at its vertices; empty where the blur left nothing.
    pub fn surface(&self) -> Surface {
        let shift = self.parameters.compensable_sigma();
        self.scheme.as_ref().map(|scheme| scheme.surface(self.grid(), &self.band, shift)).unwrap_or_default()
    }

    /// The integrals alone, without mesh, topology and flags; `None` where the blur is known to leave nothing.
    pub fn integrals(&self) -> Option<Integrals> {
        let sums = self.scheme.as_ref()?.sums(&self.pass(false));
        Some(Integrals::of(&sums.integrals, self.grid().spacing()))
    }

    fn pass(&self, with_surface: bool) -> Pass<'_> {
        Pass {
            band: &self.band,
            quadrature: &self.quadrature,
            spacing: self.grid().spacing(),
            with_surface,
        }
    }

    /// All numbers.
    pub fn measure(&self) -> Measured {
        let start = Instant::now();
        let scheme = self.scheme.as_ref();
        let sums = scheme.map(|s| s.sums(&self.pass(true))).unwrap_or_default();
        let integrals = scheme.map(|_| Integrals::of(&sums.integrals, self.grid().spacing()));
        let surviving = integrals.filter(|i| i.inside_voxels > 0);
        let compensated = self.compensated(surviving);
        let seconds = (self.setup + start.elapsed()).as_secs_f64();
        let mesh = Some(SurfaceSummary::of_sums(&sums.surface)).filter(|mesh| mesh.triangles > 0);
        let topology = VoxelTopology::of(&self.mask);
        let voxels = VoxelSummary::of(&self.mask);
        let evidence = self.evidence(surviving, compensated, mesh, &topology, &voxels);
        let mut flags = self.parameter_flags();
        flags.extend(raise_flags(&evidence));
        flags.push(Flag::new(FlagCode::NotComputed, NOT_COMPUTED));
        let compensated = compensated.filter(|_| !evidence.compensation_failed());
        Measured {
            plain: surviving.map_or_else(PlainValues::default, |i| PlainValues::of(&i)),
            compensated: compensated.map_or_else(UncertainValues::default, |c| UncertainValues::of(&c)),
            grid_noise: PlainValues::default(),
            mesh: mesh.map_or_else(MeshSummary::default, |mesh| MeshSummary::of(&mesh)),
            voxels,
            topology: TopologySummary::of(&topology, mesh.as_ref()),
            truth: None,
            parameters: self.parameters,
            grid: GridSummary::of(self.grid()),
            flags,
            read_seconds: None,
            seconds,
        }
    }

    fn compensated(&self, integrals: Option<Integrals>) -> Option<CompensatedIntegrals> {
        let sigma = self.parameters.compensable_sigma()?;
        let integrals = integrals.filter(Integrals::has_surface)?;
        Some(compensate(&integrals, sigma, band_variance(sigma, self.band.delta())))
    }

    fn evidence(
        &self,
        plain: Option<Integrals>,
        compensated: Option<CompensatedIntegrals>,
        mesh: Option<SurfaceSummary>,
        topology: &VoxelTopology,
        voxels: &VoxelSummary,
    ) -> Evidence {
        Evidence {
            spacing: self.grid().spacing(),
            distance: self.parameters.embedding == EmbeddingKind::Distance,
            sigma: self.parameters.sigma_mm,
            thickness: self.parameters.thickness_mm,
            epsilon: self.parameters.epsilon,
            saturation: self.parameters.saturation(),
            voxel_volume: voxels.volume_mm3,
            voxel_euler: topology.euler_characteristic_26,
            compensated_volume: compensated.map(|c| c.volume),
            plain,
            mesh,
        }
    }

    fn parameter_flags(&self) -> Vec<Flag> {
        let mut flags = Vec::new();
        let given = self.parameters.embedding == EmbeddingKind::Given;
        if self.mask.touches_border() && given {
            flags.push(Flag::new(FlagCode::SurfaceLeavesField, "the inside reaches the edge of the field, where its surface is left open: area and curvature miss that part and chi has no boundary term"));
        } else if self.mask.touches_border() {
            flags.push(Flag::new(FlagCode::TouchesBorder, "the object reaches the edge of the image and is closed there with a flat cap, which counts in volume, area and curvature"));
        }
        if self.parameters.compensable_sigma().is_none() {
            flags.push(Flag::new(FlagCode::CompensationUndefined, "compensation is defined for the Gaussian embedding at level 0.5 only, so `compensated` is null"));
        }
        flags
    }
}
