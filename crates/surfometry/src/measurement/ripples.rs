//! How fast mean curvature changes along a surface, of which the errors of ripples and creases are made
//! (`accuracy/ripples.rs`).

use crate::integrals::BandGeometry;
use crate::local_geometry::BandVoxels;
use crate::tiling::{ExactSum, IndexBox};
use crate::volume::Spacing;
use serde::{Deserialize, Serialize};

/// Sum over some voxels of the band.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Ripples {
    /// Of the square of the surface gradient of H, 1/mm^4.
    squares: ExactSum,
    voxels: u64,
}

impl Ripples {
    #[must_use]
    pub(super) fn merged(mut self, other: &Self) -> Self {
        self.squares.merge(&other.squares);
        self.voxels += other.voxels;
        self
    }

    /// Mean over the surface of the square of H's gradient along it, 1/mm^4; 0 where none is known.
    pub(super) fn mean_square(&self) -> f64 {
        self.squares.value() / (self.voxels.max(1) as f64)
    }
}

/// Mean curvature at the voxels of a tile's band.
pub(super) struct CurvatureTile {
    tile: IndexBox,
    spacing: [f64; 3],
    /// Not a number where it is not known.
    mean_curvature: Vec<f32>,
    places: Vec<Place>,
}

struct Place {
    offset: u32,
    normal: [f32; 3],
}

impl CurvatureTile {
    pub(super) fn new(tile: IndexBox, spacing: Spacing) -> Self {
        Self { tile, spacing: spacing.mm(), mean_curvature: Vec::new(), places: Vec::new() }
    }

    /// Takes down what is known at voxels of the band.
    pub(super) fn add(&mut self, voxels: &BandVoxels, geometry: &BandGeometry) {
        // Most tiles have no band.
        self.mean_curvature.resize(self.tile.voxels(), f32::NAN);
        let [nx, ny, _] = self.tile.extent();
        for (number, index) in voxels.indices().enumerate() {
            let [x, y, z]: [usize; 3] = std::array::from_fn(|a| (index[a] - self.tile.lower[a]) as usize);
            let offset = (z * ny + y) * nx + x;
            let mean_curvature = geometry.mean_curvatures[number] as f32;
            self.mean_curvature[offset] = mean_curvature;
            // Every other voxel, as on a chessboard, is as good as all.
            if (index[0] + index[1] + index[2]) % 2 == 0 && mean_curvature.is_finite() {
                let slope = |axis: usize| voxels.column(1 + axis)[number] / geometry.gradients[number];
                let normal = std::array::from_fn(|axis| slope(axis) as f32);
                self.places.push(Place { offset: offset as u32, normal });
            }
        }
    }

    /// What the tile's voxels add up to.
    pub(super) fn ripples(self) -> Ripples {
        let squares: Vec<f64> = self.places.iter().filter_map(|place| self.square_at(place)).collect();
        let mut sum = ExactSum::default();
        sum.add(squares.iter().sum());
        Ripples { squares: sum, voxels: squares.len() as u64 }
    }

    /// The square of H's gradient along the surface, by differences between neighbours, which hardly dampen what is a few
    /// voxels long; `None` beside voxels of which nothing is known.
    fn square_at(&self, place: &Place) -> Option<f64> {
        let [nx, ny, nz] = self.tile.extent();
        let at = place.offset as usize;
        let here = f64::from(self.mean_curvature[at]);
        let position = [at % nx, at / nx % ny, at / (nx * ny)];
        let (mut square, mut across) = (0.0, 0.0);
        for (axis, (stride, size)) in [(1, nx), (nx, ny), (nx * ny, nz)].into_iter().enumerate() {
            let slope = |neighbour: usize, sign: f64| {
                let there = f64::from(self.mean_curvature[neighbour]);
                there.is_finite().then(|| sign * (there - here) / self.spacing[axis])
            };
            let before = (position[axis] > 0).then(|| slope(at - stride, -1.0)).flatten();
            let behind = (position[axis] + 1 < size).then(|| slope(at + stride, 1.0)).flatten();
            let [a, b] = [before.or(behind)?, behind.or(before)?];
            square += 0.5 * (a * a + b * b);
            across += 0.5 * (a + b) * f64::from(place.normal[axis]);
        }
        Some((square - across * across).max(0.0))
    }
}
