//! Slices through an object: mask, embedding and curvature.

use super::packed::{Packed, Packer};
use crate::measurement::{Object, VoxelQuantity};
use crate::pictures::{ImageSlices, surroundings};
use crate::tiling::{Block, IndexBox};
use serde::Serialize;

/// Slices in one direction, u to the right and v upward.
#[derive(Debug, Serialize)]
pub(super) struct SliceStack {
    name: String,
    /// Directions at the left, right, bottom and top.
    letters: [char; 4],
    /// The image axis that the slices lie across, as a letter.
    axis: char,
    /// Which voxels the slices are at, ascending.
    slices: Vec<i64>,
    /// The place in `slices` of the one nearest to the object's centre of those that meet it.
    first: usize,
    /// Pixels along u and v, each a voxel of so many.
    size: [usize; 2],
    every: usize,
    /// Between pixels, mm.
    spacing: [f64; 2],
    /// The voxels of the first pixel and of those after it along u and v, in the first slice.
    corner: [i64; 3],
    along: [[i64; 3]; 2],
    /// Slices one after the other, u fastest: 1 in the object.
    mask: Packed,
    /// [`phi_of`] a byte.
    phi: Packed,
    /// H in the band: -`limit` to `limit` 1/mm as 1 to 255, 0 elsewhere.
    curvature: Packed,
    limit: f64,
}

/// Most slices in one direction.
const MOST: usize = 61;

/// The three directions' slices, of at most so many pixels; none where nothing was left to embed.
pub(super) fn slice_stacks(
    packer: &mut Packer,
    object: &Object,
    reach: f64,
    pixels: usize,
) -> Vec<SliceStack> {
    let within = surroundings(object);
    let mut all = [2, 1, 0]
        .map(|world| Pixels::of(object, ImageSlices::across(object.grid(), world, within), pixels / 3));
    let quantities = [VoxelQuantity::Phi, VoxelQuantity::MeanCurvature];
    let wanted: Vec<IndexBox> = all.iter().flat_map(Pixels::regions).collect();
    let is_wanted = |tile: &IndexBox| wanted.iter().any(|slice| !slice.intersection(tile).is_empty());
    // All three from one field: a slice by itself takes the blur of as many as the kernel is wide.
    let embedded = object.visit_voxel_maps(quantities, &within, 0.0, is_wanted, |tile, values| {
        for pixels in &mut all {
            pixels.take(tile, &values);
        }
    });
    let stacks = all.into_iter().filter(|_| embedded.is_some());
    stacks.map(|pixels| pixels.packed(packer, object, reach)).collect()
}

/// The slices of a direction, and what is known at their pixels, slice by slice, u fastest.
struct Pixels {
    plane: ImageSlices,
    slices: Vec<i64>,
    first: usize,
    size: [usize; 2],
    every: usize,
    phi: Vec<f32>,
    mean_curvature: Vec<f32>,
}

impl Pixels {
    /// Of at most so many pixels, none known.
    fn of(object: &Object, plane: ImageSlices, pixels: usize) -> Self {
        let [width, height] = plane.size();
        let every = (1..=width.max(height))
            .find(|&n| width.div_ceil(n) * height.div_ceil(n) <= pixels.max(64))
            .unwrap_or(1);
        let size = [width.div_ceil(every), height.div_ceil(every)];
        let (slices, first) = chosen(object, plane.axis, (pixels / (size[0] * size[1])).clamp(1, MOST));
        let unknown = vec![0.0; slices.len() * size[0] * size[1]];
        Self { plane, slices, first, size, every, phi: unknown.clone(), mean_curvature: unknown }
    }

    /// The slices, as boxes.
    fn regions(&self) -> impl Iterator<Item = IndexBox> + '_ {
        self.slices.iter().map(|&slice| self.plane.region(slice))
    }

    /// What a tile has of the pixels' phi and H.
    fn take(&mut self, tile: &IndexBox, [phi, mean_curvature]: &[Block<f32>; 2]) {
        let Self { plane, slices, size: [width, height], every, .. } = self;
        for (n, &slice) in slices.iter().enumerate() {
            let shared = plane.region(slice).intersection(tile);
            for (y, z) in shared.rows() {
                for x in shared.lower[0]..shared.upper[0] {
                    let voxel = [x, y, z];
                    let [u, v] = plane.place(voxel);
                    if u % *every == 0 && v % *every == 0 {
                        let place = (n * *height + v / *every) * *width + u / *every;
                        self.phi[place] = phi.get(voxel);
                        self.mean_curvature[place] = mean_curvature.get(voxel);
                    }
                }
            }
        }
    }

    fn packed(self, packer: &mut Packer, object: &Object, reach: f64) -> SliceStack {
        let Self { plane, slices, first, size, every, phi, mean_curvature } = self;
        let voxel = |slice, [u, v]: [usize; 2]| plane.voxel(slice, [u * every, v * every]);
        let is_inside = |n: usize| {
            let (slice, pixel) = (n / (size[0] * size[1]), n % (size[0] * size[1]));
            object.mask().get(voxel(slices[slice], [pixel % size[0], pixel / size[0]]))
        };
        let mask: Vec<u8> = (0..phi.len()).map(|n| u8::from(is_inside(n))).collect();
        let phi: Vec<u8> = phi.into_iter().map(|phi| phi_byte(phi.into(), reach)).collect();
        let limit = limit(&mean_curvature);
        let byte = |h: &f32| if *h == 0.0 { 0 } else { curvature_byte(f64::from(*h) / limit) };
        let curvature: Vec<u8> = mean_curvature.iter().map(byte).collect();
        let corner = voxel(slices[0], [0, 0]);
        let along = [[1, 0], [0, 1]].map(|place| {
            let there = voxel(slices[0], place);
            [0, 1, 2].map(|a| there[a] - corner[a])
        });
        SliceStack {
            letters: plane.letters,
            axis: ['x', 'y', 'z'][plane.axis],
            first,
            size,
            every,
            spacing: plane.spacing().map(|h| h * every as f64),
            corner,
            along,
            mask: packer.bytes(&mask),
            phi: packer.bytes(&phi),
            curvature: packer.bytes(&curvature),
            limit,
            name: plane.name,
            slices,
        }
    }
}

/// Slices evenly through an object, one of them nearest to its centre, and which that is.
fn chosen(object: &Object, axis: usize, count: usize) -> (Vec<i64>, usize) {
    let bounds = object.mask().bounds();
    let meets = |slice: &i64| {
        let mut region = bounds;
        (region.lower[axis], region.upper[axis]) = (*slice, slice + 1);
        object.mask().uniform_in(&region) != Some(false)
    };
    let all: Vec<i64> = (bounds.lower[axis]..bounds.upper[axis]).filter(meets).collect();
    let centre = centre(object, axis);
    let middle = (0..all.len()).min_by(|&a, &b| {
        let away = |n: usize| (all[n] as f64 - centre).abs();
        away(a).total_cmp(&away(b))
    });
    let middle = middle.unwrap_or_default();
    let every = all.len().div_ceil(count).max(1);
    let offset = middle % every;
    (all.iter().copied().skip(offset).step_by(every).take(count.max(1)).collect(), middle / every)
}

/// Mean index of an object's voxels along an axis.
fn centre(object: &Object, axis: usize) -> f64 {
    let (mut count, mut sum) = (0.0, 0.0);
    let bounds = object.mask().bounds();
    for (y, z) in bounds.rows() {
        for (a, b) in object.mask().runs_within(y, z, (bounds.lower[0], bounds.upper[0])) {
            let voxels = (b - a) as f64;
            count += voxels;
            sum += voxels * [0.5 * (a + b - 1) as f64, y as f64, z as f64][axis];
        }
    }
    sum / f64::max(count, 1.0)
}

/// Largest magnitude of H that is told apart: that of 98 % of the voxels with one.
fn limit(curvature: &[f32]) -> f64 {
    let mut known: Vec<f32> = curvature.iter().filter(|h| **h != 0.0).map(|h| h.abs()).collect();
    if known.is_empty() {
        return 1.0;
    }
    let place = (0.98 * (known.len() - 1) as f64) as usize;
    f64::from(*known.select_nth_unstable_by(place, f32::total_cmp).1)
}

fn curvature_byte(share: f64) -> u8 {
    libm::round(128.0 + 127.0 * share.clamp(-1.0, 1.0)) as u8
}

/// Phi in 256 steps from `-reach` to `reach`, 0 between the two in the middle, so that no sign is lost.
fn phi_byte(phi: f64, reach: f64) -> u8 {
    libm::floor(128.0 * (1.0 + phi / reach)).clamp(0.0, 255.0) as u8
}

/// The phi in the middle of a step.
pub(super) fn phi_of(byte: u8, reach: f64) -> f64 {
    ((f64::from(byte) + 0.5) / 128.0 - 1.0) * reach
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_keep_signs_and_are_even() {
        for phi in [-0.7, -0.3, -1e-9, 0.0, 1e-9, 0.2, 0.9] {
            let byte = phi_byte(phi, 0.5);
            assert_eq!(phi < 0.0, phi_of(byte, 0.5) < 0.0, "{phi}");
            assert!((phi_of(byte, 0.5) - f64::clamp(phi, -0.5, 0.5)).abs() <= 0.5 / 256.0 + 1e-12);
        }
        assert_eq!([-1.0, 0.0, 1.0].map(curvature_byte), [1, 128, 255]);
    }
}
