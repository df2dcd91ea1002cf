//! Rays through a field.

use rayon::prelude::*;

use super::camera::Camera;
use super::color_scale::ColorScale;
use super::dense_field::{DenseField, EmptyBricks};
use super::raster::{Background, Light, LinearTable, Raster};
use super::shading::brightness;
use crate::integrals::SmearedDelta;
use crate::volume::Affine;

/// Light that still comes through when a ray ends, and density that is too thin to see.
const SPENT: f32 = 0.003;
const CLEAR: f64 = 0.001;
/// Colours in the transfer function's table.
const COLORS: usize = 1024;

/// What rays go through: a field, and the values that colour it.
pub(crate) struct Medium<'a> {
    pub(crate) dimensions: [usize; 3],
    pub(crate) affine: Affine,
    pub(crate) phi: &'a [f32],
    pub(crate) values: &'a [f32],
    pub(crate) delta: SmearedDelta,
    pub(crate) scale: ColorScale,
}

/// A volume made ready for rays.
pub(crate) struct Marcher<'a> {
    dimensions: [usize; 3],
    origin: [f64; 3],
    /// From mm to voxels.
    inverse: [[f64; 3]; 3],
    /// Half the smallest spacing, mm.
    step: f64,
    phi: DenseField<'a>,
    raw_phi: &'a [f32],
    values: DenseField<'a>,
    bricks: EmptyBricks,
    delta: SmearedDelta,
    scale: ColorScale,
    table: Vec<[f32; 3]>,
    missing: [f32; 3],
}

impl<'a> Marcher<'a> {
    /// None where the affine cannot be inverted. The volume has as many values as voxels.
    pub(crate) fn new(volume: &Medium<'a>) -> Option<Self> {
        let linear = LinearTable::new();
        let smallest = volume.affine.column_lengths().into_iter().fold(f64::INFINITY, f64::min);
        Some(Self {
            dimensions: volume.dimensions,
            origin: volume.affine.origin,
            inverse: volume.affine.inverted()?.linear,
            step: 0.5 * smallest,
            phi: DenseField::new(volume.dimensions, volume.phi),
            raw_phi: volume.phi,
            values: DenseField::new(volume.dimensions, volume.values),
            bricks: EmptyBricks::new(volume.dimensions, volume.phi, volume.delta.half_width()),
            delta: volume.delta,
            scale: volume.scale,
            table: volume.scale.stops(COLORS).iter().map(|s| linear.light(s.1)).collect(),
            missing: linear.light(volume.scale.rgb(f64::NAN)),
        })
    }

    /// One ray a pixel; rows in parallel, each pixel on its own, so the bits do not depend on the number of
    /// threads.
    pub(crate) fn render(&self, camera: &Camera, background: Background) -> Raster {
        let [width, height] = camera.size;
        let row = |y: usize| -> Vec<u8> {
            (0..width)
                .flat_map(|x| self.ray(camera, [x as f64 + 0.5, y as f64 + 0.5]).on(background))
                .collect()
        };
        let rows: Vec<Vec<u8>> = (0..height).into_par_iter().map(row).collect();
        Raster { width, height, rgba: rows.concat() }
    }

    /// Front to back: what a sample adds is dimmed by what is before it.
    fn ray(&self, camera: &Camera, pixel: [f64; 2]) -> Light {
        let start = self.index(camera.unproject(pixel));
        let direction = self.turned(camera.basis.toward.map(|v| -v * self.step));
        let (mut light, mut through, mut color) = (Light::default(), 1.0f32, self.missing);
        let Some((first, last)) = self.samples_inside(start, direction) else { return light };
        let mut next = first;
        while next <= last {
            let position: [f64; 3] = std::array::from_fn(|a| start[a] + next as f64 * direction[a]);
            let passable = self.bricks.passable_steps(position, direction);
            next += passable.max(1);
            if passable > 0 {
                continue;
            }
            let Some(cell) = self.phi.cell(position) else { continue };
            let density = self.delta.heaviside(-self.phi.at(&cell));
            if density.is_nan() || density < CLEAR {
                continue;
            }
            // The density is the opacity of one smallest spacing; a step is half of that.
            let opacity = 1.0 - libm::sqrt(1.0 - density) as f32;
            let valid = |voxel: usize| f64::from(self.raw_phi[voxel]).abs() < self.delta.half_width();
            // Behind the band the quantity is unknown: what little light gets there sees the last colour.
            color = self.values.at_valid(&cell, valid).map_or(color, |value| self.color(value));
            let shade = self.shade(camera, position);
            light.add(color.map(|c| c * shade), through * opacity);
            through *= 1.0 - opacity;
            if through < SPENT {
                break;
            }
        }
        light
    }

    /// World to voxel index.
    fn index(&self, world: [f64; 3]) -> [f64; 3] {
        self.turned(std::array::from_fn(|a| world[a] - self.origin[a]))
    }

    fn turned(&self, vector: [f64; 3]) -> [f64; 3] {
        self.inverse.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
    }

    /// First and last sample of a ray within the block.
    fn samples_inside(&self, start: [f64; 3], direction: [f64; 3]) -> Option<(i64, i64)> {
        let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
        for a in 0..3 {
            let end = (self.dimensions[a] - 1) as f64;
            if direction[a].abs() < 1e-12 {
                if !(0.0..=end).contains(&start[a]) {
                    return None;
                }
                continue;
            }
            let (p, q) = (-start[a] / direction[a], (end - start[a]) / direction[a]);
            (first, last) = (first.max(p.min(q)), last.min(p.max(q)));
        }
        (first <= last && first.is_finite() && last.is_finite())
            .then(|| (libm::ceil(first) as i64, libm::floor(last) as i64))
    }

    fn color(&self, value: f64) -> [f32; 3] {
        let [low, high] = self.scale.limits();
        let place = ((value - low) / (high - low)).clamp(0.0, 1.0);
        self.table[libm::round(place * (COLORS - 1) as f64) as usize]
    }

    /// Shading by the gradient of phi, which points outward.
    fn shade(&self, camera: &Camera, position: [f64; 3]) -> f32 {
        let g = self.phi.gradient(position);
        let normal: [f64; 3] = std::array::from_fn(|w| (0..3).map(|a| self.inverse[a][w] * g[a]).sum());
        brightness(camera.basis.coordinates(normal).map(|v| v as f32))
    }
}
