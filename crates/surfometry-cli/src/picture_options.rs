//! Options of pictures and colours, as typed, and what they mean.

use crate::values::one_of;
use clap::Args;
use surfometry::pictures::{PictureKind, PictureStyle, View};
use surfometry::runs::MapStyle;
use surfometry::runs::words::positive;
use surfometry::surface::LocalQuantity;

/// What colours and pictures show.
#[derive(Debug, Args)]
pub(crate) struct PictureOptions {
    /// What colours show
    #[arg(long, default_value = "mean-curvature", value_parser = one_of::<LocalQuantity>())]
    quantity: LocalQuantity,
    /// Magnitude at the ends of the colour scale, in the quantity's unit [default: that of 98 % of the area,
    /// rounded]
    #[arg(long, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    limit: Option<f64>,
    /// Views: anterior, posterior, left, right, superior, inferior, oblique; several make several panels
    #[arg(long, value_delimiter = ',', default_value = "oblique", value_parser = one_of::<View>(), hide_possible_values = true)]
    view: Vec<View>,
    /// Pictures, a file each
    #[arg(long, value_delimiter = ',', default_value = "surface", value_parser = one_of::<PictureKind>())]
    picture: Vec<PictureKind>,
    /// Dots per inch of PNG pictures, at most 1200
    #[arg(long, default_value = "192", value_parser = clap::value_parser!(u16).range(24..=1200))]
    dpi: u16,
}

impl PictureOptions {
    /// How maps are drawn; of voxels those that are the default.
    pub(crate) fn map_style(&self) -> MapStyle {
        MapStyle {
            picture: PictureStyle {
                quantity: self.quantity,
                limit: self.limit,
                views: self.view.clone(),
                title: String::new(),
            },
            pictures: distinct(&self.picture),
            dpi_scale: f64::from(self.dpi) / 96.0,
            ..MapStyle::default()
        }
    }
}

/// Each value once, in the order of first appearance.
pub(crate) fn distinct<T: Copy + PartialEq>(values: &[T]) -> Vec<T> {
    let mut kept = Vec::new();
    for &value in values {
        if !kept.contains(&value) {
            kept.push(value);
        }
    }
    kept
}
