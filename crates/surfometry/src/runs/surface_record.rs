//! What is written of a surface besides its files.

use super::beside::{TOLD_SHARE, flag_beside};
use super::{AgainstRecord, BesideRole, InputObject, Record, Row};
use crate::accuracy::{Flag, FlagCode};
use crate::measurement::{EmbeddingKind, Measured, Regions};
use crate::surface::{CurvatureSummary, Distribution, QUANTILES, SampleSummary, SurfacePart};
use serde::Serialize;
use std::collections::BTreeSet;

/// Name and version of the format.
pub const MAP_SCHEMA: &str = "surfometry.map/1";

/// One object's results and how curvature is distributed over its surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceRecord {
    /// The results of `measure`.
    #[serde(flatten)]
    pub record: Record,
    /// The surface that was mapped, where that is not the one that was measured: at scales of its own.
    pub mapped: Option<MappedMesh>,
    /// Curvature over the surface; `None` where the blur left nothing.
    pub curvature: Option<CurvatureSummary>,
    /// Shares that the distributions' quantiles are at.
    pub quantiles: [f64; QUANTILES.len()],
    /// One a quantity.
    pub distributions: Vec<Distribution>,
    /// The same by region, in order of region; none where there are no regions.
    pub region_distributions: Vec<RegionDistributions>,
    /// How other volumes go with curvature, one a volume.
    pub samples: Vec<SampleSummary>,
    /// Vertices where the field's gradient has collapsed: their curvature is given as 0, and distributions
    /// leave them out.
    pub vertices_without_normal: u64,
    /// How the surface of a later image differs; `None` where none was named, or it lacks the object.
    pub against: Option<AgainstRecord>,
    /// The files that were written.
    pub files: Vec<String>,
}

/// The mesh of a surface that is mapped at scales of its own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MappedMesh {
    /// The field that it is of.
    pub embedding: EmbeddingKind,
    /// Enclosed volume.
    pub volume_mm3: f64,
    /// Sum of the triangles' areas.
    pub surface_area_mm2: f64,
    /// V - E + F.
    pub euler_characteristic: i64,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
}

impl MappedMesh {
    fn of(object: &InputObject) -> Option<Self> {
        let local = object.local.as_ref()?;
        let mesh = &object.surface().mesh;
        Some(Self {
            embedding: local.parameters().embedding,
            volume_mm3: mesh.volume(),
            surface_area_mm2: mesh.area(),
            euler_characteristic: mesh.euler_characteristic(),
            vertices: mesh.vertices.len(),
            triangles: mesh.triangles.len(),
        })
    }

    /// The warning that it is not quite the surface that was measured: by more of A than twice its error, or in topology.
    fn flag(&self, measured: &Measured) -> Option<Flag> {
        let (area, error) = measured
            .surface_area_mm2
            .zip(measured.standard_error.surface_area_mm2)
            .filter(|_| measured.clip.is_none())?;
        let off = (self.surface_area_mm2 - area) / area;
        let chi = measured.topology.euler_characteristic_mesh.filter(|chi| *chi != self.euler_characteristic);
        let area = (off.abs() * area > 2.0 * error).then(|| format!("its area is {:+.1} % off", 100.0 * off));
        let topology =
            chi.map(|chi| format!("its Euler characteristic is {}, not {chi}", self.euler_characteristic));
        let told: Vec<String> = area.into_iter().chain(topology).collect();
        let message = format!(
            "the surface that is mapped is not quite the one of the numbers: {}; at the scale that curvature is mapped at, thin parts tear and noise \
             is smoothed; where its shape counts, map it in the recovering embedding, without a scale for curvature",
            told.join(", and ")
        );
        (!told.is_empty()).then(|| Flag::new(FlagCode::MapDiffersFromObject, message))
    }
}

impl Row for SurfaceRecord {
    const SCHEMA: &'static str = MAP_SCHEMA;

    fn columns() -> Vec<String> {
        Record::columns()
    }
}

/// Curvature over the part of a surface in one region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionDistributions {
    /// Label of the region; 0 of what lies in none.
    pub region: i64,
    /// Its name, where it has one.
    pub name: Option<String>,
    /// What is found there.
    #[serde(flatten)]
    pub part: SurfacePart,
}

impl SurfaceRecord {
    /// Of an object, by regions too where they are asked for.
    pub fn of(object: &InputObject) -> Self {
        let surface = object.surface();
        let by_region = |regions: &Regions| -> Vec<RegionDistributions> {
            let membership = object.membership(regions);
            let labels: Vec<i64> =
                surface.mesh.vertices.iter().map(|&vertex| membership.of_point(vertex)).collect();
            let present: BTreeSet<i64> = labels.iter().copied().collect();
            let of = |region: i64| RegionDistributions {
                region,
                name: regions.name(region),
                part: surface.part(|vertex| labels[vertex] == region),
            };
            present.into_iter().map(of).collect()
        };
        let region_distributions = object.regions().map(by_region).unwrap_or_default();
        Self { region_distributions, ..Self::without_regions(object) }
    }

    /// The same without what is by region.
    pub fn without_regions(object: &InputObject) -> Self {
        let (mut record, surface) = (object.record(), object.surface());
        let mapped = MappedMesh::of(object);
        record.measured.flags.extend(mapped.and_then(|mapped| mapped.flag(&record.measured)));
        let vertices_without_normal = surface.vertices_without_normal();
        if vertices_without_normal > 0 {
            let message = format!(
                "the gradient has collapsed at {vertices_without_normal} of the surface's {} vertices: their curvature is given \
                 as 0, and distributions leave them out",
                surface.vertices.len()
            );
            record.measured.flags.push(Flag::new(FlagCode::VanishingGradient, message));
        }
        let samples: Vec<SampleSummary> =
            surface.samples.iter().map(|sample| sample.summary(surface)).collect();
        record.measured.flags.extend(samples.iter().filter_map(sample_flag));
        Self {
            record,
            mapped,
            curvature: surface.curvature_summary(),
            quantiles: QUANTILES,
            distributions: surface.distributions().to_vec(),
            region_distributions: Vec::new(),
            samples,
            vertices_without_normal,
            against: None,
            files: Vec::new(),
        }
    }
}

/// The warning of a sample that does not cover a surface, or is the same all over it.
fn sample_flag(sample: &SampleSummary) -> Option<Flag> {
    let outside = (sample.share_outside > TOLD_SHARE).then(|| {
        format!(
            "{:.1} % of the area has no value and is in no mean or correlation, for it lies outside the volume or beside voxels that are NaN",
            100.0 * sample.share_outside
        )
    });
    let constant = sample.is_constant().then(|| {
        "it is the same everywhere on the surface, up to rounding, and has no correlation".to_owned()
    });
    flag_beside(BesideRole::Sample, &sample.name, outside.into_iter().chain(constant))
}
