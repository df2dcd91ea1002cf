//! Other images on a surface: their values at its vertices, and how these go with curvature.

use super::distribution::{bin_edges, bin_of, quantiles};
use super::{LocalQuantity, Mesh, QUANTILES, Surface, VertexArray, VertexValues};
use crate::statistics::{Places, SpatialCorrelation};
use crate::volume::{Affine, FieldImage};
use serde::Serialize;

/// Quantities that a sample is compared with.
const COMPARED: [LocalQuantity; 3] =
    [LocalQuantity::MeanCurvature, LocalQuantity::GaussianCurvature, LocalQuantity::Curvedness];
/// Bins of a joint histogram along each axis.
const BINS: usize = 24;

/// A volume that is put on surfaces: values on a lattice of its own, linear between voxels.
#[derive(Debug, Clone)]
pub struct SampledVolume {
    name: String,
    image: FieldImage,
    to_index: Affine,
}

/// A volume at the vertices of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its name.
    pub name: String,
    /// One a vertex; outside the volume that of its nearest point.
    pub values: Vec<f64>,
    /// Whether the vertex lies in the volume: within half a voxel of a voxel's centre.
    pub inside: Vec<bool>,
}

/// How a sample goes with curvature over a surface; vertices outside the volume and without a normal are left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleSummary {
    /// Its name.
    pub name: String,
    /// Vertices that lie outside the volume.
    pub vertices_outside: u64,
    /// Area-weighted mean and standard deviation; `None` where no vertex is left.
    pub mean: Option<f64>,
    /// As `mean`.
    pub standard_deviation: Option<f64>,
    /// One a quantity.
    pub correlations: Vec<SampleCorrelation>,
}

/// A sample against one quantity of curvature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleCorrelation {
    /// The quantity's array.
    pub quantity: &'static str,
    /// Pearson's coefficient, weighted by area; `None` where one of them is the same everywhere.
    pub pearson: Option<SpatialCorrelation>,
    /// Spearman's.
    pub spearman: Option<SpatialCorrelation>,
    /// How they occur together.
    pub joint_histogram: JointHistogram,
}

/// Shares of the area in bins of two quantities.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointHistogram {
    /// Ends of the bins of the curvature, ascending, from its quantile 0.01 to that of 0.99; the outer bins hold all that lies
    /// beyond.
    pub quantity_edges: Vec<f64>,
    /// The same of the sample.
    pub sample_edges: Vec<f64>,
    /// A row a bin of curvature, in it a share a bin of the sample; all sum to 1.
    pub by_area: Vec<Vec<f64>>,
}

impl SampledVolume {
    /// Of a field and its name; `None` of an image whose voxels lie in one place.
    pub fn new(name: impl Into<String>, image: FieldImage) -> Option<Self> {
        let to_index = image.grid().affine().inverted()?;
        Some(Self { name: name.into(), image, to_index })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its value at a point of the world, mm, linear between voxels, and whether that lies in it.
    pub fn at(&self, world: [f64; 3]) -> (f64, bool) {
        let dimensions = self.image.grid().dimensions();
        let index = self.to_index.apply(world);
        let inside = (0..3).all(|a| (-0.5..=dimensions[a] as f64 - 0.5).contains(&index[a]));
        let last: [f64; 3] = std::array::from_fn(|a| (dimensions[a] - 1) as f64);
        let index: [f64; 3] = std::array::from_fn(|a| index[a].clamp(0.0, last[a]));
        let low: [usize; 3] =
            std::array::from_fn(|a| (index[a] as usize).min(dimensions[a].saturating_sub(2)));
        let part: [f64; 3] = std::array::from_fn(|a| index[a] - low[a] as f64);
        let corner = |n: usize| {
            let step: [usize; 3] = std::array::from_fn(|a| n >> a & 1);
            let place: [usize; 3] = std::array::from_fn(|a| (low[a] + step[a]).min(dimensions[a] - 1));
            let weight: f64 = (0..3).map(|a| if step[a] == 1 { part[a] } else { 1.0 - part[a] }).product();
            let value =
                self.image.values().get((place[2] * dimensions[1] + place[1]) * dimensions[0] + place[0]);
            if weight > 0.0 { weight * value } else { 0.0 }
        };
        ((0..8).map(corner).sum(), inside)
    }

    /// At the vertices of a mesh.
    pub fn on(&self, mesh: &Mesh) -> Sample {
        let (values, inside) = mesh.vertices.iter().map(|&vertex| self.at(vertex)).unzip();
        Sample { name: self.name.clone(), values, inside }
    }
}

impl Sample {
    /// As an array at vertices.
    pub fn array(&self) -> VertexArray {
        VertexArray { name: self.name.clone().into(), values: VertexValues::Scalar(self.values.clone()) }
    }

    /// How it goes with the curvature of its surface.
    pub fn summary(&self, surface: &Surface) -> SampleSummary {
        let weights = surface.weights();
        let kept: Vec<usize> = (0..self.values.len())
            .filter(|&n| self.inside[n] && surface.vertices[n].has_normal && weights[n] > 0.0)
            .collect();
        let of = |values: &[f64]| -> Vec<f64> { kept.iter().map(|&n| values[n]).collect() };
        let (own, areas) = (of(&self.values), of(&weights));
        let positions: Vec<[f64; 3]> = kept.iter().map(|&n| surface.mesh.vertices[n]).collect();
        let places = Places::new(&positions, &areas);
        let total: f64 = areas.iter().sum();
        let mean = |of: &dyn Fn(f64) -> f64| {
            let sum: f64 = own.iter().zip(&areas).map(|(value, area)| area * of(*value)).sum();
            (total > 0.0).then_some(sum / total)
        };
        let middle = mean(&|v| v);
        let spread = middle.and_then(|middle| mean(&|v| (v - middle) * (v - middle))).map(f64::sqrt);
        let correlation = |quantity: LocalQuantity| {
            let values = of(&surface.values(quantity)?);
            Some(SampleCorrelation {
                quantity: quantity.name(),
                pearson: places.as_ref()?.pearson(&values, &own),
                spearman: places.as_ref()?.spearman(&values, &own),
                joint_histogram: JointHistogram::of(&values, &own, &areas),
            })
        };
        SampleSummary {
            name: self.name.clone(),
            vertices_outside: self.inside.iter().filter(|inside| !**inside).count() as u64,
            mean: middle,
            standard_deviation: spread,
            correlations: COMPARED.into_iter().filter_map(correlation).collect(),
        }
    }
}

impl JointHistogram {
    fn of(quantity: &[f64], sample: &[f64], areas: &[f64]) -> Self {
        let total: f64 = areas.iter().sum();
        let edges = |values: &[f64]| {
            let ends = quantiles(values, areas);
            bin_edges(ends[0], ends[QUANTILES.len() - 1], BINS)
        };
        let (quantity_edges, sample_edges) = (edges(quantity), edges(sample));
        let mut by_area = vec![vec![0.0; BINS]; BINS];
        for ((a, b), area) in quantity.iter().zip(sample).zip(areas) {
            by_area[bin_of(&quantity_edges, *a)][bin_of(&sample_edges, *b)] += area / total;
        }
        Self { quantity_edges, sample_edges, by_area }
    }
}
