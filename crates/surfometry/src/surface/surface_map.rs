//! The surface with what is known at its vertices.

use super::isosurface::{cell_limits, stitched};
use super::tile_mesh::TileMesh;
use super::{CurvatureSummary, Distribution, LocalQuantity, Mesh, Sample, VertexArray, VertexGeometry};
use crate::Choice;
use crate::Control;
use crate::accuracy::{CurvatureDifferences, CurvatureErrors, LocalErrorModel};
use crate::integrals::Band;
use crate::local_geometry::{Curvature, Differentiation, FieldValue, Jet, TileField};
use crate::tiling::{IndexBox, Pool, TILE};
use crate::volume::{Grid, Spacing};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::OnceLock;

/// The level set phi = 0: a mesh, and the geometry at each of its vertices, from the field's derivatives
/// there. Distributions are those of the vertices as they were when one was first asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// The mesh.
    pub mesh: Mesh,
    /// One a vertex.
    pub vertices: Vec<VertexGeometry>,
    /// Other images at the vertices.
    pub samples: Vec<Sample>,
    distributions: OnceLock<Vec<Distribution>>,
}

impl Surface {
    /// Extracts the surface of a scheme's embedding and differentiates it at the vertices, tile by tile, in
    /// parallel.
    ///
    /// `band` says where the gradient has collapsed. Once the control says stop, nothing comes of it.
    pub(crate) fn of<D: Differentiation>(
        scheme: &D,
        grid: &Grid,
        band: &Band,
        extras: &VertexExtras,
        region: Option<IndexBox>,
        control: &Control,
    ) -> Self {
        let limits = cell_limits(scheme.embedding(), 0.0);
        let limits = region.map_or(limits, |region| limits.intersection(&region));
        let storage = Pool::<Vec<FieldValue<D>>>::default();
        let axes = grid.axes();
        let geometry_at = |jet: &Jet| {
            let curvature = band.curvature(jet)?;
            let displacement = match extras {
                VertexExtras::Shift { sigma } => Some(-sigma * sigma * curvature.mean_curvature),
                _ => None,
            };
            Some(VertexGeometry::of(jet, curvature, displacement, &axes))
        };
        let part = |tile: &IndexBox| {
            if control.is_stopped() {
                return Default::default();
            }
            storage.with(|memory| match scheme.tile_field(std::mem::take(memory), tile, 0.0) {
                TileField::Constant(_) => Default::default(),
                TileField::Varying(field) => {
                    let mesh = TileMesh::of(&field, tile, &limits);
                    let positions: Vec<[f64; 3]> =
                        mesh.own_vertices().map(|(_, position)| position).collect();
                    let jets = scheme.jets_at(&field, &positions);
                    *memory = field.into_storage();
                    let geometry: Vec<_> = jets.iter().map(geometry_at).collect();
                    let differences = match extras {
                        VertexExtras::Errors { plain_jets, .. } => {
                            differences(&geometry, &plain_jets(&positions))
                        }
                        _ => Vec::new(),
                    };
                    (mesh, (geometry, differences))
                }
            })
        };
        let (meshes, (geometry, differences)): (Vec<TileMesh>, (Vec<_>, Vec<_>)) =
            limits.tiles(TILE).par_iter().map(part).unzip();
        if control.is_stopped() {
            return Self::default();
        }
        let mesh = stitched(&meshes, grid);
        drop(meshes);
        let still = matches!(extras, VertexExtras::Shift { .. }).then_some(0.0);
        let vertices = completed(&mesh, geometry, still);
        let mut surface = Self { mesh, vertices, samples: Vec::new(), distributions: OnceLock::new() };
        if let VertexExtras::Errors { sigma, spacing, .. } = extras {
            surface.set_errors(*sigma, *spacing, grid, differences.into_iter().flatten());
        }
        surface
    }

    /// Standard errors, also from how far the plain blur's curvature is from the corrected one at each
    /// vertex, where it has one.
    fn set_errors(
        &mut self,
        sigma: f64,
        spacing: Spacing,
        grid: &Grid,
        differences: impl Iterator<Item = Option<CurvatureDifferences>>,
    ) {
        let larger = self.vertices.iter().map(|v| v.curvature.larger().powi(2));
        let (square, area) = larger
            .zip(self.weights())
            .fold((0.0, 0.0), |(square, area), (value, weight)| (square + value * weight, area + weight));
        let model = LocalErrorModel::new(sigma, spacing, (area / square).sqrt());
        for (vertex, differences) in self.vertices.iter_mut().zip(differences) {
            let along_axis = grid.cosine_to_nearest_axis(vertex.normal);
            let known = differences.filter(|_| vertex.has_normal);
            vertex.errors = Some(known.map_or_else(
                || CurvatureErrors::unknown(spacing),
                |differences| model.errors(&vertex.curvature, along_axis, &differences),
            ));
        }
    }

    /// Vertices where the field's gradient has collapsed.
    pub fn vertices_without_normal(&self) -> u64 {
        self.vertices.iter().filter(|vertex| !vertex.has_normal).count() as u64
    }

    /// Lets distributions be those of vertices that have changed.
    pub(super) fn forget_distributions(&mut self) {
        self.distributions = OnceLock::new();
    }

    /// The area that each vertex stands for, mm^2: 0 where it has no curvature.
    pub(super) fn weights(&self) -> Vec<f64> {
        let mut areas = self.mesh.vertex_areas();
        for (area, vertex) in areas.iter_mut().zip(&self.vertices) {
            if !vertex.has_normal {
                *area = 0.0;
            }
        }
        areas
    }

    /// Whether there is no surface.
    pub fn is_empty(&self) -> bool {
        self.mesh.triangles.is_empty()
    }

    /// The vertices' geometry as named columns, and samples behind it.
    pub fn arrays(&self) -> Vec<VertexArray> {
        let mut arrays = VertexGeometry::arrays(&self.vertices);
        arrays.extend(self.samples.iter().map(Sample::array));
        arrays
    }

    /// A quantity at every vertex; `None` where it is not defined.
    pub fn values(&self, quantity: LocalQuantity) -> Option<Vec<f64>> {
        quantity.of_all(&self.vertices)
    }

    /// Distributions of all quantities, by area and by vertex.
    pub fn distributions(&self) -> &[Distribution] {
        self.distributions.get_or_init(|| self.weighted_distributions(&self.weights(), &|_| true))
    }

    /// The part of the surface around vertices of which, by their number, something holds.
    pub fn part(&self, holds: impl Fn(usize) -> bool) -> SurfacePart {
        let within: Vec<bool> = (0..self.vertices.len()).map(holds).collect();
        let mut areas = self.weights();
        for (area, within) in areas.iter_mut().zip(&within) {
            *area = if *within { *area } else { 0.0 };
        }
        SurfacePart {
            area: areas.iter().sum(),
            curvature: CurvatureSummary::of(&self.vertices, &areas),
            distributions: self.weighted_distributions(&areas, &|n| within[n]),
        }
    }

    fn weighted_distributions(
        &self,
        areas: &[f64],
        holds: &(dyn Fn(usize) -> bool + Sync),
    ) -> Vec<Distribution> {
        let of = |quantity: &LocalQuantity| self.weighted(*quantity, areas, holds);
        LocalQuantity::ALL.par_iter().filter_map(of).collect()
    }

    /// Distribution of one quantity, without the vertices whose gradient has collapsed, or where it is not a number; `None`
    /// where it is not defined, or nothing is left.
    pub fn distribution(&self, quantity: LocalQuantity) -> Option<&Distribution> {
        self.distributions().iter().find(|distribution| distribution.name == quantity.name())
    }

    fn weighted(
        &self,
        quantity: LocalQuantity,
        areas: &[f64],
        holds: &(dyn Fn(usize) -> bool + Sync),
    ) -> Option<Distribution> {
        let kept = |n: usize| {
            let vertex = &self.vertices[n];
            let value = quantity.at(vertex).filter(|value| !value.is_nan())?;
            (vertex.has_normal && holds(n)).then_some((value, areas[n]))
        };
        let (values, areas): (Vec<f64>, Vec<f64>) = (0..self.vertices.len()).filter_map(kept).unzip();
        Distribution::of(quantity.name(), &values, &areas)
    }

    /// The surface's curvature in a few numbers; `None` where there is no surface.
    pub fn curvature_summary(&self) -> Option<CurvatureSummary> {
        CurvatureSummary::of(&self.vertices, &self.weights())
    }
}

/// Curvature over a part of a surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfacePart {
    /// Area that its vertices stand for, mm^2.
    #[serde(rename = "area_mm2")]
    pub area: f64,
    /// In a few numbers; `None` without area.
    pub curvature: Option<CurvatureSummary>,
    /// One a quantity.
    pub distributions: Vec<Distribution>,
}

/// What is told at a vertex beside its curvature.
pub(crate) enum VertexExtras<'a> {
    /// Nothing.
    None,
    /// How far a blur of `sigma` mm moved the surface, -sigma^2 H to first order.
    Shift {
        /// mm.
        sigma: f64,
    },
    /// Standard errors of a corrected embedding's curvature.
    Errors {
        /// mm.
        sigma: f64,
        /// Of the grid.
        spacing: Spacing,
        /// The derivatives of the embedding that is not corrected.
        plain_jets: &'a (dyn Fn(&[[f64; 3]]) -> Vec<Jet> + Sync),
    },
}

/// How far the plain blur's H and K are from the corrected ones, vertex by vertex.
fn differences(geometry: &[Option<VertexGeometry>], plain: &[Jet]) -> Vec<Option<CurvatureDifferences>> {
    let difference = |(vertex, jet): (&Option<VertexGeometry>, &Jet)| {
        Some(CurvatureDifferences::of(&vertex.as_ref()?.curvature, &Curvature::of(jet)?))
    };
    geometry.iter().zip(plain).map(difference).collect()
}

/// Gives vertices whose gradient has collapsed the mean normal of their triangles.
fn completed(
    mesh: &Mesh,
    geometry: Vec<Vec<Option<VertexGeometry>>>,
    displacement: Option<f64>,
) -> Vec<VertexGeometry> {
    let collapsed = geometry.iter().flatten().any(Option::is_none);
    if !collapsed {
        return geometry.into_par_iter().flat_map_iter(|part| part.into_iter().flatten()).collect();
    }
    let normals = mesh.vertex_normals();
    let complete = |(vertex, normal): (Option<VertexGeometry>, [f64; 3])| {
        vertex.unwrap_or_else(|| VertexGeometry::collapsed(normal, displacement))
    };
    geometry.into_iter().flatten().zip(normals).map(complete).collect()
}
