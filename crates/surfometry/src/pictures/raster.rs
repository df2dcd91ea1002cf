//! A grid of pixels.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::cool_warm::{decoded, encoded};
use super::error::PictureError;

/// What is behind the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// White.
    White,
    /// Nothing: alpha is the share of a pixel that the object covers.
    Transparent,
}

/// Pixels, row by row from the upper left corner: red, green, blue (sRGB) and alpha (not multiplied in), a
/// byte each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Raster {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Four bytes a pixel.
    pub rgba: Vec<u8>,
}

impl Raster {
    /// From a colour for every pixel.
    pub(crate) fn from_colors([width, height]: [usize; 2], color: impl Fn([usize; 2]) -> [u8; 3]) -> Self {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let rgba = pixels.flat_map(|at| {
            let [r, g, b] = color(at);
            [r, g, b, 255]
        });
        Self { width, height, rgba: rgba.collect() }
    }

    /// Red, green, blue and alpha of a pixel.
    pub fn pixel(&self, [x, y]: [usize; 2]) -> [u8; 4] {
        let at = 4 * (y * self.width + x);
        std::array::from_fn(|i| self.rgba[at + i])
    }

    /// As a PNG file; alpha is left out where every pixel is opaque.
    ///
    /// # Errors
    /// A raster without pixels, or with more than 2^31 a side, is no PNG.
    pub fn to_png(&self) -> Result<Vec<u8>, PictureError> {
        encode(self, None)
    }

    /// As a PNG file that says how large it is to be printed.
    pub(crate) fn to_png_at(&self, dots_per_inch: f64) -> Result<Vec<u8>, PictureError> {
        encode(self, Some(libm::round(dots_per_inch / 0.0254) as u32))
    }

    /// As an address that carries its data, for SVG and HTML.
    ///
    /// # Errors
    /// As [`Raster::to_png`].
    pub fn to_data_uri(&self) -> Result<String, PictureError> {
        Ok(format!("data:image/png;base64,{}", STANDARD.encode(self.to_png()?)))
    }
}

fn encode(raster: &Raster, dots_per_metre: Option<u32>) -> Result<Vec<u8>, PictureError> {
    let opaque = raster.rgba.chunks_exact(4).all(|p| p[3] == 255);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, raster.width as u32, raster.height as u32);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    encoder.set_pixel_dims(dots_per_metre.map(|n| png::PixelDimensions {
        xppu: n,
        yppu: n,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    if opaque {
        let rgb: Vec<u8> = raster.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        writer.write_image_data(&rgb)?;
    } else {
        writer.write_image_data(&raster.rgba)?;
    }
    writer.finish()?;
    Ok(file)
}

/// Linear light with the share of the pixel that it covers multiplied in: sums and mixtures are physical.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Light {
    pub(crate) rgb: [f32; 3],
    pub(crate) cover: f32,
}

impl Light {
    pub(crate) fn add(&mut self, rgb: [f32; 3], cover: f32) {
        for (sum, component) in self.rgb.iter_mut().zip(rgb) {
            *sum += cover * component;
        }
        self.cover += cover;
    }

    /// The pixel.
    pub(crate) fn on(self, background: Background) -> [u8; 4] {
        if self.cover == 0.0 {
            return [255, 255, 255, if background == Background::White { 255 } else { 0 }];
        }
        let cover = self.cover.min(1.0);
        let [r, g, b] = match background {
            Background::White => self.rgb.map(|c| encoded(f64::from(c + 1.0 - cover))),
            Background::Transparent => self.rgb.map(|c| encoded(f64::from(c / cover))),
        };
        let alpha = match background {
            Background::White => 255,
            Background::Transparent => libm::roundf(255.0 * cover) as u8,
        };
        [r, g, b, alpha]
    }
}

/// Linear light of every 8-bit component.
pub(crate) struct LinearTable([f32; 256]);

impl LinearTable {
    pub(crate) fn new() -> Self {
        Self(std::array::from_fn(|i| decoded(i as u8) as f32))
    }

    pub(crate) fn light(&self, color: [u8; 3]) -> [f32; 3] {
        color.map(|c| self.0[usize::from(c)])
    }
}
