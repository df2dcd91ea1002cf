//! Options of pictures and colours, as typed, and what they mean.

use crate::values::one_of;
use anyhow::Result;
use clap::Args;
use surfometry::measurement::VoxelQuantity;
use surfometry::pictures::{Palette, PictureKind, PictureStyle, SlicePlane, View, Viewpoint};
use surfometry::runs::MapStyle;
use surfometry::runs::picture_words::{PictureWidth, camera, slice, width};
use surfometry::runs::words::positive;
use surfometry::surface::LocalQuantity;

/// What colours and pictures show.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures")]
pub(crate) struct PictureOptions {
    /// What colours show [default: mean-curvature; of `map --against` distance]
    #[arg(long, value_parser = one_of::<LocalQuantity>())]
    quantity: Option<LocalQuantity>,
    /// Magnitude at the ends of the colour scale, in the quantity's unit [default: that of 98 % of the area,
    /// rounded]
    #[arg(long, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    limit: Option<f64>,
    /// Colour scale [default: cool-warm of quantities with a sign, else viridis]
    #[arg(long, value_name = "NAME", value_parser = one_of::<Palette>())]
    colors: Option<Palette>,
    /// Views: anterior, posterior, left, right, superior, inferior, oblique; several make several panels [default:
    /// oblique]
    #[arg(long, value_delimiter = ',', value_parser = one_of::<View>(), hide_possible_values = true)]
    view: Vec<View>,
    /// A view by angles in degrees: azimuth from the front toward the object's left, elevation, and by how much the
    /// picture is turned clockwise; may be given several times
    #[arg(long, value_name = "AZIMUTH,ELEVATION[,ROLL]", value_parser = camera, allow_hyphen_values = true)]
    camera: Vec<Viewpoint>,
    /// A slice for --picture slices: an axis of the image, x the fastest, and the index of a voxel; may be given several
    /// times [default: the three through the object's centroid]
    #[arg(long, value_name = "AXIS=N|centre", value_parser = slice)]
    slice: Vec<SlicePlane>,
    /// What colours show on slices
    #[arg(long, value_name = "QUANTITY", default_value = "phi", value_parser = one_of::<VoxelQuantity>())]
    on_slices: VoxelQuantity,
    /// Width of pictures, as 85mm or 1200px; text keeps its size [default: what is in them takes]
    #[arg(long, value_name = "MM|PX", value_parser = width, allow_hyphen_values = true)]
    size: Option<PictureWidth>,
    /// Pictures, a file each
    #[arg(long, value_delimiter = ',', default_value = "surface", value_parser = one_of::<PictureKind>())]
    picture: Vec<PictureKind>,
    /// Dots per inch of PNG pictures, at most 1200
    #[arg(long, default_value = "192", value_parser = clap::value_parser!(u16).range(24..=1200), allow_hyphen_values = true)]
    dpi: u16,
}

impl PictureOptions {
    /// How maps are drawn, of some quantity where none was chosen; of voxels those that are the default.
    pub(crate) fn map_style(&self, quantity: LocalQuantity) -> Result<MapStyle> {
        let dpi = f64::from(self.dpi);
        let named = self.view.iter().copied().map(Viewpoint::from);
        let views: Vec<Viewpoint> = named.chain(self.camera.iter().copied()).collect();
        let standard = PictureStyle::default();
        Ok(MapStyle {
            picture: PictureStyle {
                quantity: self.quantity.unwrap_or(quantity),
                limit: self.limit,
                palette: self.colors,
                views: if views.is_empty() { standard.views.clone() } else { views },
                slices: self.slice.clone(),
                on_slices: self.on_slices,
                width: self.size.map(|width| width.units(dpi)).transpose()?,
                ..standard
            },
            pictures: distinct(&self.picture),
            dpi_scale: dpi / 96.0,
            ..MapStyle::default()
        })
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
