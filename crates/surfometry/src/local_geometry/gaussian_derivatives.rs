//! Derivatives of the blurred indicator by convolution with derivatives of the Gaussian.

use super::{BandVoxels, Differentiation, Jet, band_indices};
use crate::embedding::{GaussianEmbedding, JET_ORDERS};
use crate::tiling::{Block, IndexBox};

/// First and second derivatives straight from the mask, without differences.
///
/// d(G * I) = (dG) * I holds exactly, so the only errors are the sampling of the kernels (exp(-2 pi^2 sigma^2
/// / h^2)) and their cut. Accurate from sigma = 1 voxel on, very accurate from 1.5 on (van Vliet and Verbeek
/// 1993 advise 2.7 for local curvature).
#[derive(Debug)]
pub struct GaussianDerivatives<'a> {
    embedding: GaussianEmbedding<'a>,
}

/// Orders of a [`Jet`]'s derivatives.
const DERIVATIVES: [[usize; 3]; 9] = {
    let [_value, derivatives @ ..] = JET_ORDERS;
    derivatives
};

impl<'a> GaussianDerivatives<'a> {
    /// Derivatives of an embedding.
    pub fn new(embedding: GaussianEmbedding<'a>) -> Self {
        Self { embedding }
    }
}

impl<'a> Differentiation for GaussianDerivatives<'a> {
    type Field = GaussianEmbedding<'a>;

    fn embedding(&self) -> &Self::Field {
        &self.embedding
    }

    fn field_region(&self, tile: &IndexBox) -> IndexBox {
        tile.grown([1; 3])
    }

    /// Convolves over the hull of the band alone.
    fn visit_band(
        &self,
        field: &Block<f32>,
        tile: &IndexBox,
        half_width: f64,
        visit: &mut dyn FnMut(&BandVoxels),
    ) {
        let indices = band_indices(field, tile, half_width);
        let unit = self.embedding.sigma();
        let mut voxels = BandVoxels::new();
        // In parts, because ten derivatives of a whole tile are much to hold.
        for indices in indices.chunk_by(|a, b| a[2].div_euclid(SLICES) == b[2].div_euclid(SLICES)) {
            let hull = indices.iter().fold(IndexBox::EMPTY, |hull, &i| hull.hull(&IndexBox::voxel(i)));
            let mut rest = indices;
            let nx = hull.extent()[0];
            self.embedding.for_each_slice(&hull, &DERIVATIVES, |z, planes| {
                let (slice, others) = rest.split_at(rest.partition_point(|i| i[2] <= z));
                rest = others;
                for &index in slice {
                    let offset =
                        (index[1] - hull.lower[1]) as usize * nx + (index[0] - hull.lower[0]) as usize;
                    let jet = jet_of_blur(field.get(index).into(), unit, |n| f64::from(planes[n][offset]));
                    voxels.push_jet(index, &jet, visit);
                }
            });
        }
        voxels.flush(visit);
    }

    fn jets_at(&self, _field: &Block<f32>, points: &[[f64; 3]]) -> Vec<Jet> {
        self.jets(points)
    }

    fn jets(&self, points: &[[f64; 3]]) -> Vec<Jet> {
        let jet = |[value, derivatives @ ..]: [f64; 10]| {
            jet_of_blur(self.embedding.level() - value, 1.0, |n| derivatives[n])
        };
        self.embedding.derivatives_at(points).into_iter().map(jet).collect()
    }
}

/// Slices of the band that are convolved together.
const SLICES: i64 = 32;
/// phi = T - blur, so its derivatives are those of the blur, negated; the blur's are in terms of a unit of
/// length in mm.
fn jet_of_blur(phi: f64, unit: f64, derivative: impl Fn(usize) -> f64) -> Jet {
    Jet {
        value: phi,
        gradient: std::array::from_fn(|n| -derivative(n) / unit),
        hessian: std::array::from_fn(|n| -derivative(n + 3) / (unit * unit)),
    }
}
