//! Why a mesh has no voxels.

use crate::volume::VolumeError;
use thiserror::Error;

/// Why a mesh has no voxels.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum VoxeliseError {
    /// No triangles.
    #[error("the mesh is empty: it has no triangles; export the surface again, as triangles or polygons")]
    Empty,
    /// A triangle that names no vertex.
    #[error("a triangle names vertex {number}, counted from 0, of {count}; export the mesh again")]
    NoSuchVertex {
        /// The vertex.
        number: u32,
        /// How many there are.
        count: usize,
    },
    /// A corner that is no place.
    #[error("vertex {0} of the mesh, counted from 0, is not finite; export the mesh again")]
    NotFinite(usize),
    /// It has no inside: edges of one triangle.
    #[error(
        "the mesh is not closed: {edges} edges, the first at ({x:.4}, {y:.4}, {z:.4}), have no triangle on one side; fill its holes first, or merge vertices that are close (up to 1/100 of the spacing apart they count as one), for instance in MeshLab"
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
    /// It has no inside that its faces agree on.
    #[error(
        "the mesh's faces are turned opposite ways: at {edges} edges, the first at ({x:.4}, {y:.4}, {z:.4}), one faces outward and the next inward; orient them alike first, for instance in MeshLab (re-orient all faces coherently)"
    )]
    Turned {
        /// How many edges are between such faces.
        edges: usize,
        /// Where the first one begins.
        x: f64,
        /// Its y.
        y: f64,
        /// Its z.
        z: f64,
    },
    /// It is closed, but branches.
    #[error(
        "three or another odd number of faces meet at {edges} edges of the mesh, the first at ({x:.4}, {y:.4}, {z:.4}): it has inner walls, or faces twice; remove these first, for instance in MeshLab"
    )]
    Branched {
        /// How many.
        edges: usize,
        /// Where the first one begins.
        x: f64,
        /// Its y.
        y: f64,
        /// Its z.
        z: f64,
    },
    /// Hardly a voxel.
    #[error(
        "the mesh is only {0} mm wide, and voxels are {1} mm: if its coordinates are in metres, scale them by 1000, in cm by 10; otherwise choose a finer spacing",
        by(widths),
        by(spacing)
    )]
    TooSmall {
        /// Of the mesh, along x, y and z, mm.
        widths: [f64; 3],
        /// Of the lattice, mm.
        spacing: [f64; 3],
    },
    /// A lattice that is too fine.
    #[error(
        "the spacing is too fine for this mesh, which is {1} mm wide: {0} voxels; if its coordinates are in micrometres, scale them by 0.001, in nm by 0.000001; otherwise choose a coarser spacing",
        by(voxels),
        by(widths)
    )]
    TooLarge {
        /// Along x, y and z.
        voxels: [f64; 3],
        /// Of the mesh, mm.
        widths: [f64; 3],
    },
    /// All centres are beside it.
    #[error(
        "no voxel's centre lies inside the mesh: it holds {volume:.4} mm\u{b3}, and voxels are {0} mm; choose a finer spacing",
        by(spacing)
    )]
    NoVoxel {
        /// What the mesh holds, mm^3.
        volume: f64,
        /// Of the lattice, mm.
        spacing: [f64; 3],
    },
    /// A lattice that cannot be.
    #[error(transparent)]
    Volume(#[from] VolumeError),
}

/// Sizes along three axes, in four digits.
fn by(sizes: &[f64; 3]) -> String {
    let digits = |size: &f64| {
        let rounded = format!("{size:.3e}").parse::<f64>().unwrap_or(*size);
        if (1e-4..1e7).contains(&rounded) { rounded.to_string() } else { format!("{rounded:e}") }
    };
    sizes.iter().map(digits).collect::<Vec<_>>().join(" x ")
}
