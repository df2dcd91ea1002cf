//! The whole surface from its tiles.

use super::mesh::{Mesh, tetrahedron_volume, triangle_area};
use super::tile_mesh::{EdgeKey, TileMesh};
use crate::embedding::Embedding;
use crate::local_geometry::BAND_GROUP;
use crate::tiling::{Block, ExactSum, IndexBox, TILE};
use crate::volume::Grid;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Extracts phi = 0 as a mesh in world coordinates.
///
/// Tiles are extracted in parallel and joined in their order, so the mesh is the same for any number of
/// threads. It is a closed manifold, except where a given field ends.
pub fn extract<E: Embedding>(embedding: &E, grid: &Grid) -> Mesh {
    let tiles = SurfaceTiles::of(embedding);
    let parts: Vec<TileMesh> = tiles.boxes.par_iter().map(|tile| tiles.mesh(tile)).collect();
    stitched(&parts, grid)
}

/// Where a surface's cells lie: the support of a field and one voxel around it, which is outside and closes
/// the surface; less where the field ends. Along x whole groups of voxels, so that voxels are grouped in the
/// same way whatever part of an object is known.
pub(crate) fn cell_limits<E: Embedding + ?Sized>(embedding: &E, half_width: f64) -> IndexBox {
    embedding.available(&cells_around(&embedding.support(half_width)))
}

/// Box of the cells that a surface within another may cross, in whole groups of voxels.
pub(crate) fn cells_around(support: &IndexBox) -> IndexBox {
    let mut limits = support.grown([1; 3]);
    limits.lower[0] = limits.lower[0].div_euclid(GROUP) * GROUP;
    limits.upper[0] = -(-limits.upper[0]).div_euclid(GROUP) * GROUP;
    limits
}

/// Voxels along x that are worked on together.
const GROUP: i64 = BAND_GROUP as i64;

/// The tiles of an embedding on their own.
struct SurfaceTiles<'a, E> {
    embedding: &'a E,
    limits: IndexBox,
    boxes: Vec<IndexBox>,
}

impl<'a, E: Embedding> SurfaceTiles<'a, E> {
    fn of(embedding: &'a E) -> Self {
        let limits = cell_limits(embedding, 0.0);
        Self { embedding, limits, boxes: limits.tiles(TILE) }
    }

    /// The surface in one tile; empty where the field is known to have one sign.
    fn mesh(&self, tile: &IndexBox) -> TileMesh {
        let region = IndexBox::new(tile.lower, tile.upper.map(|u| u + 1)).intersection(&self.limits);
        if self.embedding.constant_on(&region, 0.0).is_some() {
            return TileMesh::default();
        }
        let field: Block<E::Value> = self.embedding.evaluate(&region, 0.0);
        TileMesh::of(&field, tile, &self.limits)
    }
}

/// Joins tiles by the names of the vertices that they share.
pub(crate) fn stitched(parts: &[TileMesh], grid: &Grid) -> Mesh {
    let mut vertices = vec![[0.0; 3]; parts.iter().map(TileMesh::own_count).sum()];
    let places = cut(&mut vertices, parts.iter().map(TileMesh::own_count));
    let mut before = 0;
    let firsts = parts.iter().map(|part| {
        before += part.own_count();
        u32::try_from(before).expect("fewer than 2^32 vertices") - part.own_count() as u32
    });
    let firsts: Vec<u32> = firsts.collect();
    // By tile, the numbers of its vertices in the whole; those of borrowed ones are filled in afterwards.
    let numbered = |((part, places), first): ((&TileMesh, &mut [[f64; 3]]), u32)| {
        let mut own = vec![0; part.positions.len()];
        for (number, (place, (vertex, position))) in (first..).zip(places.iter_mut().zip(part.own_vertices()))
        {
            own[vertex] = number;
            *place = grid.affine().apply(position);
        }
        own
    };
    let mut numbers: Vec<Vec<u32>> = parts.par_iter().zip(places).zip(firsts).map(numbered).collect();
    let lent: HashMap<EdgeKey, u32> = parts
        .iter()
        .zip(&numbers)
        .flat_map(|(part, own)| part.lent.iter().map(|(vertex, key)| (*key, own[*vertex as usize])))
        .collect();
    // Where the image mirrors, what turns counter-clockwise in index space turns clockwise in the world.
    let mirrored = grid.affine().determinant() < 0.0;
    let mut triangles = vec![[0; 3]; parts.iter().map(|part| part.triangles.len()).sum()];
    let places = cut(&mut triangles, parts.iter().map(|part| part.triangles.len()));
    parts.par_iter().zip(&mut numbers).zip(places).for_each(|((part, numbers), places)| {
        for (vertex, key) in &part.borrowed {
            numbers[*vertex as usize] = lent[key];
        }
        for (place, triangle) in places.iter_mut().zip(&part.triangles) {
            let [a, b, c] = triangle.map(|v| numbers[v as usize]);
            *place = if mirrored { [a, c, b] } else { [a, b, c] };
        }
    });
    Mesh { vertices, triangles }
}

/// Consecutive pieces of the given lengths.
fn cut<T>(mut values: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    let piece = |length: usize| {
        let (piece, rest) = std::mem::take(&mut values).split_at_mut(length);
        values = rest;
        piece
    };
    lengths.map(piece).collect()
}

/// What is known of a surface without keeping it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceSummary {
    /// Vertices, V.
    pub vertices: u64,
    /// Triangles, F.
    pub triangles: u64,
    /// Edges, E.
    pub edges: u64,
    /// Sum of the triangles' areas, mm^2.
    pub area: f64,
    /// Enclosed volume, mm^3; `None` where the surface is open at the edge of a given field.
    pub volume: Option<f64>,
}

impl SurfaceSummary {
    /// Summarises phi = 0 tile by tile, in the memory of one tile a thread.
    pub fn of<E: Embedding>(embedding: &E, grid: &Grid) -> Self {
        let tiles = SurfaceTiles::of(embedding);
        let part = |tile: &IndexBox| SurfaceSums::of_tile(&tiles.mesh(tile), grid.spacing().mm());
        Self::of_sums(&tiles.boxes.par_iter().map(part).reduce(SurfaceSums::default, |a, b| a.merged(&b)))
    }

    pub(crate) fn of_sums(sums: &SurfaceSums) -> Self {
        let open = sums.border_edges > 0;
        Self {
            vertices: sums.vertices,
            triangles: sums.triangles,
            // Every edge has two triangles, except on the border.
            edges: u64::midpoint(3 * sums.triangles, sums.border_edges),
            area: sums.area.value(),
            volume: (!open).then(|| sums.volume.value()),
        }
    }

    /// V - E + F. Of a closed surface: ball 2, torus 0.
    pub fn euler_characteristic(&self) -> i64 {
        self.vertices as i64 - self.edges as i64 + self.triangles as i64
    }
}

/// What tiles add up to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SurfaceSums {
    vertices: u64,
    triangles: u64,
    border_edges: u64,
    area: ExactSum,
    volume: ExactSum,
}

impl SurfaceSums {
    /// Volume as seen from image index 0, in the order of the triangles.
    pub(crate) fn of_tile(mesh: &TileMesh, spacing: [f64; 3]) -> Self {
        let mut sums = Self {
            vertices: mesh.own_count() as u64,
            triangles: mesh.triangles.len() as u64,
            border_edges: mesh.border_edges,
            ..Self::default()
        };
        let position = |vertex: u32| {
            let index = mesh.positions[vertex as usize];
            std::array::from_fn(|a| index[a] * spacing[a])
        };
        let (mut area, mut volume) = (0.0, 0.0);
        for triangle in &mesh.triangles {
            let corners = triangle.map(position);
            area += triangle_area(corners);
            volume += tetrahedron_volume(corners);
        }
        sums.area.add(area);
        sums.volume.add(volume);
        sums
    }

    pub(crate) fn merged(mut self, other: &Self) -> Self {
        self.vertices += other.vertices;
        self.triangles += other.triangles;
        self.border_edges += other.border_edges;
        self.area.merge(&other.area);
        self.volume.merge(&other.volume);
        self
    }
}
