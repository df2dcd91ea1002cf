//! The numbers that are known at a vertex.

use super::VertexGeometry;
use crate::accuracy::CurvatureErrors;
use crate::choice::choices;

/// A number at every vertex of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LocalQuantity {
    /// H, 1/mm.
    #[default]
    MeanCurvature,
    /// K, 1/mm^2.
    GaussianCurvature,
    /// k1, the larger principal curvature, 1/mm.
    K1,
    /// k2, 1/mm.
    K2,
    /// Koenderink's shape index.
    ShapeIndex,
    /// Koenderink's curvedness, 1/mm.
    Curvedness,
    /// How far the blur moved the surface, mm.
    Displacement,
    /// How far outside a later surface lies, mm.
    Distance,
    /// By how much H is larger on that, 1/mm.
    MeanCurvatureChange,
    /// Standard error of H, 1/mm; of the corrected and the recovering embedding, as those below.
    MeanCurvatureError,
    /// Standard error of K, 1/mm^2.
    GaussianCurvatureError,
    /// Standard error of k1, 1/mm.
    K1Error,
    /// Standard error of k2, 1/mm.
    K2Error,
    /// Standard error of the shape index.
    ShapeIndexError,
}

choices!(LocalQuantity, "quantity": {
    MeanCurvature = "mean-curvature": "Mean curvature H",
    GaussianCurvature = "gaussian-curvature": "Gaussian curvature K",
    K1 = "k1": "Principal curvature k1",
    K2 = "k2": "Principal curvature k2",
    ShapeIndex = "shape-index": "Shape index",
    Curvedness = "curvedness": "Curvedness",
    Displacement = "displacement": "Displacement by the blur",
    Distance = "distance": "Distance to the later surface",
    MeanCurvatureChange = "mean-curvature-change": "Change of mean curvature H",
    MeanCurvatureError = "mean-curvature-standard-error": "Standard error of mean curvature H",
    GaussianCurvatureError = "gaussian-curvature-standard-error": "Standard error of Gaussian curvature K",
    K1Error = "k1-standard-error": "Standard error of principal curvature k1",
    K2Error = "k2-standard-error": "Standard error of principal curvature k2",
    ShapeIndexError = "shape-index-standard-error": "Standard error of the shape index",
});

impl LocalQuantity {
    /// Name of the array, which ends in the unit where there is one.
    pub fn name(self) -> &'static str {
        match self {
            Self::MeanCurvature => "mean_curvature_per_mm",
            Self::GaussianCurvature => "gaussian_curvature_per_mm2",
            Self::K1 => "k1_per_mm",
            Self::K2 => "k2_per_mm",
            Self::ShapeIndex => "shape_index",
            Self::Curvedness => "curvedness_per_mm",
            Self::Displacement => "displacement_mm",
            Self::Distance => "distance_mm",
            Self::MeanCurvatureChange => "mean_curvature_change_per_mm",
            Self::MeanCurvatureError => "mean_curvature_per_mm_standard_error",
            Self::GaussianCurvatureError => "gaussian_curvature_per_mm2_standard_error",
            Self::K1Error => "k1_per_mm_standard_error",
            Self::K2Error => "k2_per_mm_standard_error",
            Self::ShapeIndexError => "shape_index_standard_error",
        }
    }

    /// Unit, empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::MeanCurvature
            | Self::K1
            | Self::K2
            | Self::Curvedness
            | Self::MeanCurvatureChange
            | Self::MeanCurvatureError
            | Self::K1Error
            | Self::K2Error => "1/mm",
            Self::GaussianCurvature | Self::GaussianCurvatureError => "1/mm^2",
            Self::ShapeIndex | Self::ShapeIndexError => "",
            Self::Displacement | Self::Distance => "mm",
        }
    }

    /// What surfaces have it.
    #[cfg(feature = "pictures")]
    pub(crate) fn condition(self) -> &'static str {
        match self {
            Self::Displacement => "the Gaussian embedding at level 0.5",
            _ if self.is_change() => "a surface that is compared with a later one",
            _ if self.is_standard_error() => "embeddings of the original surface (a scale for curvature)",
            _ => "a surface",
        }
    }

    /// Whether it can be negative.
    pub fn is_signed(self) -> bool {
        self != Self::Curvedness && !self.is_standard_error()
    }

    /// Whether it is the error bar of another one.
    pub fn is_standard_error(self) -> bool {
        self.name().ends_with("_standard_error")
    }

    /// Whether it tells of a later surface.
    pub fn is_change(self) -> bool {
        matches!(self, Self::Distance | Self::MeanCurvatureChange)
    }

    /// Its value at a vertex; `None` for a displacement or a standard error that is not defined, and without a later surface; not a
    /// number where that is not known.
    pub fn at(self, vertex: &VertexGeometry) -> Option<f64> {
        let curvature = &vertex.curvature;
        let error = |of: fn(&CurvatureErrors) -> f32| vertex.errors.as_ref().map(|e| f64::from(of(e)));
        match self {
            Self::MeanCurvature => Some(curvature.mean_curvature),
            Self::GaussianCurvature => Some(curvature.gaussian_curvature),
            Self::K1 => Some(curvature.principal()[0]),
            Self::K2 => Some(curvature.principal()[1]),
            Self::ShapeIndex => Some(curvature.shape_index()),
            Self::Curvedness => Some(curvature.curvedness()),
            Self::Displacement => vertex.displacement,
            Self::Distance => vertex.change.map(|change| f64::from(change.distance)),
            Self::MeanCurvatureChange => vertex.change.map(|change| f64::from(change.mean_curvature)),
            Self::MeanCurvatureError => error(|e| e.mean_curvature),
            Self::GaussianCurvatureError => error(|e| e.gaussian_curvature),
            Self::K1Error | Self::K2Error => error(|e| e.principal),
            Self::ShapeIndexError => error(|e| e.shape_index),
        }
    }

    /// Its values at vertices; `None` where any lacks it.
    pub fn of_all(self, vertices: &[VertexGeometry]) -> Option<Vec<f64>> {
        vertices.iter().map(|vertex| self.at(vertex)).collect()
    }
}
