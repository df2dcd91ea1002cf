//! The blurred indicator: the paper's embedding, and the one whose leading shift is taken off.

use super::blur::Blur;
use super::point_field::PointField;
use super::point_kernel::PointDerivatives;
use super::separable::{Orders, Separable};
use super::{EdgeProfile, Embedding, Indicator};
use crate::tiling::{Block, IndexBox, Pool};
use std::sync::OnceLock;

/// phi = T - G_sigma * I, with I the indicator of the object (Besler et al., the "proposed embedding"), or a
/// combination of two such blurs ([`GaussianEmbedding::corrected`]).
///
/// Beyond the object's bounding box I is 0 without limit, so an image border changes nothing. Valid where the
/// object and its gaps are wider than about 3 sigma; thinner parts shrink or vanish.
#[derive(Debug)]
pub struct GaussianEmbedding<'a> {
    indicator: &'a dyn Indicator,
    sigma: f64,
    level: f64,
    terms: Vec<Term>,
    /// Fields of terms before they are combined.
    work: Pool<Vec<f32>>,
}

/// A blur, and its share in the field.
#[derive(Debug)]
struct Term {
    weight: f64,
    sigma: f64,
    truncation: f64,
    blur: Blur,
    /// Made when first asked for: differences of the blur need neither.
    convolution: OnceLock<Separable>,
    at_points: OnceLock<PointField>,
}

impl<'a> GaussianEmbedding<'a> {
    /// The embedding of an object with sigma in mm and level T; kernels are cut at `truncation` sigma.
    pub fn new(indicator: &'a dyn Indicator, sigma: f64, level: f64, truncation: f64) -> Self {
        Self::of_profile(indicator, &EdgeProfile::blurred(sigma), level, truncation)
    }

    /// The embedding without the leading shift of its zero level, at level 0.5: phi - sigma d phi / d sigma,
    /// which is phi - sigma^2 Laplacian(phi), as a difference of two blurs, (sqrt 2 phi_sigma - phi_(sqrt 2
    /// sigma)) / (sqrt 2 - 1).
    ///
    /// At a curved surface the blurred indicator is off 1/2 by a series in odd powers of sigma, whose first
    /// term this cancels. So the zero level stands where the object's surface was, up to sigma^4 (on a ball
    /// up to exp(-2 R^2 / sigma^2)), and curvature there is the object's. Noise is 2.6 times that of the
    /// plain blur of the same sigma, wherefore sigma should be larger.
    pub fn corrected(indicator: &'a dyn Indicator, sigma: f64, truncation: f64) -> Self {
        Self::of_profile(indicator, &EdgeProfile::corrected(sigma), 0.5, truncation)
    }

    pub(crate) fn of_profile(
        indicator: &'a dyn Indicator,
        profile: &EdgeProfile,
        level: f64,
        truncation: f64,
    ) -> Self {
        let spacing = indicator.grid().spacing().mm();
        let term = |&(weight, sigma): &(f64, f64)| Term {
            weight,
            sigma,
            truncation,
            blur: Blur::new(sigma, spacing, truncation),
            convolution: OnceLock::new(),
            at_points: OnceLock::new(),
        };
        let terms = profile.terms().iter().map(term).collect();
        Self { indicator, sigma: profile.sigma(), level, terms, work: Pool::default() }
    }

    /// The object.
    pub fn indicator(&self) -> &'a dyn Indicator {
        self.indicator
    }

    /// Standard deviation of the (first) blur, mm.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The level T.
    pub(crate) fn level(&self) -> f64 {
        self.level
    }

    /// The blurred indicator and its derivatives, in mm, at fractional voxel indices of points near each other.
    pub(crate) fn derivatives_at(&self, points: &[[f64; 3]]) -> Vec<PointDerivatives> {
        let mut totals = vec![[0.0; 10]; points.len()];
        for term in &self.terms {
            let field =
                term.at_points.get_or_init(|| PointField::new(term.sigma, self.spacing(), term.truncation));
            for (total, found) in totals.iter_mut().zip(field.derivatives(self.indicator, points)) {
                total.iter_mut().zip(found).for_each(|(sum, value)| *sum += term.weight * value);
            }
        }
        totals
    }

    /// Derivatives of the blurred indicator on a box, slice by slice; an n-th one in units of 1 / sigma^n.
    pub(crate) fn for_each_slice(
        &self,
        region: &IndexBox,
        orders: &[Orders],
        mut visit: impl FnMut(i64, &[Vec<f32>]),
    ) {
        let [first, others @ ..] = self.terms.as_slice() else { return };
        // By term, slice and order.
        let rest: Vec<Vec<Vec<Vec<f32>>>> = others
            .iter()
            .map(|term| {
                let mut slices = Vec::new();
                let keep = |_, planes: &[Vec<f32>]| slices.push(planes.to_vec());
                self.convolution(term).for_each_slice(self.indicator, region, orders, keep);
                slices
            })
            .collect();
        self.convolution(first).for_each_slice(self.indicator, region, orders, |z, planes| {
            if others.is_empty() {
                return visit(z, planes);
            }
            let mut sums = planes.to_vec();
            for (n, sum) in sums.iter_mut().enumerate() {
                for value in sum.iter_mut() {
                    *value *= first.weight as f32;
                }
                for (term, slices) in others.iter().zip(&rest) {
                    // Each term's derivatives come in units of its own sigma.
                    let order = orders[n].iter().sum::<usize>() as i32;
                    let weight = (term.weight * (self.sigma / term.sigma).powi(order)) as f32;
                    let plane = &slices[(z - region.lower[2]) as usize][n];
                    sum.iter_mut().zip(plane).for_each(|(value, other)| *value += weight * other);
                }
            }
            visit(z, &sums);
        });
    }

    fn convolution<'t>(&self, term: &'t Term) -> &'t Separable {
        term.convolution.get_or_init(|| Separable::new(term.sigma, self.spacing(), term.truncation))
    }

    fn spacing(&self) -> [f64; 3] {
        self.indicator.grid().spacing().mm()
    }

    /// How far the widest blur reaches.
    fn reach(&self) -> [i64; 3] {
        self.terms
            .iter()
            .map(|term| term.blur.halo())
            .fold([0; 3], |a, b| std::array::from_fn(|n| a[n].max(b[n])))
    }
}

impl Embedding for GaussianEmbedding<'_> {
    type Value = f32;

    fn support(&self, _half_width: f64) -> IndexBox {
        self.indicator.bounds().grown(self.reach())
    }

    fn halo(&self, _half_width: f64) -> [i64; 3] {
        self.reach()
    }

    fn evaluate_in(&self, storage: Vec<f32>, region: &IndexBox, _half_width: f64) -> Block<f32> {
        let level = self.level as f32;
        let mut phi = Block::reusing(storage, *region, level);
        let [first, others @ ..] = self.terms.as_slice() else { return phi };
        first.blur.subtract_from(level, self.indicator, region, phi.values_mut());
        for other in others {
            // Weights add up to 1: sums of differences from one field leave constants exact.
            let weight = (1.0 - other.weight) as f32;
            self.work.with(|field| {
                field.resize(region.voxels(), 0.0);
                other.blur.subtract_from(level, self.indicator, region, field);
                for (phi, &other) in phi.values_mut().iter_mut().zip(field.iter()) {
                    *phi = other + weight * (*phi - other);
                }
            });
        }
        phi
    }

    fn constant_on(&self, region: &IndexBox, _half_width: f64) -> Option<f64> {
        let inside = self.indicator.uniform_in(&region.grown(self.reach()))?;
        Some(if inside { self.level - 1.0 } else { self.level })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, Mask};

    /// A half space is blurred to an error function along every axis, anisotropic or not. Its face lies
    /// half-way between voxel centres, where a sum of samples is the midpoint rule: its known error, h^2/24
    /// times the slope of the Gaussian, is taken off, and the next term of Euler and Maclaurin bounds what is
    /// left.
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
