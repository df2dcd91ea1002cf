//! Options of pictures and colours, as typed, and what they mean.

use crate::options::positive;
use clap::{Args, ValueEnum};
use surfometry::pictures::{PictureKind, PictureStyle, View};
use surfometry::surface::LocalQuantity;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum QuantityOption {
    /// H, 1/mm
    MeanCurvature,
    /// K, 1/mm^2
    GaussianCurvature,
    /// The larger principal curvature, 1/mm
    K1,
    /// The smaller principal curvature, 1/mm
    K2,
    /// Koenderink's shape index, -1 (hollow) to 1 (ball)
    ShapeIndex,
    /// Koenderink's curvedness, 1/mm
    Curvedness,
    /// How far the blur moved the surface, mm
    Displacement,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PictureOption {
    /// The coloured surface, from --view
    Surface,
    /// Mask and embedding with the contour, in three slices
    Slices,
    /// The quantity's distribution
    Histogram,
    /// The paper's volume rendering, from --view
    Volume,
}

/// What colours and pictures show.
#[derive(Debug, Args)]
pub(crate) struct PictureOptions {
    /// What colours show
    #[arg(long, value_enum, default_value = "mean-curvature")]
    quantity: QuantityOption,
    /// Magnitude at the ends of the colour scale, in the quantity's unit [default: that of 98 % of the area, rounded]
    #[arg(long, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    limit: Option<f64>,
    /// Views: anterior, posterior, left, right, superior, inferior, oblique; several make several panels
    #[arg(long, value_delimiter = ',', default_value = "oblique")]
    view: Vec<View>,
    /// Pictures, a file each
    #[arg(long, value_enum, value_delimiter = ',', default_value = "surface")]
    picture: Vec<PictureOption>,
    /// Dots per inch of PNG pictures, at most 1200
    #[arg(long, default_value = "192", value_parser = clap::value_parser!(u16).range(24..=1200))]
    dpi: u16,
}

impl PictureOptions {
    /// Quantity, scale and views.
    pub(crate) fn style(&self) -> PictureStyle {
        PictureStyle {
            quantity: match self.quantity {
                QuantityOption::MeanCurvature => LocalQuantity::MeanCurvature,
                QuantityOption::GaussianCurvature => LocalQuantity::GaussianCurvature,
                QuantityOption::K1 => LocalQuantity::K1,
                QuantityOption::K2 => LocalQuantity::K2,
                QuantityOption::ShapeIndex => LocalQuantity::ShapeIndex,
                QuantityOption::Curvedness => LocalQuantity::Curvedness,
                QuantityOption::Displacement => LocalQuantity::Displacement,
            },
            limit: self.limit,
            views: self.view.clone(),
            title: String::new(),
        }
    }

    /// The pictures to draw.
    pub(crate) fn kinds(&self) -> Vec<PictureKind> {
        let kind = |option: &PictureOption| match option {
            PictureOption::Surface => PictureKind::Surface,
            PictureOption::Slices => PictureKind::Slices,
            PictureOption::Histogram => PictureKind::Histogram,
            PictureOption::Volume => PictureKind::Volume,
        };
        distinct(self.picture.iter().map(kind))
    }

    /// Pixels a picture unit.
    pub(crate) fn dpi_scale(&self) -> f64 {
        f64::from(self.dpi) / 96.0
    }
}

/// Each value once, in the order of first appearance.
pub(crate) fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for value in values {
        if !kept.contains(&value) {
            kept.push(value);
        }
    }
    kept
}
