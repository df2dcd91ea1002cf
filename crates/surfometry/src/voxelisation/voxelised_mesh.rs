//! A mesh on a lattice.

use super::VoxeliseError;
use super::closing::closed_triangles;
use super::crossings::{Crossing, crossings_of};
use crate::surface::Mesh;
use crate::volume::{
    Affine, Grid, LabelImage, Slab, SlabReader, Spacing, VolumeError, check_made, made_slab,
};
use std::ops::Range;

/// Background voxels on every side.
const MARGIN: i64 = 2;
/// Rows that a mesh may have, y by z: each crossing takes 24 bytes and is looked for in each triangle.
const MOST_ROWS: f64 = (1 << 26) as f64;
/// A mesh that is less wide in voxels, along all axes, is most likely in another unit.
const FEWEST: f64 = 4.0;

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

impl VoxelisedMesh {
    /// Puts a mesh on a lattice. Vertices that no triangle names do not count. Where edges are open, vertices at their
    /// ends that are up to 1/100 of the least spacing apart count as one, the first of them.
    ///
    /// # Errors
    /// [`VoxeliseError`].
    pub fn new(mesh: &Mesh, spacing: Spacing) -> Result<Self, VoxeliseError> {
        let h = spacing.mm();
        let lattice = lattice(ends(mesh)?, h)?;
        let dimensions = lattice.extent.map(|n| n as usize);
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let origin = std::array::from_fn(|axis| lattice.first[axis] * h[axis]);
        let grid = Grid::new(dimensions, Affine::from_directions(axes, h, origin))?;
        let place = |v: u32| {
            let place = mesh.vertices[v as usize];
            std::array::from_fn(|axis| place[axis] / h[axis] - lattice.first[axis])
        };
        let mut crossings = Vec::new();
        for triangle in closed_triangles(mesh, h)? {
            crossings_of(triangle.map(place), |[y, z], crossing| {
                crossings.push((z as usize * dimensions[1] + y as usize, crossing));
            });
        }
        crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)));
        let starts =
            (0..=dimensions[2]).map(|z| crossings.partition_point(|c| c.0 < z * dimensions[1])).collect();
        let voxelised = Self { grid, crossings, starts };
        if voxelised.is_empty() {
            return Err(VoxeliseError::NoVoxel { volume: mesh.volume().abs(), spacing: h });
        }
        Ok(voxelised)
    }

    /// Whether it has no voxel inside.
    fn is_empty(&self) -> bool {
        let mut rows = self.crossings.chunk_by(|a, b| a.0 == b.0);
        rows.all(|row| runs(row).all(|run| run.is_empty()))
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
            runs(row).for_each(|run| voxels[y * nx + run.start..y * nx + run.end].fill(1));
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

/// The voxels of a row that are inside: those whose centres lie from one crossing on up to the next.
fn runs(row: &[(usize, Crossing)]) -> impl Iterator<Item = Range<usize>> {
    let mut winding = 0;
    row.windows(2).filter_map(move |pair| {
        winding += pair[0].1.winding;
        (winding != 0).then(|| pair[0].1.x.ceil() as usize..pair[1].1.x.ceil() as usize)
    })
}

/// First and last place along each axis that a triangle reaches, mm.
fn ends(mesh: &Mesh) -> Result<[[f64; 2]; 3], VoxeliseError> {
    if mesh.triangles.is_empty() {
        return Err(VoxeliseError::Empty);
    }
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for &number in mesh.triangles.as_flattened() {
        let Some(place) = mesh.vertices.get(number as usize) else {
            return Err(VoxeliseError::NoSuchVertex { number, count: mesh.vertices.len() });
        };
        if place.iter().any(|c| !c.is_finite()) {
            return Err(VoxeliseError::NotFinite(number as usize));
        }
        for ([low, high], c) in ends.iter_mut().zip(place) {
            (*low, *high) = (low.min(*c), high.max(*c));
        }
    }
    Ok(ends)
}

/// Where voxels are needed, in units of the spacing.
struct Lattice {
    first: [f64; 3],
    extent: [f64; 3],
}

fn lattice(ends: [[f64; 2]; 3], h: [f64; 3]) -> Result<Lattice, VoxeliseError> {
    let widths = ends.map(|[low, high]| high - low);
    if (0..3).all(|axis| widths[axis] < FEWEST * h[axis]) {
        return Err(VoxeliseError::TooSmall { widths, spacing: h });
    }
    let margin = MARGIN as f64;
    let first = std::array::from_fn(|axis| (ends[axis][0] / h[axis]).floor() - margin);
    let extent = std::array::from_fn(|axis| (ends[axis][1] / h[axis]).ceil() + margin - first[axis] + 1.0);
    let too_large = check_made(extent.map(|n| n as usize)).is_err() || extent[1] * extent[2] > MOST_ROWS;
    if too_large {
        return Err(VoxeliseError::TooLarge { voxels: extent, widths });
    }
    Ok(Lattice { first, extent })
}
