//! A mesh on a lattice.

use super::crossings::{Crossing, crossings_of};
use crate::surface::Mesh;
use crate::volume::{
    Affine, Grid, LabelImage, Slab, SlabReader, Spacing, VolumeError, check_made, made_slab,
};
use std::collections::HashMap;
use thiserror::Error;

/// Background voxels on every side.
const MARGIN: i64 = 2;

/// The voxels whose centres lie inside a closed mesh: label 1 inside, 0 outside.
///
/// The lattice's centres are the whole multiples of the spacing from the world's origin, so meshes of one
/// frame share it. Inside is what a surface goes round once or more: parts may overlap, cavities are surfaces
/// that face the other way, and a mesh may be turned inside out.
#[derive(Debug, Clone)]
pub struct VoxelisedMesh {
    grid: Grid,
    /// By row (y, then z), ascending in x.
    crossings: Vec<(usize, Crossing)>,
    /// Where each slice's crossings begin, and where the last one's end.
    starts: Vec<usize>,
}

/// Why a mesh has no voxels.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum VoxeliseError {
    /// No triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// A corner that is no place.
    #[error("vertex {0} of the mesh is not finite")]
    NotFinite(usize),
    /// It has no inside.
    #[error(
        "the mesh is not closed: {edges} edges, the first at ({x:.4}, {y:.4}, {z:.4}), have no triangle on one side; fill its holes first, for instance in MeshLab"
    )]
    Open {
        /// How many.
        edges: usize,
        /// Where the first one begins.
        x: f64,
        /// Its y.
        y: f64,
        /// Its z.
        z: f64,
    },
    /// A lattice that is too fine.
    #[error("the spacing is too fine for this mesh: {0:?} voxels; are both in mm?")]
    TooLarge([f64; 3]),
    /// A lattice that cannot be.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

impl VoxelisedMesh {
    /// Puts a mesh on a lattice.
    ///
    /// # Errors
    /// [`VoxeliseError`].
    pub fn new(mesh: &Mesh, spacing: Spacing) -> Result<Self, VoxeliseError> {
        if mesh.triangles.is_empty() {
            return Err(VoxeliseError::Empty);
        }
        if let Some(bad) = mesh.vertices.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
            return Err(VoxeliseError::NotFinite(bad));
        }
        check_closed(mesh)?;
        let h = spacing.mm();
        let end = |axis: usize, least: bool| {
            let places = mesh.vertices.iter().map(|v| v[axis] / h[axis]);
            if least {
                places.fold(f64::INFINITY, f64::min).floor()
            } else {
                places.fold(f64::NEG_INFINITY, f64::max).ceil()
            }
        };
        let first: [f64; 3] = std::array::from_fn(|axis| end(axis, true) - MARGIN as f64);
        let extent: [f64; 3] =
            std::array::from_fn(|axis| end(axis, false) + MARGIN as f64 - first[axis] + 1.0);
        let dimensions = extent.map(|n| n as usize);
        check_made(dimensions).map_err(|_| VoxeliseError::TooLarge(extent))?;
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let origin = std::array::from_fn(|axis| first[axis] * h[axis]);
        let grid = Grid::new(dimensions, Affine::from_directions(axes, h, origin))?;
        let place = |v: &[f64; 3]| std::array::from_fn(|axis| v[axis] / h[axis] - first[axis]);
        let vertices: Vec<[f64; 3]> = mesh.vertices.iter().map(place).collect();
        let mut crossings = Vec::new();
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| vertices[v as usize]);
            crossings_of(corners, |[y, z], crossing| {
                crossings.push((z as usize * dimensions[1] + y as usize, crossing));
            });
        }
        crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)));
        let starts =
            (0..=dimensions[2]).map(|z| crossings.partition_point(|c| c.0 < z * dimensions[1])).collect();
        Ok(Self { grid, crossings, starts })
    }

    /// The lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The voxels as a stream of slabs.
    pub fn slabs(&self) -> MeshSlabs<'_> {
        MeshSlabs { mesh: self, next_slice: 0 }
    }

    /// The label image.
    ///
    /// # Errors
    /// [`VolumeError::TooLarge`] where memory does not suffice.
    pub fn labels(&self) -> Result<LabelImage, VolumeError> {
        LabelImage::from_slabs(&mut self.slabs())
    }

    fn slice(&self, z: usize, voxels: &mut [u8]) {
        let [nx, ny, _] = self.grid.dimensions();
        for row in self.crossings[self.starts[z]..self.starts[z + 1]].chunk_by(|a, b| a.0 == b.0) {
            let y = row[0].0 - z * ny;
            let mut winding = 0;
            for pair in row.windows(2) {
                winding += pair[0].1.winding;
                if winding != 0 {
                    // Centres from this crossing on, up to the next.
                    let (from, to) = (pair[0].1.x.ceil() as usize, pair[1].1.x.ceil() as usize);
                    voxels[y * nx + from..y * nx + to].fill(1);
                }
            }
        }
    }
}

/// A mesh's voxels, slab by slab, as a file would yield them.
pub struct MeshSlabs<'a> {
    mesh: &'a VoxelisedMesh,
    next_slice: usize,
}

impl SlabReader for MeshSlabs<'_> {
    type Error = VolumeError;

    fn grid(&self) -> &Grid {
        &self.mesh.grid
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, VolumeError> {
        let mesh = self.mesh;
        let slice = |z: usize, voxels: &mut [u8]| mesh.slice(z, voxels);
        made_slab(mesh.grid.dimensions(), &mut self.next_slice, slice)
    }
}

/// A surface has an inside where each edge is passed as often one way as the other; vertices count as one
/// where they are at one place.
fn check_closed(mesh: &Mesh) -> Result<(), VoxeliseError> {
    let uses = Mesh { vertices: Vec::new(), triangles: merged_triangles(mesh) }.edge_uses();
    let open = || uses.iter().filter(|((a, b), [up, down])| a != b && up != down);
    let Some(vertex) = open().map(|((a, _), _)| *a).min() else { return Ok(()) };
    let [x, y, z] = mesh.vertices[vertex as usize];
    Err(VoxeliseError::Open { edges: open().count(), x, y, z })
}

/// The triangles, whose corners are numbered by the first vertex at their place.
fn merged_triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut firsts: HashMap<[u64; 3], u32> = HashMap::new();
    let mut first = |number: u32| {
        // Adding 0 makes -0 the same as 0.
        let place = mesh.vertices[number as usize].map(|c| (c + 0.0).to_bits());
        *firsts.entry(place).or_insert(number)
    };
    mesh.triangles.iter().map(|triangle| triangle.map(&mut first)).collect()
}
