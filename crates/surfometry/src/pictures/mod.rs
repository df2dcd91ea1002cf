//! Pictures for papers and reports, drawn without a display: a [`Figure`] is an SVG document, and PNG comes
//! from it.
//!
//! ```
//! use surfometry::{Measurement, phantoms::Phantom};
//! use surfometry::pictures::{PictureKind, PictureStyle, picture};
//! let mask = Phantom::from_spec("torus?major=12&minor=5")?.labels()?.mask(1);
//! let object = Measurement::default().prepare(&mask)?;
//! let figure = picture(PictureKind::Surface, &object, &object.surface(), &PictureStyle::default())?;
//! assert!(figure.to_png(1.0)?.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod agreement_chart;
mod ambient_occlusion;
mod axes;
mod camera;
mod canvas;
mod color_bar;
mod color_scale;
mod contour;
mod cool_warm;
mod dense_field;
mod error;
mod euler_histogram;
mod figure;
mod frame;
mod histogram_picture;
mod image_slices;
mod layout;
mod line_chart;
mod object_pictures;
mod object_slices;
mod palette;
mod pdf;
mod pdf_font;
mod quantity;
mod raster;
mod ray_marching;
mod scale_bar;
mod shading;
mod slice_picture;
mod surface_picture;
mod surface_rendering;
#[cfg(feature = "report")]
mod thumbnail;
mod ticks;
mod view;
mod view_panels;
mod viewpoint;
mod volume_rendering;

pub use agreement_chart::{AgreementChart, AgreementPanel};
pub use camera::Camera;
pub use color_scale::{ColorScale, ScaleKind};
pub use error::PictureError;
pub use euler_histogram::EulerHistogram;
pub use figure::Figure;
pub use histogram_picture::{HistogramPicture, HistogramSeries};
#[cfg(feature = "report")]
pub(crate) use image_slices::ImageSlices;
pub use line_chart::{ChartLine, ChartPanel, LineChart};
#[cfg(feature = "io")]
pub(crate) use object_pictures::how_mapped;
pub use object_pictures::{PictureKind, PictureStyle, color_scale, picture};
pub use object_slices::SlicePlane;
#[cfg(feature = "report")]
pub(crate) use object_slices::surroundings;
pub use palette::Palette;
pub use quantity::Quantity;
pub use raster::{Background, Raster};
pub use slice_picture::{Slice, SlicePicture};
pub use surface_picture::{SceneSurface, SurfacePicture};
pub use surface_rendering::{ColoredSurface, render_surface};
#[cfg(feature = "report")]
pub(crate) use thumbnail::thumbnail;
#[cfg(feature = "report")]
pub(crate) use ticks::significant;
pub use view::{Basis, View};
pub use viewpoint::{CameraAngles, Viewpoint};
pub use volume_rendering::VolumeRendering;
