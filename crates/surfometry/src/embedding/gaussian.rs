//! The paper's embedding: the blurred indicator.

use super::blur::Blur;
use super::point_kernel::{PointDerivatives, PointKernel};
use super::{Embedding, Separable};
use crate::tiling::{Block, IndexBox};
use crate::volume::Mask;
use std::sync::OnceLock;

/// phi = T - G_sigma * I, with I the indicator of the object (Besler et al., the "proposed embedding").
///
/// Beyond the object's bounding box I is 0 without limit, so an image border changes nothing. Valid where the
/// object and its gaps are wider than about 3 sigma; thinner parts shrink or vanish.
#[derive(Debug)]
pub struct GaussianEmbedding<'a> {
    mask: &'a Mask,
    sigma: f64,
    level: f64,
    truncation: f64,
    blur: Blur,
    /// Made when first asked for: differences of the blur need neither.
    convolution: OnceLock<Separable>,
    at_points: OnceLock<PointKernel>,
}

impl<'a> GaussianEmbedding<'a> {
    /// The embedding of a mask with sigma in mm and level T; kernels are cut at `truncation` sigma.
    pub fn new(mask: &'a Mask, sigma: f64, level: f64, truncation: f64) -> Self {
        let spacing = mask.grid().spacing().mm();
        Self {
            mask,
            sigma,
            level,
            truncation,
            blur: Blur::new(sigma, spacing, truncation),
            convolution: OnceLock::new(),
            at_points: OnceLock::new(),
        }
    }

    /// The object.
    pub fn mask(&self) -> &'a Mask {
        self.mask
    }

    /// Standard deviation of the blur, mm.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The level T.
    pub(crate) fn level(&self) -> f64 {
        self.level
    }

    /// The blurred indicator and its derivatives at a fractional voxel index.
    pub(crate) fn convolve_at(&self, point: [f64; 3]) -> PointDerivatives {
        let kernel =
            self.at_points.get_or_init(|| PointKernel::new(self.sigma, self.spacing(), self.truncation));
        kernel.convolve(self.mask, point)
    }

    pub(crate) fn convolution(&self) -> &Separable {
        self.convolution.get_or_init(|| Separable::new(self.sigma, self.spacing(), self.truncation))
    }

    fn spacing(&self) -> [f64; 3] {
        self.mask.grid().spacing().mm()
    }
}

impl Embedding for GaussianEmbedding<'_> {
    type Value = f32;

    fn support(&self, _half_width: f64) -> IndexBox {
        self.mask.bounds().grown(self.blur.halo())
    }

    fn halo(&self, _half_width: f64) -> [i64; 3] {
        self.blur.halo()
    }

    fn evaluate_in(&self, storage: Vec<f32>, region: &IndexBox, _half_width: f64) -> Block<f32> {
        let level = self.level as f32;
        let mut phi = Block::reusing(storage, *region, level);
        self.blur.subtract_from(level, self.mask, region, phi.values_mut());
        phi
    }

    fn constant_on(&self, region: &IndexBox, _half_width: f64) -> Option<f64> {
        let inside = self.mask.uniform_in(&region.grown(self.blur.halo()))?;
        Some(if inside { self.level - 1.0 } else { self.level })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;

    /// A half space is blurred to an error function along every axis, anisotropic or not. Its face lies half-way
    /// between voxel centres, where a sum of samples is the midpoint rule: its known error, h^2/24 times the slope of
    /// the Gaussian, is taken off, and the next term of Euler and Maclaurin bounds what is left.
    #[test]
    fn a_plane_becomes_an_error_function() {
        let (sigma, n) = (2.0f64, 60usize);
        let spacing = [0.7, 1.0, 1.6];
        for (axis, h) in spacing.into_iter().enumerate() {
            let grid = Grid::axis_aligned([n; 3], spacing).unwrap();
            let mask = Mask::from_predicate(grid, |index| index[axis] < n / 2);
            let embedding = GaussianEmbedding::new(&mask, sigma, 0.5, 5.0);
            for step in -5..5 {
                let mut index = [(n / 2) as i64; 3];
                index[axis] += step;
                let phi = f64::from(embedding.evaluate(&IndexBox::voxel(index), 1.0).get(index));
                let s = (step as f64 + 0.5) * h;
                let bell =
                    libm::exp(-s * s / (2.0 * sigma * sigma)) / (sigma * libm::sqrt(std::f64::consts::TAU));
                let midpoint = h * h / 24.0 * s / (sigma * sigma) * bell;
                let expected = 0.5 * libm::erf(s / (sigma * std::f64::consts::SQRT_2)) + midpoint;
                let bound = 7.0 / 5760.0 * h.powi(4) * 0.56 / sigma.powi(4) + 1e-6;
                assert!((phi - expected).abs() < bound, "axis {axis}, step {step}: {phi} {expected} {bound}");
            }
        }
    }
}
