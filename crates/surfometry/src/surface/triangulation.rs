//! Triangles between the loops of a cell.

use super::cell::{edge_base, is_ambiguous, loops};
use super::cell_interior::{joined_across, tunnels};
use crate::space::{dot, minus};
use std::sync::LazyLock;

/// Most triangles of a cell that needs no look at its values: one loop of six edges.
const MOST_SIMPLE: usize = 4;

/// Triangles of a configuration, as edges of the cell.
pub(crate) struct SimpleCell {
    triangles: [[u8; 3]; MOST_SIMPLE],
    count: u8,
}

impl SimpleCell {
    pub(crate) fn triangles(&self) -> &[[u8; 3]] {
        &self.triangles[..self.count as usize]
    }
}

/// By configuration: the triangles, or `None` where the surface is not one disc whatever the values.
pub(crate) static SIMPLE_CELLS: LazyLock<Vec<Option<SimpleCell>>> =
    LazyLock::new(|| (0..=255).map(simple_cell).collect());

fn simple_cell(configuration: u8) -> Option<SimpleCell> {
    if (0..6).any(|face| is_ambiguous(configuration, face)) {
        return None;
    }
    let loops = loops(configuration, |_| false);
    let mut cell = SimpleCell { triangles: [[0; 3]; MOST_SIMPLE], count: 0 };
    match loops.as_slice() {
        [] => {}
        [ring] => {
            for triangle in triangulated(ring) {
                cell.triangles[cell.count as usize] = triangle;
                cell.count += 1;
            }
        }
        // Two opposite corners: a disc at each, or a tube between them.
        _ => return None,
    }
    Some(cell)
}

/// Triangles that fill a loop without further vertices, with diagonals as short as they can be between the
/// middles of the edges.
///
/// Where no face is ambiguous, no diagonal lies in a face, so the neighbour's triangles cannot have the same
/// edge.
fn triangulated(ring: &[u8]) -> Vec<[u8; 3]> {
    best_fill(ring).1
}

fn best_fill(ring: &[u8]) -> (f64, Vec<[u8; 3]>) {
    if ring.len() < 3 {
        return (0.0, Vec::new());
    }
    let (first, last) = (ring[0], ring[ring.len() - 1]);
    let diagonal = |i: usize, j: usize| {
        let step = minus(edge_middle(ring[i]), edge_middle(ring[j]));
        if i + 1 == j { 0.0 } else { dot(step, step) }
    };
    let mut best = (f64::INFINITY, Vec::new());
    for apex in 1..ring.len() - 1 {
        let (left, right) = (best_fill(&ring[..=apex]), best_fill(&ring[apex..]));
        let cost = left.0 + right.0 + diagonal(0, apex) + diagonal(apex, ring.len() - 1);
        if cost < best.0 - 1e-9 {
            best = (cost, [left.1, right.1, vec![[first, ring[apex], last]]].concat());
        }
    }
    best
}

fn edge_middle(edge: u8) -> [f64; 3] {
    let mut middle = edge_base(edge).map(|v| v as f64);
    middle[edge as usize / 4] = 0.5;
    middle
}

/// Where the triangles of a cell go: it knows the vertices on the cell's edges and takes new ones inside.
pub(crate) trait CellSink {
    /// The vertex on an edge of the cell.
    fn vertex_on(&self, edge: u8) -> u32;
    /// A new vertex inside the cell, half-way between others.
    fn add_vertex(&mut self, between: &[u32]) -> u32;
    /// A vertex' position in voxels.
    fn position(&self, vertex: u32) -> [f64; 3];
    /// A triangle, counter-clockwise as seen from outside the object.
    fn add_triangle(&mut self, triangle: [u32; 3]);
}

/// A cell whose values decide: every loop is filled around a vertex of its own, or joined to another by a
/// tube with a ring of vertices.
///
/// The new vertices keep every new edge off the faces, where the neighbour could have the same one: an edge
/// with four triangles would be no manifold.
pub(crate) fn fill_by_values(configuration: u8, values: &[f64; 8], sink: &mut impl CellSink) {
    let loops = loops(configuration, |face| joined_across(values, face));
    let tubes = tunnels(configuration, values, &loops);
    for &[a, b] in &tubes {
        let (a, b) = (vertices_on(&loops[a], sink), vertices_on(&loops[b], sink));
        add_tube(&a, &b, sink);
    }
    for (number, ring) in loops.iter().enumerate() {
        if !tubes.iter().any(|tube| tube.contains(&number)) {
            let ring = vertices_on(ring, sink);
            add_disc(&ring, sink);
        }
    }
}

fn vertices_on(ring: &[u8], sink: &impl CellSink) -> Vec<u32> {
    ring.iter().map(|&edge| sink.vertex_on(edge)).collect()
}

fn add_disc(ring: &[u32], sink: &mut impl CellSink) {
    if let &[a, b, c] = ring {
        return sink.add_triangle([a, b, c]);
    }
    let centre = sink.add_vertex(ring);
    for (i, &vertex) in ring.iter().enumerate() {
        sink.add_triangle([vertex, ring[(i + 1) % ring.len()], centre]);
    }
}

/// The strip between two loops, each of whose rungs has a vertex half-way.
///
/// Both loops turn so that the surface lies to their left, so one is walked forward and the other backward.
fn add_tube(a: &[u32], b: &[u32], sink: &mut impl CellSink) {
    let backward: Vec<u32> = b.iter().rev().copied().collect();
    let rungs = rungs(a, &backward, sink);
    let middles: Vec<u32> = rungs.iter().map(|&(i, j)| sink.add_vertex(&[a[i], backward[j]])).collect();
    for (n, &(i, j)) in rungs.iter().enumerate() {
        let following = (n + 1) % rungs.len();
        let (next_i, next_j) = rungs[following];
        let (near, far) = (middles[n], middles[following]);
        sink.add_triangle([a[i], far, near]);
        sink.add_triangle([near, far, backward[next_j]]);
        if next_i != i {
            sink.add_triangle([a[i], a[next_i], far]);
        }
        if next_j != j {
            sink.add_triangle([backward[next_j], backward[j], near]);
        }
    }
}

/// Pairs of positions, from the nearest pair on, each a step further on one of the two loops, always the
/// shorter step.
fn rungs(a: &[u32], b: &[u32], sink: &impl CellSink) -> Vec<(usize, usize)> {
    let apart = |i: usize, j: usize| {
        let step = minus(sink.position(a[i % a.len()]), sink.position(b[j % b.len()]));
        dot(step, step)
    };
    let pairs = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j)));
    let (i0, j0) =
        pairs.min_by(|p, q| apart(p.0, p.1).total_cmp(&apart(q.0, q.1))).expect("loops have edges");
    let (mut i, mut j) = (i0, j0);
    let mut rungs = Vec::with_capacity(a.len() + b.len());
    while i < i0 + a.len() || j < j0 + b.len() {
        rungs.push((i % a.len(), j % b.len()));
        let a_is_done = i == i0 + a.len();
        let b_is_done = j == j0 + b.len();
        if b_is_done || !a_is_done && apart(i + 1, j) <= apart(i, j + 1) { i += 1 } else { j += 1 }
    }
    rungs
}
