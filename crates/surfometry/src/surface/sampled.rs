//! Other images on a surface: their values at its vertices, and how these go with curvature.

use super::distribution::{bin_edges, bin_of, quantiles};
use super::{LocalQuantity, Mesh, QUANTILES, Surface, VertexArray, VertexValues};
use crate::statistics::{Places, SpatialCorrelation};
use crate::volume::{
    Affine, FieldImage, FieldOfView, FieldValues, Grid, LARGEST_FIELD_VALUE, SlabReader, VolumeError,
};
use serde::Serialize;

/// Quantities that a sample is compared with.
const COMPARED: [LocalQuantity; 3] =
    [LocalQuantity::MeanCurvature, LocalQuantity::GaussianCurvature, LocalQuantity::Curvedness];
/// Bins of a joint histogram along each axis.
const BINS: usize = 24;

/// Share of the largest magnitude up to which values differ by rounding, and are one.
const ROUNDING: f64 = 1e-9;

/// A volume that is put on surfaces: values on a lattice of its own, linear between voxels. Not a number stands for no value.
#[derive(Debug, Clone)]
pub struct SampledVolume {
    name: String,
    grid: Grid,
    values: FieldValues,
    to_index: Affine,
}

/// A volume at the vertices of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its name.
    pub name: String,
    /// One a vertex; not a number where the volume has none.
    pub values: Vec<f64>,
}

/// How a sample goes with curvature over a surface; vertices without a value and without a normal are left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleSummary {
    /// Its name.
    pub name: String,
    /// Vertices that lie outside the volume, or where it has no value.
    pub vertices_outside: u64,
    /// Share of the surface's area that they stand for.
    pub share_outside: f64,
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
        let (grid, values) = image.into_parts();
        Some(Self { name: name.into(), to_index: grid.affine().inverted()?, grid, values })
    }

    /// Reads a volume from its slabs; its values may be not a number.
    ///
    /// # Errors
    /// The source's own, and [`VolumeError`] where values are infinite or beyond 1e30, or too few, or all lie in one place.
    pub fn from_slabs<R: SlabReader>(name: impl Into<String>, reader: &mut R) -> Result<Self, R::Error> {
        let (values, grid) = (FieldValues::from_slabs(reader)?, *reader.grid());
        let (found, expected) = (values.len(), grid.voxel_count());
        if found != expected {
            return Err(VolumeError::Incomplete { found, expected }.into());
        }
        if let Some(offset) = (0..found).find(|&offset| values.get(offset).abs() > LARGEST_FIELD_VALUE) {
            let (index, value) = (grid.index_of(offset), values.get(offset));
            return Err(VolumeError::InfiniteSample { index, value }.into());
        }
        let to_index = grid.affine().inverted().ok_or(VolumeError::NonFiniteAffine)?;
        Ok(Self { name: name.into(), grid, values, to_index })
    }

    /// Where it has voxels.
    pub fn place(&self) -> Option<FieldOfView> {
        FieldOfView::new(&self.grid, &self.grid.index_box())
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its value at a point of the world, mm, linear between voxels; not a number half a voxel beyond the outermost centres, and
    /// between voxels of which one has no value.
    pub fn at(&self, world: [f64; 3]) -> f64 {
        let dimensions = self.grid.dimensions();
        let index = self.to_index.apply(world);
        if !(0..3).all(|a| (-0.5..=dimensions[a] as f64 - 0.5).contains(&index[a])) {
            return f64::NAN;
        }
        let last: [f64; 3] = std::array::from_fn(|a| (dimensions[a] - 1) as f64);
        let index: [f64; 3] = std::array::from_fn(|a| index[a].clamp(0.0, last[a]));
        let low: [usize; 3] =
            std::array::from_fn(|a| (index[a] as usize).min(dimensions[a].saturating_sub(2)));
        let part: [f64; 3] = std::array::from_fn(|a| index[a] - low[a] as f64);
        let corner = |n: usize| {
            let step: [usize; 3] = std::array::from_fn(|a| n >> a & 1);
            let place: [usize; 3] = std::array::from_fn(|a| (low[a] + step[a]).min(dimensions[a] - 1));
            let weight: f64 = (0..3).map(|a| if step[a] == 1 { part[a] } else { 1.0 - part[a] }).product();
            let value = self.values.get((place[2] * dimensions[1] + place[1]) * dimensions[0] + place[0]);
            if weight > 0.0 { weight * value } else { 0.0 }
        };
        (0..8).map(corner).sum()
    }

    /// At the vertices of a mesh.
    pub fn on(&self, mesh: &Mesh) -> Sample {
        let values = mesh.vertices.iter().map(|&vertex| self.at(vertex)).collect();
        Sample { name: self.name.clone(), values }
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
            .filter(|&n| !self.values[n].is_nan() && surface.vertices[n].has_normal && weights[n] > 0.0)
            .collect();
        let of = |values: &[f64]| -> Vec<f64> { kept.iter().map(|&n| values[n]).collect() };
        let (own, areas) = (of(&self.values), of(&weights));
        let positions: Vec<[f64; 3]> = kept.iter().map(|&n| surface.mesh.vertices[n]).collect();
        let places = Places::new(&positions, &areas);
        let total: f64 = areas.iter().sum();
        let whole: f64 = weights.iter().sum();
        let mean = |of: &dyn Fn(f64) -> f64| {
            let sum: f64 = own.iter().zip(&areas).map(|(value, area)| area * of(*value)).sum();
            (total > 0.0).then_some(sum / total)
        };
        let middle = mean(&|v| v);
        let spread = middle.and_then(|middle| mean(&|v| (v - middle) * (v - middle))).map(f64::sqrt);
        let own = tied(&own);
        let correlation = |quantity: LocalQuantity| {
            let values = tied(&of(&surface.values(quantity)?));
            Some(SampleCorrelation {
                quantity: quantity.name(),
                pearson: places.as_ref()?.pearson(&values, &own),
                spearman: places.as_ref()?.spearman(&values, &own),
                joint_histogram: JointHistogram::of(&values, &own, &areas),
            })
        };
        SampleSummary {
            name: self.name.clone(),
            vertices_outside: self.values.iter().filter(|value| value.is_nan()).count() as u64,
            share_outside: if whole > 0.0 { 1.0 - total / whole } else { 0.0 },
            mean: middle,
            standard_deviation: spread,
            correlations: COMPARED.into_iter().filter_map(correlation).collect(),
        }
    }
}

impl SampleSummary {
    /// Whether it is the same everywhere, and so goes with nothing.
    pub fn is_constant(&self) -> bool {
        !self.correlations.is_empty() && self.correlations.iter().all(|found| found.pearson.is_none())
    }
}

/// The same, with one value for all that differ by rounding.
fn tied(values: &[f64]) -> Vec<f64> {
    let step = ROUNDING * values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|&a, &b| values[a].total_cmp(&values[b]));
    let (mut tied, mut lowest) = (values.to_vec(), f64::NEG_INFINITY);
    for n in order {
        if values[n] - lowest > step {
            lowest = values[n];
        }
        tied[n] = lowest;
    }
    tied
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
