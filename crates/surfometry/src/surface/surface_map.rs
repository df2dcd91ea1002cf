//! The surface with what is known at its vertices.

use super::isosurface::{SurfaceTiles, stitched};
use super::tile_mesh::TileMesh;
use super::{CurvatureSummary, Distribution, LocalQuantity, Mesh, VertexArray, VertexGeometry};
use crate::embedding::Embedding;
use crate::local_geometry::{Curvature, Differentiation, Jet};
use crate::tiling::IndexBox;
use crate::volume::Grid;
use rayon::prelude::*;

/// The level set phi = 0: a mesh, and the geometry at each of its vertices, from the field's derivatives there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// The mesh.
    pub mesh: Mesh,
    /// One a vertex.
    pub vertices: Vec<VertexGeometry>,
    /// Vertices where the field's gradient vanishes; their curvature is given as 0 and their normal as that of a neighbour
    /// in memory.
    pub vertices_without_normal: u64,
}

impl Surface {
    /// Extracts the surface of an embedding and differentiates it at the vertices, tile by tile, in parallel.
    ///
    /// `shift_sigma` is the blur that moved the surface by -sigma^2 H (FACTS: to first order), where that is defined.
    pub fn of<E: Embedding, D: Differentiation>(
        embedding: &E,
        derivatives: &D,
        grid: &Grid,
        shift_sigma: Option<f64>,
    ) -> Self {
        let tiles = SurfaceTiles::of(embedding);
        let part = |tile: &IndexBox| {
            let mesh = tiles.mesh(tile);
            let geometry: Vec<_> = derivatives
                .jets_at(&mesh.own_positions())
                .iter()
                .map(|jet| vertex_geometry(jet, shift_sigma, grid))
                .collect();
            (mesh, geometry)
        };
        let (meshes, geometry): (Vec<TileMesh>, Vec<_>) = tiles.boxes.par_iter().map(part).unzip();
        let geometry = geometry.concat();
        let vertices_without_normal = geometry.iter().filter(|g| g.is_none()).count() as u64;
        Self { mesh: stitched(meshes, grid), vertices: filled(geometry), vertices_without_normal }
    }

    /// Whether there is no surface.
    pub fn is_empty(&self) -> bool {
        self.mesh.triangles.is_empty()
    }

    /// The vertices' geometry as named columns.
    pub fn arrays(&self) -> Vec<VertexArray> {
        VertexGeometry::arrays(&self.vertices)
    }

    /// A quantity at every vertex; `None` where it is not defined.
    pub fn values(&self, quantity: LocalQuantity) -> Option<Vec<f64>> {
        self.vertices.iter().map(|vertex| quantity.at(vertex)).collect()
    }

    /// Distributions of all quantities, by area and by vertex.
    pub fn distributions(&self) -> Vec<Distribution> {
        let areas = self.mesh.vertex_areas();
        let of = |quantity: LocalQuantity| Distribution::of(quantity.name(), &self.values(quantity)?, &areas);
        LocalQuantity::ALL.into_iter().filter_map(of).collect()
    }

    /// The surface's curvature in a few numbers; `None` where there is no surface.
    pub fn curvature_summary(&self) -> Option<CurvatureSummary> {
        CurvatureSummary::of(&self.vertices, &self.mesh.vertex_areas())
    }
}

fn vertex_geometry(jet: &Jet, shift_sigma: Option<f64>, grid: &Grid) -> Option<VertexGeometry> {
    let displacement = |sigma: f64| Some(-sigma * sigma * Curvature::of(jet)?.mean);
    VertexGeometry::of(jet, shift_sigma.and_then(displacement), grid)
}

/// Replaces what is missing by a flat piece with the normal of the vertex before.
fn filled(geometry: Vec<Option<VertexGeometry>>) -> Vec<VertexGeometry> {
    let mut last = geometry.iter().flatten().next().copied();
    let flat = Curvature { mean: 0.0, gaussian: 0.0 };
    let mut vertices = Vec::with_capacity(geometry.len());
    for vertex in geometry {
        last = vertex.or(last.map(|g| VertexGeometry { curvature: flat, ..g }));
        vertices.extend(last);
    }
    vertices
}
