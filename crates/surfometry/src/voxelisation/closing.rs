//! Whether a mesh is closed, and what it lacks where it is not.

use super::VoxeliseError;
use crate::surface::Mesh;
use std::collections::{BTreeSet, HashMap};

/// An edge with how often triangles pass it upward and downward.
type Edge = ((u32, u32), [u32; 2]);

/// How far apart the ends of open edges may be to count as one, in voxels: far more than the last digits that programs
/// round differently, far less than what voxels show.
const TOLERANCE: f64 = 0.01;
/// Smaller ones come first, each ten times the one before: what is rounded apart is nearer than what a fine mesh's own
/// vertices are.
const STEPS: i32 = 5;

/// The triangles of a mesh, whose corners at one place are one vertex, the first there. Where edges stay open, their
/// ends up to 1/100 of the spacing apart are taken for one as well.
///
/// # Errors
/// [`VoxeliseError::Open`], [`VoxeliseError::Turned`] or [`VoxeliseError::Branched`].
pub(super) fn closed_triangles(mesh: &Mesh, spacing: [f64; 3]) -> Result<Vec<[u32; 3]>, VoxeliseError> {
    let finest = spacing.into_iter().fold(f64::INFINITY, f64::min);
    let mut triangles = at_one_place(mesh);
    let mut open = open_edges(&triangles);
    for step in (0..STEPS).rev() {
        if open.is_empty() {
            break;
        }
        triangles = welded(mesh, triangles, &open, finest * TOLERANCE * 10.0_f64.powi(-step));
        open = open_edges(&triangles);
    }
    if open.is_empty() { Ok(triangles) } else { Err(what_is_wrong(mesh, &open)) }
}

/// Edges that are not passed as often one way as the other: where there are none, a surface has an inside.
fn open_edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let uses = Mesh { vertices: Vec::new(), triangles: triangles.to_vec() }.edge_uses();
    uses.into_iter().filter(|((a, b), [up, down])| a != b && up != down).collect()
}

/// The triangles, whose corners are numbered by the first vertex at their place.
fn at_one_place(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut firsts: HashMap<[u64; 3], u32> = HashMap::new();
    let mut first = |number: u32| {
        // Adding 0 makes -0 the same as 0.
        let place = mesh.vertices[number as usize].map(|c| (c + 0.0).to_bits());
        *firsts.entry(place).or_insert(number)
    };
    mesh.triangles.iter().map(|triangle| triangle.map(&mut first)).collect()
}

/// The triangles, whose corners at open edges are the first such vertex within the tolerance. Others stay: a mesh that
/// is finer than the tolerance keeps its shape.
fn welded(mesh: &Mesh, mut triangles: Vec<[u32; 3]>, open: &[Edge], tolerance: f64) -> Vec<[u32; 3]> {
    let ends: BTreeSet<u32> = open.iter().flat_map(|((a, b), _)| [*a, *b]).collect();
    let mut kept: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut first: HashMap<u32, u32> = HashMap::new();
    for number in ends {
        let place = mesh.vertices[number as usize];
        let cell = place.map(|c| (c / tolerance).floor() as i64);
        let close = |other: &&u32| {
            let there = mesh.vertices[**other as usize];
            (0..3).map(|axis| (there[axis] - place[axis]).powi(2)).sum::<f64>() <= tolerance * tolerance
        };
        let near = cells_around(cell).filter_map(|cell| kept.get(&cell)).flatten().filter(close).min();
        match near.copied() {
            Some(other) => drop(first.insert(number, other)),
            None => kept.entry(cell).or_default().push(number),
        }
    }
    triangles.as_flattened_mut().iter_mut().for_each(|corner| *corner = *first.get(corner).unwrap_or(corner));
    triangles
}

fn cells_around([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |n| [x - 1 + n % 3, y - 1 + n / 3 % 3, z - 1 + n / 9])
}

/// What keeps a mesh from being closed: holes before branches before faces that are turned.
fn what_is_wrong(mesh: &Mesh, open: &[Edge]) -> VoxeliseError {
    // How many there are of a kind, and where the first begins.
    let found = |kind: fn(u32) -> bool| {
        let edges = || open.iter().filter(|(_, [up, down])| kind(up + down)).map(|((from, _), _)| *from);
        edges().min().map(|first| (edges().count(), mesh.vertices[first as usize]))
    };
    if let Some((edges, [x, y, z])) = found(|uses| uses == 1) {
        VoxeliseError::Open { edges, x, y, z }
    } else if let Some((edges, [x, y, z])) = found(|uses| uses % 2 == 1) {
        VoxeliseError::Branched { edges, x, y, z }
    } else {
        let (edges, [x, y, z]) = found(|_| true).unwrap_or_default();
        VoxeliseError::Turned { edges, x, y, z }
    }
}
