//! The part of a level set that lies in one tile.

use super::cell::{EDGE_BASES, edge_corners};
use super::triangulation::{CellSink, SIMPLE_CELLS, fill_by_values};
use crate::embedding::Precision;
use crate::tiling::{Block, IndexBox};
use crate::vectors;
use fearless_simd::dispatch;

/// Name of a vertex on a grid edge: the voxel that the edge starts from, and the axis that it runs along.
pub(crate) type EdgeKey = ([i64; 3], u8);

/// Triangles of the cells whose first corner lies in a tile.
#[derive(Debug, Default)]
pub(crate) struct TileMesh {
    /// Positions as fractional voxel indices.
    pub(crate) positions: Vec<[f64; 3]>,
    /// Vertex numbers, counter-clockwise as seen from outside in index space.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Vertices of this tile's that others may need.
    pub(crate) lent: Vec<(u32, EdgeKey)>,
    /// Vertices that belong to other tiles.
    pub(crate) borrowed: Vec<(u32, EdgeKey)>,
    /// Triangle edges on the outer faces of the field, where the surface is left open.
    pub(crate) border_edges: u64,
}

/// Nearest to a grid point, in spacings, that a vertex may lie. Where phi is 0 at a voxel, the vertices on
/// its six edges would otherwise coincide, and files in single precision merge what coincides.
const NEAREST: f64 = 1e-3;

/// Stands for a value of exactly 0, which counts as outside. Its square is still a number.
const OUTSIDE: f64 = 1e-150;

impl TileMesh {
    /// Marching cubes over a tile, from the field on a box that holds the tile and one voxel beyond its upper
    /// ends (less where the field itself, known on `limits`, ends).
    ///
    /// Vertices lie where the field, linear along the edges, is 0 (a voxel with exactly 0 is outside); the
    /// topology is that of its trilinear interpolant: loops on ambiguous faces by the asymptotic decider,
    /// tubes inside cells by [`tunnels`](super::cell_interior::tunnels).
    ///
    /// # References
    /// Lorensen and Cline 1987; Nielson and Hamann 1991; Chernyaev 1995, whose 33 cases these rules give
    /// without a table.
    pub(crate) fn of<T: Precision>(field: &Block<T>, tile: &IndexBox, limits: &IndexBox) -> Self {
        let mut builder = Builder::new(field, tile, limits);
        let region = builder.region;
        builder.edges_of_slice(region.lower[2]);
        for z in region.lower[2]..region.upper[2] - 1 {
            builder.edges_to_next_slice(z);
            builder.edges_of_slice(z + 1);
            builder.cells(z);
        }
        builder.mesh
    }

    /// How many vertices are this tile's own.
    pub(crate) fn own_count(&self) -> usize {
        self.positions.len() - self.borrowed.len()
    }

    /// Numbers and positions of the vertices that are this tile's own, in order.
    pub(crate) fn own_vertices(&self) -> impl Iterator<Item = (usize, [f64; 3])> {
        let mut borrowed = self.borrowed.iter().map(|(vertex, _)| *vertex as usize).peekable();
        let numbered = self.positions.iter().copied().enumerate();
        numbered.filter(move |(vertex, _)| borrowed.next_if_eq(vertex).is_none())
    }
}

/// A row's voxels with phi < 0, one bit each: a tile's edge and one more.
type RowBits = u128;

struct Builder<'a, T> {
    field: &'a Block<T>,
    tile: IndexBox,
    limits: IndexBox,
    /// The tile's voxels and those that its cells reach.
    region: IndexBox,
    /// Its voxels along x and y.
    nx: usize,
    ny: usize,
    /// Of all rows, y fastest.
    inside: Vec<RowBits>,
    /// Vertex numbers on the edges along x and y that start from the voxels of two neighbouring slices (even
    /// and odd ones), and on those along z between the two.
    along_x: [Vec<u32>; 2],
    along_y: [Vec<u32>; 2],
    along_z: Vec<u32>,
    mesh: TileMesh,
}

impl<'a, T: Precision> Builder<'a, T> {
    fn new(field: &'a Block<T>, tile: &IndexBox, limits: &IndexBox) -> Self {
        let region = IndexBox::new(tile.lower, tile.upper.map(|u| u + 1)).intersection(limits);
        let [nx, ny, _] = region.extent();
        assert!(nx <= RowBits::BITS as usize, "a row of {nx} voxels does not fit");
        let rows = || vec![0; nx * ny];
        Self {
            field,
            region,
            tile: *tile,
            limits: *limits,
            nx,
            ny,
            inside: dispatch!(vectors::level(), _simd => bits_of_rows(field, &region)),
            along_x: [rows(), rows()],
            along_y: [rows(), rows()],
            along_z: rows(),
            mesh: TileMesh::default(),
        }
    }

    fn bits(&self, y: usize, z: i64) -> RowBits {
        self.inside[(z - self.region.lower[2]) as usize * self.ny + y]
    }

    /// Vertices on the edges within slice z.
    fn edges_of_slice(&mut self, z: i64) {
        let slot = (z & 1) as usize;
        for y in 0..self.ny {
            let row = self.bits(y, z);
            let crossed = (row ^ row >> 1) & low_bits(self.nx - 1);
            for x in set_bits(crossed) {
                self.along_x[slot][y * self.nx + x] = self.edge_vertex([x, y], z, 0);
            }
            if y + 1 < self.ny {
                for x in set_bits(row ^ self.bits(y + 1, z)) {
                    self.along_y[slot][y * self.nx + x] = self.edge_vertex([x, y], z, 1);
                }
            }
        }
    }

    /// Vertices on the edges between slice z and the next.
    fn edges_to_next_slice(&mut self, z: i64) {
        for y in 0..self.ny {
            for x in set_bits(self.bits(y, z) ^ self.bits(y, z + 1)) {
                self.along_z[y * self.nx + x] = self.edge_vertex([x, y], z, 2);
            }
        }
    }

    /// The vertex on an edge that starts from a voxel, given by its place in the field along x and y.
    fn edge_vertex(&mut self, [x, y]: [usize; 2], z: i64, axis: u8) -> u32 {
        let lower = self.region.lower;
        let index = [lower[0] + x as i64, lower[1] + y as i64, z];
        let mut following = index;
        following[axis as usize] += 1;
        let (start, end): (f64, f64) = (self.field.get(index).into(), self.field.get(following).into());
        let mut position = index.map(|i| i as f64);
        position[axis as usize] += (start / (start - end)).clamp(NEAREST, 1.0 - NEAREST);
        let number = self.new_vertex(position);
        if !self.tile.contains(index) {
            self.mesh.borrowed.push((number, (index, axis)));
        } else if (0..3).any(|a| index[a] == self.tile.lower[a]) {
            self.mesh.lent.push((number, (index, axis)));
        }
        number
    }

    fn new_vertex(&mut self, position: [f64; 3]) -> u32 {
        let number = u32::try_from(self.mesh.positions.len()).expect("a tile has fewer voxels");
        self.mesh.positions.push(position);
        number
    }

    /// Triangles of the cells between slice z and the next.
    fn cells(&mut self, z: i64) {
        for y in 0..self.ny.saturating_sub(1) {
            let rows = [self.bits(y, z), self.bits(y + 1, z), self.bits(y, z + 1), self.bits(y + 1, z + 1)];
            let any = rows.iter().fold(0, |bits, row| bits | row | row >> 1);
            let all = rows.iter().fold(RowBits::MAX, |bits, row| bits & row & row >> 1);
            for x in set_bits(any & !all & low_bits(self.nx - 1)) {
                let corner_pairs = rows.iter().rev().fold(0, |bits, row| bits << 2 | (row >> x & 0b11) as u8);
                self.cell([x, y], z, corner_pairs);
            }
        }
    }

    fn cell(&mut self, at: [usize; 2], z: i64, configuration: u8) {
        let mut cell = Cell { builder: self, at, z };
        if let Some(simple) = &SIMPLE_CELLS[configuration as usize] {
            for triangle in simple.triangles() {
                let triangle = triangle.map(|edge| cell.vertex_on(edge));
                cell.add_triangle(triangle);
            }
        } else {
            let values = cell.values();
            fill_by_values(configuration, &values, &mut cell);
        }
        if cell.is_at_border() {
            let edges = cell.border_edges(configuration);
            self.mesh.border_edges += edges;
        }
    }
}

/// One cell, by its first corner.
struct Cell<'b, 'a, T> {
    builder: &'b mut Builder<'a, T>,
    at: [usize; 2],
    z: i64,
}

impl<T: Precision> Cell<'_, '_, T> {
    fn index(&self) -> [i64; 3] {
        let lower = self.builder.region.lower;
        [lower[0] + self.at[0] as i64, lower[1] + self.at[1] as i64, self.z]
    }

    fn values(&self) -> [f64; 8] {
        let [x, y, z] = self.index();
        std::array::from_fn(|corner| {
            let [i, j, k] = [0, 1, 2].map(|a| (corner >> a & 1) as i64);
            let value = self.builder.field.get([x + i, y + j, z + k]).into();
            if value == 0.0 { OUTSIDE } else { value }
        })
    }

    fn is_at_border(&self) -> bool {
        let (index, limits) = (self.index(), &self.builder.limits);
        (0..3).any(|a| index[a] == limits.lower[a] || index[a] + 2 == limits.upper[a])
    }

    /// Triangle edges on those faces of the cell where the field ends.
    fn border_edges(&self, configuration: u8) -> u64 {
        let (index, limits) = (self.index(), &self.builder.limits);
        let at_border = |a: usize, side: usize| {
            if side == 0 { index[a] == limits.lower[a] } else { index[a] + 2 == limits.upper[a] }
        };
        let crossed_on = |a: usize, side: usize| {
            let on_face = |edge: &u8| edge_corners(*edge).iter().all(|corner| corner >> a & 1 == side);
            let crossed = |edge: &u8| {
                let [p, q] = edge_corners(*edge);
                (configuration >> p ^ configuration >> q) & 1 == 1
            };
            (0..12).filter(on_face).filter(crossed).count() as u64
        };
        let faces = (0..3).flat_map(|a| [(a, 0), (a, 1)]);
        faces.filter(|&(a, side)| at_border(a, side)).map(|(a, side)| crossed_on(a, side) / 2).sum()
    }
}

impl<T: Precision> CellSink for Cell<'_, '_, T> {
    fn vertex_on(&self, edge: u8) -> u32 {
        let [i, j, k] = EDGE_BASES[edge as usize];
        let place = (self.at[1] + j) * self.builder.nx + self.at[0] + i;
        let slot = ((self.z + k as i64) & 1) as usize;
        match edge / 4 {
            0 => self.builder.along_x[slot][place],
            1 => self.builder.along_y[slot][place],
            _ => self.builder.along_z[place],
        }
    }

    fn add_vertex(&mut self, between: &[u32]) -> u32 {
        let share = 1.0 / between.len() as f64;
        let mean = |a: usize| between.iter().map(|&v| self.position(v)[a] * share).sum();
        let position = std::array::from_fn(mean);
        self.builder.new_vertex(position)
    }

    fn position(&self, vertex: u32) -> [f64; 3] {
        self.builder.mesh.positions[vertex as usize]
    }

    fn add_triangle(&mut self, triangle: [u32; 3]) {
        self.builder.mesh.triangles.push(triangle);
    }
}

/// Bits of the rows of a region, y fastest.
#[inline(always)]
fn bits_of_rows<T: Precision>(field: &Block<T>, region: &IndexBox) -> Vec<RowBits> {
    let [nx, ny, nz] = region.extent();
    let mut rows = Vec::with_capacity(ny * nz);
    for z in region.lower[2]..region.upper[2] {
        for y in region.lower[1]..region.upper[1] {
            let start = field.offset([region.lower[0], y, z]);
            rows.push(negative_bits(&field.values()[start..][..nx]));
        }
    }
    rows
}

/// A bit for each value below 0: eight at a time, their bytes gathered into one by a multiplication.
#[inline(always)]
fn negative_bits<T: Precision>(row: &[T]) -> RowBits {
    let zero = T::at_most(0.0);
    let mut bits = 0;
    for (number, values) in row.chunks(8).enumerate() {
        let mut bytes = [0u8; 8];
        for (byte, &value) in bytes.iter_mut().zip(values) {
            *byte = u8::from(value < zero);
        }
        let gathered = u64::from_le_bytes(bytes).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        bits |= RowBits::from(gathered) << (8 * number);
    }
    bits
}

/// The lowest `count` bits.
fn low_bits(count: usize) -> RowBits {
    if count == 0 { 0 } else { RowBits::MAX >> (RowBits::BITS as usize - count) }
}

/// Positions of the bits that are set, ascending.
fn set_bits(mut bits: RowBits) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let position = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            position
        })
    })
}
