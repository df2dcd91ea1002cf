//! What is decided before an object's voxels are known, and how numbers are made of what was summed over them.

use super::clip::{BoundaryTerms, ClipSummary, MeasuredPart};
use super::pass::{ObjectSums, Pass};
use super::result::{
    GridSummary, Measured, MeshSummary, NO_ERRORS, PlainValues, StageSeconds, TopologySummary,
    UncertainValues,
};
use super::voxels::VoxelCounts;
use super::{Derivatives, EmbeddingKind, MeasureError, Measurement, Parameters};
use crate::accuracy::{
    CompensationTerms, ErrorModel, Evidence, Flag, FlagCode, NarrowPlace, Terraces, band_variance,
    compensation_terms, raise_flags,
};
use crate::integrals::{Band, Integrals, Quadrature, QuadratureRule, SmearedDelta};
use crate::local_geometry::{CentralWeights, matched_weights};
use crate::surface::SurfaceSummary;
use crate::topology::TopologyCounter;
use crate::volume::{Grid, Mask, Spacing};
use std::ops::Range;
use std::time::{Duration, Instant};

/// The choices for one image, filled in.
#[derive(Clone, Copy)]
pub(super) struct Setup {
    pub(super) measurement: Measurement,
    pub(super) parameters: Parameters,
    pub(super) band: Band,
    pub(super) quadrature: Quadrature,
    pub(super) grid: Grid,
    /// For matched differences.
    pub(super) weights: Option<[CentralWeights; 3]>,
    /// How far integrals are from exact; `None` where that was not studied.
    pub(super) errors: Option<ErrorModel>,
    /// What the blur leaves of the voxels' steps; `None` where errors are.
    pub(super) terraces: Option<Terraces>,
}

/// What was summed over an object, whole or as far as its slices have come.
#[derive(Clone, Default)]
pub(super) struct Totals {
    pub(super) sums: ObjectSums,
    pub(super) topology: TopologyCounter,
    pub(super) voxels: VoxelCounts,
    /// Where the object is measured, where the image cuts it and that is left out.
    pub(super) open: Option<OpenPart>,
    /// Time until the integrals were known.
    pub(super) integrated: Duration,
    pub(super) topology_time: Duration,
}

/// A part of an object whose surface is open at its ends.
#[derive(Clone, Copy)]
pub(super) struct OpenPart {
    pub(super) part: MeasuredPart,
    pub(super) boundary: BoundaryTerms,
}

/// Least sigma, in geometric means of the spacings, for which errors are modelled.
const LEAST_SIGMA: f64 = 1.2;

impl Setup {
    /// For objects that are masks.
    pub(super) fn of_masks(measurement: &Measurement, grid: Grid) -> Result<Self, MeasureError> {
        if measurement.embedding == EmbeddingKind::Given {
            return Err(MeasureError::Conflict("a given embedding is a field, not a mask: use `run_field`"));
        }
        let parameters = Parameters::resolve(measurement, grid.spacing())?;
        let delta = SmearedDelta::new(measurement.delta, parameters.epsilon, parameters.saturation());
        let band = Band::new(delta, parameters.thickness_mm);
        let blurred = parameters.shift_sigma().zip(parameters.level);
        let errors = error_model(&parameters, grid.spacing());
        let modelled = errors.zip(parameters.profile());
        Ok(Self {
            measurement: *measurement,
            parameters,
            band: blurred.map_or(band, |(sigma, level)| band.of_blurred_edge(sigma, level)),
            quadrature: Quadrature::unbounded(measurement.quadrature),
            grid,
            weights: parameters
                .sigma_mm
                .filter(|_| parameters.derivatives == Derivatives::Matched)
                .map(|sigma| matched_weights(sigma, grid.spacing().mm())),
            errors,
            terraces: modelled.map(|(model, profile)| model.terraces(&profile, &delta)),
        })
    }

    pub(super) fn pass(&self, with_surface: bool) -> Pass<'_> {
        Pass {
            band: &self.band,
            quadrature: &self.quadrature,
            spacing: self.grid.spacing(),
            with_surface,
            region: None,
            slices: None,
        }
    }

    /// Plain and compensated integrals.
    pub(super) fn values(
        &self,
        sums: &ObjectSums,
        open: Option<&OpenPart>,
    ) -> (PlainValues, UncertainValues) {
        let surviving = self.surviving(sums);
        let terms = self.compensation(surviving, open);
        (plain_values(surviving, open), self.compensated(surviving, terms))
    }

    /// All numbers of an object.
    pub(super) fn measured(&self, totals: &Totals) -> Measured {
        let surviving = self.surviving(&totals.sums);
        let open = totals.open.as_ref();
        let terms = self.compensation(surviving, open);
        let mesh = Some(SurfaceSummary::of_sums(&totals.sums.surface)).filter(|mesh| mesh.triangles > 0);
        let topology = totals.topology.topology();
        let voxels = totals.voxels.summary(&self.grid);
        let compensated_volume = surviving.zip(terms).map(|(plain, terms)| terms.added_to(&plain).volume);
        let cell_volume = self.grid.spacing().cell_volume();
        let clip = open.map(|open| open.part.summary(cell_volume, &open.boundary));
        let evidence = Evidence {
            spacing: self.grid.spacing(),
            distance: self.parameters.embedding.is_distance(),
            corrected: self.parameters.embedding == EmbeddingKind::Corrected,
            sigma: self.parameters.sigma_mm,
            thickness: self.parameters.thickness_mm,
            epsilon: self.parameters.epsilon,
            saturation: self.parameters.saturation(),
            voxel_volume: clip.map_or(voxels.volume_mm3, |clip| clip.voxel_volume_mm3),
            voxel_euler: topology.euler_characteristic_26,
            narrow: surviving.map(|plain| self.narrow_places(&plain)).unwrap_or_default(),
            boundary_curvature: open.map(|open| open.boundary.curvature),
            compensated_volume,
            plain: surviving,
            mesh,
        };
        let surface = surviving.filter(Integrals::has_surface);
        let area = surface.map(|integrals| integrals.surface.area);
        let mut flags = self.parameter_flags(totals.voxels.cut_areas(&self.grid), area, clip);
        flags.extend(raise_flags(&evidence));
        if self.errors.is_none() && surface.is_some() {
            flags.push(Flag::new(FlagCode::NotComputed, NO_ERRORS));
        }
        let noise = self.errors.zip(surface).map(|(model, integrals)| model.grid_noise(&integrals));
        let terms = terms.filter(|_| !evidence.compensation_failed());
        Measured {
            plain: plain_values(surviving, open),
            compensated: self.compensated(surviving, terms),
            grid_noise: noise.map_or_else(PlainValues::default, |e| PlainValues::of_noise(&e)),
            mesh: mesh.map_or_else(MeshSummary::default, |mesh| MeshSummary::of(&mesh)),
            voxels,
            topology: TopologySummary::of(&topology, mesh.as_ref()),
            clip,
            truth: None,
            parameters: self.parameters,
            grid: GridSummary::of(&self.grid),
            flags,
            read_seconds: None,
            seconds: totals.integrated.as_secs_f64(),
            compensation: terms,
            timings: totals.timings(),
        }
    }

    /// Where the object and the gaps in it are narrowest, of those whose share of the band counts.
    fn narrow_places(&self, plain: &Integrals) -> [Option<NarrowPlace>; 2] {
        plain.narrow.map(|narrow| {
            let (index, _) = narrow.narrowest?;
            let position_mm = self.grid.affine().apply(index.map(|v| v as f64));
            Some(NarrowPlace { share: narrow.voxels as f64 / plain.band_voxels as f64, position_mm })
        })
    }

    /// The integrals; `None` where nothing is inside the level set.
    pub(super) fn surviving(&self, sums: &ObjectSums) -> Option<Integrals> {
        let integrals = Integrals::of(&sums.integrals, self.grid.spacing());
        (integrals.inside_voxels > 0).then_some(integrals)
    }

    /// What compensation adds; `None` where it is not defined.
    fn compensation(
        &self,
        integrals: Option<Integrals>,
        open: Option<&OpenPart>,
    ) -> Option<CompensationTerms> {
        let sigma = self.parameters.compensable_sigma()?;
        let integrals = integrals.filter(Integrals::has_surface)?;
        let variance = band_variance(&self.parameters.profile()?, self.band.delta());
        let mut terms = compensation_terms(&integrals, sigma, variance, self.terraces.as_ref());
        if let Some(OpenPart { boundary, .. }) = open {
            terms.shift.area += sigma * sigma * boundary.area;
            terms.shift.mean += sigma * sigma * boundary.mean;
        }
        Some(terms)
    }

    fn compensated(&self, plain: Option<Integrals>, terms: Option<CompensationTerms>) -> UncertainValues {
        let Some((plain, terms)) = plain.zip(terms) else { return UncertainValues::default() };
        let errors = self.errors.map(|model| model.compensated(&plain));
        UncertainValues::of(&terms.added_to(&plain), errors.as_ref())
    }

    fn parameter_flags(
        &self,
        cuts: [[f64; 2]; 3],
        area: Option<f64>,
        clip: Option<ClipSummary>,
    ) -> Vec<Flag> {
        let mut flags = Vec::new();
        let touches_border = cuts.as_flattened().iter().any(|&cut| cut > 0.0);
        let given = self.parameters.embedding == EmbeddingKind::Given;
        if touches_border && given {
            flags.push(Flag::new(FlagCode::SurfaceLeavesField, "the inside reaches the edge of the field, where its surface is left open: area and curvature miss that part and chi has no boundary term"));
        } else if touches_border {
            flags.push(touching(cuts, area, clip));
        }
        if self.parameters.compensable_sigma().is_none() {
            flags.push(Flag::new(FlagCode::CompensationUndefined, "compensation is defined for the Gaussian and the corrected embedding at level 0.5 only, so `compensated` is null"));
        }
        flags
    }
}

/// Of an open surface, the Euler characteristic has a part from the boundary (Gauss-Bonnet).
fn plain_values(integrals: Option<Integrals>, open: Option<&OpenPart>) -> PlainValues {
    let mut values = integrals.map_or_else(PlainValues::default, |i| PlainValues::of(&i));
    if let Some(open) = open {
        let total = |of_surface: f64| (of_surface + open.boundary.curvature) / std::f64::consts::TAU;
        values.euler_characteristic = values.total_gaussian_curvature.map(total);
    }
    values
}

fn error_model(p: &Parameters, spacing: Spacing) -> Option<ErrorModel> {
    let enough = |sigma: &f64| *sigma >= LEAST_SIGMA * spacing.geometric_mean();
    let sigma = p.sigma_mm.filter(|sigma| p.level == Some(0.5) && enough(sigma))?;
    let studied = p.derivatives != Derivatives::FiniteDifference && p.quadrature == QuadratureRule::Sum;
    studied.then(|| ErrorModel::new(spacing, sigma, p.thickness_mm))
}

/// Where the image's edge cuts an object, and how much of its surface that makes.
fn touching(cuts: [[f64; 2]; 3], area: Option<f64>, clip: Option<ClipSummary>) -> Flag {
    let mut places = Vec::new();
    for (axis, cuts) in ["x", "y", "z"].iter().zip(cuts) {
        for (end, cut) in ["first", "last"].iter().zip(cuts).filter(|(_, cut)| *cut > 0.0) {
            places.push(format!("{end} {axis} ({cut:.1} mm2)"));
        }
    }
    if let Some(clip) = clip {
        let message = format!(
            "the object reaches the edge of the image in the slice {}: what lies within {:.4} mm of it is left out, so the numbers are those of an \
             open surface between sections of {:.1} mm2",
            places.join(", "),
            clip.rim_mm,
            clip.section_area_mm2
        );
        return Flag::new(FlagCode::TouchesBorder, message);
    }
    let total: f64 = cuts.as_flattened().iter().sum();
    let share =
        area.map_or_else(String::new, |area| format!(", {:.1} % of its surface", 100.0 * total / area));
    let message = format!(
        "the object reaches the edge of the image in the slice {}{share}: it is closed there with a flat cap, which counts in volume, area \
         and curvature",
        places.join(", ")
    );
    Flag::new(FlagCode::TouchesBorder, message)
}

impl Totals {
    /// Counts the voxels and the topology of the next slices; see [`TopologyCounter::add`] for what the mask must hold.
    pub(super) fn add_voxels(&mut self, mask: &Mask, slices: Range<i64>) {
        let start = Instant::now();
        self.topology.add(mask, slices.clone());
        self.voxels.add(mask, slices);
        self.topology_time += start.elapsed();
    }

    fn timings(&self) -> StageSeconds {
        let times = &self.sums.times;
        StageSeconds {
            embed: times.embed.as_secs_f64(),
            derive: times.derive.as_secs_f64(),
            integrate: times.integrate.as_secs_f64(),
            surface: times.surface.as_secs_f64(),
            topology: self.topology_time.as_secs_f64(),
            explain: 0.0,
        }
    }
}
