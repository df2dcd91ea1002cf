//! A finished picture.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{ImageHrefResolver, Options, Tree, fontdb};

use super::error::PictureError;
use super::pdf::to_pdf;
use super::raster::Raster;

/// The most pixels that [`Figure::to_png`] draws: 800 MB.
const MOST_PIXELS: f64 = 2e8;

/// A picture as an SVG document: text and lines as such, rendered surfaces embedded. It refers to nothing
/// outside itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    pub(crate) svg: String,
    pub(crate) title: String,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Figure {
    /// The SVG document.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Width in CSS pixels, of which an inch has 96.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Height in CSS pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// As a PNG file with `dpi_scale` times 96 pixels an inch (3 for print), drawn by resvg with DejaVu Sans:
    /// no display, no browser and no installed font takes part, so the bits are the same everywhere.
    ///
    /// # Errors
    /// A scale that is not positive, or one that makes more than 2e8 pixels.
    pub fn to_png(&self, dpi_scale: f64) -> Result<Vec<u8>, PictureError> {
        let (width, height) = (libm::round(self.width * dpi_scale), libm::round(self.height * dpi_scale));
        let too_large = PictureError::Size { width, height };
        if !(width >= 1.0 && height >= 1.0 && width * height <= MOST_PIXELS) {
            return Err(too_large);
        }
        let tree = Tree::from_str(&self.svg, &OPTIONS)?;
        let mut pixmap = Pixmap::new(width as u32, height as u32).ok_or(too_large)?;
        let scale = Transform::from_scale((width / self.width) as f32, (height / self.height) as f32);
        resvg::render(&tree, scale, &mut pixmap.as_mut());
        // The document's own background makes every pixel opaque: premultiplied is plain.
        let raster = Raster { width: width as usize, height: height as usize, rgba: pixmap.take() };
        raster.to_png_at(96.0 * dpi_scale)
    }

    /// As a PDF file of one page: text and lines as such, with the letters that it uses of DejaVu Sans. The bits
    /// are the same everywhere.
    ///
    /// # Errors
    /// [`PictureError::Pdf`], [`PictureError::Svg`].
    pub fn to_pdf(&self) -> Result<Vec<u8>, PictureError> {
        to_pdf(&Tree::from_str(&self.svg, &OPTIONS)?, dejavu::sans::regular(), &self.title)
    }
}

/// One font, and no way to files.
static OPTIONS: LazyLock<Options<'static>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_source(fontdb::Source::Binary(Arc::new(dejavu::sans::regular())));
    fonts.set_sans_serif_family("DejaVu Sans");
    Options {
        font_family: "DejaVu Sans".to_owned(),
        fontdb: Arc::new(fonts),
        image_href_resolver: ImageHrefResolver {
            resolve_string: Box::new(|_, _| None),
            ..ImageHrefResolver::default()
        },
        ..Options::default()
    }
});
